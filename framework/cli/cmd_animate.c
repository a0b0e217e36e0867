/* bvhbench animate: methods that keep trees of moving scenes up to date. */
#include "framework/base/interrupt.h"
#include "framework/base/number.h"
#include "framework/builder/registry.h"
#include "framework/cli/contest_output.h"
#include "framework/cli/inputs.h"
#include "framework/cli/output.h"
#include "framework/device/device_private.h"
#include "framework/picture/image.h"
#include "framework/tasks/animate.h"

#include <stdio.h>
#include <string.h>

typedef struct job {
    bb_contest_choice choice;
    bb_names scenes, builders, kernels, rays, metrics;
    bb_simt simts[BB_SIMT_MAX];
    const char *frames;
    bb_animate_request request;
    bb_animate_result result;
    bb_contest_output output;
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
    BB_SIMULATIONS_OPTION(job, metrics, "traces of the first and the last frame"),
    BB_ROUNDS_IN_TIME_OPTION(job, choice.time),
    BB_SEED_OPTION(job, request.seed),
    BB_GROUP(bb_contest_options, job, choice),
    {"out", "DIR", "folder for animate.json, animate.html and a strip of frames; default: none",
     BB_INTO(job, choice.out)},
    BB_HISTORY_OPTION(job, choice.history),
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
    BB_TRY(bb_choose_simulations(&j->metrics, j->simts, &request->simt_count));
    request->simts = j->simts;
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

/* What was measured, if only a part: the strip of frames and rows of the table. */
static bb_status add_result(job *j, size_t number)
{
    bb_animate_result *result = &j->result;
    char strip[64], path[PATH_MAX];
    snprintf(strip, sizeof strip, "animate-%zu.png", number);
    bb_contest_output_name(&j->output, result->scene, sizeof result->scene);
    bb_animate_fill(result, result->strip.rgb != NULL ? strip : NULL, j->output.table);
    if (result->strip.rgb != NULL) {
        BB_TRY(bb_join_path(path, j->choice.out, strip));
        BB_TRY(bb_image_write(path, result->strip.rgb, result->strip.width, result->strip.height));
    }
    return BB_OK;
}

static bb_status animate(job *j, bb_scene *scene, size_t number)
{
    char why[1024];
    BB_TRY(bb_scene_upload(scene, j->request.device));
    bb_status status = bb_animate_run(&j->request, scene, &j->result);
    snprintf(why, sizeof why, "%s", status != BB_OK ? bb_message() : "");
    bb_status added = j->result.frame_count > 0 ? add_result(j, number) : BB_OK;
    bb_animate_release(&j->result);
    if (status != BB_OK)
        return bb_fail(status, "%s", why);
    BB_TRY(added);
    return bb_contest_output_scene(&j->output);
}

static bb_status animate_all(job *j)
{
    BB_TRY(bb_contest_output_begin(&j->output, j->request.device, j->request.seed));
    for (size_t i = 0; i < j->scenes.count && !bb_interrupted(); i++) {
        bb_scene *scene;
        BB_TRY(bb_scene_load(j->scenes.items[i], &scene));
        j->request.ends_ms = bb_contest_ends(&j->choice, j->scenes.count - i);
        bb_status status = animate(j, scene, i + 1);
        bb_scene_free(scene);
        BB_TRY(status);
    }
    return BB_OK;
}

static bb_status work(job *j)
{
    BB_TRY(bb_contest_begin(&j->choice, j->scenes.items, j->scenes.count));
    BB_TRY(read_frames(j));
    BB_TRY(read_names(j));
    j->request.strip = j->choice.out != NULL;
    j->request.audit = &j->output.audit;
    j->request.watch = &j->output.watch;
    BB_TRY(bb_open_device(&j->choice.device, &j->request.device));
    bb_interrupt_catch();
    return bb_contest_output_end(&j->output, animate_all(j), &j->wrong);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    job *j = values;
    j->output = (bb_contest_output){.outline = &bb_animate_outline,
                                    .printed = &bb_animate_outline_briefly,
                                    .choice = &j->choice,
                                    .command_line = cli->command_line};
    bb_status status = work(j);
    return bb_contest_end(status, j->wrong, exit_status);
}

static void release(void *values)
{
    bb_device_close(((job *)values)->request.device);
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
    .goes_on = true,
    .run = run,
    .release = release,
};
