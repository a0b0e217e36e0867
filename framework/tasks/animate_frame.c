/* What is right in a frame: an oracle of it, its rays, and the costs of trees made for it. */
#include "framework/tasks/animate_private.h"

#include "framework/base/clock.h"
#include "framework/device/device_private.h"

#include <math.h>
#include <string.h>

/* Secondary rays start where the oracle sees the frame's surface. */
static bb_status make_rays(bb_animate *a, uint32_t index)
{
    const bb_animate_request *request = a->request;
    bb_animate_state *state = &a->result->states[index];
    for (uint32_t i = 0; i < request->ray_count; i++) {
        const bb_rays_request wanted = {
            .spec = &a->ray_specs[i],
            .view = a->workloads[i]->per_view ? a->view : NULL,
            .width = request->width,
            .height = request->height,
            .max_rays = request->max_rays,
            .seed = request->seed,
        };
        bb_rays **rays = &a->rays[index].sets[i];
        bb_status status = bb_rays_make(a->scene, a->oracle, &wanted, rays);
        if (status == BB_UNSUPPORTED) /* nothing is seen in this frame, say */
            continue;
        BB_TRY(status);
        state->rays[i] = (*rays)->count;
        BB_TRY(bb_answers_make(a->oracle, *rays, &a->answers[i]));
    }
    return BB_OK;
}

/* What trees cost that are made for this frame. */
static bb_status measure_fresh(bb_animate *a, bb_animate_state *state)
{
    state->fresh_best = NAN;
    for (uint32_t i = 0; i < a->result->yardstick_count; i++) {
        bb_instance *instance = &a->yardsticks[i];
        BB_TRY(bb_instance_build(instance, a->scene, false, NULL));
        BB_TRY(bb_tree_download(&instance->tree, NULL));
        state->fresh[i] = bb_tree_sah(&instance->tree);
        state->fresh_best = fmin(state->fresh_best, state->fresh[i]);
    }
    return BB_OK;
}

static double length(const float from[3], const float to[3])
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++)
        square += ((double)to[axis] - from[axis]) * ((double)to[axis] - from[axis]);
    return sqrt(square);
}

/* How far a box's middle has gone. */
static float way(const bb_box *from, const bb_box *to)
{
    float a[3], b[3];
    for (int axis = 0; axis < 3; axis++) {
        a[axis] = 0.5f * from->lo[axis] + 0.5f * from->hi[axis];
        b[axis] = 0.5f * to->lo[axis] + 0.5f * to->hi[axis];
    }
    return (float)length(a, b);
}

static bb_status compare_boxes(const bb_animate *a, bb_animate_state *state)
{
    const bb_scene *scene = a->scene;
    const double diagonal = length(scene->bounds.lo, scene->bounds.hi);
    float *ways = NULL;
    uint32_t moved = 0;
    BB_TRY(bb_host_alloc(NULL, scene->prim_count * sizeof *ways, "ways of primitives", &ways));
    for (uint32_t i = 0; i < scene->prim_count; i++)
        if (memcmp(&a->before[i], &scene->boxes[i], sizeof a->before[i]) != 0)
            ways[moved++] = way(&a->before[i], &scene->boxes[i]);
    state->moved = (double)moved / scene->prim_count;
    state->moved_by =
        moved > 0 && diagonal > 0 ? (double)bb_select(ways, moved, moved / 2) / diagonal : 0;
    bb_host_free(ways);
    return BB_OK;
}

/* What has moved since the frame before. */
static bb_status measure_motion(bb_animate *a, uint32_t index)
{
    bb_animate_state *state = &a->result->states[index];
    const uint32_t count = a->scene->prim_count;
    const size_t bytes = count * sizeof *a->before;
    state->moved = state->moved_by = NAN;
    if (index > 0 && a->before_count == count)
        BB_TRY(compare_boxes(a, state));
    if (a->before_count != count) {
        a->before_count = 0;
        BB_TRY(bb_host_alloc(NULL, bytes, "boxes of the frame before", &a->before));
        a->before_count = count;
    }
    memcpy(a->before, a->scene->boxes, bytes);
    return BB_OK;
}

bb_status bb_animate_judge_frame(bb_animate *a, uint32_t index)
{
    bb_animate_state *state = &a->result->states[index];
    BB_TRY(measure_motion(a, index));
    double start = bb_wall_ms();
    BB_TRY(bb_oracle_create(a->scene, bb_host_threads(a->device), &a->oracle));
    state->oracle_ms = bb_wall_ms() - start;
    BB_TRY(make_rays(a, index));
    state->judge_ms = bb_wall_ms() - start - state->oracle_ms;
    BB_TRY(bb_animate_draw_frame(a, index));
    return measure_fresh(a, state);
}

void bb_animate_leave_frame(bb_animate *a)
{
    for (uint32_t i = 0; i < a->request->ray_count; i++)
        if (a->answers[i].rays != NULL) {
            bb_answers_release(&a->answers[i]);
            a->answers[i] = (bb_answers){0};
        }
    bb_oracle_destroy(a->oracle);
    a->oracle = NULL;
}

bb_status bb_animate_load_rays(bb_animate *a, const bb_rays *rays)
{
    size_t bytes = rays->count * rays->query->result_bytes;
    BB_TRY(bb_buffer_reserve(a->device, NULL, rays->count * sizeof(bb_ray), "rays", &a->d_rays));
    BB_TRY(bb_buffer_reserve(a->device, NULL, bytes, "answers", &a->d_answers));
    if (bytes > a->result_bytes) {
        a->result_bytes = 0;
        BB_TRY(bb_host_alloc(NULL, bytes, "answers", &a->results));
        a->result_bytes = bytes;
    }
    return bb_buffer_write(&a->d_rays, 0, rays->count * sizeof(bb_ray), rays->rays);
}
