/* The results of judging: a class per ray, and counts over many. framework/judge/README.md and
 * arbiter.h define them. */
#ifndef BB_ACCURACY_H
#define BB_ACCURACY_H

#include <stdint.h>

/* Class of one ray. */
typedef enum bb_class {
    BB_RIGHT,
    BB_TIE, /* right, but names another primitive than the oracle */
    BB_MISSED,
    BB_FALSE_HIT,
    BB_WRONG_T,
    BB_UNWRITTEN, /* still poison, or not a number: counts as missed, named in the message */
} bb_class;

/* A count that was not taken: null in records. */
#define BB_UNCOUNTED UINT64_MAX

typedef struct bb_accuracy {
    uint64_t checked; /* rays judged */
    uint64_t right;   /* including ties */
    uint64_t ties;
    uint64_t missed; /* including unwritten ones */
    uint64_t false_hits;
    uint64_t wrong_t;
    uint64_t unwritten;
    uint64_t margin_limited; /* the margin exceeds a quarter of the smallest height of the reported
                              * primitive or of the oracle's */
    uint64_t t_off;          /* right, with t off by more than 2^-10 of its value */
    uint64_t oracle_wrong;   /* rays on which Embree's answer is missed, false or wrong t */
    uint64_t forgiven;       /* right, but wrong by the letter: bb_arbiter_forgives() */
    uint64_t arbitrated;     /* answers that needed the arbiter's full definitions */
    double wrong_ppm;        /* (missed + false + wrong t) per million */
    double t_ulp_max;        /* over right hits that name their primitive; NAN without any */
    double t_ulp_p99;
    double judge_ms;
    uint32_t first_wrong; /* index of the first wrong ray; BB_NONE without any */
} bb_accuracy;

#endif
