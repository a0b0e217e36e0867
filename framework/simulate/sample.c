#include "framework/simulate/sample.h"

#include "framework/base/arithmetic.h"
#include "framework/base/random.h"

#include <stdlib.h>

enum { NEIGHBOURS = 32 }; /* rays that wait for each other, about */

static int by_steps(const void *a, const void *b)
{
    const bb_sample_run *x = a, *y = b;
    return x->steps != y->steps ? (x->steps > y->steps) - (x->steps < y->steps)
                                : (x->number > y->number) - (x->number < y->number);
}

static int by_number(const void *a, const void *b)
{
    const bb_sample_run *x = a, *y = b;
    return (x->number > y->number) - (x->number < y->number);
}

static uint32_t most_of(const uint32_t *values, uint32_t count)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < count; i++)
        most = bb_max_u32(most, values[i]);
    return most;
}

void bb_sample_add(const uint32_t *steps, uint32_t first, uint32_t count, bb_sample_run *runs)
{
    for (uint32_t i = 0; i < count; i += NEIGHBOURS) {
        bb_sample_run *run = &runs[(first + i) / BB_STEPS_RUN];
        run->number = (first + i) / BB_STEPS_RUN;
        run->steps += most_of(steps + i, bb_min_u32(NEIGHBOURS, count - i));
    }
}

/* Sorted by their steps, all are divided into as many parts of equal size, of which each gives one
 * at random. */
void bb_sample_choose(bb_sample_run *runs, uint32_t count, uint32_t taken)
{
    bb_random random = bb_random_make(1, count);
    qsort(runs, count, sizeof *runs, by_steps);
    for (uint32_t i = 0; i < taken; i++) {
        const uint32_t part = (uint32_t)((uint64_t)i * count / taken);
        const uint32_t end = (uint32_t)((uint64_t)(i + 1) * count / taken);
        runs[i] = runs[part + bb_random_below(&random, end - part)];
    }
    qsort(runs, taken, sizeof *runs, by_number);
}
