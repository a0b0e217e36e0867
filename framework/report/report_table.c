/* The report as text: per scene its builds, then its traces by ray set; at the end what was
 * skipped, and where the time went. A speed never stands without the wrong-answer rate of the same
 * rays. */
#include "framework/builder/tracers.h"
#include "framework/judge/queries.h"
#include "framework/report/report.h"
#include "framework/table/figure.h"
#include "framework/table/view.h"

#include <math.h>
#include <string.h>

/* ---- what stands in the results as it is shown ---- */

enum {
    OF_BUILD = BB_SET(BB_SCENE) | BB_SET(BB_BUILDER),
    OF_TRACE = BB_SET(BB_QUESTION) | BB_SET(BB_KERNEL) | BB_SET(BB_INTERSECTOR),
};

static const bb_table_view about_view = {
    .caption = "about the trees",
    .with = OF_BUILD,
    .without = OF_TRACE,
    .having = "about",
    .rows = BB_SET(BB_RUN) | BB_SET(BB_BUILDER),
    .columns = {{.parts = {"about"}}},
};
static const bb_table_view stages_view = {
    .caption = "stages",
    .with = OF_BUILD | BB_SET(BB_MAKER),
    .without = OF_TRACE,
    .rows = BB_SET(BB_RUN) | BB_SET(BB_BUILDER) | BB_SET(BB_MAKER),
    .columns = {{.parts = {"stage_ms"}, .heading = "Stages"},
                {.parts = {"stage_sah"}},
                {.parts = {"stage_bytes"}},
                {.parts = {"stage_bytes_peak"}}},
};
static const bb_table_view reasons_view = {
    .caption = "without figures",
    .with = OF_BUILD,
    .having = "reason",
    .rows = BB_SET(BB_RUN) | OF_TRACE | BB_SET(BB_VIEW) | BB_SET(BB_BUILDER),
    .columns = {{.parts = {"status"}}, {.parts = {"reason"}}},
};
static const bb_table_view skipped_view = {
    .caption = "skipped",
    .with = BB_SET(BB_SCENE) | BB_SET(BB_QUESTION),
    .without = BB_SET(BB_BUILDER),
    .rows = BB_SET(BB_RUN) | BB_SET(BB_SCENE) | BB_SET(BB_QUESTION) | BB_SET(BB_VIEW),
    .columns = {{.parts = {"reason"}}},
};
static const bb_table_view times_view = {
    .caption = "where the time went: steps; the parts of the total, of which build and trace are "
               "timed and other is not accounted for",
    .with = BB_SET(BB_MAKER),
    .without = BB_SET(BB_SCENE) | BB_SET(BB_QUESTION),
    .rows = BB_SET(BB_MAKER),
    .columns = {{.parts = {"step_ms"}, .heading = "step"},
                {.parts = {"time_ms"}, .heading = "part"}},
};
static const bb_table_view predictions_view = {
    .caption =
        "what trees cost, against the time per ray: (1 - alpha) SAH + alpha EPO, each alone, "
        "and the counted work",
    .with = BB_SET(BB_QUESTION),
    .without = BB_SET(BB_SCENE) | BB_SET(BB_MAKER),
    .rows = BB_SET(BB_QUESTION),
    .columns = {{.parts = {"cells"}},
                {.parts = {"trees"}},
                {.parts = {"scenes"}},
                {.parts = {"alpha"}},
                {.parts = {"alpha_least"}},
                {.parts = {"alpha_most"}},
                {.parts = {"mix_error"}},
                {.parts = {"mix_correlation"}},
                {.parts = {"unseen_error"}},
                {.parts = {"sah_error"}},
                {.parts = {"sah_correlation"}},
                {.parts = {"epo_error"}},
                {.parts = {"epo_correlation"}},
                {.parts = {"work_error"}},
                {.parts = {"work_correlation"}}},
};

static void show(const bb_table_view *view, const bb_results *results, const char *scene,
                 bb_page *page)
{
    bb_view_show(view, bb_results_table(results), (bb_cell){{[BB_SCENE] = scene}}, page);
}

/* ---- columns of fields ---- */

static void add_columns(bb_page *page, const bb_field_id *fields, size_t count)
{
    for (size_t i = 0; i < count; i++)
        bb_page_column(page, bb_fields[fields[i]].heading, "", "",
                       bb_fields[fields[i]].format == BB_AS_WHOLE ? 0 : -1);
}

static void put_number(bb_page *page, double value)
{
    bb_estimate figure = bb_not_measured;
    figure.value = value;
    bb_page_put_figure(page, figure, 0);
}

/* The builder; of merged results, further runs have their number behind it, as in the summary. */
static void put_builder(bb_page *page, const bb_entry *row, bb_field_id builder)
{
    char text[1100];
    const uint32_t run = bb_run_of(row);
    snprintf(text, sizeof text, run > 0 ? "%.1024s #%u" : "%.1024s", bb_get_text(row, builder),
             run + 1);
    bb_page_put_text(page, text);
}

/* A median with its interval; with its range if there are too few rounds; or alone. The ends are
 * the four fields from `low` on. */
static void put_median(bb_page *page, const bb_entry *row, bb_field_id median, bb_field_id low)
{
    char text[BB_FIGURE_MAX + 8];
    bb_estimate e = {bb_get_number(row, median), bb_get_number(row, low),
                     bb_get_number(row, low + 1), bb_get_number(row, low + 2),
                     bb_get_number(row, low + 3)};
    if (isfinite(e.low) || !isfinite(e.least)) {
        bb_page_put_figure(page, e, 0);
        return;
    }
    e.low = e.least;
    e.high = e.most;
    strcat(strcpy(text, bb_figure_interval((char[BB_FIGURE_MAX]){0}, e, -1)), " range");
    bb_page_put_text(page, text);
}

static void put_fields(bb_page *page, const bb_entry *row, const bb_field_id *fields, size_t count)
{
    char bytes[BB_FIGURE_MAX];
    for (size_t i = 0; i < count; i++)
        if (bb_fields[fields[i]].format == BB_AS_TEXT)
            bb_page_put_text(page, bb_get_text(row, fields[i]));
        else if (bb_fields[fields[i]].format == BB_AS_BYTES)
            bb_page_put_text(page, bb_figure_bytes(bytes, bb_get_number(row, fields[i])));
        else
            put_number(page, bb_get_number(row, fields[i]));
}

/* ---- builds ---- */

static const bb_field_id of_builds[] = {BB_F_BUILD_BUILDER, BB_F_BUILD_RATE, BB_F_BUILD_HANDOVER};
static const bb_field_id of_trees[] = {BB_F_TREE_DEPTH, BB_F_TREE_BYTES, BB_F_TREE_BYTES_PEAK};
static const bb_field_id of_unbooked = BB_F_TREE_BYTES_UNBOOKED;
static const bb_field_id of_native[] = {BB_F_TREE_DEPTH, BB_F_BUILD_BYTES_NATIVE,
                                        BB_F_TREE_BYTES_PEAK};
enum {
    OF_BUILDS = sizeof of_builds / sizeof of_builds[0],
    OF_TREES = sizeof of_trees / sizeof of_trees[0],
};

/* Metrics that were measured of any build: those that always are, then those on request. */
static uint32_t choose_metrics(const bb_section *builds, const bb_metric *metrics[BB_METRICS_MAX])
{
    uint32_t count = 0;
    for (int on_request = 0; on_request < 2; on_request++)
        for (uint32_t i = 0; i < bb_metric_count(); i++)
            if (bb_metrics[i]->on_request == on_request &&
                bb_metric_measured(builds, bb_metrics[i]))
                metrics[count++] = bb_metrics[i];
    return count;
}

static bool is_of(const bb_entry *build, const char *scene)
{
    return strcmp(bb_get_text(build, BB_F_BUILD_SCENE), scene) == 0;
}

static void begin_layouts(bb_page *page)
{
    bb_page_grid(page, "layouts");
    add_columns(page, (const bb_field_id[]){BB_F_BUILD_BUILDER}, 1);
    bb_page_column(page, "Layout", "", "", 0);
    bb_page_column(page, "Layout ms", "", "", -1);
    bb_page_column(page, "First ray", "", "", -1);
    bb_page_column(page, "Launches", "", "", 0);
    bb_page_column(page, "Launch floor", "", "", -1);
}

static void add_layouts(bb_page *page, const bb_section *builds, const char *scene)
{
    bool begun = false;
    bb_each(build, builds) bb_each_part(layout, build, BB_F_BUILD_LAYOUTS_MS)
    {
        if (!is_of(build, scene))
            break;
        if (!begun)
            begin_layouts(page);
        begun = true;
        put_builder(page, build, BB_F_BUILD_BUILDER);
        bb_page_put_text(page, bb_part_name(layout));
        put_number(page, bb_get_number(layout, BB_F_BUILD_LAYOUTS_MS));
        put_number(page, bb_first_ray_ms(build, bb_part_name(layout)));
        put_number(page, bb_get_number(layout, BB_F_BUILD_LAYOUTS_LAUNCHES));
        put_number(page, bb_get_number(layout, BB_F_BUILD_LAYOUTS_FLOOR));
    }
}

/* Whether a builder has some of it: work outside the clock, memory beside its account. */
static bool any_has(const bb_section *builds, bb_field_id field)
{
    bool any = false;
    bb_each(build, builds)
    {
        any = any || bb_get_number(build, field) > 0;
    }
    return any;
}

static void add_build(bb_page *page, const bb_entry *build, bool untimed, bool unbooked,
                      const bb_metric *const *metrics, uint32_t count)
{
    const bb_entry *layout = bb_first_part(build, BB_F_BUILD_LAYOUTS_MS);
    const double native = bb_get_number(build, BB_F_BUILD_BYTES_NATIVE);
    put_builder(page, build, of_builds[0]);
    put_fields(page, build, of_builds + 1, OF_BUILDS - 1);
    put_median(page, build, BB_F_BUILD_MS_MEDIAN, BB_F_BUILD_MS_LO);
    if (untimed)
        put_number(page, bb_get_number(build, BB_F_BUILD_UNTIMED));
    put_number(page, layout != NULL ? bb_get_number(layout, BB_F_BUILD_LAYOUTS_MS) : (double)NAN);
    put_number(page, bb_first_ray_ms(build, layout != NULL ? bb_part_name(layout) : ""));
    for (uint32_t i = 0; i < count; i++)
        put_number(page, bb_get_metric(build, metrics[i]));
    put_fields(page, build, isfinite(native) ? of_native : of_trees, OF_TREES);
    if (unbooked)
        put_fields(page, build, &of_unbooked, 1);
    bb_page_put_text(page, bb_is_ok(build) ? "" : bb_get_text(build, BB_F_BUILD_STATUS));
}

static void add_builds(bb_page *page, const bb_results *results, const char *scene)
{
    const bb_section *builds = bb_results_section(results, BB_BUILDS);
    const bb_metric *metrics[BB_METRICS_MAX];
    const uint32_t count = choose_metrics(builds, metrics);
    const bool untimed = any_has(builds, BB_F_BUILD_UNTIMED);
    const bool unbooked = any_has(builds, BB_F_TREE_BYTES_UNBOOKED);
    const bb_entry *first = bb_first(builds);
    while (first != NULL && !is_of(first, scene))
        first = bb_next(first);
    if (first == NULL)
        return;
    bb_page_grid(page, "");
    add_columns(page, of_builds, OF_BUILDS);
    add_columns(page, (const bb_field_id[]){BB_F_BUILD_MS_MEDIAN, BB_F_BUILD_UNTIMED},
                untimed ? 2 : 1);
    bb_page_column(page, "Layout ms", "", "", -1);
    bb_page_column(page, "First ray", "", "", -1);
    for (uint32_t i = 0; i < count; i++)
        bb_page_column(page, metrics[i]->title, "", "", -1);
    add_columns(page, of_trees, OF_TREES);
    add_columns(page, &of_unbooked, unbooked ? 1 : 0);
    bb_page_column(page, "", "", "", 0);
    bb_each(build, builds)
    {
        if (is_of(build, scene))
            add_build(page, build, untimed, unbooked, metrics, count);
    }
    show(&about_view, results, scene, page);
    show(&stages_view, results, scene, page);
    add_layouts(page, builds, scene);
}

/* ---- traces ---- */

static const bb_field_id of_traces[] = {BB_F_TRACE_NODE_TESTS, BB_F_TRACE_PRIM_TESTS,
                                        BB_F_TRACE_WORK};
enum { OF_TRACES = sizeof of_traces / sizeof of_traces[0] };

/* The very same rays, from the same run. */
static bool same_rays(const bb_entry *a, const bb_entry *b)
{
    const char *left = bb_get_text(a, BB_F_TRACE_CELL), *right = bb_get_text(b, BB_F_TRACE_CELL);
    return bb_cell_key_same(left, bb_cell_key_rays(left), right, bb_cell_key_rays(right)) &&
           bb_same_text(a, b, BB_F_TRACE_RAYS_HASH) && bb_run_of(a) == bb_run_of(b);
}

/* The rate of wrong answers: capital letters above the limit, small ones for reference and inexact
 * rows, whose errors are expected. */
static void put_wrong(bb_page *page, const bb_entry *trace)
{
    const double ppm = bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM);
    const bool failed =
        bb_get_true(trace, BB_F_TRACE_WRONG) && bb_get_true(trace, BB_F_TRACE_COUNTS);
    char rate[BB_FIGURE_MAX], text[BB_FIGURE_MAX];
    snprintf(text, sizeof text, "%.24s%s%s%s", bb_figure(rate, ppm, -1),
             failed    ? " WRONG"
             : ppm > 0 ? " wrong"
                       : "",
             bb_get_number(trace, BB_F_TRACE_UNLIKE) > 0 ? " unlike" : "",
             bb_get_number(trace, BB_F_ACCURACY_OVERFLOWED) > 0 ? " OVERFLOW" : "");
    bb_page_put_text(page, isfinite(ppm) ? text : bb_is_ok(trace) ? "unchecked" : "-");
}

/* Missed, false and wrong t, in rays. */
static void put_classes(bb_page *page, const bb_entry *trace)
{
    char text[BB_FIGURE_MAX] = "-";
    if (isfinite(bb_get_number(trace, BB_F_ACCURACY_CHECKED)))
        snprintf(text, sizeof text, "%.0f/%.0f/%.0f", bb_get_number(trace, BB_F_ACCURACY_MISSED),
                 bb_get_number(trace, BB_F_ACCURACY_FALSE),
                 bb_get_number(trace, BB_F_ACCURACY_WRONG_T));
    bb_page_put_text(page, text);
}

/* The kernel, a star if its layout keeps the builder's own tree, and the intersector where it is
 * not the default. */
static void put_kernel(bb_page *page, const bb_entry *trace)
{
    const char *intersector = bb_get_text(trace, BB_F_TRACE_INTERSECTOR);
    const bool shown = intersector[0] != '\0' && strcmp(intersector, "exact") != 0 &&
                       !bb_get_true(trace, BB_F_TRACE_REFERENCE);
    char name[640];
    snprintf(name, sizeof name, "%s%s%s%s", bb_get_text(trace, BB_F_TRACE_KERNEL),
             bb_get_true(trace, BB_F_TRACE_NATIVE) ? " *" : "", shown ? " / " : "",
             shown ? intersector : "");
    bb_page_put_text(page, name);
}

/* Why there are no figures; or how many rays of the set were traced, if not all: brute force traces
 * only the first of them. */
static void put_rest(bb_page *page, const bb_entry *trace, double all)
{
    const double count = bb_get_number(trace, BB_F_TRACE_COUNT);
    char number[BB_FIGURE_MAX], text[BB_FIGURE_MAX + 32] = "";
    if (!bb_is_ok(trace))
        snprintf(text, sizeof text, "%.100s", bb_get_text(trace, BB_F_TRACE_STATUS));
    else if (count < all)
        snprintf(text, sizeof text, "of the first %s rays", bb_figure(number, count, 0));
    bb_page_put_text(page, text);
}

/* Rays of the set, how they were made, and what is asked of them in the query's own words; one that
 * is not known here, as of another plug-in, is named. */
static void begin_set(bb_page *page, const bb_entry *first, double count, const char *embree)
{
    char number[BB_FIGURE_MAX], text[1024], ratio[64];
    const char *view = bb_get_text(first, BB_F_TRACE_VIEW);
    const char *query = bb_get_text(first, BB_F_TRACE_QUERY);
    const bb_query *known = bb_query_find(query);
    const bool given = strcmp(bb_get_text(first, BB_F_TRACE_RAYS_SOURCE), "as given") == 0;
    snprintf(text, sizeof text, "%.300s%s%s%.300s: %s rays%s%.200s",
             bb_get_text(first, BB_F_TRACE_RAYS), given ? " (rays as given)" : "",
             view[0] != '\0' ? ", view " : "", view, bb_figure(number, count, 0),
             query[0] != '\0' ? ", " : "", known != NULL ? known->asks : query);
    snprintf(ratio, sizeof ratio, "/%s", embree);
    bb_page_grid(page, text);
    add_columns(page, (const bb_field_id[]){BB_F_TRACE_BUILDER, BB_F_TRACE_KERNEL, BB_F_TRACE_RATE},
                3);
    add_columns(page, (const bb_field_id[]){BB_F_ACCURACY_WRONG_PPM}, 1);
    bb_page_column(page, ratio, "", "", -1);
    bb_page_column(page, "mis/fal/t", "", "", 0);
    add_columns(page, of_traces, OF_TRACES);
    bb_page_column(page, "", "", "", 0);
}

/* Ratios are to the fastest row of the reference on the same rays. */
static void add_set(bb_page *page, const bb_section *traces, const bb_entry *first,
                    const char *embree)
{
    double count = 0, reference = NAN;
    bb_each(trace, traces)
    {
        if (!same_rays(trace, first))
            continue;
        count = fmax(count, bb_get_number(trace, BB_F_TRACE_COUNT));
        if (bb_is_reference(bb_get_text(trace, BB_F_TRACE_BUILDER)))
            reference = fmax(reference, bb_get_number(trace, BB_F_TRACE_RATE));
    }
    begin_set(page, first, count, embree);
    bb_each(trace, traces)
    {
        if (!same_rays(trace, first))
            continue;
        put_builder(page, trace, BB_F_TRACE_BUILDER);
        put_kernel(page, trace);
        put_median(page, trace, BB_F_TRACE_RATE, BB_F_TRACE_RATE_LO);
        put_wrong(page, trace);
        put_number(page, bb_get_number(trace, BB_F_TRACE_RATE) / reference);
        put_classes(page, trace);
        put_fields(page, trace, of_traces, OF_TRACES);
        put_rest(page, trace, count);
    }
}

static void add_traces(bb_page *page, const bb_results *results, const char *scene)
{
    const bb_section *traces = bb_results_section(results, BB_TRACES);
    bb_each(trace, traces)
    {
        const bb_entry *earlier = bb_first(traces);
        if (strcmp(bb_get_text(trace, BB_F_TRACE_SCENE), scene) != 0)
            continue;
        while (earlier != trace && !same_rays(earlier, trace))
            earlier = bb_next(earlier);
        if (earlier == trace)
            add_set(page, traces, trace, bb_results_reference(results));
    }
}

/* ---- all of it ---- */

/* Judged files do not say what was compiled, or what the clocks said. Runs merged with one that has
 * no total have steps alone. */
static void add_run(bb_page *page, const bb_results *results)
{
    const bb_entry *context = bb_results_context(results);
    char sum[BB_FIGURE_MAX];
    double total = 0;
    bb_each(step, bb_results_section(results, BB_STEPS))
    {
        const double ms = bb_get_number(step, BB_F_STEP_MS);
        total += isfinite(ms) ? ms : 0;
    }
    show(&times_view, results, NULL, page);
    if (total > 0 && !isfinite(bb_results_time_ms(results, "total")))
        bb_page_say(page, "all steps together: %s ms", bb_figure(sum, total, -1));
    if (isfinite(bb_get_number(context, BB_F_CONTEXT_PROGRAMS)))
        bb_page_say(page, "%.0f programs compiled in %.1f s by driver %s, kernel cache %s",
                    bb_get_number(context, BB_F_CONTEXT_PROGRAMS),
                    1e-3 * bb_get_number(context, BB_F_CONTEXT_COMPILE),
                    bb_get_text(context, BB_F_CONTEXT_DRIVER),
                    bb_get_text(context, BB_F_CONTEXT_CACHE));
    if (isfinite(bb_get_number(context, BB_F_CONTEXT_AUDIT_TIMINGS)))
        bb_page_say(page,
                    "%.0f timings were held against the clocks of the devices, %.0f rates against "
                    "what was judged: %.0f contradict each other",
                    bb_get_number(context, BB_F_CONTEXT_AUDIT_TIMINGS),
                    bb_get_number(context, BB_F_CONTEXT_AUDIT_RATES),
                    bb_get_number(context, BB_F_CONTEXT_AUDIT_COMPLAINTS));
}

static void add_legend(bb_page *page, const bb_results *results)
{
    bb_page_note(
        page,
        "[a, b]: 95 %% interval of the median by order statistics. range: the lowest and "
        "the highest of too few rounds for an interval, which takes %d; of one round there "
        "is neither.",
        BB_INTERVAL_ROUNDS);
    bb_page_note(page, "What trees cost: error: typical deviation of the time; r: correlation of "
                       "logarithms; both with a factor of its own for each ray set and kernel. "
                       "least, most: of alpha with one scene left out; unseen: deviation on the "
                       "scene that was.");
    if (bb_section_count(bb_results_section(results, BB_TRACES)) == 0)
        return;
    bb_page_note(page, "First ray: boxes, build, transfer and layout, in ms.");
    bb_page_note(page, "*: native, the layout keeps the shape of the builder's own tree.");
    bb_page_note(page, "/%s: to the fastest embree-native row on the same rays.",
                 bb_results_reference(results));
    bb_page_note(page, "Wrong ppm: wrong rays per million; unlike: answers unlike those of other "
                       "cells with `exact`; mis/fal/t: rays missed, false hits, wrong distance.");
    bb_page_note(page, "Box tests, Prim. tests: per ray, from a separate counting run; Work: 1.2 "
                       "for each pair of boxes, 1 for each primitive.");
}

bb_status bb_report_table(const bb_results *results, FILE *out)
{
    const bb_entry *context = bb_results_context(results);
    bb_page *page;
    BB_TRY(bb_page_create("bvhbench", &page));
    bb_page_widen(page);
    bb_page_say(page, "bvhbench %s on %s", bb_get_text(context, BB_F_CONTEXT_REVISION),
                bb_get_text(context, BB_F_CONTEXT_DEVICE));
    bb_each(scene, bb_results_section(results, BB_SCENES))
    {
        const char *name = bb_get_text(scene, BB_F_SCENE_NAME);
        char count[BB_FIGURE_MAX], heading[600];
        snprintf(heading, sizeof heading, "%.300s: %s %.100s", name,
                 bb_figure(count, bb_get_number(scene, BB_F_SCENE_PRIMS), 0),
                 bb_get_text(scene, BB_F_SCENE_KIND));
        bb_page_heading(page, heading);
        add_builds(page, results, name);
        add_traces(page, results, name);
        show(&reasons_view, results, name, page);
    }
    show(&predictions_view, results, NULL, page);
    show(&skipped_view, results, NULL, page);
    add_run(page, results);
    add_legend(page, results);
    return bb_page_end(page, bb_page_print, out);
}
