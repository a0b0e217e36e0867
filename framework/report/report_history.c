/* The history's page: its records are made here, drawn by page/history.js. */
#include "framework/report/report_history.h"

#include "framework/base/file.h"
#include "framework/base/json.h"
#include "framework/report/columns.h"
#include "framework/report/template.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Embedded at build time. */
extern const char bb_text_report_css[], bb_text_chart_js[], bb_text_report_history_html[],
    bb_text_report_history_js[];

static bool add_text(cJSON *object, const char *name, const char *text)
{
    return cJSON_AddStringToObject(object, name, text) != NULL;
}

/* null if it is not finite. */
static bool add_number(cJSON *object, const char *name, double value)
{
    return isfinite(value) ? cJSON_AddNumberToObject(object, name, value) != NULL
                           : cJSON_AddNullToObject(object, name) != NULL;
}

/* A new object at the end of the list; NULL without memory. */
static cJSON *add_object(cJSON *list)
{
    cJSON *object = cJSON_CreateObject();
    if (object != NULL && cJSON_AddItemToArray(list, object))
        return object;
    cJSON_Delete(object);
    return NULL;
}

/* ---- a cell ---- */

static const char *const verdicts[] = {
    [BB_WORSE] = "worse", [BB_BETTER] = "better", [BB_CHANGED] = "changed"};

static bool add_move(cJSON *list, uint32_t at, const bb_change *move)
{
    cJSON *object = add_object(list);
    return object != NULL && add_number(object, "at", at) &&
           add_text(object, "what", move->timed ? "ms" : move->what) &&
           add_text(object, "verdict", verdicts[move->verdict]) &&
           cJSON_AddBoolToObject(object, "counts", move->counts) != NULL &&
           add_number(object, "from", move->from) && add_number(object, "to", move->to) &&
           add_number(object, "ratio", move->effect.ratio) &&
           add_number(object, "low", move->effect.low) &&
           add_number(object, "high", move->effect.high) && add_number(object, "p", move->p);
}

static bool add_point(cJSON *list, uint32_t at, const bb_measured *cell)
{
    cJSON *object = add_object(list);
    bb_estimate e = bb_samples_estimate(&cell->ms);
    bool ok = object != NULL && add_number(object, "at", at) &&
              add_text(object, "status", cell->status) && add_number(object, "ms", e.value) &&
              add_number(object, "lo", e.low) && add_number(object, "hi", e.high) &&
              add_number(object, "least", e.least) && add_number(object, "most", e.most);
    cJSON *figures = ok ? cJSON_AddObjectToObject(object, "figures") : NULL;
    ok = figures != NULL;
    for (uint32_t i = 0; i < cell->figure_count && ok; i++)
        ok = add_number(figures, cell->figures[i].name, cell->figures[i].value);
    return ok;
}

/* Without parameters that have their defaults. */
static bool add_names(cJSON *object, const char *key)
{
    bb_cell cell;
    char brief[BB_CELL_KEY];
    snprintf(brief, sizeof brief, "%s", key);
    if (bb_cell_key_parse(key, &cell) == BB_OK) {
        bb_cell_short(&cell);
        if (bb_cell_key_format(&cell, brief) != BB_OK)
            snprintf(brief, sizeof brief, "%s", key);
    }
    return add_text(object, "key", key) && add_text(object, "name", brief);
}

static bool add_cell(cJSON *list, const bb_trend *trend, const char *key)
{
    cJSON *object = add_object(list);
    if (object == NULL || !add_names(object, key))
        return false;
    cJSON *points = cJSON_AddArrayToObject(object, "points");
    cJSON *moves = cJSON_AddArrayToObject(object, "moves");
    bool ok = points != NULL && moves != NULL;
    for (uint32_t i = 0; i < trend->count && ok; i++) {
        const bb_measured *cell = bb_cell_set_find(&trend->sets[i], key);
        const bb_comparison_result *step = &trend->steps[i];
        ok = cell == NULL || add_point(points, i, cell);
        for (uint32_t m = 0; m < step->move_count && ok; m++)
            if (strcmp(step->moves[m].after->key, key) == 0)
                ok = add_move(moves, i, &step->moves[m]);
    }
    return ok;
}

/* ---- a machine ---- */

static int by_text(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* The keys of all its cells, each once. */
static bool add_cells(cJSON *object, const bb_trend *trend)
{
    size_t room = 1, count = 0;
    for (uint32_t i = 0; i < trend->count; i++)
        room += trend->sets[i].count;
    const char **keys = malloc(room * sizeof *keys);
    cJSON *list = cJSON_AddArrayToObject(object, "cells");
    bool ok = keys != NULL && list != NULL;
    for (uint32_t i = 0; i < trend->count && ok; i++)
        for (uint32_t c = 0; c < trend->sets[i].count; c++)
            keys[count++] = trend->sets[i].cells[c].key;
    if (ok)
        qsort(keys, count, sizeof *keys, by_text);
    for (size_t i = 0; i < count && ok; i++)
        if (i == 0 || strcmp(keys[i - 1], keys[i]) != 0)
            ok = add_cell(list, trend, keys[i]);
    free(keys);
    return ok;
}

static bool add_machine(cJSON *list, const bb_trend *trend)
{
    cJSON *object = add_object(list);
    const bb_origin *o = &trend->entries[0].origin;
    if (object == NULL || !add_text(object, "host", o->host) || !add_text(object, "cpu", o->cpu) ||
        !add_text(object, "device", o->device) || !add_text(object, "driver", o->driver) ||
        !add_number(object, "floor", trend->floor.share) ||
        !add_text(object, "floor_from", trend->floor.from))
        return false;
    cJSON *revisions = cJSON_AddArrayToObject(object, "revisions");
    bool ok = revisions != NULL;
    for (uint32_t i = 0; i < trend->count && ok; i++) {
        cJSON *revision = add_object(revisions);
        const bb_history_entry *entry = &trend->entries[i];
        ok = revision != NULL && add_text(revision, "revision", entry->origin.revision) &&
             add_text(revision, "date", entry->origin.date) &&
             add_number(revision, "runs", entry->runs);
    }
    return ok && add_cells(object, trend);
}

/* For cJSON_free(); NULL without memory. */
static char *history_json(const bb_trend *trends, uint32_t count)
{
    cJSON *root = cJSON_CreateObject();
    cJSON *machines = root != NULL ? cJSON_AddArrayToObject(root, "machines") : NULL;
    bool ok = machines != NULL &&
              cJSON_AddNumberToObject(root, "assumed", BB_COMPARE_FLOOR_UNKNOWN) != NULL &&
              cJSON_AddNumberToObject(root, "level", BB_COMPARE_LEVEL) != NULL;
    for (uint32_t i = 0; i < count && ok; i++)
        ok = add_machine(machines, &trends[i]);
    char *json = ok ? bb_json_print(root, false) : NULL;
    cJSON_Delete(root);
    return json;
}

bb_status bb_report_history(const bb_trend *trends, uint32_t count, const char *path)
{
    if (count == 0)
        return bb_fail(BB_INVALID, "the history has no runs yet: bvhbench run --history DB");
    bb_page_text page = {0};
    char *json = history_json(trends, count);
    if (json == NULL)
        return bb_fail(BB_FAILED, "report %s: no memory", path);
    const bb_page_part parts[] = {
        {"@BB_CSS@", bb_text_report_css, false},
        {"@BB_HISTORY@", json, true},
        {"@BB_CHART_JS@", bb_text_chart_js, false},
        {"@BB_SCRIPT@", bb_text_report_history_js, false},
    };
    bb_status status =
        bb_page_fill(&page, bb_text_report_history_html, parts, sizeof parts / sizeof parts[0]);
    if (status == BB_OK)
        status = bb_file_write(path, page.data, page.size, "report");
    free(page.data);
    cJSON_free(json);
    return status;
}

/* ---- as text ---- */

bb_status bb_report_history_text(const bb_trend *trends, uint32_t count, FILE *out)
{
    for (uint32_t t = 0; t < count; t++) {
        const bb_trend *trend = &trends[t];
        fputs(t > 0 ? "\n " : " ", out);
        bb_print_text(out, trend->entries[0].origin.host, 0);
        fputs(", ", out);
        bb_print_text(out, trend->entries[0].origin.device, 0);
        fputc('\n', out);
        for (uint32_t i = trend->count; i-- > 0;) {
            const bb_comparison_result *step = &trend->steps[i];
            uint32_t counts[3] = {0};
            for (uint32_t m = 0; m < step->move_count; m++)
                counts[step->moves[m].verdict]++;
            fputs("  ", out);
            bb_print_text(out, trend->entries[i].origin.revision, 24);
            fputc(' ', out);
            bb_print_text(out, trend->entries[i].origin.date, 20);
            fprintf(out, "  %3u runs, %5u cells: %u worse, %u better, %u changed\n",
                    trend->entries[i].runs, trend->sets[i].count, counts[BB_WORSE],
                    counts[BB_BETTER], counts[BB_CHANGED]);
        }
    }
    return BB_OK;
}
