#include "framework/simulate/simulated_sets.h"

#include <math.h>
#include <stddef.h>

#define AT(member) offsetof(bb_simulation, member)
static const size_t bounds[] = {AT(mrays_s), AT(issue_mrays_s), AT(l1_mrays_s), AT(l2_mrays_s),
                                AT(memory_mrays_s)};
static const size_t means[] = {AT(steps), AT(stack_bytes), AT(memory_bytes)};
#undef AT

enum { BOUNDS = sizeof bounds / sizeof bounds[0], MEANS = sizeof means / sizeof means[0] };

static double *member(bb_simulation *s, size_t offset)
{
    return (double *)(void *)((char *)s + offset);
}

static double value(const bb_simulation *s, size_t offset)
{
    return *(const double *)(const void *)((const char *)s + offset);
}

void bb_simulated_add(bb_simulated_sets *sets, double rays, const bb_simulation *one)
{
    const double time = rays / one->mrays_s;
    if (sets->count++ == 0)
        sets->first = *one;
    if (time > sets->longest) {
        sets->longest = time;
        sets->binds = one->binds;
    }
    sets->rays += rays;
    sets->samples += one->rays;
    sets->lanes += rays / one->issue_mrays_s * one->efficiency;
    for (int i = 0; i < BOUNDS; i++)
        *member(&sets->sum, bounds[i]) += rays / value(one, bounds[i]);
    for (int i = 0; i < MEANS; i++)
        *member(&sets->sum, means[i]) += rays * value(one, means[i]);
}

bb_simulation bb_simulated_sum(const bb_simulated_sets *sets)
{
    if (sets->count == 1)
        return sets->first;
    bb_simulation all = {.binds = sets->binds};
#define SIMT(id, member, name, unit, better, heading, help) all.member = (double)NAN;
#include "framework/simulate/simt_figures.h"
    if (sets->count == 0)
        return all;
    for (int i = 0; i < BOUNDS; i++)
        *member(&all, bounds[i]) = sets->rays / value(&sets->sum, bounds[i]);
    for (int i = 0; i < MEANS; i++)
        *member(&all, means[i]) = value(&sets->sum, means[i]) / sets->rays;
    all.efficiency = sets->lanes / sets->sum.issue_mrays_s;
    all.rays = sets->samples;
    return all;
}
