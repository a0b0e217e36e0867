#include "framework/compare/trend.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bb_status no_memory(void)
{
    return bb_fail(BB_FAILED, "history: no memory");
}

static bool same_place(const bb_origin *a, const bb_origin *b)
{
    bool host;
    return bb_same_machine(a, b, &host) && host;
}

/* Puts the cells of `set` into `known`, in place of those of the same keys. The copies are shallow:
 * the sets still own what they point to. */
static bb_status renew(bb_cell_set *known, const bb_cell_set *set)
{
    uint32_t room = known->count + set->count, i = 0, k = 0;
    bb_cell_set merged = {.origin = set->origin, .capacity = room};
    merged.cells = malloc((room + 1) * sizeof *merged.cells);
    if (merged.cells == NULL)
        return no_memory();
    while (i < known->count || k < set->count) {
        int order = i == known->count ? 1
                    : k == set->count ? -1
                                      : strcmp(known->cells[i].key, set->cells[k].key);
        merged.cells[merged.count++] = order < 0 ? known->cells[i] : set->cells[k];
        i += order <= 0;
        k += order >= 0;
    }
    free(known->cells);
    *known = merged;
    return BB_OK;
}

static bool have_common(const bb_cell_set *a, const bb_cell_set *b)
{
    for (uint32_t i = 0; i < b->count; i++)
        if (bb_cell_set_find(a, b->cells[i].key) != NULL)
            return true;
    return false;
}

/* Compares entry i with what was known before it. */
static bb_status step(bb_trend *trend, uint32_t i, const bb_cell_set *known)
{
    bb_comparison_result *result = &trend->steps[i];
    const bb_floor *floor = isfinite(trend->floor.share) ? &trend->floor : NULL;
    if (!have_common(known, &trend->sets[i]))
        return BB_OK;
    bb_status status =
        bb_compare(&(bb_side){known, 1}, &(bb_side){&trend->sets[i], 1}, NAN, floor, result);
    for (uint32_t m = 0; m < result->move_count; m++)
        result->moves[m].before = NULL; /* it points to what this call frees */
    result->before = result->after = (bb_side){NULL, 0};
    return status;
}

static bb_status fill(bb_history *history, bb_trend *trend)
{
    bb_cell_set known = {.count = 0};
    bb_status status = bb_history_floor(history, &trend->entries[0].origin, &trend->floor);
    trend->sets = calloc(trend->count, sizeof *trend->sets);
    trend->steps = calloc(trend->count, sizeof *trend->steps);
    if (trend->sets == NULL || trend->steps == NULL)
        return no_memory();
    for (uint32_t i = 0; i < trend->count && status == BB_OK; i++) {
        status = bb_history_set(history, &trend->entries[i], &trend->sets[i]);
        if (status == BB_OK)
            status = step(trend, i, &known);
        if (status == BB_OK)
            status = renew(&known, &trend->sets[i]);
    }
    free(known.cells);
    return status;
}

/* Moves the entries of the last entry's machine from the list into the trend. */
static bb_status take_machine(bb_history_entry *entries, uint32_t *count, bb_trend *trend)
{
    const bb_origin machine = entries[*count - 1].origin;
    uint32_t left = 0;
    trend->entries = malloc(*count * sizeof *trend->entries);
    if (trend->entries == NULL)
        return no_memory();
    for (uint32_t i = 0; i < *count; i++)
        if (same_place(&entries[i].origin, &machine))
            trend->entries[trend->count++] = entries[i];
        else
            entries[left++] = entries[i];
    *count = left;
    return BB_OK;
}

bb_status bb_history_trends(bb_history *history, bb_trend **trends, uint32_t *count)
{
    bb_history_entry *entries = NULL;
    uint32_t left;
    *trends = NULL;
    *count = 0;
    bb_status status = bb_history_list(history, &entries, &left);
    if (status == BB_OK && (*trends = calloc(left + 1, sizeof **trends)) == NULL)
        status = no_memory();
    while (status == BB_OK && left > 0) {
        bb_trend *trend = &(*trends)[(*count)++];
        status = take_machine(entries, &left, trend);
        if (status == BB_OK)
            status = fill(history, trend);
    }
    free(entries);
    return status;
}

void bb_trends_free(bb_trend *trends, uint32_t count)
{
    for (uint32_t t = 0; t < count; t++) {
        for (uint32_t i = 0; i < trends[t].count; i++) {
            if (trends[t].sets != NULL)
                bb_cell_set_free(&trends[t].sets[i]);
            if (trends[t].steps != NULL)
                bb_compare_free(&trends[t].steps[i]);
        }
        bb_floor_free(&trends[t].floor);
        free(trends[t].entries);
        free(trends[t].sets);
        free(trends[t].steps);
    }
    free(trends);
}
