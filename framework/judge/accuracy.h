/* What judging says: of one ray its class, of many their counts. Definitions: `wrong ppm` in the
 * framework/report/README.md and arbiter.h.
 */
#ifndef BB_ACCURACY_H
#define BB_ACCURACY_H

#include <stdint.h>

/* Class of one ray. */
typedef enum bb_class {
    BB_RIGHT,
    BB_TIE, /* right, on another primitive than the oracle's */
    BB_MISSED,
    BB_FALSE_HIT,
    BB_WRONG_T,
    BB_UNWRITTEN, /* still poison, or no number: counts as missed, and is named in the message */
} bb_class;

/* A count that was not made: null in records. */
#define BB_UNCOUNTED UINT64_MAX

typedef struct bb_accuracy {
    uint64_t checked; /* rays judged */
    uint64_t right;   /* ties included */
    uint64_t ties;
    uint64_t missed; /* unwritten ones included */
    uint64_t false_hits;
    uint64_t wrong_t;
    uint64_t unwritten;
    uint64_t margin_limited; /* the margin exceeds a quarter of the smallest height of the primitive
                                reported, or of the oracle's */
    uint64_t t_off;          /* right, with t off by more than 2^-10 of itself */
    uint64_t oracle_wrong;   /* rays whose answer by Embree is missed, false or wrong t */
    uint64_t forgiven;       /* right, but wrong by the letter: see bb_arbiter_forgives() */
    uint64_t arbitrated;     /* answers that took the whole of the arbiter's definitions */
    double wrong_ppm;        /* (missed + false + wrong t) per million */
    double t_ulp_max;        /* of the right hits that name their primitive; NAN if there is none */
    double t_ulp_p99;
    double judge_ms;
    uint32_t first_wrong; /* index of the first wrong ray; BB_NONE if there is none */
} bb_accuracy;

#endif
