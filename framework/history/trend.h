/* Cells over the revisions of a machine. */
#ifndef BB_TREND_H
#define BB_TREND_H

#include "framework/history/history.h"

/* The revisions that one machine measured, the oldest first. */
typedef struct bb_trend {
    uint32_t count;
    bb_history_entry *entries;
    bb_cell_set *sets;
    /* steps[i]: entries[i] against what was last known of each cell before it, by the rule of
     * `compare`; of the first, and of one that shares no cell with those before it, without moves.
     * Its moves have no `before`. */
    bb_comparison_result *steps;
    bb_floor floor; /* of runs by themselves; a share of NAN: none is known */
} bb_trend;

/* Of each machine in the history, the one of the latest run first; from malloc, for
 * bb_trends_free(), also after a failure. */
bb_status bb_history_trends(bb_history *history, bb_trend **trends, uint32_t *count);
void bb_trends_free(bb_trend *trends, uint32_t count);

#endif
