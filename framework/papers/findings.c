/* What an experiment measured, looked up in the result document. */
#include "framework/papers/reproduce.h"
#include "framework/record/record.h"
#include "framework/tree/tree.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <string.h>

static bool is_of(const bb_findings *f, const cJSON *entry, bb_field_id id, const char *scene,
                  const char *builder)
{
    double number = bb_get_number(entry, id);
    return number >= f->first && number < f->end &&
           strcmp(bb_get_text(entry, BB_F_BUILD_SCENE), scene) == 0 &&
           strcmp(bb_get_text(entry, BB_F_BUILD_BUILDER), builder) == 0 && bb_is_ok(entry);
}

const cJSON *bb_found_build(const bb_findings *f, const char *scene, const char *builder)
{
    const cJSON *build;
    cJSON_ArrayForEach(build, bb_results_section(f->results, BB_BUILDS))
    {
        if (is_of(f, build, BB_F_BUILD_ID, scene, builder))
            return build;
    }
    return NULL;
}

double bb_found_tree(const bb_findings *f, const char *scene, const char *builder,
                     bb_field_id field)
{
    return bb_get_number(bb_found_build(f, scene, builder), field);
}

double bb_found_sah(const bb_findings *f, const char *scene, const char *builder)
{
    return bb_get_metric(bb_found_build(f, scene, builder), &bb_metric_sah);
}

double bb_found_build_ms(const bb_findings *f, const char *scene, const char *builder)
{
    return bb_get_number(bb_found_build(f, scene, builder), BB_F_BUILD_MS_MEDIAN);
}

const char *bb_found_about(const bb_findings *f, const char *scene, const char *builder)
{
    return bb_get_text(bb_found_build(f, scene, builder), BB_F_BUILD_ABOUT);
}

double bb_found_phase_ms(const bb_findings *f, const char *scene, const char *builder,
                         const char *phase)
{
    return bb_get_named(bb_found_build(f, scene, builder), BB_F_BUILD_PHASES, phase);
}

/* ---- times by rounds ---- */

/* Adds `more` to `sum` round by round; false if the rounds differ. */
static bool add_samples(bb_samples *sum, const bb_samples *more)
{
    if (sum->count != 0 && sum->count != more->count)
        return false;
    for (uint32_t i = 0; i < more->count; i++)
        sum->values[i] = (sum->count != 0 ? sum->values[i] : 0) + more->values[i];
    sum->count = more->count;
    return true;
}

/* All traces of a cell: their samples summed by rounds, their rays, the sum of a member times the
 * rays. */
typedef struct sum {
    bb_samples ms;
    double rays, member;
    uint32_t traces;
} sum;

static bool add_trace(const cJSON *trace, const bb_field_id *member, sum *s)
{
    double rays = bb_get_number(trace, BB_F_TRACE_COUNT);
    bb_samples ms;
    if (!bb_get_samples(trace, BB_F_TRACE_MS, &ms) || !add_samples(&s->ms, &ms))
        return false;
    s->rays += rays;
    s->member += member != NULL ? rays * bb_get_number(trace, *member) : 0;
    s->traces++;
    return true;
}

/* False if one of the traces lacks its figures, or there is none. */
static bool sum_up(const bb_findings *f, bb_selection cell, const bb_field_id *member, sum *s)
{
    *s = (sum){0};
    const cJSON *trace;
    cJSON_ArrayForEach(trace, bb_results_section(f->results, BB_TRACES))
    {
        if (!is_of(f, trace, BB_F_TRACE_BUILD, cell.scene, cell.builder) ||
            strcmp(bb_get_text(trace, BB_F_TRACE_KERNEL), cell.kernel) != 0)
            continue;
        if (cell.view != NULL && strcmp(bb_get_text(trace, BB_F_TRACE_VIEW), cell.view) != 0)
            continue;
        if (f->rays != NULL && strcmp(bb_get_text(trace, BB_F_TRACE_RAYS), f->rays) != 0)
            continue;
        if (!add_trace(trace, member, s))
            return false;
    }
    return s->traces > 0;
}

double bb_found_trace_ms(const bb_findings *f, bb_selection cell)
{
    sum s;
    return sum_up(f, cell, NULL, &s) ? bb_samples_median(&s.ms) : (double)NAN;
}

double bb_found_mrays(const bb_findings *f, bb_selection cell)
{
    sum s;
    return sum_up(f, cell, NULL, &s) ? s.rays / bb_samples_median(&s.ms) / 1e3 : (double)NAN;
}

double bb_found_tests(const bb_findings *f, bb_selection cell, bb_field_id tests)
{
    sum s;
    return sum_up(f, cell, &tests, &s) ? s.member / s.rays : (double)NAN;
}

double bb_found_work(const bb_findings *f, bb_selection cell)
{
    return BB_COST_TRAVERSAL * bb_found_tests(f, cell, BB_F_TRACE_NODE_TESTS) / 2 +
           bb_found_tests(f, cell, BB_F_TRACE_PRIM_TESTS);
}

/* Times of a cell and of how many rays they are; false if they were not measured. */
static bool times_of(const bb_findings *f, bb_times what, bb_selection cell, bb_samples *ms,
                     double *rays)
{
    sum traces = {0};
    bb_samples build;
    *ms = (bb_samples){0};
    if (what != BB_TRACE_TIME) {
        if (!bb_get_samples(bb_found_build(f, cell.scene, cell.builder), BB_F_BUILD_MS, &build))
            return false;
        add_samples(ms, &build);
    }
    if (what != BB_BUILD_TIME && (!sum_up(f, cell, NULL, &traces) || !add_samples(ms, &traces.ms)))
        return false;
    *rays = traces.rays;
    return true;
}

/* Of the same rays, round by round; empty if there is no such ratio. */
static bb_samples ratios_of(const bb_findings *f, bb_times what, bb_selection cell,
                            bb_selection base)
{
    bb_samples a, b;
    double rays, base_rays;
    if (!times_of(f, what, cell, &a, &rays) || !times_of(f, what, base, &b, &base_rays) ||
        rays != base_rays)
        return (bb_samples){0};
    return bb_samples_ratio(&a, &b);
}

bb_estimate bb_found_ratio(const bb_findings *f, bb_times what, bb_selection cell,
                           bb_selection base)
{
    bb_samples ratios = ratios_of(f, what, cell, base);
    return bb_samples_estimate(&ratios);
}

void bb_ratio_mean_add(bb_ratio_mean *mean, const bb_findings *f, bb_times what, bb_selection cell,
                       bb_selection base)
{
    bb_samples ratios = ratios_of(f, what, cell, base);
    if (ratios.count == 0)
        return;
    mean->uneven = !add_samples(&mean->sum, &ratios) || mean->uneven;
    mean->count++;
}

bb_estimate bb_ratio_mean_estimate(const bb_ratio_mean *mean)
{
    if (mean->count == 0 || mean->uneven)
        return bb_not_measured;
    bb_samples means = mean->sum;
    for (uint32_t i = 0; i < means.count; i++)
        means.values[i] /= mean->count;
    return bb_samples_estimate(&means);
}

bb_estimate bb_found_mean_ratio(const bb_findings *f, bb_times what, const char *kernel,
                                const char *builder, const char *base)
{
    bb_samples logs = {0};
    for (size_t s = 0; s < f->scene_count; s++) {
        bb_selection cell = {f->scenes[s], builder, kernel, NULL},
                     other = {f->scenes[s], base, kernel, NULL};
        bb_samples ratios = ratios_of(f, what, cell, other);
        for (uint32_t i = 0; i < ratios.count; i++)
            ratios.values[i] = log(ratios.values[i]);
        if (ratios.count == 0 || !add_samples(&logs, &ratios))
            return bb_not_measured;
    }
    for (uint32_t i = 0; i < logs.count; i++)
        logs.values[i] = exp(logs.values[i] / (double)f->scene_count);
    return bb_samples_estimate(&logs);
}

bb_estimate bb_found_build_ratios(const bb_findings *f, const char *builder, const char *base)
{
    return bb_found_mean_ratio(f, BB_BUILD_TIME, NULL, builder, base);
}

/* ---- scenes ---- */

double bb_found_scene(const bb_findings *f, const char *scene, bb_field_id field)
{
    return bb_get_number(bb_results_scene(f->results, scene), field);
}

const char *bb_found_view(const bb_findings *f, const char *scene, int number)
{
    const cJSON *views = bb_get(bb_results_scene(f->results, scene), BB_F_SCENE_VIEWS);
    const char *name = cJSON_GetStringValue(cJSON_GetArrayItem(views, number));
    return name != NULL ? name : "";
}

double bb_mean(const double *values, size_t count)
{
    double total = 0;
    size_t known = 0;
    for (size_t i = 0; i < count; i++)
        if (!isnan(values[i])) {
            total += values[i];
            known++;
        }
    return known > 0 ? total / (double)known : (double)NAN;
}

double bb_figures_mean(const bb_paper_figures *s)
{
    return bb_mean(s->values, s->f->scene_count);
}

double bb_figures_least(const bb_paper_figures *s)
{
    double low = NAN;
    for (size_t i = 0; i < s->f->scene_count; i++)
        low = fmin(low, s->values[i]);
    return low;
}

double bb_figures_most(const bb_paper_figures *s)
{
    double high = NAN;
    for (size_t i = 0; i < s->f->scene_count; i++)
        high = fmax(high, s->values[i]);
    return high;
}

/* The first scene with this figure. */
static const char *scene_with(const bb_paper_figures *s, double value)
{
    for (size_t i = 0; i < s->f->scene_count; i++)
        if (s->values[i] == value)
            return s->f->scenes[i];
    return "none";
}

void bb_say_range(bb_words *words, const char *what, const bb_paper_figures *s)
{
    double low = bb_figures_least(s), high = bb_figures_most(s);
    bb_say(words, "%s%s ", words->length > 0 ? "; " : "", what);
    if (isnan(low)) {
        bb_say(words, "not measured");
        return;
    }
    bb_say(words, "%.3g on average, %.3g (%s) to %.3g (%s)", bb_figures_mean(s), low,
           scene_with(s, low), high, scene_with(s, high));
}
