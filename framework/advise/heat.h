/* A heat: contenders measured by one ordinary comparison. */
#ifndef BB_HEAT_H
#define BB_HEAT_H

#include "framework/advise/advice.h"

/* How much is measured. */
typedef struct bb_heat {
    uint32_t width, height, max_rays, repeats;
    bool last; /* the last one: what is above the limit is out, not only what surely is */
} bb_heat;

/* Runs those of `field` that are BB_RACING on the request's scene into `results`, which is empty,
 * and sets their costs, figures and states: BB_NOT_RUN for what was not measured, BB_TOO_WRONG for
 * what is wrong more often than the request tolerates (but in the last heat, only where the whole
 * 95 % interval is above that), or, of rays that nobody judged, was answered otherwise than by
 * another `exact` one: of two such, nobody knows which is right, but of judged ones one does.
 * *outcome as bb_bench_run(). */
bb_status bb_heat_run(const bb_advise_request *request, const bb_heat *heat, bb_entered *field,
                      bb_results *results, bb_bench_outcome *outcome);

/* Racers and figures for `count` contenders, which are taken over; all in the race. */
bb_status bb_entered_make(bb_contender *who, uint32_t count, bb_entered *field);
void bb_entered_free(bb_entered *field);

#endif
