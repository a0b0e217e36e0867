/* Fits the time of rays to a cost of trees, or to the best mix of two costs:
 *
 *   y = c (1 - alpha) a + c alpha b       of each cell; c: one for each group of cells
 *
 * (Aila, Karras, Laine 2013, with SAH as a and EPO as b). The cells of a group differ only in the
 * tree, so c is the group's time per unit of cost. The fit is least squares of logarithms:
 * deviations count relative to the time, and c is the group's mean.
 */
#ifndef BB_FIT_H
#define BB_FIT_H

#include <stdint.h>

/* A cell of a fit. Cells of a group must stand together, and all three figures must be positive. */
typedef struct bb_fit_cell {
    uint32_t group;
    uint32_t fold; /* cells of one fold are left out together; from 0 */
    double a, b, y;
} bb_fit_cell;

typedef struct bb_fit {
    double error;       /* typical relative deviation from the measured time; NAN: too few cells */
    double correlation; /* of logarithms within groups; NAN: one of both never varies */
} bb_fit;

/* Returns how well the mix with this alpha, 0 to 1, fits. `fitted`: number of parameters, besides
 * those of the groups, that were fitted to these cells. */
bb_fit bb_fit_of(const bb_fit_cell *cells, uint32_t count, double alpha, uint32_t fitted);

enum { BB_FIT_ALL = UINT32_MAX };
/* Returns the alpha of least squares, 0 to 1, over all cells but those of fold `without`
 * (BB_FIT_ALL: over all cells). NAN if all alphas predict the same. */
double bb_fit_alpha(const bb_fit_cell *cells, uint32_t count, uint32_t without);

/* Results of leaving out one fold after the other. */
typedef struct bb_fit_spread {
    double least, most; /* of alpha; NAN: fewer than 3 folds, or one without an alpha */
    double unseen;      /* error on the cells of the fold that was left out; NAN likewise */
} bb_fit_spread;

bb_fit_spread bb_fit_folds(const bb_fit_cell *cells, uint32_t count, uint32_t folds);

#endif
