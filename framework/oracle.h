/* Who is right: Embree's answer, and exact arithmetic where Embree and the kernel disagree.
 *
 * Definitions: `wrong_ppm` in the README ("What the figures mean"). eps = 16 * 2^-24 * max |v - o|.
 */
#ifndef BB_ORACLE_H
#define BB_ORACLE_H

#include "framework/rays.h"
#include "framework/scene.h"

typedef struct bb_oracle bb_oracle;

/* Embree (medium, robust) over the scene, and the arbiter's own box hierarchy. The scene must outlive it. */
bb_status bb_oracle_create(const bb_scene *scene, uint32_t threads, bb_oracle **out);
void bb_oracle_destroy(bb_oracle *oracle); /* NULL is allowed */

/* Embree's answers for raw rays (used to make secondary rays). */
bb_status bb_oracle_trace(bb_oracle *oracle, const bb_ray *rays, uint32_t count, bb_query query,
                          bb_hit *hits);

/* The oracle's answers to one ray set (from Embree, any-hit: without the primitive, see bb_embree_trace()); traced once, then judged against as often as needed. */
typedef struct bb_answers {
    const bb_rays *rays;
    bb_hit *hits;
    double trace_ms;
} bb_answers;

bb_status bb_answers_make(bb_oracle *oracle, const bb_rays *rays, bb_answers *answers);
void bb_answers_release(bb_answers *answers);

/* Class of one ray. */
typedef enum bb_class {
    BB_RIGHT,
    BB_TIE, /* right, on another primitive than the oracle's */
    BB_MISSED,
    BB_FALSE_HIT,
    BB_WRONG_T,
    BB_UNWRITTEN, /* still poison, or no number: counts as missed, and is named in the message */
} bb_class;

typedef struct bb_accuracy {
    uint64_t checked; /* rays compared */
    uint64_t right;   /* ties included */
    uint64_t ties;
    uint64_t missed; /* unwritten ones included */
    uint64_t false_hits;
    uint64_t wrong_t;
    uint64_t unwritten;
    uint64_t margin_limited;
    uint64_t
        oracle_wrong;  /* disagreements in which Embree's own answer is missed, false or wrong t */
    uint64_t forgiven; /* right, but wrong by the letter: see bb_arbiter_forgives() */
    uint64_t arbitrated; /* rays that went to exact arithmetic */
    double wrong_ppm;    /* (missed + false + wrong t) per million */
    double t_ulp_max;    /* NAN if no hit was right */
    double t_ulp_p99;
    double judge_ms;
    uint32_t first_wrong; /* index of the first wrong ray; BB_NONE if there is none */
} bb_accuracy;

/* Judges `hits` (answers->rays->count of them, or fewer: the first `count`). `classes` gets one bb_class per ray unless NULL.
 *
 * Right without arbitration is an answer that agrees with the oracle's: both missed; or the same primitive (any hit: both hit
 * something), and t within eps of the exact t on it. An any-hit answer with t = 0 does not say which primitive it hit. All
 * others go to the arbiter (arbiter.h has the definitions), and so does then the oracle's own answer.
 *
 * margin_limited counts the rays with a hit (the reported one, else the oracle's, where it says which) on a primitive whose box
 * has no side of four times eps or more. oracle_wrong counts must-hit rays that both missed, too. */
bb_status bb_judge(bb_oracle *oracle, const bb_answers *answers, const bb_hit *hits, uint32_t count,
                   uint8_t *classes, bb_accuracy *accuracy);

#endif
