/* A heat measures contenders in turns. A turn is an ordinary comparison of contenders whose trees
 * and layouts fit into memory together.
 *
 * Each turn also measures the reference, which is probably the fastest contender. Costs of later
 * turns are scaled round by round by the reference's cost in the first turn over its cost in that
 * turn. So contenders of different turns are compared by their ratio to the same reference.
 */
#ifndef BB_HEAT_H
#define BB_HEAT_H

#include "framework/advise/advice.h"
#include "framework/base/progress.h"

/* The extent of a heat. */
typedef struct bb_heat {
    uint32_t width, height, max_rays, repeats;
    bool last; /* rates above the limit drop a contender even if they may be chance */
    const bb_ground *ground;
    const bb_sizes *sizes; /* for turns; NULL: one turn for all */
    /* Costs are those of a simulation, asked for in these words, of this name in the results; NULL:
     * they are measured */
    char *metric;
    const char *simulation;
    const char *guess;     /* builder of the reference while costs are unknown; NULL: any */
    bb_progress *progress; /* NULL: not shown */
    const char *name;      /* in the progress */
} bb_heat;

/* Measures all contenders that are BB_RACING into `results`, and sets costs, figures and states.
 * BB_NOT_RUN: it could not be measured. BB_TOO_WRONG: its rate of wrong rays is above the limit (in
 * early heats: the whole 95 % interval is), or unjudged answers differ from those of another
 * `exact` contender. Contenders that an interrupt left unmeasured keep their state. *outcome: the
 * sum over all turns. */
bb_status bb_heat_run(const bb_advise_request *request, const bb_heat *heat, bb_entered *field,
                      bb_results *results, bb_bench_outcome *outcome);

/* Makes racers and figures for `count` contenders, and takes ownership of `who`. */
bb_status bb_entered_make(bb_contender *who, uint32_t count, bb_entered *field);
void bb_entered_free(bb_entered *field);

#endif
