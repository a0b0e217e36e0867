#include "framework/simulate/sample.h"

#include "framework/base/arithmetic.h"
#include "framework/base/random.h"

#include <stdlib.h>
#include <string.h>

enum { NEIGHBOURS = 32 }; /* rays that wait for each other, about */

/* Rays that follow each other, and the steps of the longest of each few neighbours. */
typedef struct run {
    uint32_t number;
    uint64_t steps;
} run;

static int by_steps(const void *a, const void *b)
{
    const run *x = a, *y = b;
    return x->steps != y->steps ? (x->steps > y->steps) - (x->steps < y->steps)
                                : (x->number > y->number) - (x->number < y->number);
}

static uint64_t longest(const uint32_t *steps)
{
    uint64_t sum = 0;
    for (uint32_t first = 0; first < BB_STEPS_RUN; first += NEIGHBOURS) {
        uint32_t most = 0;
        for (uint32_t i = first; i < first + NEIGHBOURS; i++)
            most = bb_max_u32(most, steps[i]);
        sum += most;
    }
    return sum;
}

/* Sorted by their steps, all runs are divided into as many parts of equal size as are wanted, of
 * which each gives one at random. */
static bb_status take_runs(const uint32_t *steps, uint32_t count, uint32_t wanted, bool *taken)
{
    bb_random random = bb_random_make(1, count);
    run *runs = calloc(bb_max_u32(count, 1), sizeof *runs);
    if (runs == NULL)
        return bb_fail(BB_REFUSED, "no memory for a sample");
    for (uint32_t i = 0; i < count; i++)
        runs[i] = (run){i, longest(steps + (size_t)i * BB_STEPS_RUN)};
    qsort(runs, count, sizeof *runs, by_steps);
    for (uint32_t i = 0; i < wanted; i++) {
        const uint32_t part = (uint32_t)((uint64_t)i * count / wanted);
        const uint32_t end = (uint32_t)((uint64_t)(i + 1) * count / wanted);
        const uint32_t number = runs[part + bb_random_below(&random, end - part)].number;
        memset(taken + (size_t)number * BB_STEPS_RUN, true, BB_STEPS_RUN * sizeof *taken);
    }
    free(runs);
    return BB_OK;
}

static bb_status take(const uint32_t *steps, uint32_t count, uint32_t wanted, bool *taken)
{
    memset(taken, count <= wanted, count * sizeof *taken);
    return count <= wanted ? BB_OK
                           : take_runs(steps, count / BB_STEPS_RUN, wanted / BB_STEPS_RUN, taken);
}

static uint64_t steps_taken(const uint32_t *steps, uint32_t count, const bool *taken)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += taken[i] ? steps[i] : 0;
    return sum;
}

bb_status bb_sample_take(const uint32_t *steps, uint32_t count, bb_sample_size size, uint64_t room,
                         bool *taken, uint32_t *rays)
{
    for (uint32_t wanted = size.most; wanted >= size.least; wanted /= 2) {
        BB_TRY(take(steps, count, wanted, taken));
        *rays = bb_min_u32(count, wanted);
        if (steps_taken(steps, count, taken) <= room)
            return BB_OK;
    }
    return bb_fail(BB_REFUSED, "more than %llu steps of %u items: there is no room to record them",
                   (unsigned long long)room, *rays);
}
