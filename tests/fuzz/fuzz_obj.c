/* Wavefront OBJ. */
#include "tests/fuzz/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_scene("scene.obj", data, size);
    return 0;
}
