/* Cells as measured in one run, or of one revision: what is compared, and what the history keeps.
 */
#ifndef BB_CELL_SET_H
#define BB_CELL_SET_H

#include "framework/base/statistics.h"
#include "framework/record/record.h"
#include "framework/table/table.h"

enum { BB_FIGURE_NAME = 112 };

/* An exact figure: no clock has a part in it. The name is that of the result file; of a layout, the
 * field's and the layout's: "layouts_sah pair:leaf=4". */
typedef struct bb_exact_figure {
    char name[BB_FIGURE_NAME];
    bb_better better;
    double value;
} bb_exact_figure;

typedef struct bb_measured {
    char *key;     /* of the cell; from malloc, as is `figures` */
    char time[64]; /* what `ms` is the time of: "build ms" */
    bool reference;
    char status[16];
    char scene_hash[20], rays_hash[20]; /* "": not known; rays: of traces */
    bb_samples
        ms; /* all rounds, the discarded one first; of another unit in `time`; may be empty */
    uint32_t figure_count;
    bb_exact_figure *figures;
    uint32_t place; /* in the order in which they were added */
} bb_measured;

/* Where and when; "" for what is not known. */
typedef struct bb_origin {
    char what[256]; /* for messages: the file or revision */
    char date[32], revision[80], host[256], cpu[256], device[256], driver[128], embree[48],
        seed[24];
    char device_type[16]; /* BB_DEVICE_CPU ...; "": no device of ours */
    char shard[24];       /* "2/8"; "" for a whole run */
    bool interrupted;
} bb_origin;

typedef struct bb_cell_set {
    bb_origin origin;
    bb_measured *cells; /* by key, once bb_cell_set_sort() was called */
    uint32_t count, capacity;
    uint32_t duplicates; /* cells left out, since one of that key is there already */
} bb_cell_set;

/* All builds and traces of the document; `what` names it. Release with bb_cell_set_free(), also
 * after a failure. */
bb_status bb_cell_set_of_results(const bb_results *results, const char *what, bb_cell_set *set);

/* All rows of a table: a cell for the exact numbers of each, and one for each of its rounds, where
 * less is better. Keys are command and names, "command=slice/scene=tets/builder=lbvh", and for
 * rounds the column, ".../time=build_ms". Of texts "status" and "scene_hash" count. */
bb_status bb_cell_set_of_table(const bb_table *table, const char *what, bb_cell_set *set);

/* An empty cell of this key at the end. `*cell` is valid until the next call. */
bb_status bb_cell_set_add(bb_cell_set *set, const char *key, bb_measured **cell);
bb_status bb_measured_add_figure(bb_measured *cell, const char *name, bb_better better,
                                 double value);
/* NAN: it has no such figure. */
double bb_measured_figure(const bb_measured *cell, const char *name);
/* BB_BETTER_NEITHER: it has no such figure, or neither is better. */
bb_better bb_measured_better(const bb_measured *cell, const char *name);

/* Sorts by key; of cells of one key the first stays, the others are counted and dropped. */
void bb_cell_set_sort(bb_cell_set *set);
/* In a sorted set; NULL if there is none. */
const bb_measured *bb_cell_set_find(const bb_cell_set *set, const char *key);
void bb_cell_set_free(bb_cell_set *set);

/* Whether cells of both may meet: the device is part of what a cell is. Processors count as one,
 * since trees, tests and answers are the same on all of them; another device is known by its name,
 * as is one that has no type. */
bool bb_same_device(const bb_origin *a, const bb_origin *b);

/* Whether times of both can be compared: the same processor, device and driver; *host: and host. */
bool bb_same_machine(const bb_origin *a, const bb_origin *b, bool *host);

#endif
