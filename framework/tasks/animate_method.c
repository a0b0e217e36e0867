/* A method in a frame: its update, the layouts that follow, the rays traced through them. */
#include "framework/tasks/animate_private.h"

#include "framework/device/device_private.h"
#include "framework/device/stopwatch.h"
#include "traversal/pass.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

/* It has no figures from here on; the others go on. The message says why. */
static void refuse(bb_animate_method *method, bb_status status, const char *where)
{
    method->refusal = status;
    method->failed = status != BB_UNSUPPORTED && status != BB_REFUSED;
    snprintf(method->refused, sizeof method->refused, "%s%s", where, bb_message());
}

/* ---- what a method needs ---- */

static void forget(bb_rounds *rounds)
{
    for (uint32_t r = 0; r < BB_ANIMATE_ROUNDS_MAX; r++)
        (*rounds)[r] = NAN;
}

/* Nothing is measured yet. What a method that is refused later on leaves open stays so. */
static void clear(bb_animate_frame *frame)
{
    memset(frame, 0, sizeof *frame);
    forget(&frame->update);
    forget(&frame->update_cpu);
    forget(&frame->transfer);
    for (uint32_t k = 0; k < BB_ANIMATE_KERNELS_MAX; k++) {
        forget(&frame->traces[k].layout);
        for (uint32_t i = 0; i < BB_ANIMATE_RAYS_MAX; i++)
            forget(&frame->traces[k].rays[i]);
    }
}

bb_status bb_animate_runner_create(bb_animate *a, const char *builder, bb_animate_runner *runner)
{
    const bb_animate_request *request = a->request;
    bb_animate_method *method = runner->method;
    snprintf(method->builder, sizeof method->builder, "%s", builder);
    BB_TRY(bb_host_alloc(NULL, a->frames * sizeof *method->frames, "figures of frames",
                         &method->frames));
    for (uint32_t f = 0; f < a->frames; f++)
        clear(&method->frames[f]);
    BB_TRY(bb_animate_room_for_simulations(a, method));
    runner->hashes = calloc((size_t)a->frames * request->kernel_count * request->ray_count,
                            sizeof *runner->hashes);
    if (runner->hashes == NULL)
        return bb_fail(BB_REFUSED, "no memory for the hashes of answers");
    for (uint32_t k = 0; k < request->kernel_count; k++) {
        BB_TRY(bb_layout_maker_create(bb_layout_find(a->kernels[k]->layout), a->device,
                                      &runner->makers[k]));
        runner->makers[k].wish = bb_kernel_wish(&a->kernel_specs[k]);
    }
    bb_status status =
        bb_instance_create(a->device, builder, a->scene, request->seed, &runner->instance);
    if (status == BB_INVALID)
        return status;
    if (status != BB_OK)
        refuse(method, status, "");
    return BB_OK;
}

void bb_animate_runner_destroy(bb_animate *a, bb_animate_runner *runner)
{
    for (uint32_t k = 0; k < a->request->kernel_count; k++) {
        bb_layout_data_release(&runner->layouts[k]);
        bb_layout_maker_destroy(&runner->makers[k]);
        bb_layout_data_release(&runner->simulated_layouts[k]);
        bb_layout_maker_destroy(&runner->simulated_makers[k]);
    }
    bb_instance_destroy(&runner->instance);
    free(runner->hashes);
}

/* ---- update ---- */

static bb_rounds *phase_of(bb_animate_frame *frame, const char *label, const char *name)
{
    char text[sizeof frame->phases[0]];
    if (label != NULL)
        snprintf(text, sizeof text, "%.20s: %.24s", label, name);
    else
        snprintf(text, sizeof text, "%.46s", name);
    for (uint32_t i = 0; i < frame->phase_count; i++)
        if (strcmp(frame->phases[i], text) == 0)
            return &frame->phase_ms[i];
    if (frame->phase_count == BB_PHASES_MAX)
        return NULL;
    bb_rounds *rounds = &frame->phase_ms[frame->phase_count];
    forget(rounds);
    memcpy(frame->phases[frame->phase_count++], text, sizeof text);
    return rounds;
}

static void take_events(bb_animate_frame *frame, const bb_phases *phases)
{
    for (uint32_t i = 0; i < phases->event_count && frame->event_count < BB_EVENTS_MAX; i++) {
        snprintf(frame->events[frame->event_count], sizeof frame->events[0], "%s",
                 phases->event_names[i]);
        frame->event_numbers[frame->event_count++] = phases->events[i];
    }
}

/* Phases of work on the device have no clock of their own here: their step's counts. */
static void take_phases(const bb_instance *instance, uint32_t round, bb_animate_frame *frame)
{
    for (uint32_t s = 0; s < instance->step_count; s++) {
        const bb_build_step *step = &instance->steps[s];
        const char *label = instance->step_count > 1 ? step->label : NULL;
        bb_rounds *rounds;
        if (step->phases.used_device || step->phases.count == 0) {
            rounds = phase_of(frame, NULL, step->label);
            if (rounds != NULL)
                (*rounds)[round] = step->timing.timing.ms;
        } else
            for (uint32_t p = 0; p < step->phases.count; p++) {
                rounds = phase_of(frame, label, step->phases.names[p]);
                if (rounds != NULL)
                    (*rounds)[round] = step->phases.ms[p];
            }
        if (round == 0)
            take_events(frame, &step->phases);
    }
}

/* In the first frame of each round the tree is built, for all alike. */
static bb_status update(bb_animate *a, bb_animate_runner *runner, uint32_t index, uint32_t round,
                        uint32_t changed)
{
    bb_instance *instance = &runner->instance;
    bb_animate_frame *frame = &runner->method->frames[index];
    bb_build_timing timing;
    bb_update_way way = BB_REBUILT;
    if (index == 0)
        BB_TRY(bb_instance_build(instance, a->scene, false, &timing));
    else
        BB_TRY(bb_instance_update(instance, a->scene, changed, false, &way, &timing));
    if (round > 0 && way != frame->way)
        return bb_fail(BB_FAILED, "%s: %s here, but %s the first time", runner->method->builder,
                       bb_update_word(way), bb_update_word(frame->way));
    if (a->request->audit != NULL && way != BB_KEPT)
        bb_audit_build(a->request->audit, a->scene->name, instance);
    frame->way = way;
    frame->update[round] = timing.timing.ms;
    frame->update_cpu[round] = timing.timing.cpu_ms;
    take_phases(instance, round, frame);
    frame->transfer[round] = 0;
    return bb_tree_upload(&instance->tree, a->device, &frame->transfer[round]);
}

static bb_status look_at_tree(bb_animate *a, bb_animate_runner *runner, uint32_t index)
{
    bb_tree *tree = &runner->instance.tree;
    bb_animate_frame *frame = &runner->method->frames[index];
    BB_TRY(bb_tree_download(tree, NULL));
    BB_TRY(bb_tree_check(tree, a->scene));
    frame->sah = bb_tree_sah(tree);
    frame->tree = tree->info;
    frame->tree_bytes = bb_tree_bytes(tree);
    return BB_OK;
}

/* ---- traces ---- */

bb_traverser_request bb_animate_traverser(const bb_animate *a, uint32_t k, const bb_rays *rays)
{
    return (bb_traverser_request){
        .kernel = a->kernels[k],
        .spec = &a->kernel_specs[k],
        .intersector = &a->intersector,
        .query = rays->query,
    };
}

static bb_status get_traverser(bb_animate *a, bb_animate_runner *runner, uint32_t k, uint32_t set,
                               const bb_rays *rays, bool *fresh)
{
    const bb_traverser_request request = bb_animate_traverser(a, k, rays);
    bb_traverser *before = runner->traversers[k][set];
    BB_TRY(bb_traverser_get(a->device, &request, &runner->layouts[k], &runner->traversers[k][set]));
    *fresh = runner->traversers[k][set] != before;
    return BB_OK;
}

static void audit(const bb_animate *a, const bb_animate_runner *runner, uint32_t k,
                  const char *part, const bb_timing *timing)
{
    char what[400];
    snprintf(what, sizeof what, "%s of %.120s by %s on %s", part, a->scene->name,
             a->result->kernels[k], runner->method->builder);
    if (a->request->audit != NULL)
        bb_audit_timing(a->request->audit, what, timing, true);
}

static bb_status judge(bb_animate *a, uint32_t set, const bb_rays *rays, bb_animate_trace *trace)
{
    bb_accuracy accuracy;
    const bb_verdict_request wanted = {.results = a->results, .count = rays->count};
    BB_TRY(bb_judge(a->oracle, &a->answers[set], &wanted, &accuracy));
    trace->checked += accuracy.checked;
    trace->wrong += accuracy.missed + accuracy.false_hits + accuracy.wrong_t;
    return BB_OK;
}

static bb_status count_tests(bb_animate *a, bb_animate_runner *runner, uint32_t k,
                             const bb_rays *rays, bb_animate_trace *trace)
{
    bb_tests tests;
    if (a->counted < rays->count)
        BB_TRY(bb_counter_create(a->device, NULL, rays->count, &a->counter));
    a->counted = a->counted > rays->count ? a->counted : rays->count;
    BB_TRY(bb_count_tests(&a->counter, bb_animate_traverser(a, k, rays), &runner->layouts[k], rays,
                          rays->count, rays->count, &tests));
    trace->tests += tests.nodes + tests.prims;
    trace->overflowed += tests.overflowed;
    return BB_OK;
}

static bb_status trace_set(bb_animate *a, bb_animate_runner *runner, uint32_t index, uint32_t round,
                           uint32_t k, uint32_t set)
{
    const bb_rays *rays = a->rays[index].sets[set];
    bb_animate_trace *trace = &runner->method->frames[index].traces[k];
    bb_stopwatch watch;
    bb_timing timing;
    bool fresh;
    if (rays == NULL)
        return BB_OK;
    BB_TRY(bb_animate_load_rays(a, rays));
    BB_TRY(get_traverser(a, runner, k, set, rays, &fresh));
    const bb_pass pass = {.query = rays->query,
                          .traverser = runner->traversers[k][set],
                          .layout = &runner->layouts[k],
                          .rays = &a->d_rays,
                          .results = &a->d_answers};
    if (fresh) { /* compiled for the group size before the clock runs */
        uint32_t few = bb_traverser_group_size(pass.traverser);
        BB_TRY(bb_pass_launch(&pass, rays->count < few ? rays->count : few));
    }
    BB_TRY(bb_pass_poison(&pass, rays->count));
    BB_TRY(bb_stopwatch_start(a->device, &watch));
    bb_status status = bb_pass_launch(&pass, rays->count);
    BB_TRY(bb_stopwatch_stop(&watch, status, &timing));
    trace->rays[set][round] = timing.ms;
    audit(a, runner, k, "trace", &timing);
    size_t bytes = rays->count * rays->query->result_bytes;
    BB_TRY(bb_buffer_read(&a->d_answers, 0, bytes, a->results));
    uint64_t *hash =
        &runner
             ->hashes[((size_t)index * a->request->kernel_count + k) * a->request->ray_count + set];
    uint64_t now = XXH3_64bits(a->results, bytes);
    if (round == 0) {
        *hash = now;
        BB_TRY(judge(a, set, rays, trace));
        return a->request->counting ? count_tests(a, runner, k, rays, trace) : BB_OK;
    }
    if (now != *hash)
        return bb_fail(BB_FAILED, "%s with %s: other answers than the first time",
                       runner->method->builder, a->result->kernels[k]);
    return BB_OK;
}

static bb_status trace(bb_animate *a, bb_animate_runner *runner, uint32_t index, uint32_t round)
{
    const uint32_t format = bb_intersector_format(&a->intersector);
    for (uint32_t k = 0; k < a->request->kernel_count; k++) {
        bb_layout_maker *maker = &runner->makers[k];
        bb_layout_data *layout = &runner->layouts[k];
        bb_animate_trace *out = &runner->method->frames[index].traces[k];
        BB_TRY(index == 0 ? bb_layout_maker_make(maker, a->scene, &runner->instance.tree,
                                                 a->leaves[k], format, layout)
                          : bb_layout_maker_follow(maker, a->scene, &runner->instance.tree,
                                                   a->leaves[k], format, layout, &out->in_place));
        out->layout[round] = layout->timing.ms;
        if (runner->method->frames[index].way != BB_KEPT)
            audit(a, runner, k, "layout", &layout->timing);
        for (uint32_t set = 0; set < a->request->ray_count; set++)
            BB_TRY(trace_set(a, runner, index, round, k, set));
    }
    return BB_OK;
}

/* ---- a step ---- */

static uint64_t bytes_of(const bb_animate *a, const bb_animate_runner *runner)
{
    uint64_t bytes = runner->instance.account.peak;
    for (uint32_t k = 0; k < a->request->kernel_count; k++)
        bytes += runner->makers[k].account.peak;
    return bytes;
}

bb_status bb_animate_step(bb_animate *a, bb_animate_runner *runner, uint32_t index, uint32_t round,
                          uint32_t changed)
{
    bb_animate_method *method = runner->method;
    if (method->refused[0] != '\0')
        return BB_OK;
    bb_status status = update(a, runner, index, round, changed);
    if (status == BB_OK && round == 0)
        status = look_at_tree(a, runner, index);
    if (status == BB_OK)
        status = trace(a, runner, index, round);
    if (status == BB_OK && round == 0)
        status = bb_animate_simulate(a, runner, index);
    if (status == BB_OK) {
        method->done = round == 0 ? index + 1 : method->done;
        uint64_t bytes = bytes_of(a, runner);
        method->most_bytes = bytes > method->most_bytes ? bytes : method->most_bytes;
        return BB_OK;
    }
    char where[32];
    snprintf(where, sizeof where, "frame %u: ", a->result->states[index].frame);
    refuse(method, status, where);
    return bb_device_check(a->device);
}
