/* The comparison of two programs, or revisions, by the cells that both measured: README.md has the
 * rule. */
#ifndef BB_COMPARE_H
#define BB_COMPARE_H

#include "framework/compare/cell_set.h"
#include "framework/compare/effect.h"

#include <math.h>

/* The chance that any cell of a comparison of equals is called slower; and that one is called
 * faster. */
#define BB_COMPARE_LEVEL 0.01
/* Of the floor: what nobody would call a change, and what stands where no A/A is known. */
#define BB_COMPARE_FLOOR_LEAST 0.01
#define BB_COMPARE_FLOOR_UNKNOWN 0.10

/* One side of a comparison: the set of one run, or as many as there are pairs, the first of which
 * does not count. All are sorted. */
typedef struct bb_side {
    const bb_cell_set *sets;
    uint32_t count;
} bb_side;

/* ---- a side as one (side.c) ---- */

/* The first set that counts. */
uint32_t bb_side_first(const bb_side *side);
/* A cell in the sets that count: the first that is not ok, else the first; NULL if none has it. */
const bb_measured *bb_side_find(const bb_side *side, const char *key);
/* The keys of all sets that count, each once; NULL after the last. Begin with a place of 0, 0. */
typedef struct bb_side_place {
    uint32_t set, cell;
} bb_side_place;
const char *bb_side_next(const bb_side *side, bb_side_place *place);
/* How many of the sets that count lack the cell. */
uint32_t bb_side_lacks(const bb_side *side, const char *key);
/* BB_INVALID if not all sets are of one revision, machine and seed. */
bb_status bb_side_check(const bb_side *side);

/* A cell's own floor. */
typedef struct bb_cell_floor {
    char *key;
    double share;
} bb_cell_floor;

/* An effect that a program showed against itself, as a share: 0.02 for 2 %. */
typedef struct bb_floor {
    double share;       /* NAN: there is none */
    uint32_t cells;     /* of which it was taken */
    char from[200];     /* in words */
    bb_cell_floor *own; /* of runs by themselves: by key, once finished; NULL: not known */
    uint32_t own_count, own_capacity;
} bb_floor;

typedef enum bb_change_verdict {
    BB_WORSE,
    BB_BETTER,
    BB_CHANGED, /* an exact figure for which more is neither */
} bb_change_verdict;

/* Something that moved. */
typedef struct bb_change {
    const bb_measured *before, *after;
    char what[BB_FIGURE_NAME]; /* "build ms", "trace ms", "status", or an exact figure's name */
    bool timed;
    double from, to;  /* medians in ms (of pairs: of the least), or the figure; NAN of a status */
    bb_effect effect; /* of an exact figure: its ratio, NAN if it was 0 */
    double p;         /* of a time: adjusted for all cells */
    bb_change_verdict verdict;
    bool counts; /* for the exit: not of a reference */
} bb_change;

typedef struct bb_comparison_result {
    bb_side before, after;
    bool pairs;
    bool given; /* the floor, as a threshold */
    bb_floor floor;
    uint32_t common; /* cells in both */
    uint32_t timed;  /* of those, cells whose times could be compared */
    uint32_t untold; /* of those, cells with too few rounds for an interval */
    uint32_t unlike; /* cells with other geometry or other rays: nothing of them is compared */
    uint32_t faulty; /* cells that are not ok on both sides */
    bool machines_differ, hosts_differ; /* the former: no times are compared */
    uint32_t only_before, only_after;
    uint32_t lacking;   /* of pairs: cells in both that are not in all pairs that count */
    uint32_t one_sided; /* figures that only one side has */
    bb_change *moves;   /* worst first: what is worse, better, changed; each by size */
    uint32_t move_count, move_capacity;
    uint32_t worse; /* that count */
    double *ratios; /* of the times that were compared, rising */
    uint32_t ratio_count;
} bb_comparison_result;

/* Compares. Both sides have one set, or equally many of at least 2 pairs. `threshold` replaces the
 * floor (a share; NAN: not given); else `floor` is that of runs by themselves if one is known
 * (NULL: none), and pairs measure their own. The result points into the sides and the floor.
 * BB_INVALID if they are of two devices, have no cell in common, or the runs of a side are not of
 * one program and machine. Release with bb_compare_free(), also after a failure. */
bb_status bb_compare(const bb_side *before, const bb_side *after, double threshold,
                     const bb_floor *floor, bb_comparison_result *result);
void bb_compare_free(bb_comparison_result *result);

/* The median of the cells' ratios of times; NAN if there are none. */
double bb_compare_typical(const bb_comparison_result *result);

/* ---- floors (floor.c) ---- */

/* Of pairs: a cell on each side against itself, from one pair to the next. NAN: not known. */
double bb_floor_of_cell(const bb_side *before, const bb_side *after, const char *key);
/* The median of that over all cells. */
bb_status bb_floor_of_pairs(const bb_side *before, const bb_side *after, bb_floor *floor);
/* Of runs by themselves: a cell's own floor is the largest effect between two of them whose
 * interval excludes 1, that of all what 90 % of the cells do not exceed. Reference rows say
 * nothing. Takes set against the next set, from `first` on, into a floor that began as
 * BB_NO_FLOOR; after all are taken, finish it. Release with bb_floor_free(), also after a failure.
 */
#define BB_NO_FLOOR ((bb_floor){.share = (double)NAN})
bb_status bb_floor_take_runs(bb_floor *floor, const bb_side *runs, uint32_t first);
void bb_floor_finish_runs(bb_floor *floor);
/* NAN: not known. */
double bb_floor_own(const bb_floor *floor, const char *key);
void bb_floor_free(bb_floor *floor);

/* The ratio of the medians of a cell, after by before; NAN if one has none or is not ok. */
double bb_ratio_of_medians(const bb_measured *before, const bb_measured *after);
/* The same of the least times, of equally many rounds, which is what one pair says: noise only
 * lengthens, in bursts that may be as long as half of a short run. */
double bb_ratio_of_leasts(const bb_measured *before, const bb_measured *after);
/* Whether both are of the same scene and the same rays. */
bool bb_same_input(const bb_measured *a, const bb_measured *b);

#endif
