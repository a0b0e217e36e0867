/* Makes the cells of fits from those of results, by kind of rays. */
#include "framework/compare/prediction.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct cell {
    const char *rays, *key, *hash, *scene;
    double run, build;
    uint32_t trace, kind, group, fold;
    double sah, overlap, work, ns;
} cell;

/* ---- cells ---- */

double bb_prediction_overlap(const bb_entry *build)
{
    double best = NAN;
    unsigned rank = 0;
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        double value = bb_get_metric(build, bb_metrics[i]);
        if (bb_metrics[i]->mixed > rank && isfinite(value)) {
            best = value;
            rank = bb_metrics[i]->mixed;
        }
    }
    return best;
}

static bool enters(const bb_entry *trace, const bb_entry *build)
{
    return build != NULL && bb_is_ok(trace) && bb_get_true(trace, BB_F_TRACE_COUNTS) &&
           !bb_get_true(trace, BB_F_TRACE_REFERENCE) && !bb_get_true(trace, BB_F_TRACE_WRONG) &&
           bb_get_number(trace, BB_F_TRACE_RATE) > 0 && bb_get_number(trace, BB_F_TRACE_WORK) > 0 &&
           bb_get_number(build, BB_F_TREE_NODES) > 1;
}

/* Collects the cells that have all figures. If no tree of the results has an EPO, SAH takes its
 * place and *has_overlap is false. */
static uint32_t collect(const bb_results *results, cell *cells, bool *has_overlap)
{
    const bb_metric *sah = bb_metrics[bb_metric_of_layouts()];
    uint32_t count = 0, index = 0;
    *has_overlap = false;
    bb_each(build, bb_results_section(results, BB_BUILDS))
    {
        *has_overlap = *has_overlap || bb_prediction_overlap(build) > 0;
    }
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        const bb_entry *build = bb_build_of(trace);
        cell c = {.rays = bb_get_text(trace, BB_F_TRACE_RAYS),
                  .key = bb_get_text(trace, BB_F_TRACE_CELL),
                  .hash = bb_get_text(trace, BB_F_TRACE_RAYS_HASH),
                  .scene = bb_get_text(trace, BB_F_TRACE_SCENE),
                  .run = bb_run_of(trace),
                  .build = bb_place_of(build),
                  .trace = index++};
        if (!enters(trace, build))
            continue;
        c.sah = bb_get_metric(build, sah);
        c.overlap = *has_overlap ? bb_prediction_overlap(build) : c.sah;
        c.work = bb_get_number(trace, BB_F_TRACE_WORK);
        c.ns = 1e3 / bb_get_number(trace, BB_F_TRACE_RATE);
        if (c.sah > 0 && c.overlap > 0)
            cells[count++] = c;
    }
    return count;
}

/* ---- groups ---- */

static int order_of(double a, double b)
{
    return (a > b) - (a < b);
}

/* Returns what traces the cell: its key after the builder, where no name contains a '/'. */
static const char *tracer_of(const cell *c)
{
    const char *kernel = strstr(c->key, "/kernel=");
    return kernel != NULL ? kernel : "";
}

static int by_scene(const cell *a, const cell *b)
{
    return strcmp(a->scene, b->scene);
}

static int by_conditions(const cell *a, const cell *b)
{
    size_t left = bb_cell_key_rays(a->key), right = bb_cell_key_rays(b->key);
    int order = a->kind != b->kind ? (a->kind < b->kind ? -1 : 1) : by_scene(a, b);
    if (order == 0 && left != right)
        order = left < right ? -1 : 1;
    if (order == 0)
        order = memcmp(a->key, b->key, left);
    if (order == 0)
        order = strcmp(a->hash, b->hash);
    if (order == 0)
        order = order_of(a->run, b->run);
    return order != 0 ? order : strcmp(tracer_of(a), tracer_of(b));
}

static int compare_cells(const void *left, const void *right)
{
    const cell *a = left, *b = right;
    int order = by_conditions(a, b);
    return order != 0 ? order : (a->trace > b->trace) - (a->trace < b->trace);
}

/* Numbers the kinds in the order of the results, and removes cells that are alone in their group,
 * which tell nothing. Returns how many are left, sorted by kind and group. */
static uint32_t group_cells(cell *cells, uint32_t count)
{
    uint32_t kinds = 0, kept = 0, groups = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = 0;
        while (k < i && strcmp(cells[k].rays, cells[i].rays) != 0)
            k++;
        cells[i].kind = k < i ? cells[k].kind : kinds++;
    }
    qsort(cells, count, sizeof *cells, compare_cells);
    for (uint32_t i = 0, size; i < count; i += size) {
        size = 1;
        while (i + size < count && by_conditions(&cells[i], &cells[i + size]) == 0)
            size++;
        for (uint32_t k = i; k < i + size && size > 1; k++) {
            cells[kept] = cells[k];
            cells[kept++].group = groups;
        }
        groups += size > 1;
    }
    return kept;
}

static int by_build(const void *left, const void *right)
{
    const cell *a = left, *b = right;
    return order_of(a->build, b->build);
}

/* Makes each scene a fold, and counts parts; cells are sorted by scene. */
static void count_parts(cell *cells, uint32_t count, bb_prediction_record *record, cell *scratch)
{
    record->cells = count;
    for (uint32_t i = 0; i < count; i++) {
        bool first = i == 0;
        record->scenes += first || by_scene(&cells[i - 1], &cells[i]) != 0;
        record->groups += first || cells[i - 1].group != cells[i].group;
        cells[i].fold = record->scenes - 1;
    }
    memcpy(scratch, cells, count * sizeof *cells);
    qsort(scratch, count, sizeof *scratch, by_build);
    for (uint32_t i = 0; i < count; i++)
        record->trees += i == 0 || scratch[i - 1].build != scratch[i].build;
}

/* ---- fits ---- */

/* Makes cells for a fit. For the work, which is a single measure, both costs are the work. */
static void as_fit(const cell *cells, uint32_t count, bool of_work, bb_fit_cell *fit)
{
    for (uint32_t i = 0; i < count; i++)
        fit[i] =
            (bb_fit_cell){cells[i].group, cells[i].fold, of_work ? cells[i].work : cells[i].sah,
                          of_work ? cells[i].work : cells[i].overlap, cells[i].ns};
}

static double centred(double value, double sum_of_logs, uint32_t count)
{
    return exp(log(value) - sum_of_logs / count);
}

/* Sets the points of one group. */
static void place_group(const cell *cells, uint32_t count, double alpha, bb_prediction_point *p)
{
    double time = 0, sah = 0, overlap = 0, mix = 0, work = 0;
    for (uint32_t i = 0; i < count; i++) {
        const cell *c = &cells[i];
        p[i] = (bb_prediction_point){.trace = c->trace};
        p[i].mix = (1 - alpha) * c->sah + alpha * c->overlap;
        time += log(c->ns);
        sah += log(c->sah);
        overlap += log(c->overlap);
        mix += log(p[i].mix);
        work += log(c->work);
    }
    for (uint32_t i = 0; i < count; i++) {
        p[i].time = centred(cells[i].ns, time, count);
        p[i].sah = centred(cells[i].sah, sah, count);
        p[i].overlap = centred(cells[i].overlap, overlap, count);
        p[i].mix = centred(p[i].mix, mix, count);
        p[i].work = centred(cells[i].work, work, count);
    }
}

static void place(const cell *cells, uint32_t count, double alpha, bb_prediction_point *points)
{
    for (uint32_t i = 0, size; i < count; i += size) {
        size = 1;
        while (i + size < count && cells[i + size].group == cells[i].group)
            size++;
        place_group(cells + i, size, alpha, points + i);
    }
}

static void fit_kind(const cell *cells, uint32_t count, bool has_overlap, bb_fit_cell *fit,
                     bb_prediction *p)
{
    bb_prediction_record *r = &p->record;
    as_fit(cells, count, true, fit);
    bb_fit work = bb_fit_of(fit, count, 0, 0);
    as_fit(cells, count, false, fit);
    bb_fit sah = bb_fit_of(fit, count, 0, 0), epo = bb_fit_of(fit, count, 1, 0);
    r->alpha = has_overlap ? bb_fit_alpha(fit, count, BB_FIT_ALL) : (double)NAN;
    bb_fit mix = bb_fit_of(fit, count, r->alpha, 1);
    bb_fit_spread spread = bb_fit_folds(fit, count, r->scenes);
    r->alpha_least = spread.least;
    r->alpha_most = spread.most;
    r->unseen_error = spread.unseen;
    r->mix_error = mix.error;
    r->mix_correlation = mix.correlation;
    r->sah_error = sah.error;
    r->sah_correlation = sah.correlation;
    r->epo_error = has_overlap ? epo.error : (double)NAN;
    r->epo_correlation = has_overlap ? epo.correlation : (double)NAN;
    r->work_error = work.error;
    r->work_correlation = work.correlation;
    place(cells, count, r->alpha, p->points);
    for (uint32_t i = 0; i < count && !has_overlap; i++)
        p->points[i].overlap = NAN;
}

static bb_status make_kinds(cell *cells, uint32_t count, bool has_overlap, bb_predictions *out)
{
    bb_fit_cell *fit = calloc((size_t)count + 1, sizeof *fit);
    cell *scratch = calloc((size_t)count + 1, sizeof *scratch);
    bool ok = fit != NULL && scratch != NULL;
    for (uint32_t i = 0, size; ok && i < count; i += size) {
        bb_prediction *p = &out->kinds[out->count];
        *p = (bb_prediction){.rays = cells[i].rays};
        size = 1;
        while (i + size < count && cells[i + size].kind == cells[i].kind)
            size++;
        count_parts(cells + i, size, &p->record, scratch);
        p->record.rays = p->rays;
        if (p->record.trees < p->record.scenes + BB_PREDICTION_TREES)
            continue;
        p->points = calloc(size, sizeof *p->points);
        ok = p->points != NULL;
        if (!ok)
            break;
        fit_kind(cells + i, size, has_overlap, fit, p);
        out->count++;
    }
    free(fit);
    free(scratch);
    return ok ? BB_OK : bb_fail(BB_FAILED, "predictions: no memory");
}

bb_status bb_predictions_make(const bb_results *results, bb_predictions *out)
{
    size_t room = (size_t)bb_section_count(bb_results_section(results, BB_TRACES)) + 1;
    bool has_overlap;
    cell *cells = calloc(room, sizeof *cells);
    *out = (bb_predictions){.kinds = calloc(room, sizeof *out->kinds)};
    bb_status status = BB_OK;
    if (cells == NULL || out->kinds == NULL)
        status = bb_fail(BB_FAILED, "predictions: no memory");
    if (status == BB_OK) {
        uint32_t count = collect(results, cells, &has_overlap);
        count = group_cells(cells, count);
        status = make_kinds(cells, count, has_overlap, out);
    }
    if (status != BB_OK)
        bb_predictions_free(out);
    free(cells);
    return status;
}

void bb_predictions_free(bb_predictions *predictions)
{
    for (uint32_t i = 0; i < predictions->count; i++)
        free(predictions->kinds[i].points);
    free(predictions->kinds);
    *predictions = (bb_predictions){0};
}

bb_status bb_predictions_record(bb_results *results)
{
    bb_predictions made;
    bb_results_clear_predictions(results);
    BB_TRY(bb_predictions_make(results, &made));
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < made.count && status == BB_OK; i++)
        status = bb_results_add_prediction(results, &made.kinds[i].record);
    bb_predictions_free(&made);
    return status;
}
