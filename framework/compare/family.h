/* p-values that hold for all cells together. */
#ifndef BB_FAMILY_H
#define BB_FAMILY_H

#include "framework/base/statistics.h"
#include "framework/base/status.h"

#include <stdbool.h>

/* A cell: of pairs the logarithms of their ratios, in `before`; else the logarithms of the times of
 * both runs. Only what counts: no discarded rounds. A value that is no finite number says nothing;
 * at the same index all rows have what was measured next to each other. */
typedef struct bb_family_row {
    bb_samples before, after;
    double p_up, p_down; /* set: adjusted, for `after` (or the ratio) being larger, or smaller */
} bb_family_row;

/* The least number of pairs with which a p-value can be below `level`. */
uint32_t bb_family_pairs_needed(double level);

/* Sets the p-values of all rows. BB_FAILED without memory. */
bb_status bb_family_of_pairs(bb_family_row *rows, uint32_t count);
bb_status bb_family_of_runs(bb_family_row *rows, uint32_t count);

#endif
