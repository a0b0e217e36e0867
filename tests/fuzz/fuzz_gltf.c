/* glTF as JSON, with buffers in data URIs. */
#include "tests/fuzz/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_scene("scene.gltf", data, size);
    return 0;
}
