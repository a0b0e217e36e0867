/* bvhbench volume: pictures of volumes, with trees and without. */
#include "framework/base/interrupt.h"
#include "framework/base/number.h"
#include "framework/cli/contest_options.h"
#include "framework/cli/inputs.h"
#include "framework/device/device_private.h"
#include "framework/dvr/dvr.h"
#include "framework/record/put.h"
#include "framework/report/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"scene", "S",
     "volume: a file (.raw, .raw.zst, .nrrd, .vox) or `nbody:n=N`; or a mesh of tetrahedra: a file "
     "(.node, .ele, .msh, .mesh, .vtk) or `tets:side=N`",
     BB_CLI_REPEATED},
    {"transfer", "T",
     "transfer function: of `list transfers`, or a file; several follow each other; default: the "
     "scene's; of a mesh, ramp",
     BB_CLI_LIST},
    {"builder", "B", "default: what builders name for it, see below", BB_CLI_LIST},
    {"kernel", "K", "of a volume; default: stack,stack8", BB_CLI_LIST},
    {"search", "S",
     "of a mesh, how samples are found: skip, octree, octree:boundary=no; default: skip,octree",
     BB_CLI_LIST},
    {"view", "V", "view of the scene; default: all", false},
    {"turns", "N",
     "instead: the volume turned about each axis by N times 2 degrees, in parallel projection",
     false},
    {"paper", NULL,
     "the papers' settings as defaults: --turns 180 --size 2160x2160 --repeats 50; of a mesh "
     "--size "
     "1024x1024 --repeats 50",
     false},
    {"size", "WxH", "of a picture; default: 256x256", false},
    {"step", "X",
     "distance of samples, in voxels; of a mesh in 1/128 of its longest side; default: 0.5", false},
    {"cutoff", "X",
     "a ray ends where less than this is left of the light behind; default: 0, never", false},
    {"steps", "LIST", "for the accuracy: steps in voxels; default: 4,2,1,0.5,0.25; none: not",
     BB_CLI_LIST},
    {"repeats", "N", "measured rounds; default: 10", false},
    {"seed", "N", "random seed; default: 1", false},
    {"brief", NULL,
     "less: by default no builders that take long on meshes; no trees, phases and legends", false},
    {"json", NULL, "print JSON", false},
    BB_DEVICE_OPTION,
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     false},
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", true},
    {"kernels-from", "DIR", "take device code from here first (edit and run)", false},
    {"out", "DIR", "folder for volume.json, volume.html and PNG pictures; default: none", false},
    {"quiet", NULL, "do not show progress", false},
    {.name = NULL},
};

typedef struct job {
    const bb_cli *cli;
    bb_dvr_request request;
    bb_dvr_result *result;
    cJSON *results; /* of the document */
    bool wrong;
    uint32_t pictures;                       /* sets of them, so far */
    bb_names builders[2], kernels, searches; /* builders of volumes, of meshes */
} job;

/* ---- the request ---- */

static bb_status read_steps(const bb_cli *cli, bb_dvr_request *request)
{
    static const double usual[] = {4, 2, 1, 0.5, 0.25};
    uint32_t count;
    char *const *given = bb_cli_values(cli, "steps", &count);
    request->step_count = count;
    if (count == 1 && strcmp(given[0], "none") == 0)
        request->step_count = 0;
    if (count == 0) {
        request->step_count = sizeof usual / sizeof usual[0];
        memcpy(request->steps, usual, sizeof usual);
        return BB_OK;
    }
    if (request->step_count > BB_DVR_STEPS_MAX)
        return bb_fail(BB_INVALID, "--steps has %u, at most %d are taken", count, BB_DVR_STEPS_MAX);
    for (uint32_t i = 0; i < request->step_count; i++) {
        double *step = &request->steps[i];
        if (!bb_read_real(given[i], step) || !(*step >= 1e-3 && *step <= 1e3))
            return bb_fail(BB_INVALID, "--steps: '%s' is no number from 0.001 to 1000", given[i]);
        if (i > 0 && *step >= step[-1])
            return bb_fail(BB_INVALID, "--steps: %g comes after %g: they must descend", *step,
                           step[-1]);
    }
    return BB_OK;
}

static bb_status read_numbers(const bb_cli *cli, bb_dvr_request *request)
{
    uint64_t turns, repeats;
    const bool paper = bb_cli_value(cli, "paper") != NULL;
    BB_TRY(bb_cli_size(cli, "size", &request->width, &request->height));
    BB_TRY(bb_cli_u64(cli, "turns", 0, 1, 180, &turns));
    BB_TRY(bb_cli_u64(cli, "repeats", paper ? 50 : 10, 1, BB_SAMPLES_MAX - 1, &repeats));
    BB_TRY(bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &request->seed));
    request->quiet = bb_cli_value(cli, "quiet") != NULL;
    BB_TRY(bb_cli_double(cli, "step", 0.5, 1e-3, 1e3, &request->step));
    BB_TRY(bb_cli_double(cli, "cutoff", 0, 0, 1, &request->cutoff));
    request->turns = (uint32_t)turns;
    request->repeats = (uint32_t)repeats;
    request->view = bb_cli_value(cli, "view");
    if (request->view != NULL && turns > 0)
        return bb_fail(BB_INVALID, "--turns makes views of its own: drop --view");
    return read_steps(cli, request);
}

static bb_status read_names(job *j)
{
    const bool brief = bb_cli_value(j->cli, "brief") != NULL;
    uint32_t count;
    BB_TRY(bb_choose_tree_builders(j->cli, BB_OF_VOLUMES, &j->builders[0]));
    BB_TRY(bb_choose_tree_builders(j->cli, brief ? BB_OF_MESHES_BRIEFLY : BB_OF_MESHES,
                                   &j->builders[1]));
    BB_TRY(bb_choose_searches(j->cli, &j->searches));
    bb_cli_values(j->cli, "kernel", &count);
    return count > 0 ? bb_choose_kernels(j->cli, &j->kernels)
                     : bb_names_add(&j->kernels, "stack,stack8");
}

/* What depends on whether it is a volume or a mesh. */
static bb_status choose_pictures(job *j, bool mesh)
{
    const bool paper = bb_cli_value(j->cli, "paper") != NULL;
    bb_dvr_request *request = &j->request;
    request->width = request->height = !paper ? 256 : mesh ? 1024 : 2160;
    if (paper && bb_cli_value(j->cli, "turns") == NULL && request->view == NULL)
        request->turns = mesh ? 0 : 180;
    return bb_cli_size(j->cli, "size", &request->width, &request->height);
}

static void choose_names(job *j, bool mesh)
{
    bb_dvr_request *request = &j->request;
    request->builders = (const char *const *)j->builders[mesh].items;
    request->builder_count = (uint32_t)j->builders[mesh].count;
    request->kernels = (const char *const *)j->kernels.items;
    request->kernel_count = (uint32_t)j->kernels.count;
    request->searches = (const char *const *)j->searches.items;
    request->search_count = (uint32_t)j->searches.count;
}

/* ---- the work ---- */

static bb_status compare(job *j, bb_scene *scene)
{
    char folder[PATH_MAX], path[PATH_MAX];
    const char *out = bb_cli_value(j->cli, "out");
    j->pictures++;
    if (out != NULL) {
        snprintf(folder, sizeof folder, "volume-%u-%s", j->pictures,
                 scene->volume != NULL ? scene->volume->transfer.name : j->request.transfer->name);
        BB_TRY(bb_join_path(path, out, folder));
        j->request.pictures = path;
    }
    j->request.picture_files = cJSON_CreateArray();
    bb_status status = bb_dvr_run(&j->request, scene, j->result);
    if (status != BB_OK) {
        cJSON_Delete(j->request.picture_files);
        return status;
    }
    for (uint32_t w = 0; w < j->result->way_count; w++)
        j->wrong = j->wrong || j->result->ways[w].differ > 0;
    if (bb_contest_prints(j->cli, j->request.device, j->results))
        (bb_cli_value(j->cli, "brief") != NULL ? bb_dvr_print_briefly : bb_dvr_print)(j->result);
    return bb_contest_add(j->results, bb_dvr_json(j->result), j->request.picture_files);
}

/* One transfer function after the other, of those given. */
static bb_status compare_transfers(job *j, bb_scene *scene)
{
    uint32_t count, changed;
    char *const *transfers = bb_cli_values(j->cli, "transfer", &count);
    const bool mesh = scene->volume == NULL;
    bb_status status = BB_OK;
    if (count == 0 && !mesh)
        return compare(j, scene);
    for (uint32_t i = 0; (i < count || i == 0) && status == BB_OK && !bb_interrupted(); i++) {
        bb_transfer transfer;
        status =
            bb_transfer_load(count > 0 ? transfers[i] : bb_transfer_presets[0].name, &transfer);
        j->request.transfer = &transfer;
        if (status == BB_OK && !mesh)
            status = bb_scene_set_transfer(scene, &transfer, &changed);
        if (status == BB_OK)
            status = compare(j, scene);
    }
    j->request.transfer = NULL;
    return status;
}

static bb_status compare_scene(job *j, const char *name)
{
    bb_scene *scene;
    BB_TRY(bb_scene_load_any(name, &scene));
    bb_status status = BB_OK;
    if (scene->volume == NULL && scene->kinds != BB_TETRAHEDRONS)
        status = bb_fail(BB_INVALID,
                         "%s: is neither a volume nor a mesh of tetrahedra: take nbody, tets, or a "
                         "file of such",
                         name);
    choose_names(j, scene->volume == NULL);
    if (status == BB_OK)
        status = choose_pictures(j, scene->volume == NULL);
    if (status == BB_OK)
        status = bb_scene_upload(scene, j->request.device);
    if (status == BB_OK)
        status = compare_transfers(j, scene);
    bb_tracers_clear(j->request.device);
    bb_scene_free(scene);
    return status;
}

/* Before anything is measured. */
static bb_status check_transfers(const bb_cli *cli)
{
    uint32_t count;
    char *const *transfers = bb_cli_values(cli, "transfer", &count);
    for (uint32_t i = 0; i < count; i++) {
        bb_transfer transfer;
        BB_TRY(bb_transfer_load(transfers[i], &transfer));
    }
    return BB_OK;
}

static bb_status compare_all(job *j)
{
    uint32_t count;
    cJSON *document;
    char *const *scenes = bb_cli_values(j->cli, "scene", &count);
    if (!bb_contest_document("bvhbench-volume/1", j->request.device, &document, &j->results) ||
        !bb_put_number(document, "step", j->request.step) ||
        !bb_put_number(document, "cutoff", j->request.cutoff)) {
        cJSON_Delete(document);
        return bb_fail(BB_REFUSED, "no memory for the results");
    }
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < count && status == BB_OK && !bb_interrupted(); i++)
        status = compare_scene(j, scenes[i]);
    /* what was measured before a failure is kept */
    bb_status written = BB_OK;
    if (status == BB_OK || cJSON_GetArraySize(j->results) > 0)
        written = bb_contest_write(j->cli, document, "volume", bb_report_contest);
    cJSON_Delete(document);
    return status != BB_OK ? status : written;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    uint32_t scenes;
    job j = {.cli = cli};
    char *const *names = bb_cli_values(cli, "scene", &scenes);
    if (scenes == 0)
        return bb_fail(BB_INVALID, "volume needs --scene: see `bvhbench volume --help`");
    BB_TRY(read_numbers(cli, &j.request));
    BB_TRY(check_transfers(cli));
    bb_status status = bb_contest_begin(cli, names, scenes);
    if (status == BB_OK)
        status = read_names(&j);
    j.result = calloc(1, sizeof *j.result);
    if (status == BB_OK && j.result == NULL)
        status = bb_fail(BB_REFUSED, "no memory for the results");
    if (status == BB_OK)
        status = bb_open_device(cli, &j.request.device);
    if (status == BB_OK) {
        bb_interrupt_catch();
        status = compare_all(&j);
        bb_device_close(j.request.device);
    }
    free(j.result);
    for (int mesh = 0; mesh < 2; mesh++)
        bb_names_free(&j.builders[mesh]);
    bb_names_free(&j.kernels);
    bb_names_free(&j.searches);
    return bb_contest_end(status, j.wrong, exit_status);
}

extern const bb_command bb_command_volume;
const bb_command bb_command_volume = {
    .name = "volume",
    .summary = "pictures of volumes and tetrahedra: builders and kernels against each other",
    .details =
        "Of each volume and each transfer function: build, layout and picture of each "
        "builder with\n"
        "each kernel, in turns with the march without a tree, and whether the pictures are "
        "the same;\n"
        "then how far pictures are from converged ones, by the distance of samples.\n"
        "Of a mesh of tetrahedra: each builder with each search, against the first of them.\n"
        "Exit status 1: a picture differs from the one without a tree, or from the first.",
    .more_help = bb_print_volume_builders,
    .options = options,
    .run = run,
};
