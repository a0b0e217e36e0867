/* p-values that are adjusted for all cells together. */
#ifndef BB_FAMILY_H
#define BB_FAMILY_H

#include "framework/base/statistics.h"
#include "framework/base/status.h"

#include <stdbool.h>

/* A cell. For pairs, `before` has the logarithms of the ratios; for two separate runs, `before` and
 * `after` have the logarithms of the times. Discarded rounds are left out. Values that are not
 * finite are ignored. All rows must have values of the same round at the same index. */
typedef struct bb_family_row {
    bb_samples before, after;
    double p_up, p_down; /* results: that `after` (or the ratio) is larger, or smaller */
} bb_family_row;

/* Returns the least number of pairs with which a p-value can be below `level`. */
uint32_t bb_family_pairs_needed(double level);

/* Sets the p-values of all rows. BB_FAILED without memory. */
bb_status bb_family_of_pairs(bb_family_row *rows, uint32_t count);
bb_status bb_family_of_runs(bb_family_row *rows, uint32_t count);

/* For each row, the least slowing that the rule would have found had nothing else changed, as a
 * logarithm: the rows are centred, this one's `after` (or its ratios) is shifted, and the p-value
 * must be at most `level`. INFINITY: not even ten times as slow. BB_FAILED without memory. */
bb_status bb_family_found(const bb_family_row *rows, uint32_t count, bool pairs, double level,
                          double *least);

#endif
