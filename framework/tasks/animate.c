/* Rounds of frames of methods. */
#include "framework/tasks/animate_private.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/base/progress.h"
#include "framework/bench/turns.h"
#include "framework/builder/registry.h"
#include "framework/device/device_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what was asked for ---- */

static bb_status take_kernel(bb_animate *a, uint32_t k)
{
    const char *text = a->request->kernels[k];
    uint64_t leaf;
    BB_TRY(bb_kernel_parse(text, &a->kernel_specs[k], &a->kernels[k]));
    BB_TRY(
        bb_spec_u64(&a->kernel_specs[k], bb_kernel_common_options, "leaf", 1, BB_LEAF_MAX, &leaf));
    a->leaves[k] = (uint32_t)leaf;
    snprintf(a->result->kernels[k], sizeof a->result->kernels[k], "%s", text);
    return BB_OK;
}

static bb_status take_rays(bb_animate *a, uint32_t i)
{
    const char *text = a->request->rays[i];
    BB_TRY(bb_workload_parse(text, &a->ray_specs[i], &a->workloads[i]));
    if (a->workloads[i]->query->result_bytes != sizeof(bb_hit))
        return bb_fail(BB_INVALID, "animate: the answers to '%s' are no hits, which it could judge",
                       text);
    snprintf(a->result->rays[i], sizeof a->result->rays[i], "%s", text);
    return BB_OK;
}

static bb_status take_view(bb_animate *a)
{
    const char *name = a->request->view;
    for (uint32_t i = 0; i < a->scene->view_count; i++)
        if (name == NULL || strcmp(a->scene->views[i].name, name) == 0) {
            a->view = &a->scene->views[i];
            snprintf(a->result->view, sizeof a->result->view, "%s", a->view->name);
            return BB_OK;
        }
    return bb_fail(BB_INVALID, "%s: has no view '%s'", a->scene->name, name != NULL ? name : "");
}

static bb_status take_frames(bb_animate *a)
{
    const bb_animate_request *request = a->request;
    const bb_scene *scene = a->scene;
    uint32_t last = request->last < scene->frame_count ? request->last : scene->frame_count - 1;
    if (scene->frame_count <= 1)
        return bb_fail(BB_INVALID, "%s: does not move: it has one frame (see `list scenes`)",
                       scene->name);
    if (request->first >= last)
        return bb_fail(BB_INVALID,
                       "%s: from frame %u on there are not two frames to go through: they are 0 to "
                       "%u",
                       scene->name, request->first, scene->frame_count - 1);
    a->frames = last - request->first + 1;
    return BB_OK;
}

/* Figures, and rays, which are kept for all rounds: at most. */
static bb_status check_memory(const bb_animate *a)
{
    const bb_animate_request *request = a->request;
    const double pixels = (double)request->width * request->height;
    const double rays = fmax(pixels, request->max_rays) * request->ray_count * sizeof(bb_ray);
    const double bytes =
        a->frames * (rays + (double)request->builder_count * sizeof(bb_animate_frame));
    if (bytes <= (double)bb_host_limit())
        return BB_OK;
    return bb_fail(
        BB_REFUSED,
        "%s: figures and rays of %u frames may take %.0f MiB of memory, and %.0f MiB are "
        "the most: go through fewer (--frames), or with fewer rays or methods",
        a->scene->name, a->frames, bytes / 1048576.0, (double)bb_host_limit() / 1048576.0);
}

static bb_status take_request(bb_animate *a)
{
    const bb_animate_request *request = a->request;
    bb_animate_result *result = a->result;
    snprintf(result->scene, sizeof result->scene, "%s", a->scene->name);
    result->ignored = a->scene->ignored;
    snprintf(result->intersector, sizeof result->intersector, "%s", request->intersector);
    BB_TRY(take_frames(a));
    BB_TRY(take_view(a));
    BB_TRY(bb_intersector_parse(request->intersector, &a->intersector));
    for (uint32_t k = 0; k < request->kernel_count; k++)
        BB_TRY(take_kernel(a, k));
    for (uint32_t i = 0; i < request->ray_count; i++)
        BB_TRY(take_rays(a, i));
    result->method_count = request->builder_count;
    result->kernel_count = request->kernel_count;
    result->ray_count = request->ray_count;
    result->simulation_count = request->simt_count;
    for (uint32_t i = 0; i < request->simt_count; i++)
        snprintf(result->simulations[i], sizeof result->simulations[i], "%s",
                 request->simts[i].name);
    return BB_OK;
}

/* Those that take the scene. */
static bb_status make_yardsticks(bb_animate *a)
{
    bb_animate_result *result = a->result;
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const char *builder = bb_builder_variants(bb_builder_at(i), BB_ROLE_YARDSTICK);
        uint32_t at = result->yardstick_count;
        if (builder == NULL || at == BB_ANIMATE_YARDSTICKS_MAX)
            continue;
        bb_status status =
            bb_instance_create(a->device, builder, a->scene, a->request->seed, &a->yardsticks[at]);
        if (status == BB_UNSUPPORTED)
            continue;
        BB_TRY(status);
        snprintf(result->yardsticks[at], sizeof result->yardsticks[at], "%s", builder);
        result->yardstick_count++;
    }
    return BB_OK;
}

static bb_status prepare(bb_animate *a)
{
    const bb_animate_request *request = a->request;
    bb_animate_result *result = a->result;
    BB_TRY(take_request(a));
    BB_TRY(check_memory(a));
    a->rays = calloc(a->frames, sizeof *a->rays);
    a->runners = calloc(request->builder_count, sizeof *a->runners);
    result->states = calloc(a->frames, sizeof *result->states);
    if (a->rays == NULL || a->runners == NULL || result->states == NULL)
        return bb_fail(BB_REFUSED, "no memory for %u frames", a->frames);
    BB_TRY(bb_scene_set_frame(a->scene, request->first, NULL));
    BB_TRY(make_yardsticks(a));
    for (uint32_t m = 0; m < request->builder_count; m++) {
        a->runners[m].method = &result->methods[m];
        BB_TRY(bb_animate_runner_create(a, request->builders[m], &a->runners[m]));
    }
    return BB_OK;
}

static void clean_up(bb_animate *a)
{
    bb_animate_leave_frame(a);
    for (uint32_t m = 0; a->runners != NULL && m < a->request->builder_count; m++)
        if (a->runners[m].method != NULL)
            bb_animate_runner_destroy(a, &a->runners[m]);
    for (uint32_t f = 0; a->rays != NULL && f < a->frames; f++)
        for (uint32_t i = 0; i < a->request->ray_count; i++)
            bb_rays_free(a->rays[f].sets[i]);
    for (uint32_t i = 0; i < BB_ANIMATE_YARDSTICKS_MAX; i++)
        bb_instance_destroy(&a->yardsticks[i]);
    bb_buffer_release(&a->d_rays);
    bb_buffer_release(&a->d_answers);
    bb_counter_release(&a->counter);
    bb_host_free(a->results);
    bb_host_free(a->before);
    free(a->runners);
    free(a->rays);
}

/* ---- rounds ---- */

/* A frame that the scene is brought to. */
typedef struct frame_round {
    bb_animate *animate;
    uint32_t index, changed;
    bb_progress *progress;
} frame_round;

static bb_status take_turn(void *self, uint32_t who, uint32_t round, double *ms)
{
    const frame_round *f = self;
    (void)ms;
    BB_TRY(bb_animate_step(f->animate, &f->animate->runners[who], f->index, round, f->changed));
    bb_progress_step(f->progress);
    return BB_OK;
}

static bb_status do_frame(bb_animate *a, uint32_t index, uint32_t round, bb_random *random,
                          bb_progress *progress)
{
    frame_round self = {.animate = a, .index = index, .progress = progress};
    bb_turns turns = {.device = a->device,
                      .random = random,
                      .count = a->request->builder_count,
                      .self = &self,
                      .turn = take_turn};
    uint32_t frame = a->request->first + index;
    bb_animate_state *state = &a->result->states[index];
    BB_TRY(bb_scene_set_frame(a->scene, frame, &self.changed));
    state->frame = frame;
    state->prims = a->scene->prim_count;
    if (round == 0) {
        BB_TRY(bb_animate_judge_frame(a, index));
        a->result->frame_count = index + 1;
    }
    BB_TRY(bb_turns_round(&turns, round));
    bb_animate_leave_frame(a);
    return BB_OK;
}

static bb_status do_rounds(bb_animate *a, bb_progress *progress)
{
    bb_random random = bb_random_make(a->request->seed, 77);
    uint32_t repeats = a->request->repeats;
    for (uint32_t round = 0; round <= repeats; round++) {
        const double start = bb_wall_ms();
        for (uint32_t index = 0; index < a->frames && !bb_interrupted(); index++)
            BB_TRY(do_frame(a, index, round, &random, progress));
        if (bb_interrupted())
            break;
        a->result->rounds = round;
        if (round == 1 && repeats > 1) /* round 0 also judges */
            repeats = 1 + bb_turns_foretell(progress, a->scene->name, bb_wall_ms() - start,
                                            repeats - 1, a->request->ends_ms);
    }
    return a->result->rounds > 0
               ? BB_OK
               : bb_fail(BB_FAILED, "%s: interrupted before anything was timed", a->scene->name);
}

bb_status bb_animate_run(const bb_animate_request *request, bb_scene *scene,
                         bb_animate_result *result)
{
    bb_animate a = {.request = request, .device = request->device, .scene = scene};
    double start = bb_wall_ms();
    bb_progress progress;
    memset(result, 0, sizeof *result);
    a.result = result;
    bb_status status = prepare(&a);
    if (status == BB_OK) {
        bb_progress_start(&progress, request->quiet);
        if (request->watch != NULL)
            bb_warn_of_bystanders(request->watch, request->device, &progress);
        bb_progress_stage(&progress, a.frames * request->builder_count * (request->repeats + 1),
                          "%s: %u frames, %u methods", scene->name, a.frames,
                          request->builder_count);
        status = do_rounds(&a, &progress);
        bb_progress_end(&progress);
    }
    clean_up(&a);
    result->ms = bb_wall_ms() - start;
    return status;
}

void bb_animate_release(bb_animate_result *result)
{
    for (uint32_t m = 0; m < BB_ANIMATE_METHODS_MAX; m++) {
        bb_host_free(result->methods[m].frames);
        bb_host_free(result->methods[m].simulations);
    }
    free(result->states);
    bb_canvas_free(&result->strip);
    memset(result, 0, sizeof *result);
}
