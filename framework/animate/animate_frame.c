/* What is right in a frame: an oracle of it, its rays, and the costs of trees made for it. */
#include "framework/animate/animate_private.h"

#include "framework/base/clock.h"
#include "framework/device/device_private.h"

#include <math.h>

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

bb_status bb_animate_judge_frame(bb_animate *a, uint32_t index)
{
    bb_animate_state *state = &a->result->states[index];
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
