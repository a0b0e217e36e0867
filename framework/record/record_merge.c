/* Puts tables together, of whatever command: rows are copied, and get the number of their run. Of
 * results, scenes are of all runs, and steps add up. */
#include "framework/record/record_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- rows ---- */

bb_status bb_table_copy_rows(bb_table *to, const bb_table *from, bb_target_fn *aim, void *user)
{
    const char *column = bb_fields[BB_F_TRACE_TREE_RUN].name;
    for (uint32_t row = 0; row < bb_table_row_count(from); row++) {
        const char *tree_run = bb_table_get_text(from, row, column);
        bb_target at = {bb_table_cell(from, row), tree_run[0] != '\0' ? tree_run : NULL};
        if (!aim(user, to, from, row, &at))
            continue;
        const uint32_t copy = bb_table_row(to, at.cell);
        bb_table_copy(to, copy, from, row);
        if (at.tree_run != NULL)
            bb_table_set_text(to, copy, bb_field_column(BB_F_TRACE_TREE_RUN), at.tree_run);
    }
    return bb_table_status(to);
}

/* What is done with rows that are not computed. */
typedef struct results_aim {
    bb_target_fn *aim;
    void *user;
} results_aim;

/* Predictions follow from all rows, and steps add up. */
static bool aim_results(void *user, const bb_table *to, const bb_table *from, uint32_t row,
                        bb_target *target)
{
    const results_aim *own = user;
    const char *const *names = target->cell.names;
    const bool step = names[BB_MAKER] != NULL, question = names[BB_QUESTION] != NULL;
    const bool paper = bb_table_get_text(from, row, bb_fields[BB_F_PAPER_TITLE].name)[0] != '\0';
    if (names[BB_SCENE] == NULL && step != question && (step || !paper))
        return false;
    return own->aim(own->user, to, from, row, target);
}

bb_status bb_results_copy(bb_results *to, const bb_results *from, bb_target_fn *aim, void *user)
{
    results_aim own = {aim, user};
    BB_TRY(bb_table_copy_rows(to->table, from->table, aim_results, &own));
    for (uint32_t row = 0; row < bb_table_row_count(to->table); row++)
        BB_TRY(bb_results_enter(to, row));
    return BB_OK;
}

/* ---- what may be put together ---- */

static const char *text_of(const bb_table *table, bb_cell cell, bb_field_id field)
{
    return bb_table_get_text(table, bb_table_find(table, cell), bb_fields[field].name);
}

bb_status bb_tables_check_scenes(const bb_table *a, const bb_table *b)
{
    for (uint32_t row = 0; row < bb_table_row_count(b); row++) {
        const char *name = bb_table_name(b, row, BB_SCENE);
        const bb_cell scene = {{[BB_SCENE] = name}};
        const char *own = text_of(b, scene, BB_F_SCENE_HASH);
        const char *known = text_of(a, scene, BB_F_SCENE_HASH);
        if (own[0] != '\0' && known[0] != '\0' && strcmp(own, known) != 0)
            return bb_fail(BB_INVALID,
                           "scene %s has other geometry in the second result file (%s, not %s): "
                           "make separate reports",
                           name, own, known);
    }
    return BB_OK;
}

/* Checks that both runs are of one device: else devices would be mixed in one ranking. An external
 * tracer's answers have no device. */
static bb_status check_devices(const bb_table *a, const bb_table *b)
{
    const bb_cell run = {{NULL}};
    const char *device = text_of(a, run, BB_F_CONTEXT_DEVICE);
    const char *another = text_of(b, run, BB_F_CONTEXT_DEVICE);
    return device[0] == '\0' || another[0] == '\0' ||
                   bb_device_is_like(device, text_of(a, run, BB_F_CONTEXT_DEVICE_TYPE), another,
                                     text_of(b, run, BB_F_CONTEXT_DEVICE_TYPE))
               ? BB_OK
               : bb_fail(
                     BB_INVALID,
                     "the second result file was measured on %s, the first on %s: make separate "
                     "reports",
                     another, device);
}

/* ---- merging ---- */

typedef struct numbering {
    uint32_t first; /* number of the run that is the first in b */
    char run[16], tree_run[16];
} numbering;

static const char *shift(uint32_t first, const char *run, char text[16])
{
    return bb_run_name(first + (run != NULL ? (uint32_t)strtoul(run, NULL, 10) : 0), text);
}

static bool aim(void *user, const bb_table *to, const bb_table *from, uint32_t row,
                bb_target *target)
{
    numbering *n = user;
    (void)to;
    (void)from;
    (void)row;
    target->cell.names[BB_RUN] = shift(n->first, target->cell.names[BB_RUN], n->run);
    if (target->tree_run != NULL)
        target->tree_run = shift(n->first, target->tree_run, n->tree_run);
    return true;
}

/* A scene of both has its rows once. All others are of further runs. */
static bool aim_around_scenes(void *user, const bb_table *to, const bb_table *from, uint32_t row,
                              bb_target *target)
{
    const char *const *names = target->cell.names;
    if (names[BB_SCENE] != NULL && names[BB_BUILDER] == NULL && names[BB_QUESTION] == NULL &&
        names[BB_FRAME] == NULL)
        return bb_table_find(to, target->cell) == BB_NO_ROW;
    return aim(user, to, from, row, target);
}

/* Checks that b's runs can follow those of a, and begins to number them. */
static bb_status begin(const bb_table *a, const bb_table *b, numbering *n)
{
    BB_TRY(check_devices(a, b));
    BB_TRY(bb_tables_check_scenes(a, b));
    BB_TRY(bb_table_check_runs(a));
    BB_TRY(bb_table_check_runs(b));
    n->first = bb_table_runs(a);
    return n->first + bb_table_runs(b) - 1 <= BB_RUNS_MAX
               ? BB_OK
               : bb_fail(BB_INVALID, "more than %d runs cannot be put together", BB_RUNS_MAX);
}

bb_status bb_table_merge(bb_table *a, const bb_table *b)
{
    numbering n;
    BB_TRY(begin(a, b, &n));
    return bb_table_copy_rows(a, b, aim, &n);
}

bb_status bb_results_merge(bb_results *a, const bb_results *b)
{
    numbering n;
    BB_TRY(begin(a->table, b->table, &n));
    bb_results_clear_predictions(a);
    BB_TRY(bb_results_copy(a, b, aim_around_scenes, &n));
    BB_TRY(bb_results_add_steps(a, b));
    return bb_results_add_totals(a, a, b);
}

/* ---- times ---- */

bb_status bb_results_add_steps(bb_results *to, const bb_results *from)
{
    bb_each(step, bb_results_section(from, BB_STEPS))
    {
        const double ms = bb_get_number(step, BB_F_STEP_MS);
        if (isfinite(ms))
            BB_TRY(bb_results_add_step(to, bb_part_name(step), ms));
    }
    return BB_OK;
}

static double sum_of(const bb_results *a, const bb_results *b, const char *part)
{
    return bb_results_time_ms(a, part) + bb_results_time_ms(b, part);
}

bb_status bb_results_add_totals(bb_results *to, const bb_results *a, const bb_results *b)
{
    return bb_results_set_total(to, sum_of(a, b, "build"), sum_of(a, b, "trace"),
                                sum_of(a, b, "total"));
}
