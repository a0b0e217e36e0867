/* Where on an axis do methods begin to fail? First at a few values from end to end, then by
 * bisection. Knows nothing of how a value is measured, so that it can be tried on made-up ones. */
#ifndef BB_SEARCH_H
#define BB_SEARCH_H

#include "framework/stress/axis.h"
#include "framework/stress/figures.h"

enum { BB_METHODS_MAX = 96, BB_PROBES_MAX = 256, BB_WISHES_MAX = 128 };

/* The methods at one value: figures[m] of method m, BB_NOT_MEASURED of those that nobody asked for.
 */
typedef struct bb_search_probe {
    double x;
    bb_point_figures *figures; /* from malloc */
} bb_search_probe;

/* Where a method begins to fail in one manner. */
typedef struct bb_threshold {
    bool found;
    bool from_start; /* fails where all should be normal */
    bool returns;    /* at a later value it does not fail any more */
    double below;    /* the last value without, unless from_start */
    double at;       /* the first value with */
    double ratio;    /* of a manner that compares: how many times the normal figure, there */
} bb_threshold;

/* A value that is to be measured. */
typedef struct bb_wish {
    double x;
    bool wanted[BB_METHODS_MAX];
    bb_point_figures *figures; /* of all methods; those of the wanted ones are to be filled */
} bb_wish;

/* Measures all wishes side by side, in one process if all goes well; `again`: anew, whatever was
 * measured before. Anything but BB_OK ends the search. */
typedef bb_status bb_measure_fn(void *user, bb_wish *wishes, uint32_t count, bool again);

typedef struct bb_search {
    const bb_axis *axis;
    uint32_t method_count;
    uint32_t intervals, bisections; /* at most */
    bool times;                     /* judges times too, which takes a second look */
    bb_measure_fn *measure;
    void *user;
    /* out */
    uint32_t probe_count;
    bb_search_probe probes[BB_PROBES_MAX]; /* in the order of the axis */
    bb_threshold thresholds[BB_METHODS_MAX][BB_MANNERS];
} bb_search;

/* Fills probes and thresholds. A failure that a time tells is looked at again beside the normal
 * value, and counts if it shows again. What was found until an interruption (framework/base/
 * interrupt.h) stays. Release with bb_search_free(), also after a failure. */
bb_status bb_search_run(bb_search *search);
void bb_search_free(bb_search *search);

/* A method's figures at a value; NULL if nothing was measured there. */
const bb_point_figures *bb_search_figures(const bb_search *search, double x, uint32_t method);

#endif
