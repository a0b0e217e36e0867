/* The option --cell: measures exactly these cells, in as few comparisons as their sizes and seeds
 * allow. */
#ifndef BB_CELLS_OPTION_H
#define BB_CELLS_OPTION_H

#include "framework/bench/bench.h"
#include "framework/cli/choice.h"

/* The lists of specifications that are compared. */
typedef struct bb_entrants {
    bb_names scenes, builders, kernels, workloads, intersectors;
} bb_entrants;

/* Sets the lists of `request`, which then points into `entrants`. */
void bb_entrants_request(const bb_entrants *entrants, bb_bench_request *request);

/* Cells of one size, number of rays and seed: one comparison, in which they are interleaved. */
typedef struct bb_cells_group {
    bb_cell_parts *cells; /* canonical */
    uint32_t count;
    bb_entrants entrants; /* all that the cells name, once each */
} bb_cells_group;

typedef struct bb_cells {
    bb_cell_parts *cells; /* of all groups */
    bb_cells_group *groups;
    uint32_t group_count; /* 0: the option is not given */
} bb_cells;

/* Reads the keys, and checks what can be checked without a scene. BB_INVALID: a text is no key, or
 * names something that does not exist. Release with bb_cells_free(), also after a failure. */
bb_status bb_cells_read(const bb_names *keys, bb_cells *cells);
void bb_cells_free(bb_cells *cells);

/* Sets the members of `request` that follow from a group. `request` then points into the group. */
void bb_cells_request(const bb_cells_group *group, bb_bench_request *request);

#endif
