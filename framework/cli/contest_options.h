/* What commands share that compare on tasks of their own: `volume`, `slice`, `overlap`,
 * `animate`. */
#ifndef BB_CONTEST_OPTIONS_H
#define BB_CONTEST_OPTIONS_H

#include "framework/cli/choice.h"
#include "framework/cli/time_option.h"
#include "framework/simulate/simulate.h"

/* The values that these commands share. */
typedef struct bb_contest_choice {
    bb_device_choice device;
    const char *out;     /* folder; NULL: nothing is written */
    const char *history; /* database; NULL: none */
    const char *time;    /* that the command may take; NULL: any */
    double ends_ms;      /* bb_wall_ms() when it is over, once begun; 0: never */
    bool json;
    bb_names metrics;           /* simulations, where BB_SIMULATIONS_OPTION is */
    bb_simt simts[BB_SIMT_MAX]; /* the same, once begun */
    uint32_t simt_count;
} bb_contest_choice;

/* Rows for a bb_contest_choice: --json, and those of the device. */
extern const bb_cli_option bb_contest_options[];

#define BB_ROUNDS_IN_TIME_OPTION(type, member)                                                     \
    BB_TIME_OPTION(type, member,                                                                   \
                   "take about this long, such as 5min, with fewer rounds if need be; what comes " \
                   "before and after them is done in any case")

#define BB_SEARCH_OPTION(type, member, start)                                                      \
    {                                                                                              \
        "search", "S", start "skip, octree, olbvh, octree:boundary=no", BB_INTO(type, member),     \
            .fallback = "skip,octree"                                                              \
    }

/* Checks the values of --search. */
bb_status bb_check_searches(const bb_names *searches);

/* What builders declare to be compared by default: on volumes, on meshes of tetrahedra, and on
 * meshes without those that take long. */
typedef enum bb_contest_kind { BB_OF_VOLUMES, BB_OF_MESHES, BB_OF_MESHES_BRIEFLY } bb_contest_kind;

/* Completes --builder; the default: the variants that builders declare for this kind. */
bb_status bb_choose_tree_builders(bb_names *builders, bb_contest_kind kind);

/* Print the default builders as lines of help. */
void bb_print_volume_builders(FILE *out);
void bb_print_mesh_builders(FILE *out);

/* Begins a command, and its time: reads --metrics, loads plug-ins, checks the names of scenes
 * (bb_check_scene()) and makes the folder --out, if it is given. */
bb_status bb_contest_begin(bb_contest_choice *choice, char *const *scenes, size_t count);

/* Returns when the next of `left` scenes is to end, so that all have as much time; 0: at any
 * time. */
double bb_contest_ends(const bb_contest_choice *choice, size_t left);

/* Ends a command: sets the exit status from the status of the work, from `wrong` (answers differ),
 * and from an interruption. */
bb_status bb_contest_end(bb_status status, bool wrong, int *exit_status);

#endif
