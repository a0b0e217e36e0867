/* Summaries for the page: of everything, and of each choice of a scene and of rays. */
#include "framework/summary/summary_private.h"

#include <cjson/cJSON.h>
#include <string.h>

static cJSON *figure_json(double value)
{
    return isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull();
}

static void add(cJSON *object, const char *name, double value)
{
    cJSON_AddItemToObject(object, name, figure_json(value));
}

static cJSON *standing_json(const bb_standing *standing)
{
    cJSON *made = cJSON_CreateObject();
    add(made, "value", standing->value);
    add(made, "low", standing->low);
    add(made, "high", standing->high);
    cJSON_AddBoolToObject(made, "best", standing->best);
    cJSON_AddBoolToObject(made, "tied", standing->tied);
    return made;
}

static void add_standing(cJSON *object, const char *name, const bb_standing *standing)
{
    cJSON_AddItemToObject(object, name, standing_json(standing));
}

static cJSON *row_json(const bb_summary_row *row)
{
    cJSON *made = cJSON_CreateObject();
    cJSON_AddStringToObject(made, "builder", row->builder);
    cJSON_AddStringToObject(made, "kernel", row->kernel);
    add(made, "run", row->run);
    cJSON_AddBoolToObject(made, "reference", row->reference);
    cJSON_AddBoolToObject(made, "partial", row->partial);
    add(made, "sets", row->sets);
    add_standing(made, "trace", &row->trace);
    add(made, "mrays_s", row->mrays_s);
    add(made, "group", row->group == UINT32_MAX ? (double)NAN : row->group);
    add_standing(made, "build", &row->build);
    add_standing(made, "ready", &row->ready);
    cJSON *image = cJSON_AddArrayToObject(made, "image");
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        cJSON_AddItemToArray(image, standing_json(&row->image[k]));
    cJSON *curve = cJSON_AddArrayToObject(made, "curve");
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++)
        cJSON_AddItemToArray(curve, figure_json(row->curve[i]));
    add_standing(made, "quality", &row->quality);
    add(made, "peak", row->peak);
    add(made, "wrong", row->wrong);
    add(made, "checked", row->checked);
    add(made, "failed", row->failed);
    return made;
}

static cJSON *accuracy_json(const bb_summary_accuracy *accuracy)
{
    const bb_wrong_rate rate = bb_wrong_rate_of(accuracy->wrong, accuracy->checked);
    cJSON *made = cJSON_CreateObject();
    cJSON_AddStringToObject(made, "intersector", accuracy->intersector);
    add(made, "wrong", accuracy->wrong);
    add(made, "wrong_t", accuracy->wrong_t);
    add(made, "checked", accuracy->checked);
    add(made, "ppm", rate.ppm);
    add(made, "ppm_lo", rate.low);
    add(made, "ppm_hi", rate.high);
    add(made, "speed", accuracy->speed);
    return made;
}

static cJSON *summary_json(const bb_summary *s, const bb_summary_choice *choice)
{
    cJSON *made = cJSON_CreateObject();
    cJSON_AddStringToObject(made, "scene", choice->scene != NULL ? choice->scene : "");
    cJSON_AddStringToObject(made, "rays", choice->rays != NULL ? choice->rays : "");
    add(made, "scenes", s->scenes);
    add(made, "sets", s->sets);
    add(made, "sets_aside", s->sets_aside);
    add(made, "rounds", s->rounds);
    add(made, "noise", s->noise);
    add(made, "noise_worst", s->noise_worst);
    add(made, "checked", s->checked);
    add(made, "wrong", s->wrong);
    cJSON_AddBoolToObject(made, "referenced", s->referenced);
    cJSON *rows = cJSON_AddArrayToObject(made, "rows");
    for (uint32_t i = 0; i < s->row_count; i++)
        cJSON_AddItemToArray(rows, row_json(&s->rows[i]));
    cJSON *accuracy = cJSON_AddArrayToObject(made, "accuracy");
    for (uint32_t i = 0; i < s->accuracy_count; i++)
        cJSON_AddItemToArray(accuracy, accuracy_json(&s->accuracy[i]));
    cJSON *sentences = cJSON_AddArrayToObject(made, "sentences");
    for (uint32_t i = 0; i < s->sentence_count; i++) {
        cJSON *sentence = cJSON_CreateObject();
        cJSON_AddStringToObject(sentence, "label", s->sentences[i].label);
        cJSON_AddStringToObject(sentence, "text", s->sentences[i].text);
        cJSON_AddItemToArray(sentences, sentence);
    }
    return made;
}

static bb_status add_choice(cJSON *list, const bb_numbers *n, const bb_summary_choice *choice)
{
    bb_summary summary;
    BB_TRY(bb_summary_of(n, choice, &summary));
    if (summary.row_count > 0)
        cJSON_AddItemToArray(list, summary_json(&summary, choice));
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

static bb_status add_choices(cJSON *list, const bb_numbers *n)
{
    for (int64_t r = -1; r < n->set_count; r++) {
        const char *rays = r < 0 ? NULL : rays_name(n, (uint32_t)r);
        if (r >= 0 && rays == NULL)
            continue;
        for (int64_t s = -1; s < n->scene_count; s++)
            BB_TRY(add_choice(list, n, &(bb_summary_choice){s < 0 ? NULL : n->scenes[s], rays}));
    }
    return BB_OK;
}

char *bb_summary_json(const bb_results *results)
{
    bb_numbers numbers;
    char *text = NULL, busy[256];
    if (bb_numbers_read(results, &numbers) != BB_OK)
        return NULL;
    cJSON *made = cJSON_CreateObject();
    cJSON *counts = cJSON_AddArrayToObject(made, "counts");
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        cJSON_AddItemToArray(counts, cJSON_CreateNumber(bb_summary_counts[k]));
    cJSON *curve = cJSON_AddArrayToObject(made, "curve_counts");
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++)
        cJSON_AddItemToArray(curve, cJSON_CreateNumber(bb_summary_curve_count(i)));
    if (bb_summary_busy(results, busy))
        cJSON_AddStringToObject(made, "busy", busy);
    if (add_choices(cJSON_AddArrayToObject(made, "choices"), &numbers) == BB_OK)
        text = cJSON_PrintUnformatted(made);
    cJSON_Delete(made);
    bb_numbers_free(&numbers);
    return text;
}
