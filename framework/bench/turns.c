#include "framework/bench/turns.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/base/number.h"
#include "framework/bench/launches.h"

#include <stdlib.h>

enum { LONG_MS = 10000 }; /* what takes longer is foretold */

static bb_status make_round(bb_turns *turns, uint32_t round, double *ms)
{
    uint32_t *order = malloc((turns->count + 1) * sizeof *order);
    bb_status status = BB_OK;
    if (order == NULL)
        return bb_fail(BB_FAILED, "no memory for the order of %u turns", turns->count);
    bb_random_order(turns->random, order, turns->count);
    for (uint32_t i = 0; i < turns->count && status == BB_OK; i++)
        status = turns->turn(turns->self, order[i], round, ms);
    free(order);
    return status;
}

bb_status bb_turns_round(bb_turns *turns, uint32_t round)
{
    double ms = 0;
    return make_round(turns, round, &ms);
}

uint32_t bb_turns_foretell(bb_progress *progress, const char *scene, double ms, uint32_t rounds,
                           double ends_ms)
{
    const double fit = (ends_ms - bb_wall_ms()) / ms;
    const uint32_t more = ends_ms <= 0 || fit >= rounds ? rounds : fit > 1 ? (uint32_t)fit : 1;
    char time[BB_TIME_TEXT];
    bb_time_words(more * ms / 1e3, time);
    if (more < rounds)
        bb_progress_note(progress, "%s: %u of %u rounds, which take about %s: --time", scene, more,
                         rounds, time);
    else if (more * ms > LONG_MS)
        bb_progress_note(progress, "%s: %u rounds take about %s", scene, more, time);
    return more;
}

bb_status bb_turns_warm_up(bb_turns *turns, bb_progress *progress, const char *scene,
                           const char *what)
{
    bb_warming warming = {.rounds = 0};
    bool warm = turns->device->is_cpu;
    while (!warm && !bb_interrupted()) {
        double ms = 0;
        BB_TRY(make_round(turns, BB_WARMING_UP, &ms));
        warm = bb_warmed(&warming, ms);
    }
    if (warming.rounds > 0 && !warming.settled && !bb_interrupted())
        bb_progress_note(progress,
                         "%s: %s: %u rounds of warming up did not settle: times may be noisy",
                         scene, what, warming.rounds);
    return BB_OK;
}
