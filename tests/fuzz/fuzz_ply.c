/* PLY, ASCII and binary. */
#include "tests/fuzz/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_scene("scene.ply", data, size);
    return 0;
}
