/* bvhbench animate: methods that keep trees of moving scenes up to date. */
#include "framework/animate/animate.h"
#include "framework/base/interrupt.h"
#include "framework/base/number.h"
#include "framework/builder/registry.h"
#include "framework/cli/contest_options.h"
#include "framework/cli/inputs.h"
#include "framework/device/device_private.h"
#include "framework/measure/contest.h"
#include "framework/picture/image.h"
#include "framework/report/report.h"

#include <stdio.h>
#include <string.h>

typedef struct job {
    bb_contest_choice choice;
    bb_names scenes, builders, kernels, rays;
    const char *frames;
    bb_animate_request request;
    bb_animate_result result;
    cJSON *document, *results;
    bool wrong;
} job;

static const bb_cli_option options[] = {
    {"scene", "S", "a scene that moves: `list scenes` shows which have frames; FILE.glb:clip=NAME",
     BB_INTO_EACH(job, scenes), .needed = true},
    {"builder", "B", "methods; default: those that builders declare for it, see below",
     BB_INTO(job, builders)},
    {"kernel", "K", "kernels", BB_INTO(job, kernels), .fallback = "stack,stack8"},
    {"rays", "R", "workloads", BB_INTO(job, rays), .fallback = "primary,diffuse"},
    {"intersector", "I", "intersection tests: see `list intersectors`",
     BB_INTO(job, request.intersector), .fallback = "exact"},
    {"view", "V", "view of the scene; default: its first", BB_INTO(job, request.view)},
    {"frames", "A..B", "from frame A to frame B; default: all", BB_INTO(job, frames)},
    {"size", "WxH", "image size for primary rays", BB_INTO_SIZE(job, request.width),
     .fallback = "256x256"},
    {"max-rays", "N", "most rays of each sampled kind", BB_INTO(job, request.max_rays), .low = 1,
     .high = 1 << 24, .fallback = "65536"},
    {"repeats", "N", "rounds over the whole sequence that count", BB_INTO(job, request.repeats),
     .low = 1, .high = BB_ANIMATE_ROUNDS_MAX - 1, .fallback = "3"},
    BB_SEED_OPTION(job, request.seed),
    BB_GROUP(bb_contest_options, job, choice),
    {"out", "DIR", "folder for animate.json, animate.html and a strip of frames; default: none",
     BB_INTO(job, choice.out)},
    BB_QUIET_OPTION(job, request.quiet),
    {.name = NULL},
};

/* ---- what was asked for ---- */

static bb_status read_frames(job *j)
{
    const char *text = j->frames;
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
    BB_TRY(j->builders.count > 0 ? bb_choose_builders(&j->builders, true)
                                 : bb_names_add_role(&j->builders, BB_ROLE_MOVING));
    BB_TRY(bb_choose_kernels(&j->kernels, j->choice.device.name));
    BB_TRY(bb_choose_rays(&j->rays));
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

/* ---- the work ---- */

/* FOLDER/animate-N.png, whose name is added to `files`. */
static bb_status write_strip(const job *j, const bb_animate_result *result, cJSON *files)
{
    char name[64], path[PATH_MAX];
    if (result->strip.rgb == NULL)
        return BB_OK;
    snprintf(name, sizeof name, "animate-%d.png", cJSON_GetArraySize(j->results) + 1);
    BB_TRY(bb_join_path(path, j->choice.out, name));
    BB_TRY(bb_image_write(path, result->strip.rgb, result->strip.width, result->strip.height));
    cJSON *file = cJSON_CreateString(name);
    if (file != NULL && cJSON_AddItemToArray(files, file))
        return BB_OK;
    cJSON_Delete(file);
    return bb_fail(BB_REFUSED, "no memory for the results");
}

static bb_status add_result(job *j)
{
    const bb_animate_result *result = &j->result;
    cJSON *files = cJSON_CreateArray();
    if (bb_contest_prints(&j->choice, j->request.device, j->results))
        bb_animate_print(result);
    bb_status status = write_strip(j, result, files);
    if (status == BB_OK)
        return bb_contest_add(j->results, bb_animate_json(result), files);
    cJSON_Delete(files);
    return status;
}

static bb_status animate(job *j, const char *name)
{
    bb_animate_result *result = &j->result;
    bb_scene *scene;
    BB_TRY(bb_scene_load(name, &scene));
    bb_status status = bb_scene_upload(scene, j->request.device);
    if (status == BB_OK)
        status = bb_animate_run(&j->request, scene, result);
    if (status == BB_OK) {
        j->wrong = j->wrong || bb_animate_wrong(result) > 0 || bb_animate_failed(result) > 0;
        status = add_result(j);
    }
    bb_animate_release(result);
    bb_scene_free(scene);
    return status;
}

static bb_status animate_all(job *j)
{
    if (!bb_contest_document("bvhbench-animate/1", j->request.device, &j->document, &j->results))
        return bb_fail(BB_REFUSED, "no memory for the results");
    bb_status status = BB_OK;
    for (size_t i = 0; i < j->scenes.count && status == BB_OK && !bb_interrupted(); i++)
        status = animate(j, j->scenes.items[i]);
    /* what was measured before a failure is kept */
    char why[1024];
    snprintf(why, sizeof why, "%s", status != BB_OK ? bb_message() : "");
    bb_status written = BB_OK;
    if (cJSON_GetArraySize(j->results) > 0)
        written = bb_contest_write(&j->choice, j->document, "animate", bb_report_animate);
    return status != BB_OK ? bb_fail(status, "%s", why) : written;
}

static bb_status work(job *j)
{
    BB_TRY(bb_contest_begin(&j->choice, j->scenes.items, j->scenes.count));
    BB_TRY(read_frames(j));
    BB_TRY(read_names(j));
    j->request.strip = j->choice.out != NULL;
    BB_TRY(bb_open_device(&j->choice.device, &j->request.device));
    bb_interrupt_catch();
    return animate_all(j);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    (void)cli;
    job *j = values;
    bb_status status = work(j);
    return bb_contest_end(status, j->wrong, exit_status);
}

static void release(void *values)
{
    job *j = values;
    cJSON_Delete(j->document);
    bb_device_close(j->request.device);
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
    .summary = "compare methods that keep the trees of moving scenes up to date",
    .details = "A method is a builder, alone or with optimisers behind it. It builds each frame "
               "anew or updates\n"
               "its tree. All methods go through the frames together; the trees of each frame are "
               "checked and all\n"
               "answers judged. Shown are times of updates, layouts and traces, costs beside those "
               "of trees built\n"
               "for the frame, and which method wins for how many rays per frame.\n"
               "Exit status 1: an answer is wrong, or a tree is not valid.",
    .more_help = more_help,
    .options = options,
    .bytes = sizeof(job),
    .run = run,
    .release = release,
};
