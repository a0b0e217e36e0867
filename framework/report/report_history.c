/* Makes the records of the history's page, which page/history.js draws. */
#include "framework/report/report_history.h"

#include "framework/base/file.h"
#include "framework/base/json.h"
#include "framework/table/page.h"
#include "framework/table/template.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Embedded at build time. */
extern const char bb_text_style_css[], bb_text_chart_js[], bb_text_report_history_html[],
    bb_text_report_history_js[];

/* ---- a cell ---- */

static void put_move(bb_json *json, uint32_t at, const bb_change *move)
{
    bb_json_object(json, NULL);
    bb_json_add_number(json, "at", at);
    bb_json_add_text(json, "what", move->timed ? "ms" : move->what);
    bb_json_add_text(json, "verdict", bb_change_word(move->verdict));
    bb_json_add_bool(json, "counts", move->counts);
    bb_json_add_number(json, "from", move->from);
    bb_json_add_number(json, "to", move->to);
    bb_json_add_number(json, "ratio", move->effect.ratio);
    bb_json_add_number(json, "low", move->effect.low);
    bb_json_add_number(json, "high", move->effect.high);
    bb_json_add_number(json, "p", move->p);
    bb_json_end_object(json);
}

static void put_point(bb_json *json, uint32_t at, const bb_measured *cell)
{
    bb_estimate e = bb_samples_estimate(&cell->ms);
    bb_json_object(json, NULL);
    bb_json_add_number(json, "at", at);
    bb_json_add_text(json, "status", cell->status);
    bb_json_add_number(json, "ms", e.value);
    bb_json_add_number(json, "lo", e.low);
    bb_json_add_number(json, "hi", e.high);
    bb_json_add_number(json, "least", e.least);
    bb_json_add_number(json, "most", e.most);
    bb_json_object(json, "figures");
    for (uint32_t i = 0; i < cell->figure_count; i++)
        bb_json_add_number(json, cell->figures[i].name, cell->figures[i].value);
    bb_json_end_object(json);
    bb_json_end_object(json);
}

static void put_cell(bb_json *json, const bb_trend *trend, const char *key)
{
    char brief[BB_CELL_KEY];
    bb_json_object(json, NULL);
    bb_cell_key_short(key, brief);
    bb_json_add_text(json, "key", key);
    bb_json_add_text(json, "name", brief);
    bb_json_array(json, "points");
    for (uint32_t i = 0; i < trend->count; i++) {
        const bb_measured *cell = bb_cell_set_find(&trend->sets[i], key);
        if (cell != NULL)
            put_point(json, i, cell);
    }
    bb_json_end_array(json);
    bb_json_array(json, "moves");
    for (uint32_t i = 0; i < trend->count; i++)
        for (uint32_t m = 0; m < trend->steps[i].move_count; m++)
            if (strcmp(trend->steps[i].moves[m].after->key, key) == 0)
                put_move(json, i, &trend->steps[i].moves[m]);
    bb_json_end_array(json);
    bb_json_end_object(json);
}

/* ---- a machine ---- */

static int by_text(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Lists the distinct keys of all cells. */
static void put_cells(bb_json *json, const bb_trend *trend)
{
    size_t room = 1, count = 0;
    for (uint32_t i = 0; i < trend->count; i++)
        room += trend->sets[i].count;
    const char **keys = malloc(room * sizeof *keys);
    if (keys == NULL) {
        json->lost = true;
        return;
    }
    for (uint32_t i = 0; i < trend->count; i++)
        for (uint32_t c = 0; c < trend->sets[i].count; c++)
            keys[count++] = trend->sets[i].cells[c].key;
    qsort(keys, count, sizeof *keys, by_text);
    bb_json_array(json, "cells");
    for (size_t i = 0; i < count; i++)
        if (i == 0 || strcmp(keys[i - 1], keys[i]) != 0)
            put_cell(json, trend, keys[i]);
    bb_json_end_array(json);
    free(keys);
}

static void put_machine(bb_json *json, const bb_trend *trend)
{
    const bb_origin *o = &trend->entries[0].origin;
    bb_json_object(json, NULL);
    bb_json_add_text(json, "host", o->host);
    bb_json_add_text(json, "cpu", o->cpu);
    bb_json_add_text(json, "device", o->device);
    bb_json_add_text(json, "driver", o->driver);
    bb_json_add_number(json, "floor", trend->floor.share);
    bb_json_add_text(json, "floor_from", trend->floor.from);
    bb_json_array(json, "revisions");
    for (uint32_t i = 0; i < trend->count; i++) {
        bb_json_object(json, NULL);
        bb_json_add_text(json, "revision", trend->entries[i].origin.revision);
        bb_json_add_text(json, "date", trend->entries[i].origin.date);
        bb_json_add_number(json, "runs", trend->entries[i].runs);
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
    put_cells(json, trend);
    bb_json_end_object(json);
}

/* Returns a text from malloc; NULL: no memory. */
static char *history_json(const bb_trend *trends, uint32_t count)
{
    bb_json json = {0};
    bb_json_object(&json, NULL);
    bb_json_add_number(&json, "assumed", BB_COMPARE_FLOOR_UNKNOWN);
    bb_json_add_number(&json, "level", BB_COMPARE_LEVEL);
    bb_json_array(&json, "machines");
    for (uint32_t i = 0; i < count; i++)
        put_machine(&json, &trends[i]);
    bb_json_end_array(&json);
    bb_json_end_object(&json);
    return bb_json_take(&json);
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
        {"@BB_CSS@", bb_text_style_css, false},
        {"@BB_HISTORY@", json, true},
        {"@BB_CHART_JS@", bb_text_chart_js, false},
        {"@BB_SCRIPT@", bb_text_report_history_js, false},
    };
    bb_status status =
        bb_page_fill(&page, bb_text_report_history_html, parts, sizeof parts / sizeof parts[0]);
    if (status == BB_OK)
        status = bb_file_write(path, page.data, page.size, "report");
    free(page.data);
    free(json);
    return status;
}

/* ---- as text ---- */

static void add_revision(bb_page *page, const bb_trend *trend, uint32_t i)
{
    const bb_comparison_result *step = &trend->steps[i];
    uint32_t counts[6] = {trend->entries[i].runs, trend->sets[i].count};
    for (uint32_t m = 0; m < step->move_count; m++)
        counts[2 + step->moves[m].verdict]++;
    bb_page_put_text(page, trend->entries[i].origin.revision);
    bb_page_put_text(page, trend->entries[i].origin.date);
    for (int k = 0; k < 6; k++)
        bb_page_put_figure(page, (bb_estimate){counts[k], NAN, NAN, NAN, NAN}, 0);
}

bb_status bb_report_history_text(const bb_trend *trends, uint32_t count, FILE *out)
{
    static const char *const headings[] = {"revision", "date", "runs", "cells"};
    bb_page *page;
    BB_TRY(bb_page_create("history", &page));
    for (uint32_t t = 0; t < count; t++) {
        const bb_origin *o = &trends[t].entries[0].origin;
        char title[sizeof o->host + sizeof o->device + 2];
        snprintf(title, sizeof title, "%s, %s", o->host, o->device);
        bb_page_grid(page, title);
        for (int k = 0; k < 4; k++)
            bb_page_column(page, headings[k], "", "", 0);
        for (bb_change_verdict v = BB_WORSE; v <= BB_CHANGED; v++)
            bb_page_column(page, bb_change_word(v), "", "", 0);
        for (uint32_t i = trends[t].count; i-- > 0;)
            add_revision(page, &trends[t], i);
    }
    return bb_page_end(page, bb_page_print, out);
}
