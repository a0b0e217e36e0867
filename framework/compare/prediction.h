/* How well measures of trees predict the time of rays: SAH, EPO, (1 - alpha) SAH + alpha EPO with
 * the best alpha (fit.h), and the counted work of the same rays. Each kind of rays is fitted by
 * itself, over all cells with right answers, the intersector `exact` and a tree of more than one
 * leaf.
 *
 * A group of the fit has the cells of one kernel on one ray set of one run. SAH and EPO are those
 * of the tree as built. EPO is the metric that is declared `mixed`, and its better estimate if
 * there are two.
 */
#ifndef BB_PREDICTION_H
#define BB_PREDICTION_H

#include "framework/compare/fit.h"
#include "framework/record/record.h"

/* A fit needs at least so many trees more than scenes. */
enum { BB_PREDICTION_TREES = 5 };

/* The figures of a cell, each divided by the geometric mean of its group. */
typedef struct bb_prediction_point {
    uint32_t trace; /* index in the results */
    double time, sah, overlap, mix, work;
} bb_prediction_point;

typedef struct bb_prediction {
    bb_prediction_record record;
    const char *rays; /* the text is the results' */
    bb_prediction_point *points;
} bb_prediction;

typedef struct bb_predictions {
    bb_prediction *kinds; /* in the order of the results, without those that have too few trees */
    uint32_t count;
} bb_predictions;

/* Returns the EPO of a build's tree, by the better estimate if there are two; NAN: not measured. */
double bb_prediction_overlap(const bb_entry *build);

/* BB_FAILED without memory. */
bb_status bb_predictions_make(const bb_results *results, bb_predictions *out);
void bb_predictions_free(bb_predictions *predictions);

/* Makes the predictions anew and puts them into the results in place of earlier ones. */
bb_status bb_predictions_record(bb_results *results);

#endif
