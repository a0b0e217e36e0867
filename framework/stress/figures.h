/* Figures of a method at one value of an axis, and manners of failing. */
#ifndef BB_STRESS_FIGURES_H
#define BB_STRESS_FIGURES_H

#include "framework/simulate/simulated_sets.h"

#include <stdbool.h>
#include <stdint.h>

/* How a measurement ended. */
typedef enum bb_outcome {
    BB_NOT_MEASURED, /* not asked for */
    BB_MEASURED,
    BB_OUT_UNSUPPORTED, /* it declares that it does not support such scenes: no failure */
    BB_OUT_REFUSED,     /* it refuses the scene, a size or a depth */
    BB_OUT_FAILED,
    BB_OUT_CRASHED, /* its process died */
    BB_OUT_HUNG,    /* its process exceeded the time limit */
    BB_OUT_MEMORY,  /* its process exceeded the memory limit */
    BB_OUTCOMES,
} bb_outcome;

const char *bb_outcome_word(bb_outcome outcome);

/* NAN: not measured. Times are the least of the rounds, since noise only lengthens them. If some
 * ray sets were refused, so is the outcome, and the figures are those of the others. */
typedef struct bb_point_figures {
    bb_outcome outcome;
    char reason[256]; /* "" for BB_MEASURED */
    double prims;     /* of the scene */
    double build_ms;
    double ray_sets;                      /* traced sets, as bits in the order of the axis */
    double trace_ms, rays;                /* sums over these sets */
    double tests;                         /* box and primitive tests per ray */
    double metric;                        /* bb_metric_of_layouts() of the tree */
    double bytes;                         /* peak of the tree with scratch */
    double wrong, checked;                /* answers */
    double unlike;                        /* answers that differ from those of another exact cell */
    double overflowed;                    /* counted rays whose stack was too small */
    double rebuilt;                       /* moving scenes: share of frames with a new build */
    bb_simulation simulated[BB_SIMT_MAX]; /* of all traced sets; of moving scenes, of the last
                                           * frame */
} bb_point_figures;

/* Manners of failing. Relative manners compare with the method's own figures in the normal case.
 * Those by time may differ between runs. */
typedef enum bb_manner {
    BB_MANNER_CRASHED,
    BB_MANNER_HUNG,
    BB_MANNER_MEMORY,
    BB_MANNER_FAILED,
    BB_MANNER_WRONG,
    BB_MANNER_OVERFLOWED,
    BB_MANNER_REFUSED,
    BB_MANNER_REBUILT,    /* its update gives up more than twice as often */
    BB_MANNER_BIGGER,     /* more than twice the bytes per primitive */
    BB_MANNER_MORE_TESTS, /* more than twice the tests per ray */
    BB_MANNER_SLOW_TRACE, /* more than twice the time per ray */
    BB_MANNER_SLOW_BUILD, /* more than twice the time per primitive */
    BB_MANNERS,
} bb_manner;

typedef struct bb_manner_about {
    const char *name; /* in files */
    const char *word; /* in sentences: "wrong" of "is wrong" */
    bool relative;    /* compared with the normal case */
    bool timed;
} bb_manner_about;

extern const bb_manner_about bb_manners[BB_MANNERS];

/* The factor of all relative manners. */
#define BB_STRESS_FACTOR 2.0

/* Returns figures that are all not measured. */
bb_point_figures bb_no_figures(bb_outcome outcome);

/* Returns the ratio of a relative manner's figure to the normal one. NAN: a figure was not
 * measured, or the ray sets differ. Infinite: the tree is normally never built again. */
double bb_manner_ratio(bb_manner manner, const bb_point_figures *normal,
                       const bb_point_figures *here);

/* Returns whether the method fails in this manner. */
bool bb_manner_shows(bb_manner manner, const bb_point_figures *normal,
                     const bb_point_figures *here);

#endif
