/* The comparison that measures a point: builders, kernels, intersectors, each with the other parts
 * of the axis. */
#include "framework/stress/point_private.h"

#include "framework/bench/bench.h"
#include "framework/record/schema.h"
#include "traversal/traversal.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bb_figures nothing(void)
{
    return (bb_figures){.outcome = BB_NOT_MEASURED,
                        .prims = NAN,
                        .build_ms = NAN,
                        .trace_ms = NAN,
                        .rays = NAN,
                        .tests = NAN,
                        .sah = NAN,
                        .bytes = NAN,
                        .wrong = NAN,
                        .checked = NAN,
                        .unlike = NAN,
                        .overflowed = NAN};
}

static void end_as(bb_figures *f, bb_outcome outcome, const char *reason)
{
    f->outcome = outcome;
    snprintf(f->reason, sizeof f->reason, "%s", reason);
    bb_clean_text(f->reason);
}

static bb_outcome outcome_of(const char *status)
{
    return strcmp(status, "unsupported") == 0 ? BB_OUT_UNSUPPORTED
           : strcmp(status, "refused") == 0   ? BB_OUT_REFUSED
                                              : BB_OUT_FAILED;
}

/* ---- from records ---- */

static double least(const cJSON *entry, bb_field_id field)
{
    bb_samples samples;
    double value = NAN;
    if (!bb_get_samples(entry, field, &samples))
        return NAN;
    for (uint32_t i = samples.count > 1 ? 1 : 0; i < samples.count; i++)
        value = fmin(value, samples.values[i]);
    return value;
}

static double or_zero(double value)
{
    return isfinite(value) ? value : 0;
}

static void add_trace(bb_figures *f, const cJSON *trace, double *tests)
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

/* What the record has of a method: `builder`, `kernel` and `intersector` as it gives them; NULL
 * is any. */
typedef struct row {
    const char *builder, *kernel, *intersector;
} row;

static bool is_row(const cJSON *trace, const row *r)
{
    return strcmp(bb_get_text(trace, BB_F_TRACE_BUILDER), r->builder) == 0 &&
           (r->kernel == NULL || strcmp(bb_get_text(trace, BB_F_TRACE_KERNEL), r->kernel) == 0) &&
           (r->intersector == NULL ||
            strcmp(bb_get_text(trace, BB_F_TRACE_INTERSECTOR), r->intersector) == 0);
}

static double sah_of(const cJSON *build)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        if (strcmp(bb_metrics[i]->name, "sah") == 0)
            return bb_get_metric(build, bb_metrics[i]);
    return NAN;
}

static void read_build(const bb_results *results, const char *builder, bb_figures *f)
{
    const cJSON *build, *found = NULL;
    cJSON_ArrayForEach(build, bb_results_section(results, "builds"))
    {
        if (found == NULL && strcmp(bb_get_text(build, BB_F_BUILD_BUILDER), builder) == 0)
            found = build;
    }
    if (found == NULL) {
        end_as(f, BB_OUT_FAILED, "there is no record of its build");
        return;
    }
    if (!bb_is_ok(found)) {
        end_as(f, outcome_of(bb_get_text(found, BB_F_BUILD_STATUS)),
               bb_get_text(found, BB_F_BUILD_REASON));
        return;
    }
    f->outcome = BB_MEASURED;
    f->build_ms = least(found, BB_F_BUILD_MS);
    f->sah = sah_of(found);
    f->bytes = bb_get_number(found, BB_F_TREE_BYTES_PEAK);
    if (!isfinite(f->bytes))
        f->bytes = bb_get_number(found, BB_F_BUILD_BYTES_NATIVE);
}

/* What all parts share is measured by each of them, and counts once. */
static bool is_repeated(const cJSON *first, const cJSON *trace)
{
    for (const cJSON *t = first; t != trace; t = t->next)
        if (bb_same_text(t, trace, BB_F_TRACE_CELL))
            return true;
    return false;
}

static void read_traces(const bb_results *results, const row *r, bb_figures *f)
{
    double tests = 0;
    uint32_t traces = 0;
    const cJSON *all = bb_results_section(results, "traces"), *trace;
    cJSON_ArrayForEach(trace, all)
    {
        if (!is_row(trace, r) || f->outcome != BB_MEASURED || is_repeated(all->child, trace))
            continue;
        if (bb_is_ok(trace))
            add_trace(f, trace, &tests);
        else
            end_as(f, outcome_of(bb_get_text(trace, BB_F_TRACE_STATUS)),
                   bb_get_text(trace, BB_F_TRACE_REASON));
        traces++;
    }
    if (f->outcome == BB_MEASURED && traces == 0)
        end_as(f, BB_OUT_FAILED, "none of the rays could be made for this scene");
    f->tests = tests > 0 ? tests / f->rays : NAN;
}

static void read_method(const bb_results *results, const bb_points *points, uint32_t m,
                        bb_figures *f)
{
    const bb_axis *axis = points->axis;
    const bb_method *method = &points->methods[m];
    const bool reference = method->part == BB_A_BUILDER && bb_is_reference(method->text);
    row r = {axis->builder, axis->kernel, bb_intersectors[0].name};
    if (method->part == BB_A_BUILDER)
        r.builder = method->text;
    else if (method->part == BB_A_KERNEL)
        r.kernel = method->text;
    else
        r.intersector = method->text;
    if (reference)
        r.kernel = r.intersector = NULL;
    read_build(results, r.builder, f);
    if (method->part != BB_A_BUILDER) /* the tree is not its own */
        f->build_ms = f->bytes = f->sah = NAN;
    if (f->outcome == BB_MEASURED)
        read_traces(results, &r, f);
}

/* ---- the comparison ---- */

typedef struct names {
    char *items[128];
    uint32_t count;
} names;

/* The wanted methods of a part. */
static names names_of(const bb_points *points, const bool *wanted, bb_method_part part)
{
    names out = {.count = 0};
    for (uint32_t m = 0; m < points->method_count; m++)
        if (wanted[m] && points->methods[m].part == part)
            out.items[out.count++] = (char *)points->methods[m].text;
    return out;
}

typedef struct texts {
    char scene[2 * BB_AXIS_TEXT];
    char rays[BB_AXIS_RAYS_MAX][2 * BB_AXIS_TEXT];
    char *ray_list[BB_AXIS_RAYS_MAX];
    char *scene_list[1];
} texts;

static bb_status fill_texts(const bb_points *points, double x, texts *t)
{
    const bb_axis *axis = points->axis;
    BB_TRY(bb_axis_fill(axis->scene, x, points->n, t->scene, sizeof t->scene));
    t->scene_list[0] = t->scene;
    for (uint32_t i = 0; i < axis->ray_count; i++) {
        BB_TRY(bb_axis_fill(axis->rays[i], x, points->n, t->rays[i], sizeof t->rays[i]));
        t->ray_list[i] = t->rays[i];
    }
    return BB_OK;
}

static bb_status compare(const bb_points *points, bb_device *device, texts *t, names builders,
                         names kernels, names intersectors, bb_results *results)
{
    uint32_t side = 1;
    while (side * side < points->max_rays)
        side++;
    const bb_bench_request request = {
        .device = device,
        .scenes = t->scene_list,
        .scene_count = 1,
        .builders = builders.items,
        .builder_count = builders.count,
        .kernels = kernels.items,
        .kernel_count = kernels.count,
        .intersectors = intersectors.items,
        .intersector_count = intersectors.count,
        .workloads = t->ray_list,
        .workload_count = points->axis->ray_count,
        .width = side,
        .height = side,
        .max_rays = points->max_rays,
        .max_views = 1,
        .repeats = points->repeats,
        .seed = points->seed,
        .quiet = true,
    };
    bb_bench_outcome outcome;
    return builders.count == 0 || kernels.count == 0 || intersectors.count == 0
               ? BB_OK
               : bb_bench_run(&request, results, &outcome);
}

static names only(const char *text)
{
    return (names){{(char *)text}, 1};
}

/* Each part with the others as the axis has them: the sum of the methods, not their product. */
static bb_status compare_parts(const bb_points *points, bb_device *device, double x,
                               const bool *wanted, bb_results *results)
{
    const bb_axis *axis = points->axis;
    texts t;
    BB_TRY(fill_texts(points, x, &t));
    names builders = names_of(points, wanted, BB_A_BUILDER);
    names kernels = names_of(points, wanted, BB_A_KERNEL);
    names intersectors = names_of(points, wanted, BB_AN_INTERSECTOR);
    names builder = only(axis->builder), kernel = only(axis->kernel),
          intersector = only(bb_intersectors[0].name);
    BB_TRY(compare(points, device, &t, builders, kernel, intersector, results));
    BB_TRY(compare(points, device, &t, builder, kernels, intersector, results));
    return compare(points, device, &t, builder, kernel, intersectors, results);
}

void bb_point_bench(const bb_points *points, bb_device *device, bb_wish *wish)
{
    bb_results *results = NULL;
    bb_status status = bb_results_create(&(bb_context){device, points->seed, "stress"}, &results);
    if (status == BB_OK)
        status = compare_parts(points, device, wish->x, wish->wanted, results);
    char reason[256];
    const bb_outcome whole = status == BB_FAILED ? BB_OUT_FAILED : BB_OUT_REFUSED;
    const cJSON *scene = status == BB_OK ? bb_results_section(results, "scenes")->child : NULL;
    snprintf(reason, sizeof reason, "%s", bb_message());
    for (uint32_t m = 0; m < points->method_count; m++) {
        bb_figures *f = &wish->figures[m];
        *f = nothing();
        if (wish->wanted[m] && status != BB_OK) {
            end_as(f, whole, reason);
        } else if (wish->wanted[m]) {
            f->prims = bb_get_number(scene, BB_F_SCENE_PRIMS);
            read_method(results, points, m, f);
        }
    }
    bb_results_destroy(results);
}
