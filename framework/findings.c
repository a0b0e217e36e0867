/* What an experiment measured, looked up in the result document. */
#include "framework/record_private.h"
#include "framework/reproduce.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <string.h>

static bool is_of(const bb_findings *f, const cJSON *entry, const char *id, const char *scene,
                  const char *builder)
{
    double number = bb_json_number(entry, id);
    return number >= f->first && number < f->end &&
           strcmp(bb_json_text(entry, "scene"), scene) == 0 &&
           strcmp(bb_json_text(entry, "builder"), builder) == 0 &&
           strcmp(bb_json_text(entry, "status"), "ok") == 0;
}

const cJSON *bb_found_build(const bb_findings *f, const char *scene, const char *builder)
{
    const cJSON *build;
    cJSON_ArrayForEach(build,
                       cJSON_GetObjectItemCaseSensitive(bb_results_json(f->results), "builds"))
    {
        if (is_of(f, build, "id", scene, builder))
            return build;
    }
    return NULL;
}

double bb_found_tree(const bb_findings *f, const char *scene, const char *builder,
                     const char *member)
{
    const cJSON *build = bb_found_build(f, scene, builder);
    return bb_json_number(cJSON_GetObjectItemCaseSensitive(build, "tree"), member);
}

double bb_found_sah(const bb_findings *f, const char *scene, const char *builder)
{
    return bb_found_tree(f, scene, builder, "sah");
}

double bb_found_build_ms(const bb_findings *f, const char *scene, const char *builder)
{
    return bb_json_number(bb_found_build(f, scene, builder), "build_ms_median");
}

const char *bb_found_about(const bb_findings *f, const char *scene, const char *builder)
{
    return bb_json_text(bb_found_build(f, scene, builder), "about");
}

double bb_found_phase_ms(const bb_findings *f, const char *scene, const char *builder,
                         const char *phase)
{
    const cJSON *build = bb_found_build(f, scene, builder);
    return bb_json_number(cJSON_GetObjectItemCaseSensitive(build, "phases_ms"), phase);
}

/* Adds the samples of `entry` to those in `sum`, round by round; false if the rounds differ or a sample is missing. */
static bool add_samples(const cJSON *entry, const char *member, bool first, bb_samples *sum)
{
    const cJSON *array = cJSON_GetObjectItemCaseSensitive(entry, member), *item;
    uint32_t count = (uint32_t)cJSON_GetArraySize(array), i = 0;
    if (count == 0 || count > BB_SAMPLES_MAX || (!first && count != sum->count))
        return false;
    sum->count = count;
    cJSON_ArrayForEach(item, array)
    {
        if (!cJSON_IsNumber(item))
            return false;
        sum->values[i] = (first ? 0 : sum->values[i]) + item->valuedouble;
        i++;
    }
    return true;
}

bb_estimate bb_found_build_ratio(const bb_findings *f, const char *scene, const char *builder,
                                 const char *base)
{
    bb_samples a = {0}, b = {0};
    if (!add_samples(bb_found_build(f, scene, builder), "build_ms", true, &a) ||
        !add_samples(bb_found_build(f, scene, base), "build_ms", true, &b))
        return (bb_estimate){NAN, NAN, NAN};
    return bb_samples_ratio(&a, &b, BB_INTERVAL_SEED);
}

bb_estimate bb_found_build_ratios(const bb_findings *f, const char *builder, const char *base)
{
    bb_samples means = {0}, ones = {0};
    for (size_t s = 0; s < f->scene_count; s++) {
        bb_samples a = {0}, b = {0};
        if (!add_samples(bb_found_build(f, f->scenes[s], builder), "build_ms", true, &a) ||
            !add_samples(bb_found_build(f, f->scenes[s], base), "build_ms", true, &b) ||
            a.count != b.count || (s > 0 && a.count != means.count))
            return (bb_estimate){NAN, NAN, NAN};
        means.count = ones.count = a.count;
        for (uint32_t i = 0; i < a.count; i++) {
            double power = 1.0 / (double)f->scene_count;
            means.values[i] =
                (s == 0 ? 1 : means.values[i]) * pow(a.values[i] / b.values[i], power);
            ones.values[i] = 1;
        }
    }
    return bb_samples_ratio(&means, &ones, BB_INTERVAL_SEED);
}

/* ---- traces ---- */

/* All traces of a cell: their samples summed per round, their rays, the sum of a member times the rays. */
typedef struct sum {
    bb_samples ms;
    double rays, member;
    uint32_t traces;
} sum;

static bool add_trace(const cJSON *trace, const char *member, sum *s)
{
    double rays = bb_json_number(trace, "count");
    if (!add_samples(trace, "ms", s->traces == 0, &s->ms))
        return false;
    s->rays += rays;
    s->member += member != NULL ? rays * bb_json_number(trace, member) : 0;
    s->traces++;
    return true;
}

/* False if one of the traces lacks its figures, or there is none. */
static bool sum_up(const bb_findings *f, bb_cell cell, const char *member, sum *s)
{
    *s = (sum){0};
    const cJSON *trace;
    cJSON_ArrayForEach(trace,
                       cJSON_GetObjectItemCaseSensitive(bb_results_json(f->results), "traces"))
    {
        if (!is_of(f, trace, "build", cell.scene, cell.builder) ||
            strcmp(bb_json_text(trace, "kernel"), cell.kernel) != 0)
            continue;
        if (cell.view != NULL && strcmp(bb_json_text(trace, "view"), cell.view) != 0)
            continue;
        if (!add_trace(trace, member, s))
            return false;
    }
    return s->traces > 0;
}

double bb_found_trace_ms(const bb_findings *f, bb_cell cell)
{
    sum s;
    return sum_up(f, cell, NULL, &s) ? bb_samples_median(&s.ms) : (double)NAN;
}

double bb_found_mrays(const bb_findings *f, bb_cell cell)
{
    sum s;
    return sum_up(f, cell, NULL, &s) ? s.rays / bb_samples_median(&s.ms) / 1e3 : (double)NAN;
}

double bb_found_tests(const bb_findings *f, bb_cell cell, const char *member)
{
    sum s;
    return sum_up(f, cell, member, &s) ? s.member / s.rays : (double)NAN;
}

bb_estimate bb_found_trace_ratio(const bb_findings *f, bb_cell cell, bb_cell base)
{
    sum a, b;
    if (!sum_up(f, cell, NULL, &a) || !sum_up(f, base, NULL, &b) || a.rays != b.rays)
        return (bb_estimate){NAN, NAN, NAN};
    return bb_samples_ratio(&a.ms, &b.ms, BB_INTERVAL_SEED);
}

/* ---- scenes ---- */

double bb_found_scene(const bb_findings *f, const char *scene, const char *member)
{
    const cJSON *entry = bb_results_scene(f->results, scene);
    double value = bb_json_number(entry, member);
    return isnan(value) ? bb_json_number(cJSON_GetObjectItemCaseSensitive(entry, "profile"), member)
                        : value;
}

const char *bb_found_view(const bb_findings *f, const char *scene, int number)
{
    const cJSON *views =
        cJSON_GetObjectItemCaseSensitive(bb_results_scene(f->results, scene), "views");
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

double bb_series_mean(const bb_series *s)
{
    return bb_mean(s->values, s->f->scene_count);
}

double bb_series_least(const bb_series *s)
{
    double low = NAN;
    for (size_t i = 0; i < s->f->scene_count; i++)
        low = fmin(low, s->values[i]);
    return low;
}

double bb_series_most(const bb_series *s)
{
    double high = NAN;
    for (size_t i = 0; i < s->f->scene_count; i++)
        high = fmax(high, s->values[i]);
    return high;
}

/* The first scene with this figure. */
static const char *scene_with(const bb_series *s, double value)
{
    for (size_t i = 0; i < s->f->scene_count; i++)
        if (s->values[i] == value)
            return s->f->scenes[i];
    return "none";
}

void bb_say_range(bb_words *words, const char *what, const bb_series *s)
{
    double low = bb_series_least(s), high = bb_series_most(s);
    bb_say(words, "%s%s ", words->length > 0 ? "; " : "", what);
    if (isnan(low)) {
        bb_say(words, "not measured");
        return;
    }
    bb_say(words, "%.3g on average, %.3g (%s) to %.3g (%s)", bb_series_mean(s), low,
           scene_with(s, low), high, scene_with(s, high));
}
