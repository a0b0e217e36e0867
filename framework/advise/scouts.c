/* Chooses scouts, and removes contenders by their results. */
#include "framework/advise/scouts.h"

#include "framework/advise/heat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bb_status bb_scouts_enter(const bb_tried *builders, const bb_tried *kernels,
                          const bb_tried *intersectors, bb_entered *scouts)
{
    const char *builder = builders->items[bb_tried_scout(builders)];
    const size_t careful = bb_tried_careful(intersectors);
    uint32_t count = 0;
    bb_contender *who = calloc(kernels->count + intersectors->count, sizeof *who);
    for (size_t k = 1; who != NULL && k <= kernels->count; k++)
        who[count++] = (bb_contender){builder, kernels->items[k % kernels->count],
                                      intersectors->items[careful]};
    for (size_t i = 0; who != NULL && i < intersectors->count; i++)
        if (i != careful)
            who[count++] = (bb_contender){builder, kernels->items[0], intersectors->items[i]};
    return bb_entered_make(who, count, scouts);
}

bb_status bb_scouts_enter_builders(const bb_tried *builders, const char *kernel,
                                   const bb_tried *intersectors, bb_entered *scouts)
{
    const char *careful = intersectors->items[bb_tried_careful(intersectors)];
    bb_contender *who = calloc(builders->count, sizeof *who);
    for (size_t b = 0; who != NULL && b < builders->count; b++)
        who[b] = (bb_contender){builders->items[b], kernel, careful};
    return bb_entered_make(who, (uint32_t)builders->count, scouts);
}

void bb_scouts_judge(bb_entered *scouts, uint32_t kernel_count, bb_scouts_drop *drop, double slack)
{
    const uint32_t both = kernel_count - 1; /* the scout that the two groups share */
    bb_racer *intersectors = scouts->racers + both;
    const bb_racer before = *intersectors;
    drop(intersectors, scouts->count - both, slack);
    for (uint32_t i = both + 1; i < scouts->count; i++)
        if (scouts->racers[i].state == BB_TOO_SLOW)
            scouts->racers[i].behind += both;
    *intersectors = before;
    drop(scouts->racers, kernel_count, slack);
}

/* Returns whether a scout rules out a contender. Scouts with the first one's intersector stand for
 * kernels. */
static bool speaks_against(const bb_entered *scouts, uint32_t s, const bb_contender *who)
{
    const bb_contender *scout = &scouts->who[s], *first = scouts->who;
    const bool kernel = strcmp(scout->kernel, who->kernel) == 0;
    const bool intersector = strcmp(scout->intersector, who->intersector) == 0;
    const bool tells_kernels = strcmp(scout->intersector, first->intersector) == 0;
    switch (scouts->racers[s].state) {
    case BB_TOO_SLOW:
        return tells_kernels ? kernel : intersector;
    case BB_TOO_WRONG:
        return kernel && intersector;
    default:
        return false;
    }
}

uint32_t bb_scouts_keep(const bb_entered *scouts, bb_contender *who, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool out = false;
        for (uint32_t s = 0; s < scouts->count && !out; s++)
            out = speaks_against(scouts, s, &who[i]);
        if (!out)
            who[kept++] = who[i];
    }
    return kept;
}

uint32_t bb_scouts_keep_builders(const bb_entered *scouts, bb_contender *who, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool out = false;
        for (uint32_t s = 0; s < scouts->count && !out; s++)
            out = scouts->racers[s].state == BB_TOO_SLOW &&
                  strcmp(scouts->who[s].builder, who[i].builder) == 0;
        if (!out)
            who[kept++] = who[i];
    }
    return kept;
}

/* Returns NULL if there is no such scout, or it could not run. */
static const bb_tried_figures *figures_of(const bb_entered *scouts, const char *kernel,
                                          const char *intersector)
{
    for (uint32_t s = 0; s < scouts->count; s++)
        if (scouts->figures[s].measured && strcmp(scouts->who[s].kernel, kernel) == 0 &&
            strcmp(scouts->who[s].intersector, intersector) == 0)
            return &scouts->figures[s];
    return NULL;
}

/* Predicts a contender's time from its builder's scout `b`. NAN: no prediction. */
static double foretold_ms(const bb_entered *scouts, const bb_entered *builders, uint32_t b,
                          const bb_contender *who)
{
    const char *careful = scouts->who[0].intersector;
    const char *common = scouts->who[scouts->count - 1].kernel; /* of the scouts for intersectors */
    const bb_tried_figures *builder = &builders->figures[b];
    const bb_tried_figures *kernel = figures_of(scouts, who->kernel, careful);
    const bb_tried_figures *its = figures_of(scouts, builders->who[b].kernel, careful);
    const bb_tried_figures *intersector = figures_of(scouts, common, who->intersector);
    const bb_tried_figures *beside = figures_of(scouts, common, careful);
    if (!builder->measured || kernel == NULL || its == NULL || intersector == NULL ||
        beside == NULL)
        return NAN;
    return builder->build_ms + builder->layout_ms * kernel->layout_ms / its->layout_ms +
           builder->trace_ms * kernel->trace_ms / its->trace_ms * intersector->trace_ms /
               beside->trace_ms;
}

static double foretold_of(const bb_entered *scouts, const bb_entered *builders,
                          const bb_contender *who)
{
    for (uint32_t b = 0; b < builders->count; b++)
        if (strcmp(builders->who[b].builder, who->builder) == 0)
            return foretold_ms(scouts, builders, b, who);
    return NAN;
}

uint32_t bb_scouts_keep_likely(const bb_entered *scouts, const bb_entered *builders,
                               bb_contender *who, uint32_t count, double slack)
{
    double least = INFINITY;
    uint32_t kept = 0;
    if (scouts->count == 0)
        return count;
    for (uint32_t i = 0; i < count; i++)
        least = fmin(least, foretold_of(scouts, builders, &who[i]));
    for (uint32_t i = 0; i < count; i++)
        if (!(foretold_of(scouts, builders, &who[i]) > slack * least))
            who[kept++] = who[i];
    return kept;
}
