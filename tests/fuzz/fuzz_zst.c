/* Raw volumes that zstd compressed. */
#include "tests/fuzz/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_scene("scene_9x4x5_uint8.raw.zst", data, size);
    return 0;
}
