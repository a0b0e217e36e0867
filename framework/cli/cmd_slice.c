/* bvhbench slice: slices of a mesh, filled conservatively. */
#include "framework/base/interrupt.h"
#include "framework/cli/contest_options.h"
#include "framework/cli/inputs.h"
#include "framework/device/device_private.h"
#include "framework/picture/exr.h"
#include "framework/report/report.h"
#include "framework/slice/slice_contest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"scene", "S",
     "mesh of tetrahedra: a file (.node, .ele, .msh, .mesh, .vtk) or `tets:side=N` (may be "
     "repeated)",
     BB_CLI_REPEATED},
    {"builder", "B", "default: what builders name for it, see below", BB_CLI_LIST},
    {"search", "S", "skip, octree, octree:boundary=no; default: skip,octree", BB_CLI_LIST},
    {"no-tree", NULL, "also by all tetrahedra, one after the other, which others are compared with",
     false},
    {"paper", NULL, "the paper's settings as defaults: --slices 1 --size 999x999 --repeats 50",
     false},
    {"axis", "A", "across the slices: x, y or z; default: z", false},
    {"size", "WxH", "voxels of a slice, along the two other axes; default: 256x256", false},
    {"slices", "N", "one on the other, about the middle; default: 8", false},
    {"thickness", "X", "of a slice, in scene units; default: so that they fill the mesh's box",
     false},
    {"repeats", "N", "measured rounds; default: 10", false},
    {"seed", "N", "random seed; default: 1", false},
    {"json", NULL, "print JSON", false},
    BB_DEVICE_OPTION,
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     false},
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", true},
    {"kernels-from", "DIR", "take device code from here first (edit and run)", false},
    {"out", "DIR",
     "folder for slice.json, slice.html, and a PNG and an EXR of each slice; default: none", false},
    {"quiet", NULL, "do not show progress", false},
    {.name = NULL},
};

typedef struct job {
    const bb_cli *cli;
    bb_slice_request request;
    bb_slice_result *result;
    cJSON *document, *results;
    bool wrong;
    bb_names builders, searches;
} job;

static bb_status read_plan(const bb_cli *cli, bb_slice_plan *plan)
{
    const char *axis = bb_cli_value(cli, "axis");
    uint64_t slices;
    const bool paper = bb_cli_value(cli, "paper") != NULL;
    plan->width = plan->height = paper ? 999 : 256;
    BB_TRY(bb_cli_size(cli, "size", &plan->width, &plan->height));
    BB_TRY(bb_cli_u64(cli, "slices", paper ? 1 : 8, 1, 4096, &slices));
    BB_TRY(bb_cli_double(cli, "thickness", 0, 0, 1e30, &plan->thickness));
    plan->count = (uint32_t)slices;
    if (axis == NULL)
        axis = "z";
    if (strlen(axis) != 1 || strchr("xyz", axis[0]) == NULL)
        return bb_fail(BB_INVALID, "--axis is '%s', must be x, y or z", axis);
    plan->axis = (uint32_t)(axis[0] - 'x');
    return BB_OK;
}

static bb_status read_request(job *j)
{
    uint64_t repeats;
    bb_slice_request *request = &j->request;
    BB_TRY(read_plan(j->cli, &request->plan));
    BB_TRY(bb_cli_u64(j->cli, "repeats", bb_cli_value(j->cli, "paper") != NULL ? 50 : 10, 1,
                      BB_SAMPLES_MAX - 1, &repeats));
    BB_TRY(bb_cli_u64(j->cli, "seed", 1, 0, UINT64_MAX, &request->seed));
    request->quiet = bb_cli_value(j->cli, "quiet") != NULL;
    request->repeats = (uint32_t)repeats;
    request->without = bb_cli_value(j->cli, "no-tree") != NULL;
    request->exr = bb_exr_check() == BB_OK;
    if (!request->exr && bb_cli_value(j->cli, "out") != NULL)
        fprintf(stderr, "bvhbench: slices are written without EXR files: %s\n", bb_message());
    BB_TRY(bb_choose_tree_builders(j->cli, BB_OF_MESHES, &j->builders));
    BB_TRY(bb_choose_searches(j->cli, &j->searches));
    request->builders = (const char *const *)j->builders.items;
    request->builder_count = (uint32_t)j->builders.count;
    request->searches = (const char *const *)j->searches.items;
    request->search_count = (uint32_t)j->searches.count;
    return BB_OK;
}

static bb_status slice(job *j, bb_scene *scene, uint32_t number)
{
    char folder[64], path[PATH_MAX];
    const char *out = bb_cli_value(j->cli, "out");
    BB_TRY(bb_scene_upload(scene, j->request.device));
    if (out != NULL) {
        snprintf(folder, sizeof folder, "slice-%u", number);
        BB_TRY(bb_join_path(path, out, folder));
        j->request.pictures = path;
    }
    j->request.picture_files = cJSON_CreateArray();
    bb_status status = bb_slice_run(&j->request, scene, j->result);
    if (status != BB_OK) {
        cJSON_Delete(j->request.picture_files);
        return status;
    }
    for (uint32_t w = 0; w < j->result->way_count; w++)
        j->wrong = j->wrong || j->result->ways[w].differ > 0;
    if (bb_contest_prints(j->cli, j->request.device, j->results))
        bb_slice_print(j->result);
    return bb_contest_add(j->results, bb_slice_json(j->result), j->request.picture_files);
}

static bb_status slice_all(job *j)
{
    uint32_t count;
    char *const *scenes = bb_cli_values(j->cli, "scene", &count);
    if (!bb_contest_document("bvhbench-slice/1", j->request.device, &j->document, &j->results))
        return bb_fail(BB_REFUSED, "no memory for the results");
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < count && status == BB_OK && !bb_interrupted(); i++) {
        bb_scene *scene;
        status = bb_scene_load_any(scenes[i], &scene);
        if (status != BB_OK)
            break;
        status = slice(j, scene, i + 1);
        bb_scene_free(scene);
    }
    /* what was measured before a failure is kept */
    bb_status written = BB_OK;
    if (status == BB_OK || cJSON_GetArraySize(j->results) > 0)
        written = bb_contest_write(j->cli, j->document, "slice", bb_report_contest);
    cJSON_Delete(j->document);
    return status != BB_OK ? status : written;
}

static bb_status work(job *j)
{
    uint32_t count;
    char *const *scenes = bb_cli_values(j->cli, "scene", &count);
    BB_TRY(bb_contest_begin(j->cli, scenes, count));
    BB_TRY(read_request(j));
    j->result = calloc(1, sizeof *j->result);
    if (j->result == NULL)
        return bb_fail(BB_REFUSED, "no memory for the results");
    BB_TRY(bb_open_device(j->cli, &j->request.device));
    bb_interrupt_catch();
    bb_status status = slice_all(j);
    bb_device_close(j->request.device);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    uint32_t scenes;
    job j = {.cli = cli};
    bb_cli_values(cli, "scene", &scenes);
    if (scenes == 0)
        return bb_fail(BB_INVALID, "slice needs --scene: see `bvhbench slice --help`");
    bb_status status = work(&j);
    free(j.result);
    bb_names_free(&j.builders);
    bb_names_free(&j.searches);
    return bb_contest_end(status, j.wrong, exit_status);
}

extern const bb_command bb_command_slice;
const bb_command bb_command_slice = {
    .name = "slice",
    .summary = "slices of a mesh of tetrahedra, filled as a printer would",
    .details =
        "Cuts the mesh's box into slices of voxels. Material is in each voxel that a tetrahedron "
        "touches;\n"
        "its value is the field of the one that holds the centre, or that of the nearest, "
        "continued.\n"
        "Each builder with each search, against the first of them or against no tree.\n"
        "PNG: values by colour, black without material. EXR: Y the value, A 1 inside, 0.5 beside, "
        "0 empty.\n"
        "Exit status 1: a voxel differs from the first way's (of a mesh that overlaps itself, "
        "values "
        "may).",
    .more_help = bb_print_mesh_builders,
    .options = options,
    .run = run,
};
