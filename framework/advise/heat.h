/* A heat: contenders measured by one or more ordinary comparisons, "turns", whose trees and layouts
 * fit into memory together.
 *
 * All turns have the reference, the contender that is thought the best, beside the others. Costs of
 * later turns are multiplied, round by round, by the reference's cost in the first turn over its
 * cost in theirs: so two contenders of different turns are compared by what each takes beside the
 * same one, measured next to it.
 */
#ifndef BB_HEAT_H
#define BB_HEAT_H

#include "framework/advise/advice.h"
#include "framework/base/progress.h"

/* How much is measured, and on what. */
typedef struct bb_heat {
    uint32_t width, height, max_rays, repeats;
    bool last; /* the last one: what is above the limit is out, not only what surely is */
    const bb_ground *ground;
    const bb_sizes *sizes; /* by which turns are made; NULL: one turn for all */
    const char *guess;     /* builder of the reference if no costs are known; NULL: any */
    bb_progress *progress; /* NULL: it is not shown */
    const char *name;      /* in it */
} bb_heat;

/* Runs those of `field` that are BB_RACING into `results` and sets their costs, figures and states:
 * BB_NOT_RUN for what was not measured, BB_TOO_WRONG for what is wrong more often than the request
 * tolerates (but in the last heat, only where the whole 95 % interval is above that), or, of rays
 * that nobody judged, was answered otherwise than by another `exact` one: of two such, nobody knows
 * which is right, but of judged ones one does. What an interrupt left unmeasured stays as it was.
 * *outcome: the sum of the turns'. */
bb_status bb_heat_run(const bb_advise_request *request, const bb_heat *heat, bb_entered *field,
                      bb_results *results, bb_bench_outcome *outcome);

/* Racers and figures for `count` contenders, which are taken over; all in the race. */
bb_status bb_entered_make(bb_contender *who, uint32_t count, bb_entered *field);
void bb_entered_free(bb_entered *field);

#endif
