/* The report on the terminal: per scene its builds, then its traces by ray set; at the end what was
 * skipped, and where the time went.
 *
 * A speed is never printed without the wrong-answer rate of the same rays beside it.
 */
#include "framework/record/record_private.h"
#include "framework/report/report.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELL = 64 };

/* ---- cells ---- */

/* Significant digits rather than decimals: 0.0123, 1.23, 123, 12345. "-" if not measured. */
static void figure(char cell[CELL], double value)
{
    if (!isfinite(value))
        snprintf(cell, CELL, "-");
    else if (value != 0 && (fabs(value) < 1e-4 || fabs(value) >= 1e7))
        snprintf(cell, CELL, "%.3g", value);
    else
        snprintf(cell, CELL, "%.*f",
                 fabs(value) >= 1000   ? 0
                 : fabs(value) >= 100  ? 1
                 : fabs(value) >= 1    ? 2
                 : fabs(value) >= 0.01 ? 3
                                       : 5,
                 value);
}

static int larger(int a, int b)
{
    return a > b ? a : b;
}

/* What the brackets behind a figure hold. */
typedef enum spread { NOTHING, RANGE, INTERVAL } spread;

/* Of NAME of a build or a trace: the interval where there are rounds enough for one, else their
 * range; of a single round nothing. */
static spread spread_of(const cJSON *entry, const char *name, double *low, double *high)
{
    static const struct {
        spread kind;
        const char *low, *high;
    } kinds[] = {{INTERVAL, "lo", "hi"}, {RANGE, "least", "most"}};
    char label[64];
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        snprintf(label, sizeof label, "%s_%s", name, kinds[i].low);
        *low = bb_json_number(entry, label);
        snprintf(label, sizeof label, "%s_%s", name, kinds[i].high);
        *high = bb_json_number(entry, label);
        if (isfinite(*low) && isfinite(*high))
            return kinds[i].kind;
    }
    return NOTHING;
}

/* "41.2 [40.1, 43.0]", or "41.2" */
static spread with_spread(char cell[CELL], const cJSON *entry, const char *name, double value)
{
    char middle[CELL], left[CELL], right[CELL];
    double low, high;
    spread kind = spread_of(entry, name, &low, &high);
    figure(middle, value);
    figure(left, low);
    figure(right, high);
    if (kind == NOTHING)
        snprintf(cell, CELL, "%s", middle);
    else
        snprintf(cell, CELL, "%.16s [%.16s, %.16s]", middle, left, right);
    return kind;
}

/* A column of medians. Its heading says what the brackets hold; a range among intervals says so
 * itself. */
typedef struct column {
    const char *title, *name, *median; /* as printed; of the members of a row */
    char heading[CELL];
    int widths[INTERVAL + 1]; /* of the rows with such a spread; 0: there is none */
} column;

static void take_row(column *c, const cJSON *entry)
{
    char cell[CELL];
    spread kind = with_spread(cell, entry, c->name, bb_json_number(entry, c->median));
    c->widths[kind] = larger(c->widths[kind], (int)strlen(cell));
}

/* After the last row: makes the heading, returns the width. */
static int finish_column(column *c)
{
    bool intervals = c->widths[INTERVAL] > 0, ranges = c->widths[RANGE] > 0;
    snprintf(c->heading, CELL, "%s%s", c->title, intervals ? " [95 %]" : ranges ? " [range]" : "");
    int range = c->widths[RANGE] + (intervals && ranges ? (int)strlen(" range") : 0);
    return larger((int)strlen(c->heading),
                  larger(range, larger(c->widths[NOTHING], c->widths[INTERVAL])));
}

static void column_cell(char cell[CELL], const column *c, const cJSON *entry)
{
    spread kind = with_spread(cell, entry, c->name, bb_json_number(entry, c->median));
    if (kind == RANGE && c->widths[INTERVAL] > 0)
        strncat(cell, " range", CELL - strlen(cell) - 1);
}

static void bytes(char cell[CELL], double value)
{
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    if (!isfinite(value)) {
        snprintf(cell, CELL, "-");
        return;
    }
    unsigned unit = 0;
    for (; value >= 1024 && unit < 4; unit++)
        value /= 1024;
    snprintf(cell, CELL, "%.*f %s", value < 10 && unit > 0 ? 1 : 0, value, units[unit]);
}

/* 1234567 -> "1,234,567" */
static void grouped(char cell[CELL], double value)
{
    char digits[CELL];
    if (!isfinite(value) || value < 0 || value > 1e15) {
        figure(cell, value);
        return;
    }
    int length = snprintf(digits, sizeof digits, "%.0f", value), at = 0;
    for (int i = 0; i < length; i++) {
        if (i > 0 && (length - i) % 3 == 0)
            cell[at++] = ',';
        cell[at++] = digits[i];
    }
    cell[at] = '\0';
}

/* What may come from a file must not steer the terminal. */
static void print_text(FILE *out, const char *text, int width)
{
    int printed = 0;
    for (; *text != '\0'; text++) {
        unsigned char c = (unsigned char)*text;
        fputc(c < 0x20 || c == 0x7F ? '?' : c, out);
        printed += (c & 0xC0) != 0x80;
    }
    for (; printed < width; printed++)
        fputc(' ', out);
}

/* ---- builds ---- */

static const cJSON *first_entry(const cJSON *object)
{
    return object != NULL ? object->child : NULL;
}

static void print_build(FILE *out, const cJSON *build, int width, const column *times,
                        int times_width)
{
    const cJSON *tree = cJSON_GetObjectItemCaseSensitive(build, "tree");
    const cJSON *layout = first_entry(cJSON_GetObjectItemCaseSensitive(build, "layouts_ms"));
    char rate[CELL], ms[CELL], conversion[CELL], sah[CELL], epo[CELL], depth[CELL], size[CELL],
        peak[CELL];
    fputs("  ", out);
    print_text(out, bb_json_text(build, "builder"), width);
    if (strcmp(bb_json_text(build, "status"), "ok") != 0) {
        fprintf(out, "  %s: ", bb_json_text(build, "status"));
        print_text(out, bb_json_text(build, "reason"), 0);
        fputc('\n', out);
        return;
    }
    double native = bb_json_number(build, "bytes_native");
    figure(rate, bb_json_number(build, "mprims_s"));
    column_cell(ms, times, build);
    figure(conversion, cJSON_IsNumber(layout) ? layout->valuedouble : (double)NAN);
    figure(sah, bb_json_number(tree, "sah"));
    figure(epo, bb_json_number(tree, "epo"));
    grouped(depth, bb_json_number(tree, "depth"));
    bytes(size, isfinite(native) ? native : bb_json_number(tree, "bytes_tree"));
    bytes(peak, bb_json_number(tree, "bytes_peak"));
    fprintf(out, "  %8s  %-*s  %9s  %7s  %6s  %5s  %8s  %8s\n", rate, times_width, ms, conversion,
            sah, epo, depth, size, peak);
    const char *about = bb_json_text(build, "about");
    if (about[0] != '\0') {
        fputs("    ", out);
        print_text(out, about, 0);
        fputc('\n', out);
    }
    if (layout == NULL || layout->next == NULL)
        return;
    fputs("    layouts:", out);
    for (; layout != NULL; layout = layout->next) {
        figure(conversion, cJSON_IsNumber(layout) ? layout->valuedouble : (double)NAN);
        fputc(' ', out);
        print_text(out, layout->string, 0);
        fprintf(out, " %s ms%s", conversion, layout->next ? "," : "\n");
    }
}

static void print_builds(FILE *out, const cJSON *builds, const char *scene)
{
    const cJSON *build;
    column times = {.title = "build ms", .name = "build_ms", .median = "build_ms_median"};
    int width = 7, rows = 0;
    cJSON_ArrayForEach(build, builds)
    {
        if (strcmp(bb_json_text(build, "scene"), scene) != 0)
            continue;
        width = larger(width, (int)strlen(bb_json_text(build, "builder")));
        take_row(&times, build);
        rows++;
    }
    if (rows == 0)
        return;
    int times_width = finish_column(&times);
    fprintf(out, "\n  %-*s  %8s  %-*s  %9s  %7s  %6s  %5s  %8s  %8s\n", width, "builder",
            "Mprims/s", times_width, times.heading, "layout ms", "SAH", "EPO", "depth", "tree",
            "peak");
    cJSON_ArrayForEach(build, builds)
    {
        if (strcmp(bb_json_text(build, "scene"), scene) == 0)
            print_build(out, build, width, &times, times_width);
    }
}

/* ---- traces ---- */

static bool same_text(const cJSON *a, const cJSON *b, const char *name)
{
    return strcmp(bb_json_text(a, name), bb_json_text(b, name)) == 0;
}

/* Same scene, view and rays, from the same run. */
static bool same_rays(const cJSON *a, const cJSON *b)
{
    double run_a = bb_json_number(a, "run"), run_b = bb_json_number(b, "run");
    return same_text(a, b, "scene") && same_text(a, b, "view") && same_text(a, b, "rays") &&
           same_text(a, b, "rays_hash") && (run_a == run_b || (isnan(run_a) && isnan(run_b)));
}

/* Mrays/s of the fastest reference row on the rays of `trace`; NAN if there is none. */
static double reference_rate(const cJSON *traces, const cJSON *trace)
{
    double best = NAN;
    const cJSON *other;
    cJSON_ArrayForEach(other, traces)
    {
        if (bb_json_true(other, "reference") && same_rays(other, trace))
            best = fmax(best, bb_json_number(other, "mrays_s"));
    }
    return best;
}

/* "0", "12.3 WRONG": capital letters above the limit, small ones for reference and inexact rows,
 * whose errors are expected. */
static void wrong_cell(char cell[CELL], const cJSON *trace)
{
    const cJSON *accuracy = cJSON_GetObjectItemCaseSensitive(trace, "accuracy");
    double ppm = bb_json_number(accuracy, "wrong_ppm");
    double overflowed = bb_json_number(accuracy, "overflowed");
    char rate[CELL];
    if (!isfinite(ppm)) {
        snprintf(cell, CELL, "unchecked");
        return;
    }
    figure(rate, ppm);
    bool failed = bb_json_true(trace, "wrong") && bb_json_true(trace, "counts_for_exit");
    const char *mark = failed ? " WRONG" : ppm > 0 ? " wrong" : "";
    snprintf(cell, CELL, "%.24s%s%s%s", ppm == 0 ? "0" : rate, mark,
             bb_json_number(trace, "unlike") > 0 ? " unlike" : "",
             overflowed > 0 ? " OVERFLOW" : "");
}

/* Missed, false and wrong t, in rays. */
static void classes_cell(char cell[CELL], const cJSON *trace)
{
    const cJSON *accuracy = cJSON_GetObjectItemCaseSensitive(trace, "accuracy");
    if (!cJSON_IsObject(accuracy))
        snprintf(cell, CELL, "-");
    else
        snprintf(cell, CELL, "%.0f/%.0f/%.0f", bb_json_number(accuracy, "missed"),
                 bb_json_number(accuracy, "false"), bb_json_number(accuracy, "wrong_t"));
}

/* The kernel, a star if its layout keeps the builder's own tree, and the intersector where it is not the
 * default; 0-terminated in `name`. */
static void kernel_name(const cJSON *trace, char *name, size_t capacity)
{
    const char *intersector = bb_json_text(trace, "intersector");
    bool shown = intersector[0] != '\0' && strcmp(intersector, "exact") != 0 &&
                 !bb_json_true(trace, "reference");
    snprintf(name, capacity, "%s%s%s%s", bb_json_text(trace, "kernel"),
             bb_json_true(trace, "native") ? " *" : "", shown ? " / " : "",
             shown ? intersector : "");
}

/* What the rows of one ray set share. */
typedef struct group {
    double reference; /* Mrays/s; NAN if there is none */
    double count;     /* rays of the set: brute force traces only the first of them */
    int builder_width, kernel_width, rates_width;
    column rates;
} group;

static void print_trace(FILE *out, const cJSON *trace, const group *set)
{
    char kernel[640], rate[CELL], ratio[CELL], wrong[CELL], classes[CELL], nodes[CELL], prims[CELL];
    kernel_name(trace, kernel, sizeof kernel);
    fputs("  ", out);
    print_text(out, bb_json_text(trace, "builder"), set->builder_width);
    fputs("  ", out);
    print_text(out, kernel, set->kernel_width);
    if (strcmp(bb_json_text(trace, "status"), "ok") != 0) {
        fprintf(out, "  %s: ", bb_json_text(trace, "status"));
        print_text(out, bb_json_text(trace, "reason"), 0);
        fputc('\n', out);
        return;
    }
    double speed = bb_json_number(trace, "mrays_s");
    column_cell(rate, &set->rates, trace);
    figure(ratio, speed / set->reference);
    wrong_cell(wrong, trace);
    classes_cell(classes, trace);
    figure(nodes, bb_json_number(trace, "node_tests_per_ray"));
    figure(prims, bb_json_number(trace, "prim_tests_per_ray"));
    fprintf(out, "  %-*s  %6s  %-12s  %-10s  %7s  %7s", set->rates_width, rate, ratio, wrong,
            classes, nodes, prims);
    if (bb_json_number(trace, "count") < set->count) {
        grouped(rate, bb_json_number(trace, "count"));
        fprintf(out, "  of the first %s rays", rate);
    }
    fputc('\n', out);
}

static void print_group(FILE *out, const cJSON *traces, const cJSON *first)
{
    const cJSON *trace;
    group set = {.reference = reference_rate(traces, first),
                 .builder_width = 7,
                 .kernel_width = 6,
                 .rates = {.title = "Mrays/s", .name = "mrays_s", .median = "mrays_s"}};
    char count[CELL], kernel[640];
    cJSON_ArrayForEach(trace, traces)
    {
        if (!same_rays(trace, first))
            continue;
        kernel_name(trace, kernel, sizeof kernel);
        set.builder_width = larger(set.builder_width, (int)strlen(bb_json_text(trace, "builder")));
        set.kernel_width = larger(set.kernel_width, (int)strlen(kernel));
        set.count = fmax(set.count, bb_json_number(trace, "count"));
        take_row(&set.rates, trace);
    }
    set.rates_width = finish_column(&set.rates);
    grouped(count, set.count);
    fputs("\n  ", out);
    print_text(out, bb_json_text(first, "rays"), 0);
    if (strcmp(bb_json_text(first, "rays_source"), "as given") == 0)
        fputs(" (rays as given)", out);
    if (bb_json_text(first, "view")[0] != '\0') {
        fputs(", view ", out);
        print_text(out, bb_json_text(first, "view"), 0);
    }
    fprintf(out, ": %s rays, %s hit\n", count,
            strcmp(bb_json_text(first, "query"), "any") == 0 ? "any" : "closest");
    fprintf(out, "  %-*s  %-*s  %-*s  %6s  %-12s  %-10s  %7s  %7s\n", set.builder_width, "builder",
            set.kernel_width, "kernel", set.rates_width, set.rates.heading, "/Embree", "wrong ppm",
            "mis/fal/t", "boxes", "prims");
    cJSON_ArrayForEach(trace, traces)
    {
        if (same_rays(trace, first))
            print_trace(out, trace, &set);
    }
}

static void print_traces(FILE *out, const cJSON *traces, const char *scene)
{
    const cJSON *trace;
    cJSON_ArrayForEach(trace, traces)
    {
        if (strcmp(bb_json_text(trace, "scene"), scene) != 0)
            continue;
        const cJSON *earlier = traces->child;
        while (earlier != trace && !same_rays(earlier, trace))
            earlier = earlier->next;
        if (earlier == trace)
            print_group(out, traces, trace);
    }
}

/* ---- skipped sets, times ---- */

static void print_skipped(FILE *out, const cJSON *skipped)
{
    const cJSON *set;
    if (first_entry(skipped) == NULL)
        return;
    fputs("\nskipped\n", out);
    cJSON_ArrayForEach(set, skipped)
    {
        const char *view = bb_json_text(set, "view");
        fputs("  ", out);
        print_text(out, bb_json_text(set, "scene"), 0);
        fputs(": ", out);
        print_text(out, bb_json_text(set, "rays"), 0);
        fputs(view[0] != '\0' ? ", view " : "", out);
        print_text(out, view, 0);
        fputs(": ", out);
        print_text(out, bb_json_text(set, "reason"), 0);
        fputc('\n', out);
    }
}

static void print_seconds(FILE *out, const char *name, double ms)
{
    fputs("  ", out);
    print_text(out, name, 32);
    if (isfinite(ms))
        fprintf(out, " %9.3f s\n", ms / 1e3);
    else
        fputs("         -\n", out);
}

/* Files of earlier versions have the steps only. */
static void print_times(FILE *out, const cJSON *steps, const cJSON *times)
{
    const cJSON *step;
    double total = 0;
    bool whole = cJSON_IsObject(times);
    if (first_entry(steps) == NULL && !whole)
        return;
    fputs(whole ? "\nwhere the time went\n" : "\ntime outside build and trace\n", out);
    if (whole) {
        print_seconds(out, "builds, timed", bb_json_number(times, "build"));
        print_seconds(out, "traces, timed", bb_json_number(times, "trace"));
    }
    cJSON_ArrayForEach(step, steps)
    {
        if (!cJSON_IsNumber(step))
            continue;
        print_seconds(out, step->string, step->valuedouble);
        total += step->valuedouble;
    }
    if (whole) {
        print_seconds(out, "not accounted for", bb_json_number(times, "other"));
        total = bb_json_number(times, "total");
    }
    print_seconds(out, "total", total);
}

static void print_audit(FILE *out, const cJSON *audit)
{
    if (!cJSON_IsObject(audit))
        return;
    fprintf(
        out,
        "\n%.0f timings were held against the clocks of the devices, %.0f rates against what was "
        "judged: %.0f contradict each other\n",
        bb_json_number(audit, "timings"), bb_json_number(audit, "rates"),
        bb_json_number(audit, "complaints"));
}

/* What the tables' headings mean. */
static void print_legend(FILE *out, bool traced)
{
    fprintf(out,
            "\n[95 %%]: interval of the median by order statistics. [range]: the lowest and the "
            "highest of too\nfew rounds for an interval, which takes %d; of one round there is "
            "neither.\n",
            BB_INTERVAL_ROUNDS);
    if (traced)
        fputs("*: native, the layout keeps the shape of the builder's own tree.\n"
              "/Embree: to the fastest embree-native row on the same rays.\n"
              "wrong ppm: wrong rays per million; unlike: answers unlike those of other cells with "
              "`exact`;\nmis/fal/t: rays missed, false hits, wrong distance.\nboxes, prims: tests "
              "per ray, from a separate counting run.\n",
              out);
}

bb_status bb_report_table(bb_results *results, FILE *out)
{
    const cJSON *root = bb_results_json(results), *scene;
    const cJSON *context = cJSON_GetObjectItemCaseSensitive(root, "context");
    const cJSON *builds = cJSON_GetObjectItemCaseSensitive(root, "builds");
    const cJSON *traces = cJSON_GetObjectItemCaseSensitive(root, "traces");
    fprintf(out, "bvhbench ");
    print_text(out, bb_json_text(context, "revision"), 0);
    fputs(" on ", out);
    print_text(out, bb_json_text(context, "device"), 0);
    fputc('\n', out);
    cJSON_ArrayForEach(scene, cJSON_GetObjectItemCaseSensitive(root, "scenes"))
    {
        const char *name = bb_json_text(scene, "name");
        char count[CELL];
        grouped(count, bb_json_number(scene, "prims"));
        fputc('\n', out);
        print_text(out, name, 0);
        fprintf(out, ": %s %s\n", count, bb_json_text(scene, "kind"));
        print_builds(out, builds, name);
        print_traces(out, traces, name);
    }
    print_skipped(out, cJSON_GetObjectItemCaseSensitive(root, "skipped"));
    print_times(out, cJSON_GetObjectItemCaseSensitive(root, "steps_ms"),
                cJSON_GetObjectItemCaseSensitive(root, "time_ms"));
    print_audit(out, cJSON_GetObjectItemCaseSensitive(root, "audit"));
    print_legend(out, cJSON_GetArraySize(traces) > 0);
    return ferror(out) ? bb_fail(BB_FAILED, "cannot write the table") : BB_OK;
}
