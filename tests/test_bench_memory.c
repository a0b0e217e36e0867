/* What a comparison holds in memory, and what is foretold of a large scene from a small comparison.
 * Some ten seconds. */
#include "framework/base/file.h"
#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "framework/bench/forecast.h"
#include "tests/device_fixture.h"

#include <math.h>

static char *scene_name = "soup:n=200000",
            *builders[] = {"lbvh", "hploc", "embree-native", "embree-native:query=packet8"},
            *kernels[] = {"stack"}, *intersectors[] = {"exact"}, *rays[] = {"primary", "random"};

static bb_bench_request request_on(bb_scene *scene)
{
    return (bb_bench_request){.device = device,
                              .scenes = &scene_name,
                              .scene_count = 1,
                              .scene = scene,
                              .builders = builders,
                              .builder_count = sizeof builders / sizeof builders[0],
                              .kernels = kernels,
                              .kernel_count = 1,
                              .intersectors = intersectors,
                              .intersector_count = 1,
                              .workloads = rays,
                              .workload_count = sizeof rays / sizeof rays[0],
                              .width = 32,
                              .height = 32,
                              .max_rays = 4096,
                              .repeats = 2,
                              .seed = seed,
                              .quiet = true};
}

/* Returns the most that the comparison books beyond what is booked before. */
static double booked_by(const bb_bench_request *request)
{
    bb_account *all = bb_host_account();
    bb_results *results = NULL;
    bb_bench_outcome outcome;
    const uint64_t before = all->bytes;
    check(bb_results_create(&(bb_context){device, seed, "test"}, &results), "results");
    bb_account_mark(all);
    check(bb_bench_run(request, results, &outcome), "run");
    bb_results_destroy(results);
    assert_int_equal(outcome.wrong + outcome.unbuilt, 0);
    return (double)(all->peak - before);
}

static void memory_is_foretold(void **state)
{
    (void)state;
    if (!device->is_cpu)
        skip(); /* trees are on the device, and the forecast is the host's */
    bb_scene *scene = NULL;
    bb_forecast forecast;
    check(bb_scene_load(scene_name, &scene), "scene");
    const bb_bench_request request = request_on(scene);
    const double taken = booked_by(&request);
    const uint64_t before = bb_host_account()->bytes;
    const double resident = (double)bb_host_resident();
    check(bb_bench_forecast(&request, scene, scene_name, &forecast), "forecast");
    const double foretold = forecast.bytes - resident;
    assert_int_equal(bb_host_account()->bytes, before); /* the sample is gone */
    if (!(foretold > 0.8 * taken && foretold < 1.25 * taken))
        fail_msg("%.3g bytes are foretold, %.3g were taken", foretold, taken);
    assert_true(forecast.seconds[0] > 0);
    for (uint32_t t = 1; t < BB_THRIFTS; t++) /* the more is left out, the less time it takes */
        assert_true(forecast.seconds[t] > 0 && forecast.seconds[t] <= forecast.seconds[t - 1]);
    assert_true(forecast.seconds[BB_THRIFTS - 1] < forecast.seconds[0]);
    bb_scene_free(scene);
}

/* Steps that take as long on a sample, or no time to speak of. Whoever renames one that grows finds
 * it here. */
static void steps_that_grow_are_known(void **state)
{
    (void)state;
    static const char *const others[] = {"load and profile scenes",
                                         "keep records",
                                         "time launches",
                                         "EPO~",
                                         "warming up",
                                         "free trees",
                                         "free scenes"};
    bb_scene *scene = NULL;
    bb_results *results = NULL;
    bb_bench_outcome outcome;
    check(bb_scene_load(scene_name, &scene), "scene");
    bb_bench_request request = request_on(scene);
    request.metrics = (char *const[]){"simt"};
    request.metric_count = 1;
    check(bb_results_create(&(bb_context){device, seed, "test"}, &results), "results");
    check(bb_bench_run(&request, results, &outcome), "run");
    assert_true(bb_results_step_ms(results, "simulate builds") > 0);
    bb_each(step, bb_results_section(results, BB_STEPS))
    {
        const char *name = bb_part_name(step);
        bool known = bb_bench_knows_growth(name);
        for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
            known = known || strcmp(others[i], name) == 0;
        if (!known)
            fail_msg("how does the time of the step '%s' grow?", name);
    }
    bb_results_destroy(results);
    bb_scene_free(scene);
}

/* ---- what is held ---- */

typedef struct held {
    uint64_t building, tracing;
} held;

static void look(void *whom, double share)
{
    held *h = whom;
    if (share < 0.1 && device->bytes > h->building)
        h->building = device->bytes;
    if (share > 0.5)
        h->tracing = device->bytes;
}

/* While rays are traced there are layouts, and no trees. */
static void trees_are_freed_before_the_rays(void **state)
{
    (void)state;
    held h = {0};
    bb_scene *scene = NULL;
    bb_results *results = NULL;
    bb_bench_outcome outcome;
    check(bb_scene_load(scene_name, &scene), "scene");
    bb_bench_request request = request_on(scene);
    request.max_rays = 1 << 16;
    request.repeats = 20;
    request.lean = true;
    request.tell = look;
    request.whom = &h;
    check(bb_results_create(&(bb_context){device, seed, "test"}, &results), "results");
    check(bb_bench_run(&request, results, &outcome), "run");
    assert_true(h.building > 0 && h.tracing > 0);
    /* two trees with their scratch, against as many layouts */
    if (h.tracing > h.building)
        fail_msg("%llu bytes were held while building, %llu while tracing",
                 (unsigned long long)h.building, (unsigned long long)h.tracing);
    bb_results_destroy(results);
    bb_scene_free(scene);
}

/* ---- what makes room ---- */

/* Runs builders alone where so many bytes are left; returns how many cells were judged. */
static uint32_t judged_in(uint64_t room, bb_scene *scene)
{
    bb_account *all = bb_host_account();
    bb_results *results = NULL;
    bb_bench_outcome outcome;
    uint32_t judged = 0;
    bb_bench_request request = request_on(scene);
    request.builder_count = 2; /* ours */
    check(bb_results_create(&(bb_context){device, seed, "test"}, &results), "results");
    const uint64_t filled = bb_host_most() - all->bytes - room;
    bb_host_book(filled);
    bb_status status = bb_bench_run(&request, results, &outcome);
    bb_host_unbook(filled);
    check(status, "run");
    bb_each(trace, bb_results_section(results, BB_TRACES)) judged +=
        bb_get_number(trace, BB_F_ACCURACY_CHECKED) > 0 &&
        bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM) == 0;
    bb_results_destroy(results);
    return judged;
}

/* Where builds and the oracle do not fit beside each other, it is made again when it is asked; and
 * a tree is measured without its builder, where its metrics need that room. */
static void oracle_and_builders_make_room(void **state)
{
    (void)state;
    if (!device->is_cpu || bb_host_most() == UINT64_MAX)
        skip(); /* trees are on the device, or nobody knows the memory */
    bb_scene *scene = NULL;
    check(bb_scene_load(scene_name, &scene), "scene");
    bb_bench_request request = request_on(scene);
    request.builder_count = 2;
    const double taken = booked_by(&request);
    const uint32_t all = judged_in((uint64_t)(1.1 * taken), scene);
    assert_true(all > 0);
    /* 0.45 is the least for both ways together; without either, 0.47 is too little */
    assert_int_equal(judged_in((uint64_t)(0.47 * taken), scene), all);
    bb_scene_free(scene);
}

/* More of anything takes longer: of rays, of rounds, of primitives. */
static void more_takes_longer(void **state)
{
    (void)state;
    if (!device->is_cpu)
        skip();
    bb_scene *scene = NULL;
    bb_forecast few, many;
    check(bb_scene_load(scene_name, &scene), "scene");
    assert_true(bb_bench_can_be_foretold(scene));
    bb_bench_request request = request_on(scene);
    check(bb_bench_forecast(&request, scene, scene_name, &few), "forecast");
    request.max_rays = 1 << 24;
    check(bb_bench_forecast(&request, scene, scene_name, &many), "forecast");
    assert_true(many.seconds[0] > 4 * few.seconds[0] && many.bytes > few.bytes + 4e8);
    char *own[] = {"random:count=4096"}; /* however many there may be */
    request.workloads = own;
    request.workload_count = 1;
    check(bb_bench_forecast(&request, scene, scene_name, &many), "forecast");
    assert_true(many.seconds[0] < 2 * few.seconds[0] && many.bytes < few.bytes + 1e8);
    char pictures[PATH_MAX];
    check(bb_temporary_folder(pictures), "folder");
    request.picture_folder = pictures;
    request.width = request.height = 4096;
    check(bb_bench_forecast(&request, scene, scene_name, &few), "forecast");
    bb_remove_folder(pictures);
    assert_true(few.seconds[0] > many.seconds[0] + 1 && few.bytes < many.bytes + 1e8);
    request = request_on(scene);
    check(bb_bench_forecast(&request, scene, scene_name, &few), "forecast");
    request.repeats = 59;
    check(bb_bench_forecast(&request, scene, scene_name, &many), "forecast");
    assert_true(many.seconds[0] > 2 * few.seconds[0]);
    request.workload_count = 0; /* builds alone */
    check(bb_bench_forecast(&request, scene, scene_name, &many), "forecast");
    assert_true(isfinite(many.seconds[0]) && many.seconds[0] > 0 && isfinite(many.bytes));
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_is_foretold),
        cmocka_unit_test(more_takes_longer),
        cmocka_unit_test(steps_that_grow_are_known),
        cmocka_unit_test(trees_are_freed_before_the_rays),
        cmocka_unit_test(oracle_and_builders_make_room),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
