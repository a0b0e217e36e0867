/* Which rays a sample of a set has: runs of rays that follow each other, as many short and long
 * ones as the set has. */
#ifndef BB_SAMPLE_H
#define BB_SAMPLE_H

#include <stdint.h>

/* Rays of a sample that follow each other, so that groups have their neighbours. */
enum { BB_STEPS_RUN = 1 << 6 };

/* BB_STEPS_RUN rays that follow each other, and the steps of the longest of each few neighbours. */
typedef struct bb_sample_run {
    uint32_t number;
    uint64_t steps;
} bb_sample_run;

/* Adds the steps of rays first to first + count - 1 to their runs, which begin zeroed; `first` is a
 * multiple of BB_STEPS_RUN. */
void bb_sample_add(const uint32_t *steps, uint32_t first, uint32_t count, bb_sample_run *runs);

/* Chooses `taken` of the runs, and puts these to the front, by their numbers. */
void bb_sample_choose(bb_sample_run *runs, uint32_t count, uint32_t taken);

#endif
