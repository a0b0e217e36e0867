/* What is drawn from frames, on figures made up here; and the strip of pictures. */
#include "framework/animate/animate.h"
#include "tests/device_forms.h"

#include <math.h>

enum { FRAMES = 4, RAYS = 1000 };

/* A method that takes `update` ms in all frames, and `layout` and `rate` rays per ms with kernel 0,
 * twice both with kernel 1. */
static void fill(bb_animate_method *method, bb_update_way way, double update, double layout,
                 double rate)
{
    method->frames = NULL;
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

static void faster(const bb_animate_result *result, uint32_t m, uint32_t with, uint32_t count,
                   double from, double to)
{
    bb_animate_interval intervals[BB_ANIMATE_INTERVALS_MAX];
    uint32_t found =
        bb_animate_faster(result, &result->methods[m], &result->methods[with], 0, intervals);
    if (found != count)
        fail_msg("method %u with %u: %u intervals", m, with, found);
    if (count > 0 &&
        !(fabs(intervals[0].from - from) <= 1e-9 * from &&
          (isinf(to) ? isinf(intervals[0].to) : fabs(intervals[0].to - to) <= 1e-9 * to)))
        fail_msg("method %u with %u: %g to %g", m, with, intervals[0].from, intervals[0].to);
}

static void methods_change_places_where_times_cross(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(6);
    bb_animate_method *m = result->methods;
    fill(&m[0], BB_UPDATED, 1, 1, 100);   /* 2 + n / 100, or 3 + n / 200 */
    fill(&m[1], BB_REBUILT, 7, 1, 1000);  /* 8 + n / 1000, or 9 + n / 2000 */
    fill(&m[2], BB_REBUILT, 9, 1, 500);   /* never better than 1 */
    fill(&m[3], BB_UPDATED, 1, 10, 150);  /* 11 + n / 150, or 21 + n / 300 */
    fill(&m[4], BB_UPDATED, 1, 0.5, 100); /* 1.5 + n / 100, or 2 + n / 200: better than 0 */
    strcpy(m[2].refused, "frame 13: no more");
    /* 3 + n / 200 = 8 + n / 1000 */
    faster(result, 0, 1, 1, 0, 1250);
    faster(result, 1, 0, 1, 1250, INFINITY);
    faster(result, 3, 1, 0, 0, 0);
    faster(result, 1, 3, 1, 0, INFINITY);
    faster(result, 4, 0, 1, 0, INFINITY);
    faster(result, 0, 0, 0, 0, 0);
    faster(result, 0, 2, 0, 0, 0); /* which has no times */
    faster(result, 2, 0, 0, 0, 0);
    /* one that is faster at both ends, since its kernels are */
    fill(&m[5], BB_UPDATED, 1.2, 0, 95);
    for (uint32_t f = 1; f < FRAMES; f++) {
        m[5].frames[f].traces[1].layout[1] = 20;
        m[5].frames[f].traces[1].rays[0][1] = RAYS / 1000.0;
    }
    /* 1.2 + n / 95 < 3 + n / 200; 21.2 + n / 1000 < 3 + n / 200 */
    faster(result, 5, 0, 2, 0, 1.8 / (1 / 95.0 - 1 / 200.0));
    assert_ptr_equal(bb_animate_rebuilder(result), &m[1]);
    m[1].frames[2].way = BB_UPDATED;
    assert_null(bb_animate_rebuilder(result));
    m[1].frames[2].way = BB_REBUILT;
    /* who wins is told by the same times */
    assert_int_equal(bb_animate_winner(result, 0, 1000), 4);
    assert_int_equal(bb_animate_winner(result, 0, 1e6), 1);
    destroy(result);
}

static void sums_name_the_worst_frame_and_the_drift(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(1);
    fill(&result->methods[0], BB_UPDATED, 3, 1, 100);
    result->methods[0].frames[0].update[1] = 50; /* a build for all: not in the sums */
    result->methods[0].frames[2].update[1] = 9;
    bb_animate_sums sums = bb_animate_sum(result, &result->methods[0]);
    assert_int_equal(sums.worst_frame, 12);
    assert_true(sums.worst_update == 9 && sums.update == 5);
    assert_true(fabs(sums.drift - 0.5) < 1e-12); /* of SAH 3, 4, 5 over 2 */
    assert_true(sums.sah_most == 2.5 && sums.sah_last == 2.5 && sums.sah_mean == 2);
    destroy(result);
}

/* Whether anything but the background is in a tile. */
static bool something_is_drawn(const bb_canvas *strip, uint32_t left, uint32_t right)
{
    for (uint32_t y = strip->height / 4; y < strip->height; y++)
        for (uint32_t x = left + 1; x < right; x++) {
            const float *first = strip->rgb + 3 * ((size_t)y * strip->width + left);
            if (memcmp(first, strip->rgb + 3 * ((size_t)y * strip->width + x), 3 * sizeof *first) !=
                0)
                return true;
        }
    return false;
}

static void a_strip_shows_frames_that_differ(void **state)
{
    (void)state;
    static const char *const builders[] = {"lbvh"}, *const kernels[] = {"stack"},
                             *const rays[] = {"primary"};
    bb_animate_request request = {.device = devices[CPU_FORM],
                                  .builders = builders,
                                  .builder_count = 1,
                                  .kernels = kernels,
                                  .kernel_count = 1,
                                  .rays = rays,
                                  .ray_count = 1,
                                  .intersector = "exact",
                                  .width = 8,
                                  .height = 8,
                                  .max_rays = 64,
                                  .last = UINT32_MAX,
                                  .repeats = 1,
                                  .seed = 1,
                                  .quiet = true,
                                  .strip = true};
    bb_animate_result *result = calloc(1, sizeof *result);
    bb_scene *scene;
    assert_non_null(result);
    ASSERT_OK(bb_scene_load("twist:n=300,frames=3", &scene));
    ASSERT_OK(bb_scene_upload(scene, request.device));
    ASSERT_OK(bb_animate_run(&request, scene, result));
    const bb_canvas *strip = &result->strip;
    assert_non_null(strip->rgb);
    uint32_t third = strip->width / 3;
    bool differ = false;
    for (uint32_t tile = 0; tile < 3; tile++)
        assert_true(something_is_drawn(strip, tile * (third + 1), tile * (third + 1) + third - 8));
    for (uint32_t y = strip->height / 2; y < strip->height; y++)
        differ = differ || memcmp(strip->rgb + 3 * (size_t)y * strip->width,
                                  strip->rgb + 3 * ((size_t)y * strip->width + 2 * (third + 2)),
                                  3 * (third - 8) * sizeof(float)) != 0;
    assert_true(differ);
    bb_animate_release(result);
    assert_null(result->strip.rgb);
    request.strip = false;
    ASSERT_OK(bb_animate_run(&request, scene, result));
    assert_null(result->strip.rgb);
    destroy(result);
    bb_scene_free(scene);
}

static void samples_are_sums_of_frames(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(1);
    bb_animate_method *method = &result->methods[0];
    fill(method, BB_UPDATED, 3, 2, 100);
    result->rounds = 2;
    for (uint32_t f = 0; f < FRAMES; f++) {
        method->frames[f].update[2] = 1 + f;
        method->frames[f].transfer[2] = 0.5;
    }
    bb_samples s = bb_animate_samples(result, method, 0, BB_ANIMATE_UPDATE);
    assert_int_equal(s.count, 3);
    assert_true(s.values[1] == 9 && s.values[2] == 2 + 3 + 4); /* not of the first frame */
    s = bb_animate_samples(result, method, 1, BB_ANIMATE_LAYOUT | BB_ANIMATE_TRACE);
    assert_true(s.values[1] == 3 * (4 + 5));
    s = bb_animate_samples(result, method, 0, BB_ANIMATE_UPDATE | BB_ANIMATE_TRANSFER);
    assert_true(s.values[2] == 9 + 1.5);
    /* a frame without such rays adds nothing, one that is missing leaves nothing */
    result->states[1].rays[0] = 0;
    method->frames[1].traces[0].rays[0][1] = NAN;
    s = bb_animate_samples(result, method, 0, BB_ANIMATE_TRACE);
    assert_true(s.values[1] == 2 * 10);
    method->done--;
    assert_int_equal(bb_animate_samples(result, method, 0, BB_ANIMATE_UPDATE).count, 0);
    destroy(result);
}

/* One method through a few frames. */
static bb_animate_result *run_through(const char *name, bool counting)
{
    static const char *const builders[] = {"lbvh"}, *const kernels[] = {"stack"},
                             *const rays[] = {"random:count=100"};
    const bb_animate_request request = {.device = devices[CPU_FORM],
                                        .builders = builders,
                                        .builder_count = 1,
                                        .kernels = kernels,
                                        .kernel_count = 1,
                                        .rays = rays,
                                        .ray_count = 1,
                                        .intersector = "exact",
                                        .width = 8,
                                        .height = 8,
                                        .max_rays = 100,
                                        .last = UINT32_MAX,
                                        .repeats = 1,
                                        .counting = counting,
                                        .quiet = true};
    bb_animate_result *result = calloc(1, sizeof *result);
    bb_scene *scene;
    assert_non_null(result);
    ASSERT_OK(bb_scene_load(name, &scene));
    ASSERT_OK(bb_scene_upload(scene, request.device));
    ASSERT_OK(bb_animate_run(&request, scene, result));
    bb_scene_free(scene);
    return result;
}

static void motion_is_measured(void **state)
{
    (void)state;
    bb_animate_result *result = run_through("crowd:kind=cross,n=800,frames=4", true);
    assert_true(isnan(result->states[0].moved));
    for (uint32_t f = 1; f < 4; f++) {
        assert_true(result->states[f].moved == 1); /* each by 1, in a scene of about 1 x 1 x 4 */
        assert_true(result->states[f].moved_by > 0.2 && result->states[f].moved_by < 0.8);
    }
    for (uint32_t f = 0; f < 4; f++)
        assert_true(result->methods[0].frames[f].traces[0].tests > 100);
    destroy(result);
    result = run_through("crowd:kind=still,n=800,frames=3", false);
    assert_true(result->states[1].moved == 0 && result->states[1].moved_by == 0);
    assert_true(result->methods[0].frames[1].traces[0].tests == 0);
    destroy(result);
    result = run_through("crowd:kind=shuffle,n=80000,frames=3,share=0.01", false);
    assert_true(result->states[2].moved > 0.015 && result->states[2].moved <= 0.02);
    assert_true(result->states[2].moved_by > 0.1);
    destroy(result);
    result = run_through("crowd:kind=grow,n=800,frames=3", false);
    assert_true(isnan(result->states[1].moved) && isnan(result->states[2].moved_by));
    destroy(result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(methods_change_places_where_times_cross),
        cmocka_unit_test(sums_name_the_worst_frame_and_the_drift),
        cmocka_unit_test(a_strip_shows_frames_that_differ),
        cmocka_unit_test(samples_are_sums_of_frames),
        cmocka_unit_test(motion_is_measured),
    };
    return cmocka_run_group_tests_name("animate_sums", tests, open_devices, close_devices);
}
