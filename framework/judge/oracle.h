/* The oracle: Embree's answers to a ray set, each of them held against exact arithmetic.
 *
 * Nobody is believed. That Embree answers in some way proves nothing, and that a kernel agrees with
 * it proves no more (both may lose the same primitive); so each of Embree's answers is arbitrated
 * once per ray set, and only where it was shown right does agreement with it show anything
 * (judge.h).
 */
#ifndef BB_ORACLE_H
#define BB_ORACLE_H

#include "framework/rays/rays.h"
#include "framework/scene/scene.h"

typedef struct bb_oracle bb_oracle;

/* Embree (medium, robust) over the scene. The scene must outlive it. */
bb_status bb_oracle_create(const bb_scene *scene, uint32_t threads, bb_oracle **out);
void bb_oracle_destroy(bb_oracle *oracle); /* NULL is allowed */

/* Embree's answers for raw rays (used to make secondary rays). */
bb_status bb_oracle_trace(bb_oracle *oracle, const bb_ray *rays, uint32_t count,
                          const bb_query *query, bb_hit *hits);

/* What is known of one of the oracle's answers. */
enum {
    BB_ORACLE_WRONG, /* missed, false or wrong t */
    BB_ORACLE_RIGHT,
    /* Right, and shown so by the ray itself, without copies that are moved aside. A miss: it hits
     * nothing. A closest hit: it hits nothing else before the end of the primitive's margin, so
     * that any other t within the margin is right as well. An unnamed hit: it hits something. */
    BB_ORACLE_SURE,
};

struct bb_judged; /* answers that were judged before: judge.c */

/* The oracle's answers to one ray set, none where a query's answers are no hits (any hit: without
 * the primitive, see bb_embree_trace()): traced and arbitrated once, then judged against as often
 * as needed. */
typedef struct bb_answers {
    const bb_rays *rays;
    bb_hit *hits;
    uint8_t *shown; /* BB_ORACLE_... of each ray */
    struct bb_judged *judged;
} bb_answers;

/* `rays` must outlive the answers. After a failure there is nothing to release. */
bb_status bb_answers_make(bb_oracle *oracle, const bb_rays *rays, bb_answers *answers);

/* Its two halves, for who times them: the second arbitrates answers->hits, whoever gave them. A
 * failure releases nothing. */
bb_status bb_answers_trace(bb_oracle *oracle, const bb_rays *rays, bb_answers *answers);
bb_status bb_answers_show(bb_oracle *oracle, bb_answers *answers);
void bb_answers_release(bb_answers *answers);

#endif
