/* bvhbench animate: methods that keep trees of moving scenes up to date. */
#include "framework/animate/animate.h"
#include "framework/base/interrupt.h"
#include "framework/base/number.h"
#include "framework/builder/registry.h"
#include "framework/cli/contest_options.h"
#include "framework/cli/inputs.h"
#include "framework/contest/contest.h"
#include "framework/device/device_private.h"
#include "framework/picture/image.h"
#include "framework/report/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"scene", "S", "a scene that moves: `list scenes` shows which have frames; FILE.glb:clip=NAME",
     BB_CLI_REPEATED},
    {"builder", "B", "the methods; default: what builders name for it, see below", BB_CLI_LIST},
    {"kernel", "K", "default: stack,stack8", BB_CLI_LIST},
    {"rays", "R", "default: primary,diffuse", BB_CLI_LIST},
    {"intersector", "I", "default: exact", BB_CLI_ONCE},
    {"view", "V", "view of the scene; default: its first", BB_CLI_ONCE},
    {"frames", "A..B", "from frame A to frame B; default: all", BB_CLI_ONCE},
    {"size", "WxH", "of the picture that primary rays make; default: 256x256", BB_CLI_ONCE},
    {"max-rays", "N", "most rays of another kind; default: 65536", BB_CLI_ONCE},
    {"repeats", "N", "rounds over the whole sequence that count; default: 3", BB_CLI_ONCE},
    {"seed", "N", "random seed; default: 1", BB_CLI_ONCE},
    {"json", NULL, "print JSON", BB_CLI_ONCE},
    {"quiet", NULL, "do not show progress", BB_CLI_ONCE},
    {"device", "D", "index of an OpenCL device, or part of its name; default: the first",
     BB_CLI_ONCE},
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     BB_CLI_ONCE},
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", BB_CLI_LIST},
    {"kernels-from", "DIR", "take device code from here first (edit and run)", BB_CLI_ONCE},
    {"out", "DIR", "folder for animate.json, animate.html and a strip of frames; default: none",
     BB_CLI_ONCE},
    {.name = NULL},
};

typedef struct job {
    const bb_cli *cli;
    bb_animate_request request;
    cJSON *document, *results;
    bool wrong;
    bb_names builders, kernels, rays;
} job;

/* ---- what was asked for ---- */

static bb_status read_frames(job *j)
{
    const char *text = bb_cli_value(j->cli, "frames");
    uint64_t first, last;
    j->request.last = UINT32_MAX;
    if (text == NULL)
        return BB_OK;
    const char *dots = strstr(text, "..");
    char from[24];
    snprintf(from, sizeof from, "%.*s", dots != NULL ? (int)(dots - text) : 0, text);
    if (!bb_read_whole(from, &first) || !bb_read_whole(dots + 2, &last) || first >= last ||
        last > UINT32_MAX)
        return bb_fail(BB_INVALID, "--frames: '%s' is none of A..B, with A below B, as in 0..20",
                       text);
    j->request.first = (uint32_t)first;
    j->request.last = (uint32_t)last;
    return BB_OK;
}

static bb_status check_count(const char *option, size_t count, size_t most)
{
    return count <= most ? BB_OK
                         : bb_fail(BB_INVALID, "--%s: at most %zu, not %zu", option, most, count);
}

static bb_status read_names(job *j)
{
    bb_animate_request *request = &j->request;
    uint32_t count;
    bb_cli_values(j->cli, "builder", &count);
    BB_TRY(count > 0 ? bb_choose_builders(j->cli, true, &j->builders)
                     : bb_names_add_role(&j->builders, BB_ROLE_MOVING));
    bb_cli_values(j->cli, "kernel", &count);
    BB_TRY(count > 0 ? bb_choose_kernels(j->cli, &j->kernels)
                     : bb_names_add(&j->kernels, "stack,stack8"));
    bb_cli_values(j->cli, "rays", &count);
    BB_TRY(count > 0 ? bb_choose_rays(j->cli, &j->rays)
                     : bb_names_add(&j->rays, "primary,diffuse"));
    BB_TRY(check_count("builder", j->builders.count, BB_ANIMATE_METHODS_MAX));
    BB_TRY(check_count("kernel", j->kernels.count, BB_ANIMATE_KERNELS_MAX));
    BB_TRY(check_count("rays", j->rays.count, BB_ANIMATE_RAYS_MAX));
    request->builders = (const char *const *)j->builders.items;
    request->builder_count = (uint32_t)j->builders.count;
    request->kernels = (const char *const *)j->kernels.items;
    request->kernel_count = (uint32_t)j->kernels.count;
    request->rays = (const char *const *)j->rays.items;
    request->ray_count = (uint32_t)j->rays.count;
    return BB_OK;
}

static bb_status read_request(job *j)
{
    uint64_t repeats, most;
    bb_animate_request *request = &j->request;
    const char *intersector = bb_cli_value(j->cli, "intersector");
    request->width = request->height = 256;
    if (bb_cli_value(j->cli, "size") != NULL)
        BB_TRY(bb_cli_size(j->cli, "size", &request->width, &request->height));
    BB_TRY(bb_cli_u64(j->cli, "repeats", 3, 1, BB_ANIMATE_ROUNDS_MAX - 1, &repeats));
    BB_TRY(bb_cli_u64(j->cli, "max-rays", 65536, 1, 1 << 24, &most));
    BB_TRY(bb_cli_u64(j->cli, "seed", 1, 0, UINT64_MAX, &request->seed));
    request->repeats = (uint32_t)repeats;
    request->max_rays = (uint32_t)most;
    request->intersector = intersector != NULL ? intersector : "exact";
    request->view = bb_cli_value(j->cli, "view");
    request->quiet = bb_cli_value(j->cli, "quiet") != NULL;
    request->strip = bb_cli_value(j->cli, "out") != NULL;
    BB_TRY(read_frames(j));
    return read_names(j);
}

/* ---- the work ---- */

/* FOLDER/animate-N.png, whose name is added to `files`. */
static bb_status write_strip(const job *j, const bb_animate_result *result, cJSON *files)
{
    char name[64], path[PATH_MAX];
    if (result->strip.rgb == NULL)
        return BB_OK;
    snprintf(name, sizeof name, "animate-%d.png", cJSON_GetArraySize(j->results) + 1);
    BB_TRY(bb_join_path(path, bb_cli_value(j->cli, "out"), name));
    BB_TRY(bb_image_write(path, result->strip.rgb, result->strip.width, result->strip.height));
    return bb_contest_add_file(files, path);
}

static bb_status add_result(job *j, const bb_animate_result *result)
{
    cJSON *files = cJSON_CreateArray();
    if (bb_contest_prints(j->cli, j->request.device, j->results))
        bb_animate_print(result);
    bb_status status = write_strip(j, result, files);
    if (status == BB_OK)
        return bb_contest_add(j->results, bb_animate_json(result), files);
    cJSON_Delete(files);
    return status;
}

static bb_status animate(job *j, const char *name, bb_animate_result *result)
{
    bb_scene *scene;
    BB_TRY(bb_scene_load(name, &scene));
    bb_status status = bb_scene_upload(scene, j->request.device);
    if (status == BB_OK)
        status = bb_animate_run(&j->request, scene, result);
    if (status == BB_OK) {
        j->wrong = j->wrong || bb_animate_wrong(result) > 0 || bb_animate_failed(result) > 0;
        status = add_result(j, result);
    }
    bb_animate_release(result);
    bb_scene_free(scene);
    return status;
}

static bb_status animate_all(job *j, char *const *scenes, uint32_t count)
{
    bb_animate_result *result = calloc(1, sizeof *result);
    if (result == NULL ||
        !bb_contest_document("bvhbench-animate/1", j->request.device, &j->document, &j->results)) {
        free(result);
        return bb_fail(BB_REFUSED, "no memory for the results");
    }
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < count && status == BB_OK && !bb_interrupted(); i++)
        status = animate(j, scenes[i], result);
    /* what was measured before a failure is kept */
    char why[1024];
    snprintf(why, sizeof why, "%s", status != BB_OK ? bb_message() : "");
    bb_status written = BB_OK;
    if (cJSON_GetArraySize(j->results) > 0)
        written = bb_contest_write(j->cli, j->document, "animate", bb_report_animate);
    free(result);
    return status != BB_OK ? bb_fail(status, "%s", why) : written;
}

static bb_status work(job *j)
{
    uint32_t count;
    char *const *scenes = bb_cli_values(j->cli, "scene", &count);
    if (count == 0)
        return bb_fail(BB_INVALID, "animate: give a scene that moves, such as --scene twist");
    BB_TRY(bb_contest_begin(j->cli, scenes, count));
    BB_TRY(read_request(j));
    BB_TRY(bb_open_device(j->cli, &j->request.device));
    bb_interrupt_catch();
    bb_status status = animate_all(j, scenes, count);
    bb_device_close(j->request.device);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    job j = {.cli = cli};
    bb_status status = work(&j);
    cJSON_Delete(j.document);
    bb_names_free(&j.builders);
    bb_names_free(&j.kernels);
    bb_names_free(&j.rays);
    return bb_contest_end(status, j.wrong, exit_status);
}

static void more_help(FILE *out)
{
    bb_names methods = {0};
    if (bb_names_add_role(&methods, BB_ROLE_MOVING) == BB_OK)
        for (size_t i = 0; i < methods.count; i++)
            fprintf(out, "%s%s", i == 0 ? "\nmethods by default: " : ", ", methods.items[i]);
    fprintf(out, "\n");
    bb_names_free(&methods);
}

extern const bb_command bb_command_animate;
const bb_command bb_command_animate = {
    .name = "animate",
    .summary = "moving scenes: methods that keep trees up to date, frame by frame",
    .details = "A method is a builder, which builds each frame anew, or follows with what it has "
               "for it, alone or\n"
               "with optimisers behind it. All go through the frames together; each frame's trees "
               "are checked and\n"
               "each answer judged. Reported are updates, layouts, tracing, costs beside those of "
               "trees made for the\n"
               "frame, and who wins for how many rays per frame.\n"
               "Exit status 1: an answer is wrong, or a tree does not hold.",
    .more_help = more_help,
    .options = options,
    .run = run,
};
