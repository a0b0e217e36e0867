/* Summaries for the page, of all results and of each choice of a scene and of rays. */
#include "framework/base/json.h"
#include "framework/compare/prediction.h"
#include "framework/compare/summary_private.h"

#include <string.h>

static void put_standing(bb_json *json, const char *name, const bb_standing *standing)
{
    bb_json_object(json, name);
    bb_json_add_number(json, "value", standing->value);
    bb_json_add_number(json, "low", standing->low);
    bb_json_add_number(json, "high", standing->high);
    bb_json_add_bool(json, "best", standing->best);
    bb_json_add_bool(json, "tied", standing->tied);
    bb_json_end_object(json);
}

/* Wrong rays of those judged, and the 95 % interval of their rate. */
static void put_wrong(bb_json *json, double wrong, double checked)
{
    const bb_wrong_rate rate = bb_wrong_rate_of(wrong, checked);
    bb_json_add_number(json, "wrong", wrong);
    bb_json_add_number(json, "checked", checked);
    bb_json_add_number(json, "ppm", rate.ppm);
    bb_json_add_number(json, "ppm_lo", rate.low);
    bb_json_add_number(json, "ppm_hi", rate.high);
}

static void put_row(bb_json *json, const bb_summary_row *row)
{
    bb_json_object(json, NULL);
    bb_json_add_text(json, "builder", row->builder);
    bb_json_add_text(json, "kernel", row->kernel);
    bb_json_add_number(json, "run", row->run);
    bb_json_add_bool(json, "reference", row->reference);
    bb_json_add_bool(json, "partial", row->partial);
    bb_json_add_number(json, "sets", row->sets);
    put_standing(json, "trace", &row->trace);
    bb_json_add_number(json, "mrays_s", row->mrays_s);
    bb_json_add_number(json, "group", row->group == UINT32_MAX ? (double)NAN : row->group);
    bb_json_add_number(json, "untimed", row->untimed);
    bb_json_add_bool(json, "leaves_out", row->leaves_out);
    put_standing(json, "build", &row->build);
    put_standing(json, "ready", &row->ready);
    bb_json_array(json, "image");
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        put_standing(json, NULL, &row->image[k]);
    bb_json_end_array(json);
    bb_json_array(json, "curve");
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++)
        bb_json_add_number(json, NULL, row->curve[i]);
    bb_json_end_array(json);
    put_standing(json, "quality", &row->quality);
    put_standing(json, "overlap", &row->overlap);
    put_standing(json, "work", &row->work);
    bb_json_add_number(json, "tree", row->tree);
    bb_json_add_number(json, "peak", row->peak);
    put_wrong(json, row->wrong, row->checked);
    bb_json_add_number(json, "failed", row->failed);
    bb_json_end_object(json);
}

static void put_accuracy(bb_json *json, const bb_summary_accuracy *accuracy)
{
    bb_json_object(json, NULL);
    bb_json_add_text(json, "intersector", accuracy->intersector);
    put_wrong(json, accuracy->wrong, accuracy->checked);
    bb_json_add_number(json, "wrong_t", accuracy->wrong_t);
    bb_json_add_number(json, "speed", accuracy->speed);
    bb_json_end_object(json);
}

static void put_simulation(bb_json *json, const bb_summary *s, const bb_summary_simulation *of)
{
    bb_json_object(json, NULL);
    bb_json_add_text(json, "name", of->name);
    bb_json_add_number(json, "sets", of->sets);
    bb_json_add_number(json, "correlation", of->correlation);
    bb_json_add_number(json, "stability", of->stability);
    bb_json_array(json, "mrays_s"); /* of each row */
    for (uint32_t i = 0; i < s->row_count; i++)
        bb_json_add_number(json, NULL, of->mrays_s[i]);
    bb_json_end_array(json);
    bb_json_array(json, "binds");
    for (uint32_t i = 0; i < s->row_count; i++)
        bb_json_add_text(json, NULL, bb_binding_word(of->binds[i]));
    bb_json_end_array(json);
    bb_json_end_object(json);
}

static void put_summary(bb_json *json, const bb_summary *s, const bb_summary_choice *choice)
{
    bb_json_object(json, NULL);
    bb_json_add_text(json, "scene", choice->scene != NULL ? choice->scene : "");
    bb_json_add_text(json, "rays", choice->rays != NULL ? choice->rays : "");
    bb_json_add_number(json, "scenes", s->scenes);
    bb_json_add_number(json, "sets", s->sets);
    bb_json_add_number(json, "sets_aside", s->sets_aside);
    bb_json_add_number(json, "rounds", s->rounds);
    bb_json_add_number(json, "noise", s->noise);
    bb_json_add_number(json, "noise_worst", s->noise_worst);
    bb_json_add_number(json, "checked", s->checked);
    bb_json_add_number(json, "wrong", s->wrong);
    bb_json_add_text(json, "reference", s->reference != NULL ? s->reference : "");
    bb_json_array(json, "rows");
    for (uint32_t i = 0; i < s->row_count; i++)
        put_row(json, &s->rows[i]);
    bb_json_end_array(json);
    bb_json_array(json, "accuracy");
    for (uint32_t i = 0; i < s->accuracy_count; i++)
        put_accuracy(json, &s->accuracy[i]);
    bb_json_end_array(json);
    bb_json_array(json, "simulations");
    for (uint32_t i = 0; i < s->simulation_count; i++)
        put_simulation(json, s, &s->simulations[i]);
    bb_json_end_array(json);
    bb_json_array(json, "sentences");
    for (uint32_t i = 0; i < s->sentence_count; i++) {
        bb_json_object(json, NULL);
        bb_json_add_text(json, "label", s->sentences[i].label);
        bb_json_add_text(json, "text", s->sentences[i].text);
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
    bb_json_end_object(json);
}

static bb_status put_choice(bb_json *json, const bb_numbers *n, const bb_summary_choice *choice)
{
    bb_summary summary;
    BB_TRY(bb_summary_of(n, choice, &summary));
    if (summary.row_count > 0)
        put_summary(json, &summary, choice);
    bb_summary_free(&summary);
    return BB_OK;
}

/* Returns the name of the set's rays; NULL if an earlier set has it. */
static const char *rays_name(const bb_numbers *n, uint32_t set)
{
    for (uint32_t i = 0; i < set; i++)
        if (strcmp(n->sets[i].rays, n->sets[set].rays) == 0)
            return NULL;
    return n->sets[set].rays;
}

static bb_status put_choices(bb_json *json, const bb_numbers *n)
{
    for (int64_t r = -1; r < n->set_count; r++) {
        const char *rays = r < 0 ? NULL : rays_name(n, (uint32_t)r);
        if (r >= 0 && rays == NULL)
            continue;
        for (int64_t s = -1; s < n->scene_count; s++)
            BB_TRY(put_choice(json, n, &(bb_summary_choice){s < 0 ? NULL : n->scenes[s], rays}));
    }
    return BB_OK;
}

/* Puts [trace, time, SAH, EPO, mix, work] of each cell, grouped by kind of rays. The fitted figures
 * are in the results. */
static bb_status put_predictions(bb_json *json, const bb_results *results)
{
    bb_predictions made;
    BB_TRY(bb_predictions_make(results, &made));
    bb_json_array(json, "predictions");
    for (uint32_t i = 0; i < made.count; i++) {
        const bb_prediction *p = &made.kinds[i];
        bb_json_object(json, NULL);
        bb_json_add_text(json, "rays", p->rays);
        bb_json_array(json, "points");
        for (uint32_t k = 0; k < p->record.cells; k++) {
            const bb_prediction_point *at = &p->points[k];
            const double figures[] = {at->trace, at->time, at->sah, at->overlap, at->mix, at->work};
            bb_json_array(json, NULL);
            for (size_t f = 0; f < sizeof figures / sizeof figures[0]; f++)
                bb_json_add_number(json, NULL, figures[f]);
            bb_json_end_array(json);
        }
        bb_json_end_array(json);
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
    bb_predictions_free(&made);
    return BB_OK;
}

char *bb_summary_json(const bb_results *results)
{
    bb_numbers numbers;
    char busy[256], implausible[BB_IMPLAUSIBLE];
    bb_json json = {0};
    if (bb_numbers_read(results, &numbers) != BB_OK)
        return NULL;
    bb_json_object(&json, NULL);
    bb_json_array(&json, "counts");
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        bb_json_add_number(&json, NULL, bb_summary_counts[k]);
    bb_json_end_array(&json);
    bb_json_array(&json, "curve_counts");
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++)
        bb_json_add_number(&json, NULL, bb_summary_curve_count(i));
    bb_json_end_array(&json);
    if (bb_summary_busy(results, busy))
        bb_json_add_text(&json, "busy", busy);
    if (bb_summary_implausible(results, implausible))
        bb_json_add_text(&json, "implausible", implausible);
    bb_json_array(&json, "choices");
    bb_status status = put_choices(&json, &numbers);
    bb_json_end_array(&json);
    if (status == BB_OK)
        status = put_predictions(&json, results);
    bb_json_end_object(&json);
    bb_numbers_free(&numbers);
    json.lost = json.lost || status != BB_OK;
    return bb_json_take(&json);
}
