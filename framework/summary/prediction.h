/* Does a measure of trees predict what rays take? Per kind of rays, over all cells of a document
 * whose answers are right, whose intersector is `exact` and whose tree is more than a leaf: SAH
 * alone, EPO alone, (1 - alpha) SAH + alpha EPO with the best alpha (fit.h), and the counted work
 * of the very rays.
 *
 * A group, which has one factor, is the cells of one kernel on one ray set of one run. SAH and EPO
 * are those of the tree as built; EPO is the metric that is `mixed`, the better one where it has
 * two.
 */
#ifndef BB_PREDICTION_H
#define BB_PREDICTION_H

#include "framework/record/record.h"
#include "framework/summary/fit.h"

/* So many trees more than scenes make a fit. */
enum { BB_PREDICTION_TREES = 5 };

/* A cell by the geometric mean of its group. */
typedef struct bb_prediction_point {
    uint32_t trace; /* index in the document */
    double time, sah, overlap, mix, work;
} bb_prediction_point;

typedef struct bb_prediction {
    bb_prediction_record record;
    const char *rays; /* the document's */
    bb_prediction_point *points;
} bb_prediction;

typedef struct bb_predictions {
    bb_prediction *kinds; /* in the order of the document; those with too few trees are left out */
    uint32_t count;
} bb_predictions;

/* EPO of a build's tree: the better estimate where there are two; NAN. */
double bb_prediction_overlap(const bb_entry *build);

/* BB_FAILED without memory. */
bb_status bb_predictions_make(const bb_results *results, bb_predictions *out);
void bb_predictions_free(bb_predictions *predictions);

/* Puts them into the document, in place of those of an earlier state of it. */
bb_status bb_predictions_record(bb_results *results);

#endif
