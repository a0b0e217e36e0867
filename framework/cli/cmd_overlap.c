/* bvhbench overlap: where two meshes overlap. */
#include "framework/base/interrupt.h"
#include "framework/cli/contest_output.h"
#include "framework/cli/inputs.h"
#include "framework/cli/output.h"
#include "framework/device/device_private.h"
#include "framework/scene/tets_gather.h"
#include "framework/tasks/overlap_contest.h"

#include <stdio.h>

typedef struct job {
    bb_contest_choice choice;
    bb_names builders, searches;
    double fit; /* 0: mesh B stays as it is */
    bb_contest_request request;
    bb_scene *scenes[2];
    bb_contest_output output;
    bool brief, wrong;
} job;

static const bb_cli_option options[] = {
    {"builder", "B", "builders; default: the variants that they declare for it, see below",
     BB_INTO(job, builders)},
    BB_SEARCH_OPTION(job, searches, ""),
    {"no-tree", NULL, "also test all pairs without a tree, and compare the others with that",
     BB_INTO(job, request.without)},
    {"fit", "X",
     "scale mesh B until its box's longest side is X times A's, and centre it on A; default: B "
     "stays as it is",
     BB_INTO(job, fit), .low = 1e-6, .high = 1e6},
    {"repeats", "N", "measured rounds (the paper: 50)", BB_INTO(job, request.repeats), .low = 1,
     .high = BB_SAMPLES_MAX - 1, .fallback = "10"},
    BB_ROUNDS_IN_TIME_OPTION(job, choice.time),
    BB_SEED_OPTION(job, request.seed),
    {"brief", NULL,
     "show less: no trees, phases and legends; by default no builders that take long on meshes",
     BB_INTO(job, brief)},
    BB_SIMULATIONS_OPTION(job, choice.metrics, "each way's answer to the first question"),
    BB_GROUP(bb_contest_options, job, choice),
    {"out", "DIR",
     "folder for overlap.json, overlap.html and pictures of what does not overlap; default: none",
     BB_INTO(job, choice.out)},
    BB_HISTORY_OPTION(job, choice.history),
    BB_QUIET_OPTION(job, request.quiet),
    {.name = NULL},
};

static bb_status read_request(job *j)
{
    BB_TRY(bb_choose_tree_builders(&j->builders, j->brief ? BB_OF_MESHES_BRIEFLY : BB_OF_MESHES));
    return bb_check_searches(&j->searches);
}

/* ---- meshes ---- */

static bb_status fit(const bb_scene *a, double times, bb_scene **b)
{
    bb_scene *fitted;
    BB_TRY(bb_tets_fit(*b, a, times, &fitted));
    bb_scene_free(*b);
    *b = fitted;
    return BB_OK;
}

static bb_status load(job *j, char *const *names)
{
    for (uint32_t s = 0; s < 2; s++) {
        BB_TRY(bb_scene_load(names[s], &j->scenes[s]));
        if (j->scenes[s]->tets == NULL)
            return bb_fail(BB_INVALID, "%s: has no tetrahedra that could overlap", names[s]);
    }
    return j->fit > 0 ? fit(j->scenes[0], j->fit, &j->scenes[1]) : BB_OK;
}

/* ---- the work ---- */

/* With the pictures that there are: a failure of theirs loses nothing else. */
static bb_status overlap(job *j)
{
    char why[1024], name[sizeof j->scenes[0]->name * 2 + 8];
    for (int s = 0; s < 2; s++)
        BB_TRY(bb_scene_upload(j->scenes[s], j->request.device));
    BB_TRY(bb_contest_output_request(&j->output, &j->builders, &j->searches, &j->request));
    snprintf(name, sizeof name, "%s and %s", j->scenes[0]->name, j->scenes[1]->name);
    j->request.name = name;
    j->request.ends_ms = bb_contest_ends(&j->choice, 1);
    bb_status status = bb_overlap_run(&j->request, j->scenes, j->choice.out, j->output.table);
    snprintf(why, sizeof why, "%s", status != BB_OK ? bb_message() : "");
    if (bb_table_row_count(j->output.table) > 1)
        BB_TRY(bb_contest_output_scene(&j->output));
    return status == BB_OK ? BB_OK : bb_fail(status, "%s", why);
}

static bb_status work(job *j, char *const *names)
{
    BB_TRY(bb_contest_begin(&j->choice, names, 2));
    BB_TRY(read_request(j));
    BB_TRY(load(j, names));
    BB_TRY(bb_open_device(&j->choice.device, &j->request.device));
    bb_interrupt_catch();
    return bb_contest_output_end(&j->output, overlap(j), &j->wrong);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    job *j = values;
    if (cli->positional_count != 2)
        return bb_fail(BB_INVALID, "overlap takes two meshes: see `bvhbench overlap --help`");
    j->output = (bb_contest_output){.outline = &bb_overlap_outline,
                                    .printed = j->brief ? &bb_overlap_outline_briefly : NULL,
                                    .choice = &j->choice,
                                    .command_line = cli->command_line};
    bb_status status = work(j, cli->positional);
    return bb_contest_end(status, j->wrong, exit_status);
}

static void release(void *values)
{
    job *j = values;
    for (int s = 0; s < 2; s++)
        bb_scene_free(j->scenes[s]);
    bb_device_close(j->request.device);
}

extern const bb_command bb_command_overlap;
const bb_command bb_command_overlap = {
    .name = "overlap",
    .summary = "find where two meshes of tetrahedra overlap",
    .arguments = "A B",
    .details =
        "Finds the tetrahedra of mesh A that share a point with one of mesh B, and those of B with "
        "one of\n"
        "A. Faces, edges and corners belong to tetrahedra; tetrahedra without a volume are left "
        "out.\n"
        "Each builder is measured with each search, and compared with the first of these or with "
        "no tree.\n"
        "`octree` needs no tests where a cell lies fully inside or fully outside the other mesh.\n"
        "Exit status 1: an answer differs from the first one's, or clocks contradict each other.",
    .more_help = bb_print_mesh_builders,
    .options = options,
    .bytes = sizeof(job),
    .goes_on = true,
    .run = run,
    .release = release,
};
