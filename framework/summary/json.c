/* Summaries for the page: of everything, and of each choice of a scene and of rays. */
#include "framework/base/json.h"
#include "framework/summary/prediction.h"
#include "framework/summary/summary_private.h"

#include <cjson/cJSON.h>
#include <string.h>

/* Where there is no memory, the page must not silently lack something. */
typedef struct writer {
    bool lost;
} writer;

/* Puts `item` in, under `name` or, if that is NULL, at the end of an array; else deletes it. */
static void put(writer *w, cJSON *parent, const char *name, cJSON *item)
{
    bool done = parent != NULL && item != NULL &&
                (name != NULL ? cJSON_AddItemToObject(parent, name, item)
                              : cJSON_AddItemToArray(parent, item));
    if (done)
        return;
    w->lost = true;
    cJSON_Delete(item);
}

static void put_figure(writer *w, cJSON *parent, const char *name, double value)
{
    put(w, parent, name, isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull());
}

static void put_text(writer *w, cJSON *object, const char *name, const char *text)
{
    put(w, object, name, cJSON_CreateString(text));
}

static void put_bool(writer *w, cJSON *object, const char *name, bool value)
{
    put(w, object, name, cJSON_CreateBool(value));
}

/* Of the parent's; NULL if it could not be made. */
static cJSON *put_array(writer *w, cJSON *object, const char *name)
{
    cJSON *array = cJSON_AddArrayToObject(object, name);
    w->lost = w->lost || array == NULL;
    return array;
}

static cJSON *standing_json(writer *w, const bb_standing *standing)
{
    cJSON *made = cJSON_CreateObject();
    put_figure(w, made, "value", standing->value);
    put_figure(w, made, "low", standing->low);
    put_figure(w, made, "high", standing->high);
    put_bool(w, made, "best", standing->best);
    put_bool(w, made, "tied", standing->tied);
    return made;
}

static cJSON *row_json(writer *w, const bb_summary_row *row)
{
    cJSON *made = cJSON_CreateObject();
    put_text(w, made, "builder", row->builder);
    put_text(w, made, "kernel", row->kernel);
    put_figure(w, made, "run", row->run);
    put_bool(w, made, "reference", row->reference);
    put_bool(w, made, "partial", row->partial);
    put_figure(w, made, "sets", row->sets);
    put(w, made, "trace", standing_json(w, &row->trace));
    put_figure(w, made, "mrays_s", row->mrays_s);
    put_figure(w, made, "group", row->group == UINT32_MAX ? (double)NAN : row->group);
    put(w, made, "build", standing_json(w, &row->build));
    put(w, made, "ready", standing_json(w, &row->ready));
    cJSON *image = put_array(w, made, "image");
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        put(w, image, NULL, standing_json(w, &row->image[k]));
    cJSON *curve = put_array(w, made, "curve");
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++)
        put_figure(w, curve, NULL, row->curve[i]);
    put(w, made, "quality", standing_json(w, &row->quality));
    put(w, made, "overlap", standing_json(w, &row->overlap));
    put(w, made, "work", standing_json(w, &row->work));
    put_figure(w, made, "peak", row->peak);
    put_figure(w, made, "wrong", row->wrong);
    put_figure(w, made, "checked", row->checked);
    put_figure(w, made, "failed", row->failed);
    return made;
}

static cJSON *accuracy_json(writer *w, const bb_summary_accuracy *accuracy)
{
    const bb_wrong_rate rate = bb_wrong_rate_of(accuracy->wrong, accuracy->checked);
    cJSON *made = cJSON_CreateObject();
    put_text(w, made, "intersector", accuracy->intersector);
    put_figure(w, made, "wrong", accuracy->wrong);
    put_figure(w, made, "wrong_t", accuracy->wrong_t);
    put_figure(w, made, "checked", accuracy->checked);
    put_figure(w, made, "ppm", rate.ppm);
    put_figure(w, made, "ppm_lo", rate.low);
    put_figure(w, made, "ppm_hi", rate.high);
    put_figure(w, made, "speed", accuracy->speed);
    return made;
}

static cJSON *summary_json(writer *w, const bb_summary *s, const bb_summary_choice *choice)
{
    cJSON *made = cJSON_CreateObject();
    put_text(w, made, "scene", choice->scene != NULL ? choice->scene : "");
    put_text(w, made, "rays", choice->rays != NULL ? choice->rays : "");
    put_figure(w, made, "scenes", s->scenes);
    put_figure(w, made, "sets", s->sets);
    put_figure(w, made, "sets_aside", s->sets_aside);
    put_figure(w, made, "rounds", s->rounds);
    put_figure(w, made, "noise", s->noise);
    put_figure(w, made, "noise_worst", s->noise_worst);
    put_figure(w, made, "checked", s->checked);
    put_figure(w, made, "wrong", s->wrong);
    put_text(w, made, "reference", s->reference != NULL ? s->reference : "");
    cJSON *rows = put_array(w, made, "rows");
    for (uint32_t i = 0; i < s->row_count; i++)
        put(w, rows, NULL, row_json(w, &s->rows[i]));
    cJSON *accuracy = put_array(w, made, "accuracy");
    for (uint32_t i = 0; i < s->accuracy_count; i++)
        put(w, accuracy, NULL, accuracy_json(w, &s->accuracy[i]));
    cJSON *sentences = put_array(w, made, "sentences");
    for (uint32_t i = 0; i < s->sentence_count; i++) {
        cJSON *sentence = cJSON_CreateObject();
        put_text(w, sentence, "label", s->sentences[i].label);
        put_text(w, sentence, "text", s->sentences[i].text);
        put(w, sentences, NULL, sentence);
    }
    return made;
}

static bb_status add_choice(writer *w, cJSON *list, const bb_numbers *n,
                            const bb_summary_choice *choice)
{
    bb_summary summary;
    BB_TRY(bb_summary_of(n, choice, &summary));
    if (summary.row_count > 0)
        put(w, list, NULL, summary_json(w, &summary, choice));
    bb_summary_free(&summary);
    return BB_OK;
}

/* Names of rays, each once. */
static const char *rays_name(const bb_numbers *n, uint32_t set)
{
    for (uint32_t i = 0; i < set; i++)
        if (strcmp(n->sets[i].rays, n->sets[set].rays) == 0)
            return NULL;
    return n->sets[set].rays;
}

static bb_status add_choices(writer *w, cJSON *list, const bb_numbers *n)
{
    for (int64_t r = -1; r < n->set_count; r++) {
        const char *rays = r < 0 ? NULL : rays_name(n, (uint32_t)r);
        if (r >= 0 && rays == NULL)
            continue;
        for (int64_t s = -1; s < n->scene_count; s++)
            BB_TRY(add_choice(w, list, n, &(bb_summary_choice){s < 0 ? NULL : n->scenes[s], rays}));
    }
    return BB_OK;
}

/* [trace, time, SAH, EPO, mix, work] of each cell, by kind of rays; what follows from them the
 * document has. */
static bb_status add_predictions(writer *w, cJSON *object, const bb_results *results)
{
    bb_predictions made;
    BB_TRY(bb_predictions_make(results, &made));
    cJSON *list = put_array(w, object, "predictions");
    for (uint32_t i = 0; i < made.count; i++) {
        const bb_prediction *p = &made.kinds[i];
        cJSON *kind = cJSON_CreateObject();
        put_text(w, kind, "rays", p->rays);
        cJSON *points = put_array(w, kind, "points");
        for (uint32_t k = 0; k < p->record.cells; k++) {
            const bb_prediction_point *at = &p->points[k];
            const double figures[] = {at->trace, at->time, at->sah, at->overlap, at->mix, at->work};
            cJSON *point = cJSON_CreateArray();
            for (size_t f = 0; f < sizeof figures / sizeof figures[0]; f++)
                put(w, point, NULL,
                    isfinite(figures[f]) ? cJSON_CreateNumber(figures[f]) : cJSON_CreateNull());
            put(w, points, NULL, point);
        }
        put(w, list, NULL, kind);
    }
    bb_predictions_free(&made);
    return BB_OK;
}

char *bb_summary_json(const bb_results *results)
{
    bb_numbers numbers;
    char *text = NULL, busy[256], implausible[BB_IMPLAUSIBLE];
    writer all = {false}, *w = &all;
    if (bb_numbers_read(results, &numbers) != BB_OK)
        return NULL;
    cJSON *made = cJSON_CreateObject();
    cJSON *counts = put_array(w, made, "counts");
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        put_figure(w, counts, NULL, bb_summary_counts[k]);
    cJSON *curve = put_array(w, made, "curve_counts");
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++)
        put_figure(w, curve, NULL, bb_summary_curve_count(i));
    if (bb_summary_busy(results, busy))
        put_text(w, made, "busy", busy);
    if (bb_summary_implausible(results, implausible))
        put_text(w, made, "implausible", implausible);
    cJSON *choices = put_array(w, made, "choices");
    if (add_choices(w, choices, &numbers) == BB_OK && add_predictions(w, made, results) == BB_OK &&
        !w->lost)
        text = bb_json_print(made, false);
    cJSON_Delete(made);
    bb_numbers_free(&numbers);
    return text;
}
