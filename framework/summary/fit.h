/* How well a cost of trees predicts what rays take, and which mix of two costs does so best:
 *
 *   y = c (1 - alpha) a + c alpha b       of each cell; c: one for each group of cells
 *
 * (Aila, Karras, Laine 2013, with SAH as a and EPO as b). A group is what is measured under the
 * same conditions but for the tree, so that c is the time of a unit of cost there. Least squares of
 * logarithms: deviations count in parts of the time, and c falls out as the group's mean.
 */
#ifndef BB_FIT_H
#define BB_FIT_H

#include <stdint.h>

/* Cells of a group stand together; all three figures are positive. */
typedef struct bb_fit_cell {
    uint32_t group;
    uint32_t fold; /* what is left out together, from 0 */
    double a, b, y;
} bb_fit_cell;

typedef struct bb_fit {
    double error; /* typical deviation from what was measured, in parts of it; NAN: too few cells */
    double correlation; /* of logarithms, within the groups; NAN: one of the two never varies */
} bb_fit;

/* Of the mix with this alpha, 0 to 1. `fitted`: how many figures were fitted to these cells besides
 * the groups'. */
bb_fit bb_fit_of(const bb_fit_cell *cells, uint32_t count, double alpha, uint32_t fitted);

enum { BB_FIT_ALL = UINT32_MAX };
/* The alpha of least squares, 0 to 1, over all cells but those of the fold `without` (BB_FIT_ALL:
 * over all). NAN where every alpha predicts alike. */
double bb_fit_alpha(const bb_fit_cell *cells, uint32_t count, uint32_t without);

/* What is known of alpha from leaving out one of `folds` folds after the other. */
typedef struct bb_fit_spread {
    double least, most; /* of alpha; NAN: fewer than 3 folds, or one without an alpha */
    double unseen;      /* error on cells whose fold did not enter alpha; NAN likewise */
} bb_fit_spread;

bb_fit_spread bb_fit_folds(const bb_fit_cell *cells, uint32_t count, uint32_t folds);

#endif
