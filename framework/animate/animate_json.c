/* An animation as JSON: README.md has the schema. */
#include "framework/animate/animate.h"

#include "framework/record/put.h"
#include "framework/tree/metric.h"

#include <math.h>
#include <stdlib.h>

static const double counts[] = {1e5, 1e6, 1e7, 1e8, 1e9};

enum { COUNTS = sizeof counts / sizeof counts[0] };

/* One number per frame. `of` gets method, or NULL, and frame. */
typedef double (*figure)(const bb_animate_result *result, const bb_animate_method *method,
                         uint32_t frame, uint32_t k, uint32_t i);

static bool put_frames(cJSON *object, const char *name, const bb_animate_result *result,
                       const bb_animate_method *method, figure of, uint32_t k, uint32_t i)
{
    uint32_t count = method != NULL ? method->done : result->frame_count;
    double *values = malloc((count + 1) * sizeof *values);
    if (values == NULL)
        return false;
    for (uint32_t f = 0; f < count; f++)
        values[f] = of(result, method, f, k, i);
    bool put = bb_put_numbers(object, name, values, count);
    free(values);
    return put;
}

#define FIGURE(name, value)                                                                        \
    static double name(const bb_animate_result *result, const bb_animate_method *method,           \
                       uint32_t f, uint32_t k, uint32_t i)                                         \
    {                                                                                              \
        (void)result, (void)method, (void)f, (void)k, (void)i;                                     \
        return value;                                                                              \
    }

FIGURE(frame_of, result->states[f].frame)
FIGURE(prims_of, result->states[f].prims)
FIGURE(moved_of, result->states[f].moved)
FIGURE(moved_by_of, result->states[f].moved_by)
FIGURE(rays_of, result->states[f].rays[i])
FIGURE(best_of, result->states[f].fresh_best)
FIGURE(fresh_of, result->states[f].fresh[i])
FIGURE(oracle_of, result->states[f].oracle_ms)
FIGURE(judge_of, result->states[f].judge_ms)
FIGURE(way_of, method->frames[f].way)
FIGURE(update_of, bb_animate_median(result, method->frames[f].update))
FIGURE(cpu_of, bb_animate_median(result, method->frames[f].update_cpu))
FIGURE(transfer_of, bb_animate_median(result, method->frames[f].transfer))
FIGURE(sah_of, method->frames[f].sah)
FIGURE(nodes_of, method->frames[f].tree.node_count)
FIGURE(depth_of, method->frames[f].tree.depth)
FIGURE(bytes_of, (double)method->frames[f].tree_bytes)
FIGURE(layout_of, bb_animate_median(result, method->frames[f].traces[k].layout))
FIGURE(place_of, method->frames[f].traces[k].in_place)
FIGURE(wrong_of, (double)method->frames[f].traces[k].wrong)
FIGURE(ms_of, bb_animate_median(result, method->frames[f].traces[k].rays[i]))

/* ---- a method ---- */

static bool put_steps(cJSON *object, const bb_animate_result *result,
                      const bb_animate_method *method)
{
    cJSON *list = cJSON_CreateArray();
    bool put = bb_put(object, "steps", list);
    for (uint32_t f = 0; f < method->done && put; f++) {
        const bb_animate_frame *frame = &method->frames[f];
        cJSON *entry = cJSON_CreateObject(), *phases = cJSON_CreateObject();
        cJSON *events = cJSON_CreateObject();
        put = entry != NULL && cJSON_AddItemToArray(list, entry);
        put = bb_put(entry, "phases_ms", phases) && put;
        put = bb_put(entry, "events", events) && put;
        for (uint32_t p = 0; p < frame->phase_count && put; p++)
            put = bb_put_number(phases, frame->phases[p],
                                bb_animate_median(result, frame->phase_ms[p]));
        for (uint32_t e = 0; e < frame->event_count && put; e++)
            put = bb_put_number(events, frame->events[e], (double)frame->event_numbers[e]);
    }
    return put;
}

static bool put_kernel(cJSON *list, const bb_animate_result *result,
                       const bb_animate_method *method, uint32_t k)
{
    cJSON *entry = cJSON_CreateObject(), *rays = cJSON_CreateObject();
    bool put = entry != NULL && cJSON_AddItemToArray(list, entry);
    put = bb_put(entry, "rays_ms", rays) && put;
    put = put && bb_put_text(entry, "kernel", result->kernels[k]) &&
          put_frames(entry, "layout_ms", result, method, layout_of, k, 0) &&
          put_frames(entry, "in_place", result, method, place_of, k, 0) &&
          put_frames(entry, "wrong", result, method, wrong_of, k, 0);
    for (uint32_t i = 0; i < result->ray_count && put; i++)
        put = put_frames(rays, result->rays[i], result, method, ms_of, k, i);
    return put;
}

static bool put_sums(cJSON *object, const bb_animate_result *result,
                     const bb_animate_method *method)
{
    bb_animate_sums s = bb_animate_sum(result, method);
    cJSON *sums = cJSON_CreateObject();
    bool put = bb_put(object, "sums", sums);
    return put && bb_put_number(sums, "update_ms", s.frames > 0 ? s.update : NAN) &&
           bb_put_number(sums, "worst_update_ms", s.frames > 0 ? s.worst_update : NAN) &&
           bb_put_number(sums, "worst_frame", s.frames > 0 ? s.worst_frame : NAN) &&
           bb_put_number(sums, "sah_over_best", s.frames > 0 ? s.sah_mean : NAN) &&
           bb_put_number(sums, "sah_over_best_most", s.frames > 0 ? s.sah_most : NAN) &&
           bb_put_number(sums, "drift_per_frame", s.frames > 0 ? s.drift : NAN) &&
           bb_put_number(sums, "answers", (double)s.checked) &&
           bb_put_number(sums, "wrong", (double)s.wrong);
}

/* Per kind of rays, for how many of them it is faster than the method that `faster_than` names. */
static bool put_faster(cJSON *object, const bb_animate_result *result,
                       const bb_animate_method *method)
{
    const bb_animate_method *with = bb_animate_rebuilder(result);
    cJSON *all = cJSON_CreateObject();
    bool put = bb_put(object, "faster", all);
    for (uint32_t i = 0; with != NULL && with != method && i < result->ray_count && put; i++) {
        bb_animate_interval intervals[BB_ANIMATE_INTERVALS_MAX];
        uint32_t count = bb_animate_faster(result, method, with, i, intervals);
        cJSON *list = cJSON_CreateArray();
        put = bb_put(all, result->rays[i], list);
        for (uint32_t k = 0; k < count && put; k++) {
            cJSON *interval = cJSON_CreateObject();
            put = interval != NULL && cJSON_AddItemToArray(list, interval) &&
                  bb_put_number(interval, "from", intervals[k].from) &&
                  bb_put_number(interval, "to", intervals[k].to);
        }
    }
    return put;
}

static bool put_method(cJSON *list, const bb_animate_result *result,
                       const bb_animate_method *method)
{
    cJSON *entry = cJSON_CreateObject(), *kernels = cJSON_CreateArray();
    bool put = entry != NULL && cJSON_AddItemToArray(list, entry);
    put = bb_put(entry, "kernels", kernels) && put;
    put = put && bb_put_text(entry, "method", method->builder) &&
          bb_put_text(entry, "refused", method->refused) &&
          bb_put(entry, "failed", cJSON_CreateBool(method->failed)) &&
          bb_put_number(entry, "most_bytes", (double)method->most_bytes) &&
          put_frames(entry, "way", result, method, way_of, 0, 0) &&
          put_frames(entry, "update_ms", result, method, update_of, 0, 0) &&
          put_frames(entry, "update_cpu_ms", result, method, cpu_of, 0, 0) &&
          put_frames(entry, "transfer_ms", result, method, transfer_of, 0, 0) &&
          put_frames(entry, bb_metric_sah.name, result, method, sah_of, 0, 0) &&
          put_frames(entry, "nodes", result, method, nodes_of, 0, 0) &&
          put_frames(entry, "depth", result, method, depth_of, 0, 0) &&
          put_frames(entry, "tree_bytes", result, method, bytes_of, 0, 0) &&
          put_sums(entry, result, method) && put_faster(entry, result, method) &&
          put_steps(entry, result, method);
    for (uint32_t k = 0; k < result->kernel_count && put; k++)
        put = put_kernel(kernels, result, method, k);
    return put;
}

/* ---- all ---- */

static bool put_winner(cJSON *list, const bb_animate_result *result, uint32_t winner, uint32_t rays,
                       double count)
{
    uint32_t kernel = 0;
    const bb_animate_method *method = &result->methods[winner];
    double ms = bb_animate_frame_ms(result, method, rays, count, &kernel);
    cJSON *entry = cJSON_CreateObject(), *ties = cJSON_CreateArray();
    bool put = entry != NULL && cJSON_AddItemToArray(list, entry);
    put = bb_put(entry, "as_fast", ties) && put;
    put = put && bb_put_text(entry, "rays", result->rays[rays]) &&
          bb_put_number(entry, "count", count) && bb_put_text(entry, "method", method->builder) &&
          bb_put_text(entry, "kernel", result->kernels[kernel]) &&
          bb_put_number(entry, "frame_ms", ms);
    for (uint32_t m = 0; m < result->method_count && put; m++)
        if (bb_animate_ties(result, winner, m, rays, count))
            put = cJSON_AddItemToArray(ties, cJSON_CreateString(result->methods[m].builder));
    return put;
}

static bool put_winners(cJSON *root, const bb_animate_result *result)
{
    cJSON *list = cJSON_CreateArray();
    bool put = bb_put(root, "winners", list);
    for (uint32_t i = 0; i < result->ray_count && put; i++)
        for (int n = 0; n < COUNTS && put; n++) {
            uint32_t winner = bb_animate_winner(result, i, counts[n]);
            if (winner != BB_NONE)
                put = put_winner(list, result, winner, i, counts[n]);
        }
    return put;
}

static bool put_result(cJSON *root, const bb_animate_result *result)
{
    cJSON *methods = cJSON_CreateArray(), *rays = cJSON_CreateObject();
    cJSON *fresh = cJSON_CreateObject();
    const bb_animate_method *with = bb_animate_rebuilder(result);
    bool put = bb_put(root, "methods", methods);
    put = put && bb_put_text(root, "faster_than", with != NULL ? with->builder : "");
    put = bb_put(root, "rays", rays) && put;
    put = bb_put(root, "sah_fresh", fresh) && put;
    put = put && bb_put_text(root, "scene", result->scene) &&
          bb_put_number(root, "ignored", result->ignored) &&
          bb_put_text(root, "view", result->view) &&
          bb_put_text(root, "intersector", result->intersector) &&
          bb_put_number(root, "rounds", result->rounds) &&
          bb_put_number(root, "seconds", result->ms / 1e3) &&
          put_frames(root, "frames", result, NULL, frame_of, 0, 0) &&
          put_frames(root, "primitives", result, NULL, prims_of, 0, 0) &&
          put_frames(root, "moved", result, NULL, moved_of, 0, 0) &&
          put_frames(root, "moved_by", result, NULL, moved_by_of, 0, 0) &&
          put_frames(root, "sah_fresh_best", result, NULL, best_of, 0, 0) &&
          put_frames(root, "oracle_ms", result, NULL, oracle_of, 0, 0) &&
          put_frames(root, "judge_ms", result, NULL, judge_of, 0, 0) && put_winners(root, result);
    for (uint32_t i = 0; i < result->ray_count && put; i++)
        put = put_frames(rays, result->rays[i], result, NULL, rays_of, 0, i);
    for (uint32_t i = 0; i < result->yardstick_count && put; i++)
        put = put_frames(fresh, result->yardsticks[i], result, NULL, fresh_of, 0, i);
    for (uint32_t m = 0; m < result->method_count && put; m++)
        put = put_method(methods, result, &result->methods[m]);
    return put;
}

cJSON *bb_animate_json(const bb_animate_result *result)
{
    cJSON *root = cJSON_CreateObject();
    if (root != NULL && put_result(root, result))
        return root;
    cJSON_Delete(root);
    return NULL;
}
