/* Measures a point of an axis with frames by sequences, and reads the figures of its methods. The
 * methods of a run differ in one part. */
#include "framework/stress/point_private.h"

#include "framework/bench/bench.h"
#include "framework/builder/tracers.h"
#include "framework/tasks/animate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Methods of one part that are measured in one run. */
typedef struct group {
    bb_method_part part;
    uint32_t count;
    uint32_t methods[BB_ANIMATE_METHODS_MAX];
} group;

/* ---- figures of a method ---- */

/* Returns the least round that counts; NAN: none. */
static double least(const bb_animate_result *result, const bb_rounds rounds)
{
    bb_samples samples = {.count = 0};
    for (uint32_t r = 0; r <= result->rounds; r++)
        bb_samples_add(&samples, rounds[r]);
    return bb_samples_least(&samples);
}

/* Returns the sets that all frames after the first have, as bits. */
static uint32_t common_sets(const bb_animate_result *result)
{
    uint32_t sets = 0;
    for (uint32_t i = 0; i < result->ray_count; i++) {
        bool everywhere = true;
        for (uint32_t f = 1; f < result->frame_count; f++)
            everywhere = everywhere && result->states[f].rays[i] > 0;
        sets |= (uint32_t)everywhere << i;
    }
    return sets;
}

/* Sums over all frames after the first, in which all methods build. Answers of the first count too.
 */
static void read_frames(const bb_animate_result *result, const bb_animate_method *method,
                        uint32_t kernel, bb_point_figures *f)
{
    const uint32_t sets = common_sets(result);
    double prims = 0, update = 0, rebuilt = 0, trace = 0, rays = 0, tests = 0;
    for (uint32_t i = 1; i < method->done; i++) {
        const bb_animate_frame *frame = &method->frames[i];
        prims += result->states[i].prims;
        update += least(result, frame->update);
        rebuilt += frame->way == BB_REBUILT;
        tests += (double)frame->traces[kernel].tests; /* over all sets */
        for (uint32_t set = 0; set < result->ray_count; set++)
            if (sets >> set & 1) {
                trace += least(result, frame->traces[kernel].rays[set]);
                rays += result->states[i].rays[set];
            }
    }
    const double frames = method->done - 1.0;
    f->prims = prims / frames;
    f->build_ms = update / frames;
    f->rebuilt = rebuilt / frames;
    f->bytes = (double)method->most_bytes;
    f->ray_sets = sets;
    f->trace_ms = trace;
    f->rays = rays;
    f->tests = rays > 0 && sets == (1u << result->ray_count) - 1u ? tests / rays : NAN;
}

/* Sums over the sets that the last frame has. */
static void read_simulations(const bb_animate_result *result, const bb_animate_method *method,
                             uint32_t kernel, bb_point_figures *f)
{
    const uint32_t last = result->frame_count - 1;
    for (uint32_t i = 0; i < result->simulation_count; i++) {
        bb_simulated_sets sets = {.count = 0};
        for (uint32_t set = 0; set < result->ray_count; set++) {
            const bb_simulation *s = bb_animate_simulation(result, method, last, kernel, set, i);
            if (s != NULL)
                bb_simulated_add(&sets, result->states[last].rays[set], s);
        }
        f->simulated[i] = bb_simulated_sum(&sets);
    }
}

static void read_answers(const bb_animate_method *method, uint32_t kernel, bb_point_figures *f)
{
    f->wrong = f->checked = f->overflowed = 0;
    for (uint32_t i = 0; i < method->done; i++) {
        const bb_animate_trace *trace = &method->frames[i].traces[kernel];
        f->wrong += (double)trace->wrong;
        f->checked += (double)trace->checked;
        f->overflowed += (double)trace->overflowed;
    }
}

static void read_method(const bb_animate_result *result, bb_method_part part, uint32_t at,
                        bb_point_figures *f)
{
    const bb_animate_method *method = &result->methods[part == BB_A_BUILDER ? at : 0];
    const uint32_t kernel = part == BB_A_KERNEL ? at : 0;
    if (method->refusal != BB_OK) {
        bb_point_end(f,
                     method->refusal == BB_UNSUPPORTED ? BB_OUT_UNSUPPORTED
                     : method->refusal == BB_REFUSED   ? BB_OUT_REFUSED
                                                       : BB_OUT_FAILED,
                     method->refused);
    } else {
        f->outcome = BB_MEASURED;
        read_frames(result, method, kernel, f);
        read_simulations(result, method, kernel, f);
    }
    if (method->done > 0)
        read_answers(method, kernel, f);
    if (part != BB_A_BUILDER) /* it does not build the tree */
        f->build_ms = f->bytes = f->rebuilt = NAN;
}

/* ---- a run ---- */

static bb_status run(const bb_points *points, bb_device *device, const bb_point_request *asked,
                     const group *g, bb_animate_result *result)
{
    const bb_axis *axis = points->axis;
    const char *parts[BB_METHOD_PARTS], *lists[BB_METHOD_PARTS][BB_ANIMATE_METHODS_MAX];
    uint32_t counts[BB_METHOD_PARTS] = {1, 1, 1};
    bb_scene *scene;
    for (uint32_t i = 0; i < g->count; i++) {
        bb_method_cell(axis, &points->methods[g->methods[i]], parts);
        for (int part = 0; part < BB_METHOD_PARTS; part++)
            lists[part][i] = parts[part];
    }
    counts[g->part] = g->count;
    const bb_animate_request request = {
        .device = device,
        .builders = lists[BB_A_BUILDER],
        .builder_count = counts[BB_A_BUILDER],
        .kernels = lists[BB_A_KERNEL],
        .kernel_count = counts[BB_A_KERNEL],
        .rays = (const char *const *)asked->ray_sets,
        .ray_count = axis->ray_count,
        .intersector = lists[BB_AN_INTERSECTOR][0],
        .width = asked->bench.width,
        .height = asked->bench.height,
        .max_rays = points->max_rays,
        .last = axis->frames - 1,
        .repeats = points->repeats,
        .seed = points->seed,
        .counting = true,
        .simts = points->simts,
        .simt_count = points->simt_count,
        .quiet = true,
    };
    BB_TRY(bb_scene_load(asked->scene, &scene));
    bb_status status = bb_scene_upload(scene, device);
    if (status == BB_OK)
        status = bb_animate_run(&request, scene, result);
    bb_traversers_clear(device);
    bb_scene_free(scene);
    return status;
}

static void measure_group(const bb_points *points, bb_device *device, bb_wish *wish, const group *g)
{
    bb_point_request asked;
    bb_animate_result *result = calloc(1, sizeof *result);
    bb_status status = result != NULL ? BB_OK : bb_fail(BB_REFUSED, "no memory for the frames");
    if (status == BB_OK)
        status = bb_point_request_make(points, wish->x, wish->wanted, &asked);
    if (status == BB_OK)
        status = run(points, device, &asked, g, result);
    bb_child_alive();
    char reason[256];
    snprintf(reason, sizeof reason, "%.255s", bb_message());
    for (uint32_t i = 0; i < g->count; i++) {
        bb_point_figures *f = &wish->figures[g->methods[i]];
        if (status == BB_OK)
            read_method(result, g->part, i, f);
        else
            bb_point_end(f, status == BB_FAILED ? BB_OUT_FAILED : BB_OUT_REFUSED, reason);
    }
    if (result != NULL)
        bb_animate_release(result);
    free(result);
}

void bb_point_frames(const bb_points *points, bb_device *device, bb_wish *wish)
{
    static const uint32_t most[BB_METHOD_PARTS] = {
        [BB_A_BUILDER] = BB_ANIMATE_METHODS_MAX,
        [BB_A_KERNEL] = BB_ANIMATE_KERNELS_MAX,
        [BB_AN_INTERSECTOR] = 1,
    };
    group groups[BB_METHOD_PARTS] = {
        {.part = BB_A_BUILDER}, {.part = BB_A_KERNEL}, {.part = BB_AN_INTERSECTOR}};
    for (uint32_t m = 0; m < points->method_count; m++) {
        const bb_method *method = &points->methods[m];
        group *g = &groups[method->part];
        wish->figures[m] = bb_no_figures(BB_NOT_MEASURED);
        if (!wish->wanted[m])
            continue;
        if (method->part == BB_A_BUILDER && bb_tracer_of(method->text) != NULL) {
            bb_point_end(&wish->figures[m], BB_OUT_UNSUPPORTED,
                         "the reference does not follow a scene that moves");
            continue;
        }
        g->methods[g->count++] = m;
        if (g->count == most[method->part]) {
            measure_group(points, device, wish, g);
            g->count = 0;
        }
    }
    for (int part = 0; part < BB_METHOD_PARTS; part++)
        if (groups[part].count > 0)
            measure_group(points, device, wish, &groups[part]);
}
