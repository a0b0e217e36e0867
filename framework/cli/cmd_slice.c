/* bvhbench slice: slices of a mesh, filled conservatively. */
#include "framework/base/interrupt.h"
#include "framework/cli/contest_output.h"
#include "framework/cli/inputs.h"
#include "framework/cli/output.h"
#include "framework/device/device_private.h"
#include "framework/picture/exr.h"
#include "framework/tasks/slice_contest.h"

#include <stdio.h>

typedef struct job {
    bb_contest_choice choice;
    bb_names scenes, builders, searches;
    bool paper;
    bb_slice_request request;
    bb_contest_output output;
    bool wrong;
} job;

static const bb_cli_option options[] = {
    {"scene", "S", "mesh of tetrahedra: a file (.node, .ele, .msh, .mesh, .vtk) or `tets:side=N`",
     BB_INTO_EACH(job, scenes), .needed = true},
    {"builder", "B", "builders; default: the variants that they declare for it, see below",
     BB_INTO(job, builders)},
    BB_SEARCH_OPTION(job, searches, ""),
    {"no-tree", NULL, "also test all tetrahedra without a tree, and compare the others with that",
     BB_INTO(job, request.contest.without)},
    {"paper", NULL, "the paper's settings", BB_INTO(job, paper),
     .presets = (const char *const[]){"slices", "1", "size", "999x999", "repeats", "50", NULL}},
    {"axis", NULL, "the axis across the slices", BB_INTO(job, request.plan.axis), .words = "x|y|z",
     .fallback = "z"},
    {"size", "WxH", "voxels of a slice, along the two other axes",
     BB_INTO_SIZE(job, request.plan.width), .fallback = "256x256"},
    {"slices", "N", "number of slices, stacked about the middle", BB_INTO(job, request.plan.count),
     .low = 1, .high = 4096, .fallback = "8"},
    {"thickness", "X",
     "thickness of a slice in scene units; default: the slices fill the mesh's box",
     BB_INTO(job, request.plan.thickness), .high = 1e30},
    {"repeats", "N", "measured rounds", BB_INTO(job, request.contest.repeats), .low = 1,
     .high = BB_SAMPLES_MAX - 1, .fallback = "10"},
    BB_ROUNDS_IN_TIME_OPTION(job, choice.time),
    BB_SEED_OPTION(job, request.contest.seed),
    BB_SIMULATIONS_OPTION(job, choice.metrics, "each way's answer to the first question"),
    BB_GROUP(bb_contest_options, job, choice),
    {"out", "DIR",
     "folder for slice.json, slice.html, and a PNG and an EXR of each slice; default: none",
     BB_INTO(job, choice.out)},
    BB_HISTORY_OPTION(job, choice.history),
    BB_QUIET_OPTION(job, request.contest.quiet),
    {.name = NULL},
};

static bb_status read_request(job *j)
{
    bb_slice_request *request = &j->request;
    request->exr = bb_exr_check() == BB_OK;
    if (!request->exr && j->choice.out != NULL)
        fprintf(stderr, "bvhbench: slices are written without EXR files: %s\n", bb_message());
    BB_TRY(bb_choose_tree_builders(&j->builders, BB_OF_MESHES));
    return bb_check_searches(&j->searches);
}

static bb_status slice(job *j, bb_scene *scene, size_t number)
{
    char name[sizeof scene->name], file[64], path[PATH_MAX];
    bb_contest_request *request = &j->request.contest;
    BB_TRY(bb_scene_upload(scene, request->device));
    snprintf(file, sizeof file, "slice-%zu", number);
    if (j->choice.out != NULL) {
        BB_TRY(bb_join_path(path, j->choice.out, file));
        request->pictures = path;
    }
    snprintf(name, sizeof name, "%s", scene->name);
    bb_contest_output_name(&j->output, name, sizeof name);
    request->name = name;
    request->files = file;
    BB_TRY(bb_slice_run(&j->request, scene, j->output.table));
    return bb_contest_output_scene(&j->output);
}

static bb_status slice_all(job *j)
{
    BB_TRY(bb_contest_output_request(&j->output, &j->builders, &j->searches, &j->request.contest));
    for (size_t i = 0; i < j->scenes.count && !bb_interrupted(); i++) {
        bb_scene *scene;
        BB_TRY(bb_scene_load_any(j->scenes.items[i], &scene));
        j->request.contest.ends_ms = bb_contest_ends(&j->choice, j->scenes.count - i);
        bb_status status = slice(j, scene, i + 1);
        bb_scene_free(scene);
        BB_TRY(status);
    }
    return BB_OK;
}

static bb_status work(job *j)
{
    BB_TRY(bb_contest_begin(&j->choice, j->scenes.items, j->scenes.count));
    BB_TRY(read_request(j));
    BB_TRY(bb_open_device(&j->choice.device, &j->request.contest.device));
    bb_interrupt_catch();
    return bb_contest_output_end(&j->output, slice_all(j), &j->wrong);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    job *j = values;
    j->output = (bb_contest_output){
        .outline = &bb_slice_outline, .choice = &j->choice, .command_line = cli->command_line};
    bb_status status = work(j);
    return bb_contest_end(status, j->wrong, exit_status);
}

static void release(void *values)
{
    bb_device_close(((job *)values)->request.contest.device);
}

extern const bb_command bb_command_slice;
const bb_command bb_command_slice = {
    .name = "slice",
    .summary = "fill slices of a mesh of tetrahedra as a 3D printer would",
    .details =
        "Cuts the mesh's box into slices of voxels. A voxel has material if a tetrahedron touches\n"
        "it. Its value is the field of the tetrahedron that holds its centre, or of the nearest, "
        "continued.\n"
        "Each builder is measured with each search, and compared with the first of these or with "
        "no tree.\n"
        "PNG: values by colour, black without material. EXR: Y is the value; A is 1 inside, 0.5 "
        "beside, 0\n"
        "empty. Exit status 1: a voxel differs from the first one's (if a mesh overlaps itself, "
        "values may\n"
        "differ), or clocks contradict each other.",
    .more_help = bb_print_mesh_builders,
    .options = options,
    .bytes = sizeof(job),
    .goes_on = true,
    .run = run,
    .release = release,
};
