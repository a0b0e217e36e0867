/* Which rays of a set a sample has: runs of rays that follow each other, as many short and long
 * ones as the set has. */
#ifndef BB_SAMPLE_H
#define BB_SAMPLE_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Rays of a sample that follow each other, so that groups have their neighbours. */
enum { BB_STEPS_RUN = 1 << 6 };

/* A sample has `most` rays; if there is no room for their steps, half as many, and so on, down to
 * `least`. `least` is a multiple of BB_STEPS_RUN, and `most` is `least` times a power of two. */
typedef struct bb_sample_size {
    uint32_t least, most;
} bb_sample_size;

/* All rays of any set. */
#define BB_SAMPLE_ALL ((bb_sample_size){UINT32_MAX, UINT32_MAX})

/* Sets taken[i] to whether ray i is in the sample, and *rays to how many are: all, if they are no
 * more than size.most. Ray i has steps[i] steps; there is room for `room` steps in all. BB_REFUSED
 * if the least sample has more. */
bb_status bb_sample_take(const uint32_t *steps, uint32_t count, bb_sample_size size, uint64_t room,
                         bool *taken, uint32_t *rays);

#endif
