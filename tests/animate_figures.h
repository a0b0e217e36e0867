/* Figures of animations, made up. */
#ifndef BB_TESTS_ANIMATE_FIGURES_H
#define BB_TESTS_ANIMATE_FIGURES_H

#include "framework/tasks/animate.h"
#include "tests/device_forms.h"

enum { FRAMES = 4, RAYS = 1000 };

/* A method that takes `update` ms in all frames, and `layout` and `rate` rays per ms with kernel 0,
 * twice both with kernel 1. */
static void fill(bb_animate_method *method, bb_update_way way, double update, double layout,
                 double rate)
{
    ASSERT_OK(bb_host_alloc(NULL, FRAMES * sizeof *method->frames, "frames", &method->frames));
    memset(method->frames, 0, FRAMES * sizeof *method->frames);
    method->done = FRAMES;
    for (uint32_t f = 0; f < FRAMES; f++) {
        bb_animate_frame *frame = &method->frames[f];
        frame->way = f == 0 ? BB_REBUILT : way;
        frame->update[1] = update;
        frame->sah = 2 + f;
        for (uint32_t k = 0; k < 2; k++) {
            frame->traces[k].layout[1] = layout * (k + 1);
            frame->traces[k].rays[0][1] = RAYS / (rate * (k + 1));
        }
    }
}

static bb_animate_result *make_result(uint32_t methods)
{
    bb_animate_result *result = calloc(1, sizeof *result);
    assert_non_null(result);
    result->frame_count = FRAMES;
    result->rounds = result->ray_count = 1;
    result->kernel_count = 2;
    result->method_count = methods;
    result->states = calloc(FRAMES, sizeof *result->states);
    assert_non_null(result->states);
    for (uint32_t f = 0; f < FRAMES; f++)
        result->states[f] = (bb_animate_state){.frame = 10 + f, .rays = {RAYS}, .fresh_best = 2};
    return result;
}

static void destroy(bb_animate_result *result)
{
    bb_animate_release(result);
    free(result);
}

#endif
