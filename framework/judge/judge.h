/* The judge: which of a tracer's answers to a ray set are right. */
#ifndef BB_JUDGE_H
#define BB_JUDGE_H

#include "framework/judge/accuracy.h"
#include "framework/judge/oracle.h"

#include <stdbool.h>

typedef struct bb_verdict_request {
    const void *results; /* answers of the query's type: bb_hit for a closest or any hit */
    uint32_t count;      /* at most the number of rays: answers to the first rays */
    bool
        may_be_unnamed; /* an any-hit answer may be BB_UNNAMED: Embree's and outside tracers' may */
    uint8_t *classes;   /* out: one bb_class per answer; may be NULL */
} bb_verdict_request;

/* Judges by the rays' query. A hit counts as right if one of these proves it:
 *
 *   - a miss: the oracle's miss was proved right;
 *   - any hit: the ray itself, in exact arithmetic, hits the primitive named, at a t within the
 *     margin;
 *   - closest hit: it names the oracle's primitive, at a t within the margin of the exact one, and
 *     the ray itself was shown to hit nothing else before that (BB_ORACLE_SURE);
 *   - the arbiter's full definitions (arbiter.h).
 *
 * Judged answers of a set are kept: the same answer, bit for bit, is not judged again.
 * BB_INVALID for more answers than rays. */
bb_status bb_judge(bb_oracle *oracle, bb_answers *answers, const bb_verdict_request *request,
                   bb_accuracy *accuracy);

#endif
