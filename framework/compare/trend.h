/* Cells over the revisions of a machine. */
#ifndef BB_TREND_H
#define BB_TREND_H

#include "framework/compare/history.h"

/* The revisions that one machine measured, the oldest first. */
typedef struct bb_trend {
    uint32_t count;
    bb_history_entry *entries;
    bb_cell_set *sets;
    /* steps[i] compares entries[i] with the last earlier measurement of each cell, by the rule of
     * `compare`. It has no moves for the first entry, and for one that shares no cell with earlier
     * ones. Its moves have no `before`. */
    bb_comparison_result *steps;
    bb_floor floor; /* of separate runs; share NAN: not known */
} bb_trend;

/* Makes the trends of all machines, sorted by their latest run, the latest first. Release with
 * bb_trends_free(), also after a failure. */
bb_status bb_history_trends(bb_history *history, bb_trend **trends, uint32_t *count);
void bb_trends_free(bb_trend *trends, uint32_t count);

#endif
