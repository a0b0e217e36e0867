/* Two runs side by side, for the page: of each cell that both measured, both figures and their
 * ratio, and what the comparison says of it. */
#include "framework/base/json.h"
#include "framework/report/report_compare.h"

#include <string.h>

/* A row of the page; NAN: not known. */
typedef struct against_row {
    const bb_measured *before;
    const char *figure, *verdict;
    double from, to;
    bb_effect effect;
} against_row;

static void put_row(bb_json *json, const against_row *row)
{
    bb_json_object(json, NULL);
    bb_json_add_text(json, "cell", row->before->key);
    bb_json_add_text(json, "figure", row->figure);
    bb_json_add_number(json, "old", row->from);
    bb_json_add_number(json, "new", row->to);
    bb_json_add_number(json, "ratio", row->effect.ratio);
    bb_json_add_number(json, "low", row->effect.low);
    bb_json_add_number(json, "high", row->effect.high);
    bb_json_add_text(json, "verdict", row->verdict);
    bb_json_end_object(json);
}

static const char *verdict_of(const bb_change *move)
{
    return move == NULL ? "not told apart" : bb_change_word(move->verdict);
}

/* Returns what moved of the cell by this name; NULL: nothing did. */
static const bb_change *find_move(const bb_comparison_result *r, const bb_measured *cell,
                                  const char *what)
{
    for (uint32_t i = 0; i < r->move_count; i++)
        if (r->moves[i].before == cell && strcmp(r->moves[i].what, what) == 0)
            return &r->moves[i];
    return NULL;
}

/* The time of a cell, which is compared only on the same machine, scene and rays. */
static void put_time(bb_json *json, const bb_comparison_result *r, const bb_measured *before,
                     const bb_measured *after)
{
    against_row row = {.before = before,
                       .figure = before->time,
                       .from = bb_samples_median(&before->ms),
                       .to = bb_samples_median(&after->ms),
                       .effect = bb_effect_of_runs(&before->ms, &after->ms)};
    row.verdict = r->machines_differ              ? "another machine"
                  : !bb_same_input(before, after) ? "another scene, or other rays"
                  : !isfinite(row.effect.low)     ? "too few rounds"
                                                  : verdict_of(find_move(r, before, row.figure));
    put_row(json, &row);
}

/* The exact figures of a cell that moved; a status is none. */
static void put_moves(bb_json *json, const bb_comparison_result *r, const bb_measured *before)
{
    for (uint32_t i = 0; i < r->move_count; i++) {
        const bb_change *move = &r->moves[i];
        if (move->before != before || move->timed)
            continue;
        const against_row row = {before,     move->what, verdict_of(move),
                                 move->from, move->to,   {move->effect.ratio, NAN, NAN}};
        put_row(json, &row);
    }
}

static void put_side(bb_json *json, const char *name, const bb_origin *o)
{
    bb_json_object(json, name);
    bb_json_add_text(json, "what", o->what);
    bb_json_add_text(json, "revision", o->revision);
    bb_json_add_text(json, "date", o->date);
    bb_json_add_text(json, "host", o->host);
    bb_json_end_object(json);
}

char *bb_against_json(const bb_comparison_result *r)
{
    bb_json json = {0};
    bb_side_place place = {0, 0};
    bb_json_object(&json, NULL);
    put_side(&json, "old", &r->before.sets[0].origin);
    put_side(&json, "new", &r->after.sets[0].origin);
    bb_json_add_number(&json, "common", r->common);
    bb_json_add_number(&json, "worse", r->worse);
    bb_json_add_number(&json, "floor", r->floor.share);
    bb_json_add_text(&json, "floor_from", r->floor.from);
    bb_json_add_number(&json, "only_old", r->only_before);
    bb_json_add_number(&json, "only_new", r->only_after);
    bb_json_array(&json, "rows");
    for (const char *key; (key = bb_side_next(&r->before, &place)) != NULL;) {
        const bb_measured *before = bb_side_find(&r->before, key);
        const bb_measured *after = bb_side_find(&r->after, key);
        if (after == NULL || bb_is_clock(key))
            continue;
        if (before->ms.count > 0 && after->ms.count > 0)
            put_time(&json, r, before, after);
        put_moves(&json, r, before);
    }
    bb_json_end_array(&json);
    bb_json_end_object(&json);
    return bb_json_take(&json);
}
