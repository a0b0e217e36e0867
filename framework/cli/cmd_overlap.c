/* bvhbench overlap: where two meshes overlap. */
#include "framework/base/interrupt.h"
#include "framework/cli/contest_options.h"
#include "framework/cli/inputs.h"
#include "framework/device/device_private.h"
#include "framework/overlap/overlap_contest.h"
#include "framework/report/report.h"
#include "framework/scene/tets_gather.h"

#include <stdio.h>
#include <stdlib.h>

static const bb_cli_option options[] = {
    {"builder", "B", "default: what builders name for it, see below", BB_CLI_LIST},
    {"search", "S", "skip, octree, octree:boundary=no; default: skip,octree", BB_CLI_LIST},
    {"no-tree", NULL, "also by all pairs, which others are compared with", false},
    {"fit", "X",
     "scale and move mesh B: its box's longest side becomes X times A's, its middle A's middle; "
     "default: as it is",
     false},
    {"repeats", "N", "measured rounds; default: 10 (the paper: 50)", false},
    {"seed", "N", "random seed; default: 1", false},
    {"json", NULL, "print JSON", false},
    BB_DEVICE_OPTION,
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     false},
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", true},
    {"kernels-from", "DIR", "take device code from here first (edit and run)", false},
    {"out", "DIR",
     "folder for overlap.json, overlap.html and pictures of what does not overlap; default: none",
     false},
    {"quiet", NULL, "do not show progress", false},
    {.name = NULL},
};

typedef struct job {
    const bb_cli *cli;
    bb_overlap_request request;
    bb_overlap_result *result;
    bb_scene *scenes[2];
    bool wrong;
    bb_names builders, searches;
} job;

static bb_status read_request(job *j)
{
    uint64_t repeats;
    bb_overlap_request *request = &j->request;
    BB_TRY(bb_cli_u64(j->cli, "repeats", 10, 1, BB_SAMPLES_MAX - 1, &repeats));
    BB_TRY(bb_cli_u64(j->cli, "seed", 1, 0, UINT64_MAX, &request->seed));
    request->quiet = bb_cli_value(j->cli, "quiet") != NULL;
    request->repeats = (uint32_t)repeats;
    request->without = bb_cli_value(j->cli, "no-tree") != NULL;
    BB_TRY(bb_choose_tree_builders(j->cli, BB_OF_MESHES, &j->builders));
    BB_TRY(bb_choose_searches(j->cli, &j->searches));
    request->builders = (const char *const *)j->builders.items;
    request->builder_count = (uint32_t)j->builders.count;
    request->searches = (const char *const *)j->searches.items;
    request->search_count = (uint32_t)j->searches.count;
    return BB_OK;
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

static bb_status load(job *j)
{
    double times;
    BB_TRY(bb_cli_double(j->cli, "fit", 0, 1e-6, 1e6, &times));
    for (uint32_t s = 0; s < 2; s++) {
        const char *name = j->cli->positional[s];
        BB_TRY(bb_scene_load(name, &j->scenes[s]));
        if (j->scenes[s]->tets == NULL)
            return bb_fail(BB_INVALID, "%s: has no tetrahedra that could overlap", name);
    }
    return times > 0 ? fit(j->scenes[0], times, &j->scenes[1]) : BB_OK;
}

/* ---- the work ---- */

static bb_status paint(const job *j, cJSON *files)
{
    const char *out = bb_cli_value(j->cli, "out");
    char path[PATH_MAX];
    if (out == NULL)
        return BB_OK;
    BB_TRY(bb_join_path(path, out, "apart"));
    return bb_overlap_paint(j->scenes, j->result, path, files);
}

/* With the pictures that there are: a failure of theirs loses nothing else. */
static bb_status write(const job *j)
{
    cJSON *document, *results, *files = cJSON_CreateArray();
    const bb_status painted = paint(j, files);
    if (!bb_contest_document("bvhbench-overlap/1", j->request.device, &document, &results)) {
        cJSON_Delete(files);
        return bb_fail(BB_REFUSED, "no memory for the results");
    }
    char why[1024];
    snprintf(why, sizeof why, "%s", painted != BB_OK ? bb_message() : "");
    bb_status status = bb_contest_add(results, bb_overlap_json(j->result), files);
    if (status == BB_OK)
        status = bb_contest_write(j->cli, document, "overlap", bb_report_contest);
    cJSON_Delete(document);
    return status == BB_OK && painted != BB_OK ? bb_fail(painted, "%s", why) : status;
}

static bb_status overlap(job *j)
{
    for (int s = 0; s < 2; s++)
        BB_TRY(bb_scene_upload(j->scenes[s], j->request.device));
    BB_TRY(bb_overlap_run(&j->request, j->scenes, j->result));
    for (uint32_t w = 0; w < j->result->way_count; w++)
        j->wrong = j->wrong || j->result->ways[w].differ > 0;
    if (bb_contest_prints(j->cli, j->request.device, NULL))
        bb_overlap_print(j->result);
    return write(j);
}

static bb_status work(job *j)
{
    BB_TRY(bb_contest_begin(j->cli, j->cli->positional, 2));
    BB_TRY(read_request(j));
    j->result = calloc(1, sizeof *j->result);
    if (j->result == NULL)
        return bb_fail(BB_REFUSED, "no memory for the results");
    bb_status status = load(j);
    if (status == BB_OK)
        status = bb_open_device(j->cli, &j->request.device);
    if (status == BB_OK) {
        bb_interrupt_catch();
        status = overlap(j);
    }
    bb_overlap_release(j->result);
    for (int s = 0; s < 2; s++)
        bb_scene_free(j->scenes[s]);
    bb_device_close(j->request.device);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    job j = {.cli = cli};
    if (cli->positional_count != 2)
        return bb_fail(BB_INVALID, "overlap takes two meshes: see `bvhbench overlap --help`");
    bb_status status = work(&j);
    free(j.result);
    bb_names_free(&j.builders);
    bb_names_free(&j.searches);
    return bb_contest_end(status, j.wrong, exit_status);
}

extern const bb_command bb_command_overlap;
const bb_command bb_command_overlap = {
    .name = "overlap",
    .summary = "where two meshes of tetrahedra overlap",
    .arguments = "A B",
    .details =
        "Which tetrahedra of mesh A share a point with one of mesh B, and which of B with one of "
        "A: faces,\n"
        "edges and corners belong to them; those without a volume are left out.\n"
        "Each builder with each search, against the first of them or against no tree. `octree` "
        "spares\n"
        "tests where a cell is all inside of the other mesh, or all outside.\n"
        "Exit status 1: an answer differs from the first way's.",
    .more_help = bb_print_mesh_builders,
    .options = options,
    .run = run,
};
