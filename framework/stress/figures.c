#include "framework/stress/figures.h"

#include <math.h>

const char *bb_outcome_word(bb_outcome outcome)
{
    static const char *const words[BB_OUTCOMES] = {
        "not measured", "ok", "unsupported", "refused", "failed", "crashed", "hung", "memory"};
    return words[outcome];
}

bb_point_figures bb_no_figures(bb_outcome outcome)
{
    const bb_simulated_sets no_sets = {.count = 0};
    bb_point_figures none = {.outcome = outcome,
                             .prims = NAN,
                             .build_ms = NAN,
                             .ray_sets = NAN,
                             .trace_ms = NAN,
                             .rays = NAN,
                             .tests = NAN,
                             .metric = NAN,
                             .bytes = NAN,
                             .wrong = NAN,
                             .checked = NAN,
                             .unlike = NAN,
                             .overflowed = NAN,
                             .rebuilt = NAN};
    for (uint32_t i = 0; i < BB_SIMT_MAX; i++)
        none.simulated[i] = bb_simulated_sum(&no_sets);
    return none;
}

const bb_manner_about bb_manners[BB_MANNERS] = {
    [BB_MANNER_CRASHED] = {"crashed", "crashes", false, false},
    [BB_MANNER_HUNG] = {"hung", "hangs", false, false},
    [BB_MANNER_MEMORY] = {"memory", "beyond the limit of memory", false, false},
    [BB_MANNER_FAILED] = {"failed", "fails", false, false},
    [BB_MANNER_WRONG] = {"wrong", "wrong answers", false, false},
    [BB_MANNER_OVERFLOWED] = {"overflowed", "stack overflow caught", false, false},
    [BB_MANNER_REFUSED] = {"refused", "refused", false, false},
    [BB_MANNER_REBUILT] = {"rebuilt", "no update: built again", true, false},
    [BB_MANNER_BIGGER] = {"bigger", "twice the memory", true, false},
    [BB_MANNER_MORE_TESTS] = {"more-tests", "twice the tests per ray", true, false},
    [BB_MANNER_SLOW_TRACE] = {"slow-trace", "half the trace speed", true, true},
    [BB_MANNER_SLOW_BUILD] = {"slow-build", "half the build speed", true, true},
};

/* Returns NAN without a normal figure. */
static double over(double here, double normal)
{
    return normal > 0 ? here / normal : (double)NAN;
}

double bb_manner_ratio(bb_manner manner, const bb_point_figures *normal,
                       const bb_point_figures *here)
{
    if (normal->outcome != BB_MEASURED || here->outcome != BB_MEASURED)
        return NAN;
    const bool same_rays = normal->ray_sets == here->ray_sets;
    switch (manner) {
    case BB_MANNER_REBUILT:
        return normal->rebuilt == 0 ? (here->rebuilt > 0 ? INFINITY : 1)
                                    : over(here->rebuilt, normal->rebuilt);
    case BB_MANNER_BIGGER:
        return over(here->bytes / here->prims, normal->bytes / normal->prims);
    case BB_MANNER_MORE_TESTS:
        return same_rays ? over(here->tests, normal->tests) : (double)NAN;
    case BB_MANNER_SLOW_TRACE:
        return same_rays ? over(here->trace_ms / here->rays, normal->trace_ms / normal->rays)
                         : (double)NAN;
    case BB_MANNER_SLOW_BUILD:
        return over(here->build_ms / here->prims, normal->build_ms / normal->prims);
    default:
        return NAN;
    }
}

bool bb_manner_shows(bb_manner manner, const bb_point_figures *normal, const bb_point_figures *here)
{
    if (bb_manners[manner].relative)
        return bb_manner_ratio(manner, normal, here) > BB_STRESS_FACTOR;
    switch (manner) {
    case BB_MANNER_CRASHED:
        return here->outcome == BB_OUT_CRASHED;
    case BB_MANNER_HUNG:
        return here->outcome == BB_OUT_HUNG;
    case BB_MANNER_MEMORY:
        return here->outcome == BB_OUT_MEMORY;
    case BB_MANNER_FAILED:
        return here->outcome == BB_OUT_FAILED;
    case BB_MANNER_REFUSED:
        return here->outcome == BB_OUT_REFUSED;
    case BB_MANNER_WRONG:
        return here->wrong > 0;
    case BB_MANNER_OVERFLOWED:
        return here->overflowed > 0;
    default:
        return false;
    }
}
