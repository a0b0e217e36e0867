/* Finds where on an axis methods begin to fail: first at a few values from end to end, then by
 * bisection. The caller measures the values. */
#ifndef BB_SEARCH_H
#define BB_SEARCH_H

#include "framework/stress/axis.h"
#include "framework/stress/figures.h"

enum { BB_METHODS_MAX = 96, BB_PROBES_MAX = 256, BB_WISHES_MAX = 128 };

/* Figures at one value. figures[m] of method m are BB_NOT_MEASURED if it was not asked for. */
typedef struct bb_search_probe {
    double x;
    bb_point_figures *figures; /* from malloc */
} bb_search_probe;

/* Where a method begins to fail in one manner. */
typedef struct bb_threshold {
    bool found;
    bool from_start; /* it fails in the normal case */
    bool returns;    /* it does not fail at some later value */
    double below;    /* the last value before the failure, unless from_start */
    double at;       /* the first value with the failure */
    double ratio;    /* relative manners: the ratio to the normal figure at this value */
} bb_threshold;

/* A value to measure. */
typedef struct bb_wish {
    double x;
    bool wanted[BB_METHODS_MAX];
    bb_point_figures *figures; /* of all methods; those of the wanted methods are filled */
} bb_wish;

/* Measures all wishes side by side. `again`: ignores earlier measurements. A failure ends the
 * search. */
typedef bb_status bb_measure_fn(void *user, bb_wish *wishes, uint32_t count, bool again);

typedef struct bb_search {
    const bb_axis *axis;
    uint32_t method_count;
    uint32_t intervals, bisections; /* upper limits */
    bool times;                     /* also judges times, by a second measurement */
    bb_measure_fn *measure;
    void *user;
    /* out */
    uint32_t probe_count;
    bb_search_probe probes[BB_PROBES_MAX]; /* in the order of the axis */
    bb_threshold thresholds[BB_METHODS_MAX][BB_MANNERS];
} bb_search;

/* Fills probes and thresholds. A failure by time is measured again beside the normal value, and
 * counts if it shows again. Findings before an interruption (framework/base/interrupt.h) are kept.
 * Release with bb_search_free(), also after a failure. */
bb_status bb_search_run(bb_search *search);
void bb_search_free(bb_search *search);

/* Returns a method's figures at a value; NULL: not measured. */
const bb_point_figures *bb_search_figures(const bb_search *search, double x, uint32_t method);

#endif
