/* bvhbench volume: pictures of volumes, with trees and without. */
#include "framework/base/interrupt.h"
#include "framework/base/number.h"
#include "framework/cli/contest_output.h"
#include "framework/cli/inputs.h"
#include "framework/cli/output.h"
#include "framework/device/device_private.h"
#include "framework/tasks/dvr.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct job {
    bb_contest_choice choice;
    bb_names scenes, transfers, builders, mesh_builders, kernels, searches, steps;
    bb_dvr_request request;
    uint32_t width, height, turns; /* 0: by the kind of scene */
    bool paper, brief;
    bb_contest_output output;
    bool wrong;
    uint32_t pictures; /* sets of them, so far */
    size_t left;       /* scenes, with each transfer function, until the next has begun */
} job;

static const bb_cli_option options[] = {
    {"scene", "S",
     "volume: a file (.raw, .raw.zst, .nrrd, .vox) or `nbody:n=N`; or a mesh of tetrahedra: a file "
     "(.node, .ele, .msh, .mesh, .vtk) or `tets:side=N`",
     BB_INTO_EACH(job, scenes), .needed = true},
    {"transfer", "T",
     "transfer function: one of `list transfers`, or a file; default: the scene's, for a mesh ramp",
     BB_INTO(job, transfers)},
    {"builder", "B", "builders; default: the variants that they declare for it, see below",
     BB_INTO(job, builders)},
    {"kernel", "K", "kernels for volumes", BB_INTO(job, kernels), .fallback = "stack,stack8"},
    BB_SEARCH_OPTION(job, searches, "how samples are found in a mesh: "),
    {"view", "V", "view of the scene; default: all", BB_INTO(job, request.view), .apart = "turns"},
    {"turns", "N",
     "instead of views, N pictures in parallel projection while the volume turns full circle, "
     "about each of the three axes",
     BB_INTO(job, turns), .low = 1, .high = 180},
    {"paper", NULL,
     "the papers' settings: --turns 180 --size 2160x2160, for a mesh --size 1024x1024",
     BB_INTO(job, paper), .presets = (const char *const[]){"repeats", "50", NULL}},
    {"size", "WxH", "size of a picture; default: 256x256", BB_INTO_SIZE(job, width)},
    {"step", "X", "distance of samples, in voxels; in a mesh, in 1/128 of its longest side",
     BB_INTO(job, request.step), .low = 1e-3, .high = 1e3, .fallback = "0.5"},
    {"cutoff", "X", "a ray ends where less than this share of the light behind is left; 0: never",
     BB_INTO(job, request.cutoff), .high = 1, .fallback = "0"},
    {"steps", "LIST", "distances of samples for which the accuracy is measured; none: it is not",
     BB_INTO(job, steps), .fallback = "4,2,1,0.5,0.25"},
    {"repeats", "N", "measured rounds", BB_INTO(job, request.contest.repeats), .low = 1,
     .high = BB_SAMPLES_MAX - 1, .fallback = "10"},
    BB_ROUNDS_IN_TIME_OPTION(job, choice.time),
    BB_SEED_OPTION(job, request.contest.seed),
    {"brief", NULL,
     "show less: no trees, phases and legends; by default no builders that take long on meshes",
     BB_INTO(job, brief)},
    BB_SIMULATIONS_OPTION(job, choice.metrics, "each way's answer to the first question"),
    BB_GROUP(bb_contest_options, job, choice),
    {"out", "DIR", "folder for volume.json, volume.html and PNG pictures; default: none",
     BB_INTO(job, choice.out)},
    BB_HISTORY_OPTION(job, choice.history),
    BB_QUIET_OPTION(job, request.contest.quiet),
    {.name = NULL},
};

/* ---- the request ---- */

static bb_status read_steps(job *j)
{
    const bb_names *given = &j->steps;
    if (given->count == 1 && strcmp(given->items[0], "none") == 0)
        return BB_OK;
    if (given->count > BB_DVR_STEPS_MAX)
        return bb_fail(BB_INVALID, "--steps has %zu, at most %d are taken", given->count,
                       BB_DVR_STEPS_MAX);
    for (size_t i = 0; i < given->count; i++) {
        double *step = &j->request.steps[i];
        if (!bb_read_real(given->items[i], step) || !(*step >= 1e-3 && *step <= 1e3))
            return bb_fail(BB_INVALID, "--steps: '%s' is no number from 0.001 to 1000",
                           given->items[i]);
        if (i > 0 && *step >= step[-1])
            return bb_fail(BB_INVALID, "--steps: %g comes after %g: they must descend", *step,
                           step[-1]);
    }
    j->request.step_count = (uint32_t)given->count;
    return BB_OK;
}

static bb_status read_names(job *j)
{
    for (size_t i = 0; i < j->builders.count; i++)
        BB_TRY(bb_names_add_item(&j->mesh_builders, j->builders.items[i]));
    BB_TRY(bb_choose_tree_builders(&j->builders, BB_OF_VOLUMES));
    BB_TRY(
        bb_choose_tree_builders(&j->mesh_builders, j->brief ? BB_OF_MESHES_BRIEFLY : BB_OF_MESHES));
    BB_TRY(bb_check_searches(&j->searches));
    return bb_choose_kernels(&j->kernels, j->choice.device.name);
}

/* What depends on whether it is a volume or a mesh. */
static void choose_pictures(job *j, bool mesh)
{
    bb_dvr_request *request = &j->request;
    const bb_names *builders = mesh ? &j->mesh_builders : &j->builders;
    request->width = request->height = !j->paper ? 256 : mesh ? 1024 : 2160;
    if (j->width > 0) {
        request->width = j->width;
        request->height = j->height;
    }
    request->turns = j->turns;
    if (j->paper && j->turns == 0 && request->view == NULL)
        request->turns = mesh ? 0 : 180;
    bb_contest_take_names(builders, mesh ? &j->searches : &j->kernels, &request->contest);
}

/* ---- the work ---- */

static bb_status compare(job *j, bb_scene *scene)
{
    char name[sizeof scene->name + 96], file[96], path[PATH_MAX];
    bb_contest_request *request = &j->request.contest;
    const char *transfer =
        scene->volume != NULL ? scene->volume->transfer.name : j->request.transfer->name;
    snprintf(file, sizeof file, "volume-%u-%s", ++j->pictures, transfer);
    if (j->choice.out != NULL) {
        BB_TRY(bb_join_path(path, j->choice.out, file));
        request->pictures = path;
    }
    snprintf(name, sizeof name, "%s, transfer function %s", scene->name, transfer);
    bb_contest_output_name(&j->output, name, sizeof name);
    request->name = name;
    request->files = file;
    request->ends_ms = bb_contest_ends(&j->choice, --j->left);
    BB_TRY(bb_dvr_run(&j->request, scene, j->output.table));
    return bb_contest_output_scene(&j->output);
}

/* One transfer function after the other, of those given. */
static bb_status compare_transfers(job *j, bb_scene *scene)
{
    uint32_t changed;
    const size_t count = j->transfers.count;
    const bool mesh = scene->volume == NULL;
    bb_status status = BB_OK;
    if (count == 0 && !mesh)
        return compare(j, scene);
    for (size_t i = 0; (i < count || i == 0) && status == BB_OK && !bb_interrupted(); i++) {
        bb_transfer transfer;
        status = bb_transfer_load(count > 0 ? j->transfers.items[i] : bb_transfer_presets[0].name,
                                  &transfer);
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
    choose_pictures(j, scene->volume == NULL);
    if (status == BB_OK)
        status = bb_scene_upload(scene, j->request.contest.device);
    if (status == BB_OK)
        status = compare_transfers(j, scene);
    bb_traversers_clear(j->request.contest.device);
    bb_scene_free(scene);
    return status;
}

/* Before anything is measured. */
static bb_status check_transfers(const bb_names *names)
{
    for (size_t i = 0; i < names->count; i++) {
        bb_transfer transfer;
        BB_TRY(bb_transfer_load(names->items[i], &transfer));
    }
    return BB_OK;
}

static bb_status compare_all(job *j)
{
    BB_TRY(bb_contest_output_request(&j->output, &j->builders, &j->kernels, &j->request.contest));
    j->left = 1 + j->scenes.count * (j->transfers.count > 0 ? j->transfers.count : 1);
    for (size_t i = 0; i < j->scenes.count && !bb_interrupted(); i++)
        BB_TRY(compare_scene(j, j->scenes.items[i]));
    return BB_OK;
}

static bb_status work(job *j)
{
    BB_TRY(read_steps(j));
    BB_TRY(check_transfers(&j->transfers));
    BB_TRY(bb_contest_begin(&j->choice, j->scenes.items, j->scenes.count));
    BB_TRY(read_names(j));
    BB_TRY(bb_open_device(&j->choice.device, &j->request.contest.device));
    bb_interrupt_catch();
    return bb_contest_output_end(&j->output, compare_all(j), &j->wrong);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    job *j = values;
    j->output = (bb_contest_output){.outline = &bb_dvr_outline,
                                    .printed = j->brief ? &bb_dvr_outline_briefly : NULL,
                                    .choice = &j->choice,
                                    .command_line = cli->command_line};
    bb_status status = work(j);
    return bb_contest_end(status, j->wrong, exit_status);
}

static void release(void *values)
{
    job *j = values;
    bb_names_free(&j->mesh_builders);
    bb_device_close(j->request.contest.device);
}

extern const bb_command bb_command_volume;
const bb_command bb_command_volume = {
    .name = "volume",
    .summary = "compare builders and kernels on pictures of volumes and of tetrahedra",
    .details =
        "For each volume and each transfer function, builds, layouts and pictures of each "
        "builder with each\n"
        "kernel are timed in turns with the march without a tree, and the pictures are "
        "compared. Then the\n"
        "error against converged pictures is shown by the distance of samples.\n"
        "On a mesh of tetrahedra, each builder with each search is compared with the "
        "first of these.\n"
        "Exit status 1: a picture differs from the one without a tree, or from the first; or "
        "clocks\n"
        "contradict each other.",
    .more_help = bb_print_volume_builders,
    .options = options,
    .bytes = sizeof(job),
    .goes_on = true,
    .run = run,
    .release = release,
};
