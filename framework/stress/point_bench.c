/* Measures a point by a comparison, and reads the figures of its methods from the record. */
#include "framework/stress/point_private.h"

#include "framework/base/steering.h"
#include "framework/bench/bench.h"
#include "framework/builder/tracers.h"
#include "framework/record/schema.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bb_point_end(bb_point_figures *f, bb_outcome outcome, const char *reason)
{
    f->outcome = outcome;
    snprintf(f->reason, sizeof f->reason, "%s", reason);
    bb_calm_text(f->reason);
}

static bb_outcome outcome_of(const char *status)
{
    return strcmp(status, "unsupported") == 0 ? BB_OUT_UNSUPPORTED
           : strcmp(status, "refused") == 0   ? BB_OUT_REFUSED
                                              : BB_OUT_FAILED;
}

/* ---- from records ---- */

static double least(const bb_entry *entry, bb_field_id field)
{
    bb_samples samples;
    return bb_get_samples(entry, field, &samples) ? bb_samples_least(&samples) : (double)NAN;
}

static double or_zero(double value)
{
    return isfinite(value) ? value : 0;
}

static void add_trace(bb_point_figures *f, const bb_entry *trace, double *tests)
{
    double rays = bb_get_number(trace, BB_F_TRACE_COUNT);
    f->trace_ms = or_zero(f->trace_ms) + least(trace, BB_F_TRACE_MS);
    f->rays = or_zero(f->rays) + rays;
    *tests += rays * (bb_get_number(trace, BB_F_TRACE_NODE_TESTS) +
                      bb_get_number(trace, BB_F_TRACE_PRIM_TESTS));
    f->checked = or_zero(f->checked) + bb_get_number(trace, BB_F_ACCURACY_CHECKED);
    f->wrong = or_zero(f->wrong) + bb_get_number(trace, BB_F_ACCURACY_MISSED) +
               bb_get_number(trace, BB_F_ACCURACY_FALSE) +
               bb_get_number(trace, BB_F_ACCURACY_WRONG_T);
    f->unlike = or_zero(f->unlike) + or_zero(bb_get_number(trace, BB_F_TRACE_UNLIKE));
    f->overflowed =
        or_zero(f->overflowed) + or_zero(bb_get_number(trace, BB_F_ACCURACY_OVERFLOWED));
}

/* What is not simulated makes the sum NAN. */
static void add_simulations(const bb_points *points, const bb_entry *trace,
                            bb_simulated_sets *simulated)
{
    for (uint32_t i = 0; i < points->simt_count; i++) {
        bb_simulation one;
        bb_get_simulation(trace, points->simts[i].name, &one);
        bb_simulated_add(&simulated[i], bb_get_number(trace, BB_F_TRACE_COUNT), &one);
    }
}

/* Selects entries of a method by the texts of bb_bench_request; NULL: any. */
typedef struct row {
    const char *builder, *kernel, *intersector;
} row;

static bool is_row(const bb_entry *trace, const row *r)
{
    return bb_bench_fits(r->builder, bb_get_text(trace, BB_F_TRACE_BUILDER)) &&
           bb_bench_fits(r->kernel, bb_get_text(trace, BB_F_TRACE_KERNEL)) &&
           bb_bench_fits(r->intersector, bb_get_text(trace, BB_F_TRACE_INTERSECTOR));
}

static void read_build(const bb_results *results, const char *builder, bb_point_figures *f)
{
    const bb_entry *found = NULL;
    bb_each(build, bb_results_section(results, BB_BUILDS))
    {
        if (found == NULL && strcmp(bb_get_text(build, BB_F_BUILD_BUILDER), builder) == 0)
            found = build;
    }
    if (found == NULL) {
        bb_point_end(f, BB_OUT_FAILED, "there is no record of its build");
        return;
    }
    if (!bb_is_ok(found)) {
        bb_point_end(f, outcome_of(bb_get_text(found, BB_F_BUILD_STATUS)),
                     bb_get_text(found, BB_F_BUILD_REASON));
        return;
    }
    f->outcome = BB_MEASURED;
    f->build_ms = least(found, BB_F_BUILD_MS);
    f->metric = bb_get_metric(found, bb_metrics[bb_metric_of_layouts()]);
    f->bytes = bb_get_number(found, BB_F_TREE_BYTES_PEAK);
    if (!isfinite(f->bytes))
        f->bytes = bb_get_number(found, BB_F_BUILD_BYTES_NATIVE);
}

/* The worst outcome of all ray sets counts: failed, refused, measured, unsupported. */
static int weight_of(bb_outcome outcome)
{
    return outcome == BB_OUT_FAILED    ? 3
           : outcome == BB_OUT_REFUSED ? 2
           : outcome == BB_MEASURED    ? 1
                                       : 0;
}

/* Returns the index of the ray set in the request. */
static uint32_t set_of(const bb_point_request *request, const bb_entry *trace)
{
    uint32_t set = 0;
    while (set < request->bench.workload_count &&
           strcmp(request->ray_sets[set], bb_get_text(trace, BB_F_TRACE_RAYS)) != 0)
        set++;
    return set;
}

static void read_traces(const bb_results *results, const bb_point_request *request, const row *r,
                        bb_point_figures *f)
{
    const bb_points *points = request->points;
    bb_simulated_sets simulated[BB_SIMT_MAX] = {{.count = 0}};
    double tests = 0;
    uint32_t traces = 0, sets = 0;
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        if (!is_row(trace, r))
            continue;
        const bb_outcome outcome =
            bb_is_ok(trace) ? BB_MEASURED : outcome_of(bb_get_text(trace, BB_F_TRACE_STATUS));
        if (outcome == BB_MEASURED) {
            add_trace(f, trace, &tests);
            add_simulations(points, trace, simulated);
            sets |= 1u << set_of(request, trace);
        }
        if (traces++ == 0 || weight_of(outcome) > weight_of(f->outcome))
            bb_point_end(f, outcome, bb_is_ok(trace) ? "" : bb_get_text(trace, BB_F_TRACE_REASON));
    }
    if (traces == 0)
        bb_point_end(f, BB_OUT_FAILED, "none of the rays could be made for this scene");
    f->ray_sets = sets;
    for (uint32_t i = 0; i < points->simt_count; i++)
        f->simulated[i] = bb_simulated_sum(&simulated[i]);
    f->tests = tests > 0 ? tests / f->rays : NAN;
}

static void read_method(const bb_results *results, const bb_point_request *request, uint32_t m,
                        bb_point_figures *f)
{
    const bb_method *method = &request->points->methods[m];
    const char *parts[BB_METHOD_PARTS];
    bb_method_cell(request->points->axis, method, parts);
    row r = {parts[BB_A_BUILDER], parts[BB_A_KERNEL], parts[BB_AN_INTERSECTOR]};
    if (bb_tracer_of(r.builder) != NULL)
        r.kernel = r.intersector = NULL;
    read_build(results, r.builder, f);
    if (method->part != BB_A_BUILDER) /* it does not build the tree */
        f->build_ms = f->bytes = f->metric = NAN;
    if (f->outcome == BB_MEASURED)
        read_traces(results, request, &r, f);
}

static bb_status run_comparison(const bb_points *points, bb_device *device, const bb_wish *wish,
                                bb_point_request *request, bb_results *results)
{
    bb_bench_outcome outcome;
    BB_TRY(bb_point_request_make(points, wish->x, wish->wanted, request));
    request->bench.device = device;
    return bb_bench_run(&request->bench, results, &outcome);
}

void bb_point_bench(const bb_points *points, bb_device *device, bb_wish *wish)
{
    bb_results *results = NULL;
    bb_point_request request;
    bb_status status = bb_results_create(&(bb_context){device, points->seed, "stress"}, &results);
    if (status == BB_OK)
        status = run_comparison(points, device, wish, &request, results);
    char reason[256];
    const bb_outcome whole = status == BB_FAILED ? BB_OUT_FAILED : BB_OUT_REFUSED;
    const bb_entry *scene =
        status == BB_OK ? bb_first(bb_results_section(results, BB_SCENES)) : NULL;
    snprintf(reason, sizeof reason, "%s", bb_message());
    for (uint32_t m = 0; m < points->method_count; m++) {
        bb_point_figures *f = &wish->figures[m];
        *f = bb_no_figures(BB_NOT_MEASURED);
        if (wish->wanted[m] && status != BB_OK) {
            bb_point_end(f, whole, reason);
        } else if (wish->wanted[m]) {
            f->prims = bb_get_number(scene, BB_F_SCENE_PRIMS);
            read_method(results, &request, m, f);
        }
    }
    bb_results_destroy(results);
}
