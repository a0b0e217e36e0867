/* What is measured of a method at one value of an axis, and the manners in which it fails. */
#ifndef BB_STRESS_FIGURES_H
#define BB_STRESS_FIGURES_H

#include <stdbool.h>
#include <stdint.h>

/* How a measurement ended. */
typedef enum bb_outcome {
    BB_NOT_MEASURED, /* nobody asked */
    BB_MEASURED,
    BB_OUT_UNSUPPORTED, /* it does not take such scenes, and says so: no failure */
    BB_OUT_REFUSED,     /* it says that it will not: a scene, a size, a depth */
    BB_OUT_FAILED,
    BB_OUT_CRASHED, /* its process died */
    BB_OUT_HUNG,    /* its process did not end within the limit of time */
    BB_OUT_MEMORY,  /* its process took more memory than the limit */
    BB_OUTCOMES,
} bb_outcome;

const char *bb_outcome_word(bb_outcome outcome);

/* NAN: not measured. Times are the least of the rounds, which noise can only lengthen. If some of
 * the ray sets were refused, the outcome says so, and the figures are those of the others. */
typedef struct bb_point_figures {
    bb_outcome outcome;
    char reason[256]; /* of all but BB_MEASURED */
    double prims;     /* of the scene */
    double build_ms;
    double ray_sets;       /* those that were traced, as bits in the order of the axis; 0: none */
    double trace_ms, rays; /* sums over these */
    double tests;          /* of boxes and primitives, per ray */
    double metric;         /* of the tree: that of bb_metric_of_layouts() */
    double bytes;          /* of the tree with all scratch, at the peak */
    double wrong, checked; /* answers */
    double unlike;         /* answers unlike those of another cell that must be as exact */
    double overflowed;     /* counted rays that needed more stack than there is */
    double rebuilt;        /* of moving scenes: share of frames in which the tree was built again */
} bb_point_figures;

/* Manners of failing. Those that are told by a comparison take the method's own figures where all
 * is normal; those by times are not the same in every run. */
typedef enum bb_manner {
    BB_MANNER_CRASHED,
    BB_MANNER_HUNG,
    BB_MANNER_MEMORY,
    BB_MANNER_FAILED,
    BB_MANNER_WRONG,
    BB_MANNER_OVERFLOWED,
    BB_MANNER_REFUSED,
    BB_MANNER_REBUILT,    /* its update gives up, more than twice as often */
    BB_MANNER_BIGGER,     /* more than twice the bytes per primitive */
    BB_MANNER_MORE_TESTS, /* more than twice the tests per ray */
    BB_MANNER_SLOW_TRACE, /* more than twice the time per ray */
    BB_MANNER_SLOW_BUILD, /* more than twice the time per primitive */
    BB_MANNERS,
} bb_manner;

typedef struct bb_manner_about {
    const char *name; /* in files */
    const char *word; /* in sentences: "is wrong" without the "is" */
    bool relative;    /* to what is normal */
    bool timed;
} bb_manner_about;

extern const bb_manner_about bb_manners[BB_MANNERS];

/* What is twice, in all manners that compare. */
#define BB_STRESS_FACTOR 2.0

/* Nothing of it was measured. */
bb_point_figures bb_no_figures(bb_outcome outcome);

/* How many times the normal figure this one is, of a manner that compares; NAN if either was not
 * measured, or not of the same ray sets. Infinite for a tree that is normally never built again. */
double bb_manner_ratio(bb_manner manner, const bb_point_figures *normal,
                       const bb_point_figures *here);

/* Whether it fails in that manner. */
bool bb_manner_shows(bb_manner manner, const bb_point_figures *normal,
                     const bb_point_figures *here);

#endif
