/* Compares two programs or revisions by the cells that both measured. README.md has the rule. */
#ifndef BB_COMPARE_H
#define BB_COMPARE_H

#include "framework/compare/cell_set.h"
#include "framework/compare/effect.h"

#include <math.h>

/* The probability that any cell is called slower when equal programs are compared. The same holds
 * for faster. */
#define BB_COMPARE_LEVEL 0.01
/* The least floor, and the floor if no A/A is known. */
#define BB_COMPARE_FLOOR_LEAST 0.01
#define BB_COMPARE_FLOOR_UNKNOWN 0.10
/* Beyond this floor, nothing is compared. */
#define BB_COMPARE_FLOOR_MOST 0.5

/* One side of a comparison: one run, or one run of each pair, of which the first does not count.
 * All sets are sorted. */
typedef struct bb_side {
    const bb_cell_set *sets;
    uint32_t count;
} bb_side;

/* ---- a side as one (side.c) ---- */

/* Returns the index of the first set that counts. */
uint32_t bb_side_first(const bb_side *side);
/* Finds a cell in the sets that count: the first that is not ok, else the first; NULL if none has
 * it. */
const bb_measured *bb_side_find(const bb_side *side, const char *key);
/* Returns the keys of all sets that count one by one, each once, then NULL. `place` begins as {0,
 * 0}. */
typedef struct bb_side_place {
    uint32_t set, cell;
} bb_side_place;
const char *bb_side_next(const bb_side *side, bb_side_place *place);
/* Returns how many of the sets that count lack the cell. */
uint32_t bb_side_lacks(const bb_side *side, const char *key);
/* BB_INVALID if the sets differ in revision, machine or seed. */
bb_status bb_side_check(const bb_side *side);

/* A cell's own floor. */
typedef struct bb_cell_floor {
    char *key;
    double share;
} bb_cell_floor;

/* The effect of a program against itself, as a share: 0.02 is 2 %. */
typedef struct bb_floor {
    double share;       /* NAN: there is none */
    double clocks;      /* of pairs: of their processor time; NAN: there is none */
    uint32_t cells;     /* cells from which the share was taken */
    char from[200];     /* its origin, in words */
    bb_cell_floor *own; /* of separate runs: sorted by key once finished; NULL: not known */
    uint32_t own_count, own_capacity;
} bb_floor;

typedef enum bb_change_verdict {
    BB_WORSE,
    BB_BETTER,
    BB_UNDECIDED, /* a time that is less, of two runs by themselves on a busy machine */
    BB_CHANGED,   /* an exact figure that is neither better nor worse */
} bb_change_verdict;

/* Returns it in a word: "worse". */
const char *bb_change_word(bb_change_verdict verdict);

/* A time or figure that moved. */
typedef struct bb_change {
    const bb_measured *before, *after;
    char what[BB_FIGURE_NAME]; /* bb_measured.time, "status", or an exact figure's name */
    bool timed;
    double from,
        to; /* medians in ms (for pairs, of the least times), or the figure; NAN for a status */
    bb_effect effect; /* of an exact figure, only the ratio; NAN if it was 0 */
    double p;         /* of a time, adjusted for all cells */
    bb_change_verdict verdict;
    bool counts; /* affects the exit status: not a reference */
} bb_change;

/* What the comparison could have seen of a cell. */
typedef struct bb_sight {
    const bb_measured *cell;
    /* the least slowing that the rule would have found, as a share; INFINITY: none. In pairs a
     * slowing of wall time and processor time alike, by whichever shows it better */
    double least;
} bb_sight;

typedef struct bb_comparison_result {
    bb_side before, after;
    bool pairs;
    bool given; /* the floor was given as a threshold */
    bb_floor floor;
    uint32_t common; /* cells in both */
    uint32_t timed;  /* common cells whose times could be compared */
    uint32_t clocks; /* of pairs: those whose processor time could be compared, too */
    uint32_t untold; /* timed cells with too few rounds for an interval */
    uint32_t unlike; /* common cells with other geometry or rays; they are not compared */
    uint32_t faulty; /* common cells that are not ok on both sides */
    bool machines_differ, hosts_differ; /* if machines differ, no times are compared */
    bool busy;                          /* not in pairs, and other programs took much of one side */
    uint32_t only_before, only_after;
    uint32_t missing;   /* of only_before, those that count: they were ok and no reference */
    uint32_t lacking;   /* for pairs, common cells that some counting pair lacks */
    uint32_t one_sided; /* exact figures that only one side has */
    bb_change *moves;   /* in the order of their verdicts; each sorted by size */
    uint32_t move_count, move_capacity;
    uint32_t worse;   /* moves that are worse and count */
    bb_sight *sights; /* of cells that count and whose times were compared; the blindest first */
    uint32_t sight_count;
    double *ratios; /* of the compared times, ascending */
    uint32_t ratio_count;
} bb_comparison_result;

/* Compares two sides of one set each, or of equally many pairs, at least 2. `threshold` is a share
 * that replaces the floor; NAN: not given. Otherwise pairs measure their floor, and separate runs
 * take `floor` (NULL: not known). The result points into the sides and the floor. BB_INVALID if the
 * devices differ, no cell is common, or the runs of a side are of different programs or machines.
 * Release with bb_compare_free(), also after a failure. */
bb_status bb_compare(const bb_side *before, const bb_side *after, double threshold,
                     const bb_floor *floor, bb_comparison_result *result);
void bb_compare_free(bb_comparison_result *result);

/* Makes one sight of those of a cell's wall time and processor time, the better one; sorts all. */
void bb_compare_sort_sights(bb_comparison_result *result);
/* Returns how many sights could not have shown a slowing by this share. */
uint32_t bb_compare_blind(const bb_comparison_result *result, double share);

/* Returns whether it is worse if a cell of the side before is missing: it was ok, and is neither of
 * a reference nor a layout. */
bool bb_counts_as_missing(const bb_measured *cell);

/* Returns the median of the cells' ratios of times; NAN if there are none. */
double bb_compare_typical(const bb_comparison_result *result);

/* ---- floors (floor.c) ---- */

/* Returns the effect of a cell against itself, from one pair to the next on each side. NAN: not
 * known. */
double bb_floor_of_cell(const bb_side *before, const bb_side *after, const char *key);
/* Sets the floor of pairs: the median of the cells' effects against themselves, of wall time and of
 * processor time. */
bb_status bb_floor_of_pairs(const bb_side *before, const bb_side *after, bb_floor *floor);
/* Adds the effects between successive sets of `runs`, from `first` on, to a floor that began as
 * BB_NO_FLOOR. bb_floor_finish_runs() then sets the floor of separate runs: a cell's own floor is
 * its largest effect whose interval excludes 1, and the share is what 90 % of the cells do not
 * exceed. Reference rows do not enter. Release with bb_floor_free(), also after a failure.
 */
#define BB_NO_FLOOR ((bb_floor){.share = (double)NAN, .clocks = (double)NAN})
bb_status bb_floor_take_runs(bb_floor *floor, const bb_side *runs, uint32_t first);
void bb_floor_finish_runs(bb_floor *floor);
/* Returns a cell's own floor; NAN: not known. */
double bb_floor_own(const bb_floor *floor, const char *key);
void bb_floor_free(bb_floor *floor);

/* Returns the ratio of a cell's medians, after by before; NAN if one has no times or is not ok. */
double bb_ratio_of_medians(const bb_measured *before, const bb_measured *after);
/* Returns the time of a run that pairs compare: the least, since noise only lengthens times, in
 * bursts that may last for half of a short run. Of processor time the median, which other programs
 * hardly change: it scatters less. */
double bb_time_of_pair(const bb_measured *cell);
/* Returns the ratio of these times. NAN also if the numbers of rounds differ. */
double bb_ratio_of_pair(const bb_measured *before, const bb_measured *after);
/* Returns whether both have the same scene and rays. */
bool bb_same_input(const bb_measured *a, const bb_measured *b);

#endif
