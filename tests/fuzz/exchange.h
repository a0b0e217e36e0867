/* What the targets of rays and of hits files share: a scene, and a file whose sums are right, since
 * no mutation would find them. */
#ifndef BB_FUZZ_EXCHANGE_H
#define BB_FUZZ_EXCHANGE_H

#include "framework/workload/exchange_file.h"
#include "tests/fuzz/fuzz.h"

#include <xxhash.h>

/* Twelve triangles; freed at the end. */
static bb_scene *fuzz_cube;

static inline void fuzz_free_cube(void)
{
    bb_scene_free(fuzz_cube);
}

static inline const bb_scene *fuzz_get_cube(void)
{
    if (fuzz_cube == NULL) {
        FUZZ_CHECK(bb_scene_load("cube", &fuzz_cube) == BB_OK);
        atexit(fuzz_free_cube);
    }
    return fuzz_cube;
}

/* Puts in the checksum of the whole, which lies at `at`. */
static inline void fuzz_seal(uint8_t *bytes, size_t size, size_t at)
{
    uint64_t sum = 0;
    memcpy(bytes + at, &sum, sizeof sum);
    sum = XXH3_64bits(bytes, size);
    memcpy(bytes + at, &sum, sizeof sum);
}

#endif
