/* NRRD, as teem reads it. */
#include "tests/fuzz/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_scene("scene.nrrd", data, size);
    return 0;
}
