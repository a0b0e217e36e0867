/* The measured cells of one run or one revision, which `compare` compares and the history keeps.
 */
#ifndef BB_CELL_SET_H
#define BB_CELL_SET_H

#include "framework/base/statistics.h"
#include "framework/record/record.h"
#include "framework/table/table.h"

enum { BB_FIGURE_NAME = 112 };

/* A figure that does not depend on a clock. Its name is that of the result file. */
typedef struct bb_exact_figure {
    char name[BB_FIGURE_NAME];
    bb_better better;
    double value;
} bb_exact_figure;

typedef struct bb_measured {
    char *key;     /* key of the cell; from malloc, as is `figures` */
    char time[64]; /* what was timed: "build ms" */
    bool reference;
    char status[16];
    char scene_hash[20], rays_hash[20]; /* "": not known; only traces have rays */
    /* all rounds, the discarded one first; in ms unless `time` names another unit; may be empty */
    bb_samples ms;
    uint32_t figure_count;
    bb_exact_figure *figures;
    uint32_t place; /* number of its row; in sorting, of the cell as cells were added */
} bb_measured;

/* What an origin says where the runs of a merged table differ. */
#define BB_SEVERAL "several"

/* Where and when the cells were measured. "" stands for what is not known. Of a merged table the
 * date is that of the latest run, and `interrupted` says whether any was. */
typedef struct bb_origin {
    char what[256]; /* for messages: the file or revision */
    char date[32], revision[80], host[256], cpu[256], device[256], driver[128], embree[48],
        seed[24];
    char device_type[16]; /* BB_DEVICE_CPU ...; "": no device of ours */
    char shard[24];       /* "2/8"; "" for a whole run */
    char reduced_to[160]; /* to keep a time, in words; "": not */
    bool has_reduced_to;  /* that is known: a history does not keep it */
    char governor[64], smt[8], boost[8], processors[256]; /* as in framework/device/processors.h */
    /* share of the processors that other programs kept at work, the most of all runs */
    double busy;
    bool interrupted;
} bb_origin;

typedef struct bb_cell_set {
    bb_origin origin;
    bb_measured *cells; /* by key, once bb_cell_set_sort() was called */
    uint32_t count, capacity;
    uint32_t duplicates; /* cells that were dropped because another has their key */
} bb_cell_set;

/* Takes all rows of a table, which messages call `what`. A build or trace of `run` becomes a cell
 * with the key that it has, a layout one with the key of its build and "/layout=pair". Of other
 * commands a row becomes a cell with its exact numbers, and one more cell for each column of rounds
 * in which less is better. Keys are made of command and names then,
 * "command=slice/scene=tets/builder=lbvh", and for rounds also of the column, ".../time=build_ms".
 * Keys of a merged table's further runs end with the number of their run, ".../run=1". Of the
 * texts, only "status" and the scene's "hash" are taken. BB_INVALID if a run is no number, or a key
 * too long. Release with bb_cell_set_free(), also after a failure. */
bb_status bb_cell_set_of_table(const bb_table *table, const char *what, bb_cell_set *set);
/* The same for a run of a pair. Builds and traces of `run` on a processor's device have a second
 * cell each, "/clock=cpu" behind the key, with the processor time of all threads: it tells less of
 * what other programs do. */
bb_status bb_cell_set_of_pair(const bb_table *table, const char *what, bb_cell_set *set);
/* Returns whether it is such a cell. */
bool bb_is_clock(const char *key);
/* Writes the key of the cell whose processor time it is; of other cells, the key itself. */
void bb_wall_key(const char *key, char wall[BB_CELL_KEY]);

/* Appends an empty cell with this key, made canonical: a parameter that the key's program did not
 * have yet gets its default here. `*cell` is valid until the next call. */
bb_status bb_cell_set_add(bb_cell_set *set, const char *key, bb_measured **cell);
bb_status bb_measured_add_figure(bb_measured *cell, const char *name, bb_better better,
                                 double value);
/* Returns the figure of this name; NAN if there is none. */
double bb_measured_figure(const bb_measured *cell, const char *name);
/* Returns its sense; BB_BETTER_NEITHER also if there is no such figure. */
bb_better bb_measured_better(const bb_measured *cell, const char *name);

/* Sorts by key. If several cells have one key, the first stays; the others are counted and dropped.
 */
void bb_cell_set_sort(bb_cell_set *set);
/* Finds a cell of a sorted set; NULL if there is none. */
const bb_measured *bb_cell_set_find(const bb_cell_set *set, const char *key);
void bb_cell_set_free(bb_cell_set *set);

/* Returns whether both have the same device, so that their cells may be compared. All processors
 * count as one device, since trees, tests and answers are the same on all of them. Other devices,
 * and those without a type, are compared by name. */
bool bb_same_device(const bb_origin *a, const bb_origin *b);

/* Returns whether times of both can be compared: processor, device and driver are the same. *host:
 * whether the host is the same too. */
bool bb_same_machine(const bb_origin *a, const bb_origin *b, bool *host);

#endif
