/* The oracle: Embree's answers to a ray set, each held against exact arithmetic.
 *
 * Embree's answer proves nothing by itself, and neither does a kernel that agrees with it: both may
 * lose the same primitive. So each of Embree's answers is arbitrated once per ray set, and
 * agreement with it counts only where it was proved right (judge.h). */
#ifndef BB_ORACLE_H
#define BB_ORACLE_H

#include "framework/judge/rays.h"
#include "framework/scene/scene.h"

typedef struct bb_oracle bb_oracle;

/* Makes an oracle: Embree (medium, robust, compact) over the scene, which must outlive
 * it. */
bb_status bb_oracle_create(const bb_scene *scene, uint32_t threads, bb_oracle **out);
void bb_oracle_destroy(bb_oracle *oracle); /* NULL is allowed */

/* Traces single rays with Embree, to make secondary rays. */
bb_status bb_oracle_trace(bb_oracle *oracle, const bb_ray *rays, uint32_t count,
                          const bb_query *query, bb_hit *hits);

/* Makes all that the oracle needs, arbitration included, unless it is there: it takes time and
 * memory. Whoever asks the oracle does it too. */
bb_status bb_oracle_prepare(bb_oracle *oracle);
/* Frees all that the oracle needs, which is made again when somebody asks it. Returns whether there
 * was anything to free. */
bool bb_oracle_give_up(bb_oracle *oracle);

/* What is known about one of the oracle's answers. */
enum {
    BB_ORACLE_WRONG, /* missed, false or wrong t */
    BB_ORACLE_RIGHT,
    /* Right, and proved by the ray itself, without moved copies. A miss: it hits nothing. A closest
     * hit: it hits nothing else before the end of the primitive's margin, so that any other t
     * within the margin is right as well. An unnamed hit: it hits something. */
    BB_ORACLE_SURE,
};

struct bb_judged; /* answers already judged: judge_hits.c */

/* The oracle's answers to one ray set (any hit: without the primitive, see bb_embree_trace()):
 * traced and arbitrated once, then used to judge any number of answers. Empty for a query whose
 * answers are no hits. */
typedef struct bb_answers {
    const bb_rays *rays;
    bb_hit *hits;
    uint8_t *shown; /* BB_ORACLE_... per ray */
    struct bb_judged *judged;
} bb_answers;

/* Traces and arbitrates. `rays` must outlive the answers. After a failure there is nothing to
 * release. */
bb_status bb_answers_make(bb_oracle *oracle, const bb_rays *rays, bb_answers *answers);

/* The two halves of bb_answers_make(), for callers that time them: the second arbitrates
 * answers->hits, whatever their source. A failure releases nothing. */
bb_status bb_answers_trace(bb_oracle *oracle, const bb_rays *rays, bb_answers *answers);
bb_status bb_answers_show(bb_oracle *oracle, bb_answers *answers);
void bb_answers_release(bb_answers *answers);

#endif
