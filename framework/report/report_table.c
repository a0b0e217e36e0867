/* The report on the terminal: per scene its builds, then its traces by ray set; at the end what was
 * skipped, and where the time went.
 *
 * A speed is never printed without the wrong-answer rate of the same rays beside it.
 */
#include "framework/judge/queries.h"
#include "framework/report/columns.h"
#include "framework/report/report.h"
#include "framework/report/report_prediction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- builds ---- */

/* What a build's row has behind its time: fields and metrics of the tree, each as wide as it needs.
 */
typedef struct tree_columns {
    const bb_metric
        *metrics[BB_METRICS_MAX]; /* those that were measured, of any build of the file */
    uint32_t count;
} tree_columns;

static const bb_field_id after_metrics[] = {BB_F_TREE_DEPTH, BB_F_TREE_BYTES, BB_F_TREE_BYTES_PEAK};
enum { AFTER_METRICS = sizeof after_metrics / sizeof after_metrics[0] };

/* Those that are always measured, then those on request. */
static tree_columns choose_columns(const bb_section *builds)
{
    tree_columns columns = {.count = 0};
    for (int on_request = 0; on_request < 2; on_request++)
        for (uint32_t i = 0; i < bb_metric_count(); i++)
            if (bb_metrics[i]->on_request == on_request &&
                bb_metric_measured(builds, bb_metrics[i]))
                columns.metrics[columns.count++] = bb_metrics[i];
    return columns;
}

static int metric_width(const bb_metric *metric)
{
    return bb_larger(7, (int)strlen(metric->title));
}

static void print_heading(FILE *out, const bb_medians *times, const tree_columns *columns,
                          int width)
{
    fprintf(out, "\n  %-*s  %8s  %-9s  %-*s  %9s  %9s", width,
            bb_fields[BB_F_BUILD_BUILDER].heading, bb_fields[BB_F_BUILD_RATE].heading,
            bb_fields[BB_F_BUILD_HANDOVER].heading, times->width, times->heading, "Layout ms",
            "First ray");
    for (uint32_t i = 0; i < columns->count; i++)
        fprintf(out, "  %*s", metric_width(columns->metrics[i]), columns->metrics[i]->title);
    for (size_t i = 0; i < AFTER_METRICS; i++)
        fprintf(out, "  %8s", bb_fields[after_metrics[i]].heading);
    fputc('\n', out);
}

/* Why a row has no figures; false if it has. */
static bool print_reason(FILE *out, const bb_entry *row, bb_field_id status, bb_field_id reason)
{
    if (bb_is_ok(row))
        return false;
    fputs("  ", out);
    bb_print_text(out, bb_get_text(row, status), 0);
    fputs(": ", out);
    bb_print_text(out, bb_get_text(row, reason), 0);
    fputc('\n', out);
    return true;
}

static void print_tree(FILE *out, const bb_entry *build, const tree_columns *columns)
{
    char entry[BB_ENTRY];
    double native = bb_get_number(build, BB_F_BUILD_BYTES_NATIVE);
    for (uint32_t i = 0; i < columns->count; i++) {
        bb_figure(entry, bb_get_metric(build, columns->metrics[i]), -1);
        fprintf(out, "  %*s", metric_width(columns->metrics[i]), entry);
    }
    for (size_t i = 0; i < AFTER_METRICS; i++) {
        bb_text_field(entry, build, after_metrics[i]);
        if (after_metrics[i] == BB_F_TREE_BYTES && isfinite(native))
            bb_figure_bytes(entry, native);
        fprintf(out, "  %8s", entry);
    }
    fputc('\n', out);
}

/* Of a pipeline: what each step took, the SAH of the tree after it, and the memory. */
static void print_stages(FILE *out, const bb_entry *build)
{
    const char *after = "    stages:";
    bb_each_part(stage, build, BB_F_BUILD_STAGES)
    {
        char ms[BB_ENTRY], sah[BB_ENTRY], bytes[BB_ENTRY];
        const char *name = bb_part_name(stage);
        bb_figure(ms, bb_get_number(stage, BB_F_BUILD_STAGES), -1);
        double cost = bb_get_named(build, BB_F_BUILD_STAGES_SAH, name);
        double peak = bb_get_named(build, BB_F_BUILD_STAGES_PEAK, name);
        bb_figure(sah, cost, -1);
        bb_figure_bytes(bytes, peak);
        fprintf(out, "%s ", after);
        bb_print_text(out, name, 0);
        fprintf(out, " %s ms", ms);
        if (isfinite(cost))
            fprintf(out, ", SAH %s", sah);
        if (isfinite(peak))
            fprintf(out, ", %s", bytes);
        after = ";";
    }
    if (after[0] == ';')
        fputc('\n', out);
}

static void print_build(FILE *out, const bb_entry *build, int width, const bb_medians *times,
                        const tree_columns *columns)
{
    const bb_entry *layout = bb_first_part(build, BB_F_BUILD_LAYOUTS_MS);
    char rate[BB_ENTRY], ms[BB_ENTRY], conversion[BB_ENTRY], first[BB_ENTRY];
    fputs("  ", out);
    bb_print_text(out, bb_get_text(build, BB_F_BUILD_BUILDER), width);
    if (print_reason(out, build, BB_F_BUILD_STATUS, BB_F_BUILD_REASON))
        return;
    bb_text_field(rate, build, BB_F_BUILD_RATE);
    bb_medians_text(ms, times, build);
    bb_figure(conversion,
              layout != NULL ? bb_get_number(layout, BB_F_BUILD_LAYOUTS_MS) : (double)NAN, -1);
    bb_figure(first, bb_first_ray_ms(build, layout != NULL ? bb_part_name(layout) : ""), -1);
    fprintf(out, "  %8s  %-9s  %-*s  %9s  %9s", rate, bb_get_text(build, BB_F_BUILD_HANDOVER),
            times->width, ms, conversion, first);
    print_tree(out, build, columns);
    const char *about = bb_get_text(build, BB_F_BUILD_ABOUT);
    if (about[0] != '\0') {
        fputs("    ", out);
        bb_print_text(out, about, 0);
        fputc('\n', out);
    }
    print_stages(out, build);
    if (layout == NULL || bb_next_part(layout, BB_F_BUILD_LAYOUTS_MS) == NULL)
        return;
    fputs("    layouts:", out);
    for (; layout != NULL; layout = bb_next_part(layout, BB_F_BUILD_LAYOUTS_MS)) {
        bb_figure(conversion, bb_get_number(layout, BB_F_BUILD_LAYOUTS_MS), -1);
        fputc(' ', out);
        bb_figure(first, bb_first_ray_ms(build, bb_part_name(layout)), -1);
        bb_print_text(out, bb_part_name(layout), 0);
        fprintf(out, " %s ms, first ray %s%s", conversion, first,
                bb_next_part(layout, BB_F_BUILD_LAYOUTS_MS) != NULL ? ";" : "\n");
    }
}

static void print_builds(FILE *out, const bb_section *builds, const char *scene)
{
    bb_medians times = {.median = BB_F_BUILD_MS_MEDIAN, .low = BB_F_BUILD_MS_LO};
    const tree_columns columns = choose_columns(builds);
    int width = 7, rows = 0;
    bb_each(build, builds)
    {
        if (strcmp(bb_get_text(build, BB_F_BUILD_SCENE), scene) != 0)
            continue;
        width = bb_larger(width, (int)strlen(bb_get_text(build, BB_F_BUILD_BUILDER)));
        bb_medians_take(&times, build);
        rows++;
    }
    if (rows == 0)
        return;
    bb_medians_finish(&times);
    print_heading(out, &times, &columns, width);
    bb_each(build, builds)
    {
        if (strcmp(bb_get_text(build, BB_F_BUILD_SCENE), scene) == 0)
            print_build(out, build, width, &times, &columns);
    }
}

/* ---- traces ---- */

/* The very same rays, from the same run. */
static bool same_rays(const bb_entry *a, const bb_entry *b)
{
    const char *left = bb_get_text(a, BB_F_TRACE_CELL), *right = bb_get_text(b, BB_F_TRACE_CELL);
    return bb_cell_key_same(left, bb_cell_key_rays(left), right, bb_cell_key_rays(right)) &&
           bb_same_text(a, b, BB_F_TRACE_RAYS_HASH) && bb_run_of(a) == bb_run_of(b);
}

/* Mrays/s of the fastest reference row on the rays of `trace`; NAN if there is none. */
static double reference_rate(const bb_section *traces, const bb_entry *trace)
{
    double best = NAN;
    bb_each(other, traces)
    {
        if (bb_get_true(other, BB_F_TRACE_REFERENCE) && same_rays(other, trace))
            best = fmax(best, bb_get_number(other, BB_F_TRACE_RATE));
    }
    return best;
}

/* "0", "12.3 WRONG": capital letters above the limit, small ones for reference and inexact rows,
 * whose errors are expected. */
static void wrong_entry(char entry[BB_ENTRY], const bb_entry *trace)
{
    double ppm = bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM);
    double overflowed = bb_get_number(trace, BB_F_ACCURACY_OVERFLOWED);
    char rate[BB_ENTRY];
    if (!isfinite(ppm)) {
        snprintf(entry, BB_ENTRY, "unchecked");
        return;
    }
    bb_figure(rate, ppm, -1);
    bool failed = bb_get_true(trace, BB_F_TRACE_WRONG) && bb_get_true(trace, BB_F_TRACE_COUNTS);
    const char *mark = failed ? " WRONG" : ppm > 0 ? " wrong" : "";
    snprintf(entry, BB_ENTRY, "%.24s%s%s%s", ppm == 0 ? "0" : rate, mark,
             bb_get_number(trace, BB_F_TRACE_UNLIKE) > 0 ? " unlike" : "",
             overflowed > 0 ? " OVERFLOW" : "");
}

/* Missed, false and wrong t, in rays. */
static void classes_entry(char entry[BB_ENTRY], const bb_entry *trace)
{
    if (isnan(bb_get_number(trace, BB_F_ACCURACY_CHECKED)))
        snprintf(entry, BB_ENTRY, "-");
    else
        snprintf(entry, BB_ENTRY, "%.0f/%.0f/%.0f", bb_get_number(trace, BB_F_ACCURACY_MISSED),
                 bb_get_number(trace, BB_F_ACCURACY_FALSE),
                 bb_get_number(trace, BB_F_ACCURACY_WRONG_T));
}

/* The kernel, a star if its layout keeps the builder's own tree, and the intersector where it is
 * not the default; 0-terminated in `name`. */
static void kernel_name(const bb_entry *trace, char *name, size_t capacity)
{
    const char *intersector = bb_get_text(trace, BB_F_TRACE_INTERSECTOR);
    bool shown = intersector[0] != '\0' && strcmp(intersector, "exact") != 0 &&
                 !bb_get_true(trace, BB_F_TRACE_REFERENCE);
    snprintf(name, capacity, "%s%s%s%s", bb_get_text(trace, BB_F_TRACE_KERNEL),
             bb_get_true(trace, BB_F_TRACE_NATIVE) ? " *" : "", shown ? " / " : "",
             shown ? intersector : "");
}

/* What the rows of one ray set share. */
typedef struct group {
    double reference;   /* Mrays/s; NAN if there is none */
    double count;       /* rays of the set: brute force traces only the first of them */
    const char *embree; /* what the ratios are to */
    int builder_width, kernel_width, ratio_width;
    bb_medians rates;
} group;

static void print_trace(FILE *out, const bb_entry *trace, const group *set)
{
    char kernel[640], rate[BB_ENTRY], ratio[BB_ENTRY], wrong[BB_ENTRY], classes[BB_ENTRY],
        nodes[BB_ENTRY], prims[BB_ENTRY], work[BB_ENTRY];
    kernel_name(trace, kernel, sizeof kernel);
    fputs("  ", out);
    bb_print_text(out, bb_get_text(trace, BB_F_TRACE_BUILDER), set->builder_width);
    fputs("  ", out);
    bb_print_text(out, kernel, set->kernel_width);
    if (print_reason(out, trace, BB_F_TRACE_STATUS, BB_F_TRACE_REASON))
        return;
    double speed = bb_get_number(trace, BB_F_TRACE_RATE);
    bb_medians_text(rate, &set->rates, trace);
    bb_figure(ratio, speed / set->reference, -1);
    wrong_entry(wrong, trace);
    classes_entry(classes, trace);
    bb_text_field(nodes, trace, BB_F_TRACE_NODE_TESTS);
    bb_text_field(prims, trace, BB_F_TRACE_PRIM_TESTS);
    bb_text_field(work, trace, BB_F_TRACE_WORK);
    fprintf(out, "  %-*s  %*s  %-12s  %-10s  %9s  %11s  %7s", set->rates.width, rate,
            set->ratio_width, ratio, wrong, classes, nodes, prims, work);
    if (bb_get_number(trace, BB_F_TRACE_COUNT) < set->count) {
        bb_figure(rate, bb_get_number(trace, BB_F_TRACE_COUNT), 0);
        fprintf(out, "  of the first %s rays", rate);
    }
    fputc('\n', out);
}

/* In its own words; one that is not known here, as of another plug-in, by its name. */
static void print_query(FILE *out, const char *name)
{
    const bb_query *query = bb_query_find(name);
    if (name[0] == '\0')
        return;
    fputs(", ", out);
    bb_print_text(out, query != NULL ? query->asks : name, 0);
}

static void print_group(FILE *out, const bb_section *traces, const bb_entry *first,
                        const char *embree)
{
    group set = {.reference = reference_rate(traces, first),
                 .embree = embree,
                 .builder_width = 7,
                 .kernel_width = 6,
                 .ratio_width = 1 + (int)strlen(embree),
                 .rates = {.median = BB_F_TRACE_RATE, .low = BB_F_TRACE_RATE_LO}};
    char count[BB_ENTRY], kernel[640];
    bb_each(trace, traces)
    {
        if (!same_rays(trace, first))
            continue;
        kernel_name(trace, kernel, sizeof kernel);
        set.builder_width =
            bb_larger(set.builder_width, (int)strlen(bb_get_text(trace, BB_F_TRACE_BUILDER)));
        set.kernel_width = bb_larger(set.kernel_width, (int)strlen(kernel));
        set.count = fmax(set.count, bb_get_number(trace, BB_F_TRACE_COUNT));
        bb_medians_take(&set.rates, trace);
    }
    bb_medians_finish(&set.rates);
    bb_figure(count, set.count, 0);
    fputs("\n  ", out);
    bb_print_text(out, bb_get_text(first, BB_F_TRACE_RAYS), 0);
    if (strcmp(bb_get_text(first, BB_F_TRACE_RAYS_SOURCE), "as given") == 0)
        fputs(" (rays as given)", out);
    if (bb_get_text(first, BB_F_TRACE_VIEW)[0] != '\0') {
        fputs(", view ", out);
        bb_print_text(out, bb_get_text(first, BB_F_TRACE_VIEW), 0);
    }
    fprintf(out, ": %s rays", count);
    print_query(out, bb_get_text(first, BB_F_TRACE_QUERY));
    fputc('\n', out);
    fprintf(out, "  %-*s  %-*s  %-*s  /%s  %-12s  %-10s  %9s  %11s  %7s\n", set.builder_width,
            bb_fields[BB_F_TRACE_BUILDER].heading, set.kernel_width,
            bb_fields[BB_F_TRACE_KERNEL].heading, set.rates.width, set.rates.heading, set.embree,
            bb_fields[BB_F_ACCURACY_WRONG_PPM].heading, "mis/fal/t",
            bb_fields[BB_F_TRACE_NODE_TESTS].heading, bb_fields[BB_F_TRACE_PRIM_TESTS].heading,
            bb_fields[BB_F_TRACE_WORK].heading);
    bb_each(trace, traces)
    {
        if (same_rays(trace, first))
            print_trace(out, trace, &set);
    }
}

static void print_traces(FILE *out, const bb_section *traces, const char *scene, const char *embree)
{
    bb_each(trace, traces)
    {
        if (strcmp(bb_get_text(trace, BB_F_TRACE_SCENE), scene) != 0)
            continue;
        const bb_entry *earlier = bb_first(traces);
        while (earlier != trace && !same_rays(earlier, trace))
            earlier = bb_next(earlier);
        if (earlier == trace)
            print_group(out, traces, trace, embree);
    }
}

/* ---- skipped sets, times ---- */

static void print_skipped(FILE *out, const bb_section *skipped)
{
    if (bb_first(skipped) == NULL)
        return;
    fputs("\nskipped\n", out);
    bb_each(set, skipped)
    {
        const char *view = bb_get_text(set, BB_F_SKIPPED_VIEW);
        fputs("  ", out);
        bb_print_text(out, bb_get_text(set, BB_F_SKIPPED_SCENE), 0);
        fputs(": ", out);
        bb_print_text(out, bb_get_text(set, BB_F_SKIPPED_RAYS), 0);
        fputs(view[0] != '\0' ? ", view " : "", out);
        bb_print_text(out, view, 0);
        fputs(": ", out);
        bb_print_text(out, bb_get_text(set, BB_F_SKIPPED_REASON), 0);
        fputc('\n', out);
    }
}

static void print_seconds(FILE *out, const char *name, double ms)
{
    fputs("  ", out);
    bb_print_text(out, name, 32);
    if (isfinite(ms))
        fprintf(out, " %9.3f s\n", ms / 1e3);
    else
        fputs("         -\n", out);
}

/* Runs merged with one that has no total have the steps only. */
static void print_times(FILE *out, const bb_results *results)
{
    const bb_section *steps = bb_results_section(results, BB_STEPS);
    const bool whole = isfinite(bb_results_time_ms(results, "total"));
    double total = 0;
    if (bb_first(steps) == NULL)
        return;
    fputs(whole ? "\nwhere the time went\n" : "\ntime outside build and trace\n", out);
    if (whole) {
        print_seconds(out, "builds, timed", bb_results_time_ms(results, "build"));
        print_seconds(out, "traces, timed", bb_results_time_ms(results, "trace"));
    }
    bb_each(step, steps)
    {
        const double ms = bb_get_number(step, BB_F_STEP_MS);
        if (isnan(ms)) /* of the times alone */
            continue;
        print_seconds(out, bb_part_name(step), ms);
        total += ms;
    }
    if (whole) {
        print_seconds(out, "not accounted for", bb_results_time_ms(results, "other"));
        total = bb_results_time_ms(results, "total");
    }
    print_seconds(out, "total", total);
}

/* Judged files do not say: nothing was compiled for them. */
static void print_compiling(FILE *out, const bb_entry *context)
{
    if (isnan(bb_get_number(context, BB_F_CONTEXT_PROGRAMS)))
        return;
    fprintf(out, "\n%.0f programs compiled in %.1f s by driver ",
            bb_get_number(context, BB_F_CONTEXT_PROGRAMS),
            1e-3 * bb_get_number(context, BB_F_CONTEXT_COMPILE));
    bb_print_text(out, bb_get_text(context, BB_F_CONTEXT_DRIVER), 0);
    fputs(", kernel cache ", out);
    bb_print_text(out, bb_get_text(context, BB_F_CONTEXT_CACHE), 0);
    fputc('\n', out);
}

static void print_audit(FILE *out, const bb_entry *context)
{
    if (isnan(bb_get_number(context, BB_F_CONTEXT_AUDIT_TIMINGS)))
        return;
    fprintf(
        out,
        "\n%.0f timings were held against the clocks of the devices, %.0f rates against what was "
        "judged: %.0f contradict each other\n",
        bb_get_number(context, BB_F_CONTEXT_AUDIT_TIMINGS),
        bb_get_number(context, BB_F_CONTEXT_AUDIT_RATES),
        bb_get_number(context, BB_F_CONTEXT_AUDIT_COMPLAINTS));
}

/* What the tables' headings mean. `embree`: what traces are held against; NULL: there are none. */
static void print_legend(FILE *out, const char *embree)
{
    fprintf(out,
            "\n[95 %%]: interval of the median by order statistics. [range]: the lowest and the "
            "highest of too\nfew rounds for an interval, which takes %d; of one round there is "
            "neither.\n",
            BB_INTERVAL_ROUNDS);
    if (embree != NULL)
        fprintf(out,
                "First ray: boxes, build, transfer and layout, in ms.\n*: native, the layout keeps "
                "the shape of the builder's own tree.\n"
                "/%s: to the fastest embree-native row on the same rays.\n"
                "Wrong ppm: wrong rays per million; unlike: answers unlike those of other cells "
                "with `exact`;\nmis/fal/t: rays missed, false hits, wrong distance.\nBox tests, "
                "Prim. tests: per ray, from a separate counting run; Work: 1.2 for each pair of "
                "boxes, 1 for each primitive.\n",
                embree);
}

bb_status bb_report_table(const bb_results *results, FILE *out)
{
    const bb_entry *context = bb_results_context(results);
    const bb_section *builds = bb_results_section(results, BB_BUILDS);
    const bb_section *traces = bb_results_section(results, BB_TRACES);
    fprintf(out, "bvhbench ");
    bb_print_text(out, bb_get_text(context, BB_F_CONTEXT_REVISION), 0);
    fputs(" on ", out);
    bb_print_text(out, bb_get_text(context, BB_F_CONTEXT_DEVICE), 0);
    fputc('\n', out);
    bb_each(scene, bb_results_section(results, BB_SCENES))
    {
        const char *name = bb_get_text(scene, BB_F_SCENE_NAME);
        char count[BB_ENTRY];
        bb_figure(count, bb_get_number(scene, BB_F_SCENE_PRIMS), 0);
        fputc('\n', out);
        bb_print_text(out, name, 0);
        fprintf(out, ": %s ", count);
        bb_print_text(out, bb_get_text(scene, BB_F_SCENE_KIND), 0);
        fputc('\n', out);
        print_builds(out, builds, name);
        print_traces(out, traces, name, bb_results_reference(results));
    }
    BB_TRY(bb_report_predictions(results, out));
    print_skipped(out, bb_results_section(results, BB_SKIPPED));
    print_times(out, results);
    print_compiling(out, context);
    print_audit(out, context);
    print_legend(out, bb_section_count(traces) > 0 ? bb_results_reference(results) : NULL);
    return ferror(out) ? bb_fail(BB_FAILED, "cannot write the table") : BB_OK;
}
