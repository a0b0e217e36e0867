/* The audit: each figure that contradicts another is complained of, and what was measured rightly
 * is not. The clocks that run wrong here are those that somebody might write by mistake.
 */
#include "framework/base/clock.h"
#include "framework/base/random.h"
#include "framework/bench/audit_results.h"
#include "framework/bench/bench_private.h"
#include "framework/builder/registry.h"
#include "framework/builder/tracing.h"
#include "framework/judge/queries.h"
#include "framework/record/record_private.h"
#include "tests/device_fixture.h"
#include "tests/trace_fixture.h"
#include "traversal/pass.h"

#include <unistd.h>

enum { RAYS = 1 << 16 };

static uint32_t complaints(double ms, double event_ms)
{
    bb_audit audit = {0};
    bb_audit_timing(&audit, "test", &(bb_timing){ms, ms, event_ms, 0, 0}, false);
    assert_int_equal(audit.timings, 1);
    return audit.complaints;
}

static void timings_are_held_against_events(void **state)
{
    (void)state;
    assert_int_equal(complaints(10, 9), 0);
    assert_int_equal(complaints(10, 0), 0); /* work of a host's thread has no events */
    assert_int_equal(complaints(10, 10.1), 0);
    assert_int_equal(complaints(10, 10.3), 1);
    assert_int_equal(complaints(0, 0), 1);
    assert_int_equal(complaints(-1, 0), 1);
    assert_int_equal(complaints(NAN, 1), 1);
    assert_int_equal(complaints(0.01, 0.04), 0); /* what two clocks may differ by */
    assert_int_equal(complaints(0.01, 0.08), 1);
}

/* A clock that stopped before the launch saw nothing of it. */
static void work_that_no_clock_saw_is_found_out(void **state)
{
    (void)state;
    bb_audit audit = {0};
    bb_audit_timing(&audit, "trace", &(bb_timing){10, 10, 0, 0, 0}, true);
    assert_int_equal(audit.complaints, 1);
    bb_audit_timing(&audit, "host", &(bb_timing){10, 10, 0, 0, 0}, false);
    assert_int_equal(audit.complaints, 1);
}

static void complaints_add_up(void **state)
{
    (void)state;
    bb_audit sum = {0}, more = {0};
    for (int i = 0; i < BB_COMPLAINTS_MAX + 5; i++)
        bb_audit_timing(&more, "a clock", &(bb_timing){0, 0, 0, 0, 0}, true);
    assert_int_equal(more.complaints, BB_COMPLAINTS_MAX + 5);
    bb_audit_add(&sum, &more);
    bb_audit_add(&sum, &more);
    assert_int_equal(sum.complaints, 2 * (BB_COMPLAINTS_MAX + 5));
    assert_int_equal(sum.timings, 2 * (BB_COMPLAINTS_MAX + 5));
    assert_non_null(strstr(sum.texts[BB_COMPLAINTS_MAX - 1], "a clock"));
}

/* ---- rates ---- */

/* Results with one trace: `count` rays, of which `judged` were judged. */
static bb_results *one_cell(uint32_t count, uint32_t judged)
{
    bb_results *results = NULL;
    bb_trace_record trace;
    static bb_build_record build;
    bb_spec spec;
    check(bb_spec_parse("lbvh", &spec), "spec");
    bb_build_record_init(&build);
    snprintf(build.scene, sizeof build.scene, "a scene");
    build.spec = &spec;
    build.options = bb_builder_find("lbvh")->options;
    check(bb_results_create(&(bb_context){.command = "test"}, &results), "results");
    assert_non_null(bb_results_entry(results, (bb_cell){{[BB_SCENE] = "a scene"}}));
    check(bb_results_add_build(results, &build), "build");
    bb_trace_record_init(&trace);
    trace.query = &bb_query_closest;
    snprintf(trace.scene, sizeof trace.scene, "a scene");
    snprintf(trace.builder, sizeof trace.builder, "lbvh");
    snprintf(trace.rays, sizeof trace.rays, "primary");
    trace.count = count;
    bb_samples_add(&trace.ms, 30);
    bb_samples_add(&trace.ms, 20);
    trace.has_accuracy = true;
    trace.accuracy.checked = judged;
    check(bb_results_add_trace(results, &trace), "trace");
    return results;
}

static uint32_t rate_complaints(bb_results *results)
{
    bb_audit audit = {0};
    bb_audit_rates(&audit, results);
    assert_int_equal(audit.rates, 1);
    bb_results_destroy(results);
    return audit.complaints;
}

static bb_entry *trace_of(bb_results *results)
{
    return results->sections[BB_TRACES].first;
}

static void rates_are_of_the_rays_that_were_judged(void **state)
{
    (void)state;
    assert_int_equal(rate_complaints(one_cell(1000, 1000)), 0);
    assert_int_equal(rate_complaints(one_cell(1000, 999)), 1);
    bb_results *results = one_cell(1000, 1000);
    bb_entry *trace = trace_of(results);
    bb_put_number(trace, BB_F_TRACE_RATE_GIVEN, bb_get_number(trace, BB_F_TRACE_RATE) * 1.01);
    assert_int_equal(rate_complaints(results), 1);
    results = one_cell(1000, 1000);
    bb_put_rounds(trace_of(results), BB_F_TRACE_MS, &(bb_samples){0});
    assert_int_equal(rate_complaints(results), 1);
    results = one_cell(1000, 1000);
    bb_put_rounds(trace_of(results), BB_F_TRACE_EVENT_MS, &(bb_samples){2, {41, 41}});
    assert_int_equal(rate_complaints(results), 1); /* 20 ms shown, 41 ms seen */
    results = one_cell(1000, 1000);
    bb_put_number(trace_of(results), BB_F_ACCURACY_CHECKED, (double)NAN);
    assert_int_equal(rate_complaints(results), 1);
}

static void launches_are_of_the_rays_that_count(void **state)
{
    (void)state;
    bb_audit audit = {0};
    bb_audit_launches(&audit, "a trace", 1000, 1000, 1000);
    assert_int_equal(audit.complaints, 0);
    bb_audit_launches(&audit, "a trace", 500, 1500,
                      1000); /* half, and all again beside the clock */
    bb_audit_launches(&audit, "a trace", 500, 1000, 1000);
    bb_audit_launches(&audit, "a trace", 1000, 2000, 1000);
    bb_audit_launches(&audit, "a trace", 999, 999, 1000);
    assert_int_equal(audit.complaints, 4);
}

static void totals_are_sums(void **state)
{
    (void)state;
    bb_audit audit = {0};
    bb_audit_total(&audit, 1000, 2000, 6900, 10000);
    assert_int_equal(audit.complaints, 0);
    assert_true(audit.rest_ms == 100);
    bb_audit_total(&audit, 1000, 2000, 6500, 10000);
    assert_int_equal(audit.complaints, 1);
    bb_audit_total(&audit, 1000, 2000, 7500, 10000);
    assert_int_equal(audit.complaints, 2);
}

/* ---- a run ---- */

/* A terminal that is held. */
static void hold(void *whom, double share)
{
    bool *held = whom;
    (void)share;
    if (!*held)
        usleep(500000);
    *held = true;
}

/* The time of a build that fails is booked, and that for which a terminal is held. */
static void nothing_of_a_run_is_lost(void **state)
{
    (void)state;
    char *scene = "sphere-mesh:n=8", *builders[] = {"lbvh", "wreck:above=1,how=tire"},
         *kernel = "stack", *intersector = "exact", *rays = "primary";
    bool held = false;
    bb_results *results = NULL;
    bb_bench_outcome outcome;
    const bb_bench_request request = {.device = device,
                                      .scenes = &scene,
                                      .scene_count = 1,
                                      .builders = builders,
                                      .builder_count = 2,
                                      .kernels = &kernel,
                                      .kernel_count = 1,
                                      .intersectors = &intersector,
                                      .intersector_count = 1,
                                      .workloads = &rays,
                                      .workload_count = 1,
                                      .width = 8,
                                      .height = 8,
                                      .max_rays = 64,
                                      .repeats = 30,
                                      .seed = 1,
                                      .lean = true,
                                      .tell = hold,
                                      .whom = &held,
                                      .quiet = true};
    check(bb_plugin_load(BB_TEST_PLUGIN_DIR "/wreck.so"), "plug-in");
    check(bb_results_create(&(bb_context){device, 1, "test"}, &results), "results");
    check(bb_bench_run(&request, results, &outcome), "run");
    const bb_bench_times *t = &outcome.times;
    check(bb_results_set_total(results, t->build_ms, t->trace_ms, t->total_ms), "total");
    bb_audit_total(&outcome.audit, t->build_ms, t->trace_ms, bb_results_time_ms(results, "steps"),
                   t->total_ms);
    assert_true(held);
    assert_int_equal(outcome.wrong, 1);
    if (outcome.audit.complaints > 0)
        fail_msg("%s", outcome.audit.texts[0]);
    bb_results_destroy(results);
}

/* What booking a step takes is in no other step; the results get it with the next. */
static void booking_is_booked(void **state)
{
    (void)state;
    static bb_bench_outcome outcome;
    static bb_bench bench = {.outcome = &outcome};
    double sum = 0;
    check(bb_results_create(&(bb_context){.command = "test"}, &bench.results), "results");
    for (int i = 0; i < 3; i++) {
        bb_step outer = bb_bench_begin(&bench), inner = bb_bench_begin(&bench);
        check(bb_bench_end(&bench, inner, "inner", BB_OK), "inner");
        check(bb_bench_end(&bench, outer, "outer", BB_OK), "outer");
    }
    sum = bb_results_step_ms(bench.results, "inner") + bb_results_step_ms(bench.results, "outer");
    assert_true(bench.booking_ms > 0);
    assert_float_equal(sum + bench.booking_ms, bench.steps_ms, 1e-9);
    bb_results_destroy(bench.results);
}

/* ---- real clocks ---- */

/* Rays through a room, launched as a run does; the wall time ends before or after the queue is
 * done. */
static bb_timing time_trace(bed *b, const bb_buffer *rays, bb_buffer *hits, bool too_early)
{
    bb_traverser_request request = {
        .query = &bb_query_closest,
        .kernel = bb_kernel_find("stack"),
        .spec = &b->kernel,
        .intersector = bb_intersector_find("exact"),
    };
    bb_traverser *traverser;
    bb_stopwatch watch;
    bb_timing timing;
    check(bb_traverser_get(device, &request, &b->layout, &traverser), "traverser");
    const bb_pass pass = {.query = &bb_query_closest,
                          .traverser = traverser,
                          .layout = &b->layout,
                          .rays = rays,
                          .results = hits};
    check(bb_pass_launch(&pass, RAYS), "warm up");
    check(bb_stopwatch_start(device, &watch), "start");
    check(bb_pass_launch(&pass, RAYS), "trace");
    double early = bb_wall_ms() - watch.wall;
    check(bb_stopwatch_stop(&watch, BB_OK, &timing), "stop");
    timing.ms = too_early ? early : timing.ms;
    return timing;
}

static void a_clock_that_stops_before_the_queue_is_found_out(void **state)
{
    (void)state;
    bed b;
    bb_buffer d_rays = {0}, d_hits = {0};
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_random random = bb_random_make(seed, 1);
    open_bed(&b, load("interior:n=20000"), "lbvh", "stack", 1);
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i].tmax = INFINITY;
        for (int k = 0; k < 3; k++)
            rays[i].d[k] = (float)bb_random_range(&random, -1, 1);
    }
    check(bb_buffer_reserve(device, NULL, RAYS * sizeof *rays, "rays", &d_rays), "rays");
    check(bb_buffer_reserve(device, NULL, RAYS * sizeof(bb_hit), "hits", &d_hits), "hits");
    check(bb_buffer_write(&d_rays, 0, RAYS * sizeof *rays, rays), "rays");
    bb_audit audit = {0};
    bb_timing timing = time_trace(&b, &d_rays, &d_hits, false);
    assert_true(timing.event_ms > 0.2 * timing.ms); /* else the comparison shows little */
    bb_audit_timing(&audit, "trace", &timing, true);
    if (audit.complaints > 0)
        fail_msg("%s", audit.texts[0]);
    timing = time_trace(&b, &d_rays, &d_hits, true);
    bb_audit_timing(&audit, "trace", &timing, true);
    assert_int_equal(audit.complaints, 1);
    bb_buffer_release(&d_rays);
    bb_buffer_release(&d_hits);
    free(rays);
    close_bed(&b);
}

static void builds_and_layouts_are_timed_to_their_end(void **state)
{
    (void)state;
    bb_audit audit = {0};
    bb_build_timing timing;
    bed b;
    open_bed(&b, load("interior:n=20000"), "lbvh", "stack8q", 1);
    check(bb_instance_build(&b.instance, b.scene, false, &timing), "build");
    assert_true(timing.timing.event_ms > 0.05 * timing.timing.ms);
    bb_audit_timing(&audit, "build", &timing.timing, true);
    bb_stopwatch watch;
    bb_timing made;
    check(bb_stopwatch_start(device, &watch), "start");
    check(
        bb_layout_maker_make(&b.maker, b.scene, &b.instance.tree, 1, BB_FORMAT_VERTICES, &b.layout),
        "layout");
    check(bb_stopwatch_stop(&watch, BB_OK, &made), "stop");
    assert_true(made.event_ms > 0);
    bb_audit_timing(&audit, "layout", &made, true);
    if (audit.complaints > 0)
        fail_msg("%s", audit.texts[0]);
    close_bed(&b);
}

/* What the threads saw must lie within the time that a tracer is given. */
static void a_tracer_is_timed_with_its_trace(void **state)
{
    (void)state;
    bb_audit audit = {0};
    bb_scene *scene = load("interior:n=20000");
    bb_tracing *embree = NULL;
    bb_build_timing built;
    bb_phases phases;
    bb_timing timing;
    bb_hit *hits = calloc(RAYS, sizeof *hits);
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    for (uint32_t i = 0; i < RAYS; i++)
        rays[i] = (bb_ray){.d = {1, (float)i / RAYS, 0.5f}, .tmax = INFINITY};
    check(bb_tracing_create(device, BB_REFERENCE_NAME, scene, &embree), "embree");
    check(bb_tracing_build(embree, &built, &phases), "build");
    assert_true(built.timing.ms > 0);
    const bb_guarded whose = {"", ""};
    check(bb_tracing_trace(embree, whose, NULL, rays, RAYS, false, hits, &timing), "trace");
    assert_true(timing.event_ms > 0.2 * timing.ms);
    bb_audit_timing(&audit, "tracer", &timing, true);
    if (audit.complaints > 0)
        fail_msg("%s", audit.texts[0]);
    double later = bb_wall_ms(); /* of nothing */
    bb_audit_timing(&audit, "tracer", &(bb_timing){bb_wall_ms() - later, 0, timing.event_ms, 0, 0},
                    true);
    assert_int_equal(audit.complaints, 1);
    bb_tracing_destroy(embree);
    bb_scene_free(scene);
    free(hits);
    free(rays);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(timings_are_held_against_events),
        cmocka_unit_test(work_that_no_clock_saw_is_found_out),
        cmocka_unit_test(complaints_add_up),
        cmocka_unit_test(rates_are_of_the_rays_that_were_judged),
        cmocka_unit_test(launches_are_of_the_rays_that_count),
        cmocka_unit_test(totals_are_sums),
        cmocka_unit_test(nothing_of_a_run_is_lost),
        cmocka_unit_test(booking_is_booked),
        cmocka_unit_test(a_clock_that_stops_before_the_queue_is_found_out),
        cmocka_unit_test(builds_and_layouts_are_timed_to_their_end),
        cmocka_unit_test(a_tracer_is_timed_with_its_trace),
    };
    return cmocka_run_group_tests_name("audit", tests, open_device, close_device);
}
