/* Makes the cells of charts from the records of a run: grouped by scene and rays, summed over
 * views. */
#include "framework/report/chart.h"
#include "framework/record/record.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct entry {
    const bb_entry *trace, *build;
    uint32_t index;
    uint32_t group; /* index of the first entry of its scene and rays, then of its cell */
    double rays;    /* of the whole set */
} entry;

static const char *key_of(const entry *e)
{
    return bb_get_text(e->trace, BB_F_TRACE_CELL);
}

static int compare_texts(const char *a, size_t a_length, const char *b, size_t b_length)
{
    int order = memcmp(a, b, a_length < b_length ? a_length : b_length);
    return order != 0 ? order : (a_length > b_length) - (a_length < b_length);
}

/* Compares scene and rays, for any view. */
static int compare_rays(const entry *a, const entry *b)
{
    const char *left = key_of(a), *right = key_of(b);
    return compare_texts(left, bb_cell_key_set(left), right, bb_cell_key_set(right));
}

static int compare_numbers(double a, double b)
{
    return a < b ? -1 : a > b;
}

/* Compares build, kernel and intersector: the cell without its rays. */
static int compare_cells(const entry *a, const entry *b)
{
    const char *left = key_of(a), *right = key_of(b);
    int order = compare_numbers(bb_place_of(a->build), bb_place_of(b->build));
    return order != 0 ? order
                      : strcmp(left + bb_cell_key_rays(left), right + bb_cell_key_rays(right));
}

/* Compares run and hash of the rays. */
static int compare_hashes(const entry *a, const entry *b)
{
    const char *left = key_of(a), *right = key_of(b);
    int order = compare_texts(left, bb_cell_key_rays(left), right, bb_cell_key_rays(right));
    if (order == 0)
        order = strcmp(bb_get_text(a->trace, BB_F_TRACE_RAYS_HASH),
                       bb_get_text(b->trace, BB_F_TRACE_RAYS_HASH));
    return order != 0 ? order : compare_numbers(bb_run_of(a->trace), bb_run_of(b->trace));
}

static int by_rays(const void *left, const void *right)
{
    const entry *a = left, *b = right;
    int order = compare_rays(a, b);
    return order != 0 ? order : compare_numbers(a->index, b->index);
}

static int by_hash(const void *left, const void *right)
{
    const entry *a = left, *b = right;
    int order = compare_hashes(a, b);
    return order != 0 ? order : compare_numbers(a->index, b->index);
}

static int by_cell(const void *left, const void *right)
{
    const entry *a = left, *b = right;
    int order = compare_cells(a, b);
    return order != 0 ? order : compare_numbers(a->index, b->index);
}

static int by_group(const void *left, const void *right)
{
    const entry *a = left, *b = right;
    int order = compare_numbers(a->group, b->group);
    return order != 0 ? order : compare_numbers(a->index, b->index);
}

static int by_index(const void *left, const void *right)
{
    return compare_numbers(((const entry *)left)->index, ((const entry *)right)->index);
}

/* Sorts by `compare`, and gives all entries that `same` finds equal the index of the first. */
static void group_entries(entry *entries, uint32_t count,
                          int (*compare)(const void *, const void *),
                          int (*same)(const entry *, const entry *))
{
    qsort(entries, count, sizeof *entries, compare);
    for (uint32_t i = 0; i < count; i++)
        entries[i].group = i > 0 && same(&entries[i - 1], &entries[i]) == 0 ? entries[i - 1].group
                                                                            : entries[i].index;
}

/* Returns how many entries from `first` on share its group. */
static uint32_t group_size(const entry *entries, uint32_t count, uint32_t first)
{
    uint32_t end = first;
    while (end < count && entries[end].group == entries[first].group)
        end++;
    return end - first;
}

/* Returns a cell with the members that all views share. */
static bb_chart_cell first_cell(const entry *from)
{
    const bb_entry *trace = from->trace, *build = from->build;
    const char *layout = bb_get_text(trace, BB_F_TRACE_LAYOUT);
    bool reference = bb_get_true(trace, BB_F_TRACE_REFERENCE);
    bb_chart_cell cell = {
        .trace = trace,
        .build = build,
        .trace_index = from->index,
        .fixed_ms = bb_first_ray_ms(build, layout) + bb_left_out_ms(build),
        .reference = reference,
        .usable = true,
    };
    for (uint32_t i = 0; i < BB_METRICS_MAX; i++)
        cell.metrics[i] = reference || i >= bb_metric_count()
                              ? (double)NAN
                              : bb_get_metric_traced(build, bb_metrics[i], layout);
    return cell;
}

/* Returns the milliseconds for the trace's rays at the rate in this field; NAN if there is none. */
static double ms_at(const bb_entry *trace, bb_field_id rate)
{
    return bb_get_number(trace, BB_F_TRACE_COUNT) / bb_get_number(trace, rate) / 1e3;
}

/* Makes one cell of `views` entries that differ only in their view. The ends of the views'
 * intervals are added up, which is no narrower than an interval of the sum. If one view has no
 * interval, the cell has none. */
static bb_chart_cell make_cell(const bb_charts *charts, const entry *entries, uint32_t views)
{
    bb_chart_cell cell = first_cell(entries);
    double low_ms = 0, high_ms = 0, least_ms = 0, most_ms = 0, wrong = 0;
    double simulated_us[BB_SIMT_MAX] = {0};
    for (uint32_t i = 0; i < views; i++) {
        const bb_entry *trace = entries[i].trace;
        double count = bb_get_number(trace, BB_F_TRACE_COUNT),
               ppm = bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM);
        bool counts = bb_get_true(trace, BB_F_TRACE_COUNTS);
        cell.count += count;
        cell.rays += entries[i].rays;
        cell.ms += ms_at(trace, BB_F_TRACE_RATE);
        low_ms += ms_at(trace, BB_F_TRACE_RATE_HI);
        high_ms += ms_at(trace, BB_F_TRACE_RATE_LO);
        least_ms += ms_at(trace, BB_F_TRACE_RATE_MOST);
        most_ms += ms_at(trace, BB_F_TRACE_RATE_LEAST);
        cell.work += count * bb_get_number(trace, BB_F_TRACE_WORK);
        for (uint32_t s = 0; s < charts->simulation_count; s++)
            simulated_us[s] += count / bb_get_named(trace, BB_F_SIMT_RATE, charts->simulations[s]);
        double checked = bb_get_number(trace, BB_F_ACCURACY_CHECKED);
        cell.checked += checked;
        wrong += round(ppm * checked / 1e6);
        cell.missed += bb_get_number(trace, BB_F_ACCURACY_MISSED);
        cell.false_hits += bb_get_number(trace, BB_F_ACCURACY_FALSE);
        cell.wrong_t += bb_get_number(trace, BB_F_ACCURACY_WRONG_T);
        cell.usable = cell.usable && (cell.reference ||
                                      (counts ? !bb_get_true(trace, BB_F_TRACE_WRONG) : ppm == 0));
    }
    cell.views = views;
    cell.wrong_rays = wrong;
    cell.mrays_s = cell.count / cell.ms / 1e3;
    cell.mrays_s_lo = cell.count / high_ms / 1e3;
    cell.mrays_s_hi = cell.count / low_ms / 1e3;
    cell.mrays_s_least = cell.count / most_ms / 1e3;
    cell.mrays_s_most = cell.count / least_ms / 1e3;
    cell.wrong = bb_wrong_rate_of(wrong, cell.checked);
    cell.work /= cell.count;
    for (uint32_t s = 0; s < BB_SIMT_MAX; s++)
        cell.simulated[s] =
            s < charts->simulation_count ? cell.count / simulated_us[s] : (double)NAN;
    return cell;
}

static void add_cell(const bb_charts *charts, bb_chart_set *set, const entry *entries,
                     uint32_t views)
{
    set->cells[set->cell_count++] = make_cell(charts, entries, views);
}

/* Adds the cells of all views together. Cells that lack a view are left out, since their sums would
 * not be comparable. `entries` are of one scene and rays; their order changes. */
static void add_together(const bb_charts *charts, bb_chart_set *set, entry *entries, uint32_t count)
{
    group_entries(entries, count, by_cell, compare_cells);
    qsort(entries, count, sizeof *entries, by_group);
    for (uint32_t i = 0, views; i < count; i += views) {
        views = group_size(entries, count, i);
        if (views == set->views)
            add_cell(charts, set, entries + i, views);
        else
            set->incomplete++;
    }
    qsort(entries, count, sizeof *entries, by_index);
}

/* Adds a set whose cells follow those of the last one. */
static bb_chart_set *add_set(bb_charts *charts, const entry *first, const char *view)
{
    bb_chart_set *set = &charts->sets[charts->set_count++];
    bb_chart_cell *cells = charts->cells;
    if (charts->set_count > 1)
        cells = set[-1].cells + set[-1].cell_count;
    *set = (bb_chart_set){.scene = bb_get_text(first->trace, BB_F_TRACE_SCENE),
                          .rays = bb_get_text(first->trace, BB_F_TRACE_RAYS),
                          .view = view,
                          .views = 1,
                          .cells = cells};
    return set;
}

/* Adds the sets of one scene and rays. `entries` are in the order of the results; `views` has room
 * for as many. */
static void add_sets(bb_charts *charts, entry *entries, uint32_t count, const char **views)
{
    bb_chart_set *together = add_set(charts, entries, NULL);
    uint32_t view_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        const char *view = bb_get_text(entries[i].trace, BB_F_TRACE_VIEW);
        uint32_t v = 0;
        while (v < view_count && strcmp(views[v], view) != 0)
            v++;
        if (v == view_count)
            views[view_count++] = view;
    }
    together->views = view_count;
    add_together(charts, together, entries, count);
    for (uint32_t v = 0; view_count > 1 && v < view_count; v++) {
        bb_chart_set *set = add_set(charts, entries, views[v]);
        for (uint32_t i = 0; i < count; i++)
            if (strcmp(bb_get_text(entries[i].trace, BB_F_TRACE_VIEW), views[v]) == 0)
                add_cell(charts, set, &entries[i], 1);
    }
}

/* Collects the measured traces with their builds, in the order of the results. Returns how many.
 */
static uint32_t collect(const bb_section *traces, entry *entries)
{
    uint32_t count = 0, index = 0;
    bb_each(trace, traces)
    {
        bool measured = bb_is_ok(trace) && bb_get_number(trace, BB_F_TRACE_RATE) > 0 &&
                        bb_get_number(trace, BB_F_TRACE_COUNT) > 0;
        if (measured)
            entries[count++] = (entry){.trace = trace, .build = bb_build_of(trace), .index = index};
        index++;
    }
    return count;
}

/* Sets the size of the whole ray set: the largest count among the cells on the same rays. */
static void size_sets(entry *entries, uint32_t count)
{
    group_entries(entries, count, by_hash, compare_hashes);
    for (uint32_t i = 0, size; i < count; i += size) {
        double rays = 0;
        size = group_size(entries, count, i);
        for (uint32_t k = i; k < i + size; k++)
            rays = fmax(rays, bb_get_number(entries[k].trace, BB_F_TRACE_COUNT));
        for (uint32_t k = i; k < i + size; k++)
            entries[k].rays = rays;
    }
}

bb_status bb_charts_make(bb_results *results, bb_charts *out)
{
    const bb_section *traces = bb_results_section(results, BB_TRACES);
    size_t room = (size_t)bb_section_count(traces) + 1;
    uint32_t count;
    entry *entries = calloc(room, sizeof *entries);
    const char **views = calloc(room, sizeof *views);
    /* each cell at most once on its own and once with the other views; no set without a cell, or
     * one more per scene and rays */
    *out = (bb_charts){.sets = calloc(2 * room, sizeof *out->sets),
                       .cells = calloc(2 * room, sizeof *out->cells)};
    bb_status status = BB_OK;
    if (entries == NULL || views == NULL || out->sets == NULL || out->cells == NULL) {
        status = bb_fail(BB_FAILED, "charts: no memory");
        bb_charts_free(out);
        goto out;
    }
    out->simulation_count = bb_results_simulations(results, out->simulations);
    count = collect(traces, entries);
    size_sets(entries, count);
    group_entries(entries, count, by_rays, compare_rays);
    qsort(entries, count, sizeof *entries, by_group);
    for (uint32_t i = 0, size; i < count; i += size) {
        size = group_size(entries, count, i);
        add_sets(out, entries + i, size, views);
    }
out:
    free(views);
    free(entries);
    return status;
}

double bb_chart_run(const bb_chart_cell *cell)
{
    return bb_run_of(cell->trace);
}

void bb_chart_builder_name(const bb_chart_cell *cell, bool runs, char *name, size_t capacity)
{
    const char *builder = bb_get_text(cell->trace, BB_F_TRACE_BUILDER);
    const char *on = bb_get_text(cell->trace, BB_F_TRACE_ON);
    char run[32] = "";
    if (runs)
        snprintf(run, sizeof run, " (run %g)", bb_chart_run(cell) + 1);
    snprintf(name, capacity, "%s%s%s%s%s", builder, on[0] != '\0' ? " (" : "", on,
             on[0] != '\0' ? ")" : "", run);
}

void bb_charts_free(bb_charts *charts)
{
    free(charts->cells);
    free(charts->sets);
    *charts = (bb_charts){0};
}
