/* What is drawn from frames, on figures made up here; and the strip of pictures. */
#include "tests/animate_figures.h"

#include <math.h>

static void sums_name_the_worst_frame_and_the_drift(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(1);
    fill(&result->methods[0], BB_UPDATED, 3, 1, 100);
    result->methods[0].frames[0].update[1] = 50; /* a build for all: not in the sums */
    result->methods[0].frames[2].update[1] = 9;
    bb_animate_sums sums = bb_animate_sum(result, &result->methods[0]);
    assert_int_equal(sums.worst_frame, 12);
    assert_true(sums.worst_update == 9 && bb_animate_median(result, sums.update) == 5);
    assert_true(fabs(sums.drift - 0.5) < 1e-12); /* of SAH 3, 4, 5 over 2 */
    assert_true(sums.sah_most == 2.5 && sums.sah_last == 2.5 && sums.sah_mean == 2);
    destroy(result);
}

/* Over each yardstick's own; a frame whose scene has no area has no cost to compare. */
static void costs_are_of_frames_that_have_one(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(1);
    bb_animate_method *method = &result->methods[0];
    fill(method, BB_UPDATED, 3, 1, 100);
    result->yardstick_count = 2;
    for (uint32_t f = 0; f < FRAMES; f++) {
        result->states[f].fresh[0] = 2;
        result->states[f].fresh[1] = 4 + f;
    }
    bb_animate_sums sums = bb_animate_sum(result, method);
    assert_true(sums.fresh_most[0] == 2.5 && sums.fresh_most[1] == 5.0 / 7);
    assert_true(isnan(sums.fresh_most[2]));
    method->frames[2].sah = result->states[2].fresh_best = result->states[2].fresh[0] = NAN;
    sums = bb_animate_sum(result, method); /* SAH 3 and 5 over 2, in frames 1 and 3 */
    assert_true(sums.sah_most == 2.5 && sums.sah_mean == 2 && fabs(sums.drift - 0.5) < 1e-12);
    for (uint32_t f = 0; f < FRAMES; f++) {
        method->frames[f].sah = 0;
        result->states[f].fresh_best = result->states[f].fresh[0] = 0;
    }
    sums = bb_animate_sum(result, method);
    assert_true(isnan(sums.sah_most) && isnan(sums.sah_mean) && isnan(sums.sah_last));
    assert_true(isnan(sums.drift) && isnan(sums.fresh_most[0]) && sums.fresh_most[1] == 0);
    assert_true(bb_animate_median(result, sums.update) == 3);
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

/* Before anything is reserved for a million frames. */
static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    static const char *const builders[] = {"lbvh"}, *const kernels[] = {"stack"},
                             *const rays[] = {"primary"};
    const bb_animate_request request = {.device = devices[CPU_FORM],
                                        .builders = builders,
                                        .builder_count = 1,
                                        .kernels = kernels,
                                        .kernel_count = 1,
                                        .rays = rays,
                                        .ray_count = 1,
                                        .intersector = "exact",
                                        .width = 4096,
                                        .height = 4096,
                                        .max_rays = 64,
                                        .last = UINT32_MAX,
                                        .repeats = 1,
                                        .quiet = true};
    bb_animate_result *result = calloc(1, sizeof *result);
    bb_scene *scene;
    assert_non_null(result);
    ASSERT_OK(bb_scene_load("crowd:n=100,frames=1000000", &scene));
    ASSERT_OK(bb_scene_upload(scene, request.device));
    assert_int_equal(bb_animate_run(&request, scene, result), BB_REFUSED);
    assert_non_null(strstr(bb_message(), "--frames"));
    assert_null(result->states);
    bb_scene_free(scene);
    destroy(result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_name_the_worst_frame_and_the_drift),
        cmocka_unit_test(costs_are_of_frames_that_have_one),
        cmocka_unit_test(a_strip_shows_frames_that_differ),
        cmocka_unit_test(samples_are_sums_of_frames),
        cmocka_unit_test(motion_is_measured),
        cmocka_unit_test(what_does_not_fit_is_refused),
    };
    return cmocka_run_group_tests_name("animate_sums", tests, open_devices, close_devices);
}
