/* Puts results together: rows are copied, and get the number of their run. */
#include "framework/record/record_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- for merging and joining ---- */

/* Predictions follow from all rows, and steps add up. */
static bool is_computed(const bb_results *from, uint32_t row)
{
    const bb_cell cell = bb_table_cell(from->table, row);
    const bool step = cell.names[BB_MAKER] != NULL;
    const bool question = cell.names[BB_QUESTION] != NULL;
    if (cell.names[BB_SCENE] != NULL || step == question)
        return false;
    return step || bb_get_text(from->entries[row], BB_F_PAPER_TITLE)[0] == '\0';
}

bb_status bb_results_copy(bb_results *to, const bb_results *from, bb_target_fn *aim, void *user)
{
    for (uint32_t row = 0; row < bb_table_row_count(from->table); row++) {
        const char *tree_run = bb_get_text(from->entries[row], BB_F_TRACE_TREE_RUN);
        bb_target at = {bb_table_cell(from->table, row), tree_run[0] != '\0' ? tree_run : NULL};
        if (is_computed(from, row) || !aim(user, to, from, row, &at))
            continue;
        const uint32_t copy = bb_table_row(to->table, at.cell);
        bb_table_copy(to->table, copy, from->table, row);
        if (at.tree_run != NULL)
            bb_table_set_text(to->table, copy, bb_field_column(BB_F_TRACE_TREE_RUN), at.tree_run);
        BB_TRY(bb_table_status(to->table));
        BB_TRY(bb_results_enter(to, copy));
    }
    return BB_OK;
}

bb_status bb_results_check_scenes(const bb_results *a, const bb_results *b)
{
    bb_each(scene, bb_results_section(b, BB_SCENES))
    {
        const char *name = bb_get_text(scene, BB_F_SCENE_NAME);
        const bb_entry *known = bb_results_scene(a, name);
        if (known != NULL && !bb_same_text(known, scene, BB_F_SCENE_HASH))
            return bb_fail(BB_INVALID,
                           "scene %s has other geometry in the second result file (%s, not %s): "
                           "make separate reports",
                           name, bb_get_text(scene, BB_F_SCENE_HASH),
                           bb_get_text(known, BB_F_SCENE_HASH));
    }
    return BB_OK;
}

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

/* ---- merging ---- */

/* Checks that both runs are of one device: else devices would be mixed in one ranking. An external
 * tracer's answers have no device. */
static bb_status check_devices(const bb_results *a, const bb_results *b)
{
    const bb_entry *one = bb_results_context(a), *other = bb_results_context(b);
    const char *device = bb_get_text(one, BB_F_CONTEXT_DEVICE);
    const char *another = bb_get_text(other, BB_F_CONTEXT_DEVICE);
    return device[0] == '\0' || another[0] == '\0' ||
                   bb_device_is_like(device, bb_get_text(one, BB_F_CONTEXT_DEVICE_TYPE), another,
                                     bb_get_text(other, BB_F_CONTEXT_DEVICE_TYPE))
               ? BB_OK
               : bb_fail(
                     BB_INVALID,
                     "the second result file was measured on %s, the first on %s: make separate "
                     "reports",
                     another, device);
}

typedef struct numbering {
    uint32_t first; /* number of the run that is the first in b */
    char run[16], tree_run[16];
} numbering;

static const char *shift(uint32_t first, const char *run, char text[16])
{
    return bb_run_name(first + (run != NULL ? (uint32_t)strtoul(run, NULL, 10) : 0), text);
}

/* A scene of both has its rows once. All others are of further runs. */
static bool aim(void *user, const bb_results *to, const bb_results *from, uint32_t row,
                bb_target *target)
{
    numbering *n = user;
    const char *const *names = target->cell.names;
    (void)from;
    (void)row;
    if (names[BB_SCENE] != NULL && names[BB_BUILDER] == NULL && names[BB_QUESTION] == NULL &&
        names[BB_FRAME] == NULL)
        return bb_results_find(to, target->cell) == NULL;
    target->cell.names[BB_RUN] = shift(n->first, names[BB_RUN], n->run);
    if (target->tree_run != NULL)
        target->tree_run = shift(n->first, target->tree_run, n->tree_run);
    return true;
}

bb_status bb_results_merge(bb_results *a, const bb_results *b)
{
    BB_TRY(check_devices(a, b));
    BB_TRY(bb_results_check_scenes(a, b));
    bb_results_clear_predictions(a);
    numbering n = {.first = bb_results_new_run(a)};
    if (n.first + bb_results_new_run(b) - 1 > BB_RUNS_MAX)
        return bb_fail(BB_INVALID, "more than %d runs cannot be put together", BB_RUNS_MAX);
    BB_TRY(bb_results_copy(a, b, aim, &n));
    BB_TRY(bb_results_add_steps(a, b));
    return bb_results_add_totals(a, a, b);
}
