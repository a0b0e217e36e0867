/* The judge: which of a tracer's answers to a ray set are right. */
#ifndef BB_JUDGE_H
#define BB_JUDGE_H

#include "framework/judge/accuracy.h"
#include "framework/judge/oracle.h"

#include <stdbool.h>

typedef struct bb_verdict_request {
    const void *results; /* answers as the query has them: bb_hit of a closest or any hit */
    uint32_t count;      /* as many as there are rays, or fewer: those of the first rays */
    bool
        may_be_unnamed; /* an any-hit answer may be BB_UNNAMED: Embree's and outside tracers' may */
    uint8_t *classes;   /* out: one bb_class per answer; may be NULL */
} bb_verdict_request;

/* By the rays' query. A hit is right because it was shown to be, in one of these ways:
 *
 *   - the oracle was shown right to miss, and so does this;
 *   - any hit: the ray itself, in exact arithmetic, hits the primitive named, at a t within the
 *     margin;
 *   - closest hit: it names the oracle's primitive, at a t within the margin of the exact one, and
 *     the ray itself was shown to hit nothing else before that (BB_ORACLE_SURE);
 *   - all of the arbiter's definitions say so (arbiter.h).
 *
 * A set's answers are remembered: one that comes again, bit for bit, is not judged again.
 * BB_INVALID for more answers than rays. */
bb_status bb_judge(bb_oracle *oracle, bb_answers *answers, const bb_verdict_request *request,
                   bb_accuracy *accuracy);

#endif
