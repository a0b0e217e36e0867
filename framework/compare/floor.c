/* The effect of a program against itself on a machine. The labels of pairs may be exchanged, so
 * their p-values are exact (family.c); their floor is only a least size: the effect of the typical
 * cell and the cell's own. Two separate runs may differ in much that all rounds of a run share.
 * Their floor is therefore high, the effect that 90 % of the cells do not exceed, and a cell that
 * varies more has its own floor. No single cell sets the floor of all others. An effect whose
 * interval includes 1 counts as none. */
#include "framework/compare/compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool bb_same_input(const bb_measured *a, const bb_measured *b)
{
    return strcmp(a->scene_hash, b->scene_hash) == 0 && strcmp(a->rays_hash, b->rays_hash) == 0;
}

static bool has_times(const bb_measured *cell)
{
    return strcmp(cell->status, "ok") == 0 && cell->ms.count > 0;
}

static double ratio_of(const bb_measured *before, const bb_measured *after,
                       double (*place)(const bb_samples *ms))
{
    if (before == NULL || after == NULL || !has_times(before) || !has_times(after) ||
        !bb_same_input(before, after))
        return NAN;
    double ratio = place(&after->ms) / place(&before->ms);
    return isfinite(ratio) && ratio > 0 ? ratio : (double)NAN;
}

double bb_ratio_of_medians(const bb_measured *before, const bb_measured *after)
{
    return ratio_of(before, after, bb_samples_median);
}

typedef double (*place_of_samples)(const bb_samples *ms);

static place_of_samples place_of_pair(const bb_measured *cell)
{
    return bb_is_clock(cell->key) ? bb_samples_median : bb_samples_least;
}

double bb_time_of_pair(const bb_measured *cell)
{
    return place_of_pair(cell)(&cell->ms);
}

double bb_ratio_of_pair(const bb_measured *before, const bb_measured *after)
{
    /* with more rounds the least time is less */
    return before != NULL && after != NULL && before->ms.count == after->ms.count
               ? ratio_of(before, after, place_of_pair(before))
               : (double)NAN;
}

/* Takes the ratio from pair 1 to 2, from 3 to 4 and so on, on each side. There are as many ratios
 * as pairs, and each has the noise of two runs, as the ratios of old and new have. */
double bb_floor_of_cell(const bb_side *before, const bb_side *after, const char *key)
{
    const bb_side *sides[] = {before, after};
    bb_samples ratios = {0};
    bb_samples_add(&ratios, 1); /* takes the place of the discarded one */
    for (uint32_t s = 0; s < 2; s++)
        for (uint32_t i = 1; i + 1 < sides[s]->count; i += 2) {
            double ratio = bb_ratio_of_pair(bb_cell_set_find(&sides[s]->sets[i], key),
                                            bb_cell_set_find(&sides[s]->sets[i + 1], key));
            if (isfinite(ratio) && ratios.count < BB_SAMPLES_MAX)
                bb_samples_add(&ratios, ratio);
        }
    return ratios.count > 1 ? expm1(fabs(log(bb_effect_of_pairs(&ratios).ratio))) : (double)NAN;
}

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the median effect against itself of all cells of a kind, and in *cells their number; NAN
 * if there are none. `effects` has room for all cells. */
static double typical(const bb_side *before, const bb_side *after, bool clocks, double *effects,
                      uint32_t *cells)
{
    bb_side_place place = {0, 0};
    *cells = 0;
    for (const char *key; (key = bb_side_next(before, &place)) != NULL;) {
        double effect = bb_is_clock(key) == clocks ? bb_floor_of_cell(before, after, key) : NAN;
        if (isfinite(effect))
            effects[(*cells)++] = effect;
    }
    qsort(effects, *cells, sizeof *effects, rising);
    return *cells > 0 ? fmax(BB_COMPARE_FLOOR_LEAST, effects[*cells / 2]) : (double)NAN;
}

bb_status bb_floor_of_pairs(const bb_side *before, const bb_side *after, bb_floor *floor)
{
    uint32_t cells = 0, clocks;
    bb_side_place place = {0, 0};
    while (bb_side_next(before, &place) != NULL)
        cells++;
    double *effects = calloc(cells + 1, sizeof *effects);
    if (effects == NULL)
        return bb_fail(BB_FAILED, "comparison: no memory");
    *floor = BB_NO_FLOOR;
    floor->share = typical(before, after, false, effects, &floor->cells);
    floor->clocks = typical(before, after, true, effects, &clocks);
    free(effects);
    snprintf(floor->from, sizeof floor->from,
             "the median effect of each side against itself, from pair to pair; each cell's own "
             "counts too");
    return BB_OK;
}

/* ---- of runs by themselves ---- */

static int by_key(const void *a, const void *b)
{
    return strcmp(((const bb_cell_floor *)a)->key, ((const bb_cell_floor *)b)->key);
}

static bb_cell_floor *find_own(const bb_floor *floor, uint32_t count, const char *key)
{
    const bb_cell_floor wanted = {.key = (char *)(uintptr_t)key};
    return count == 0 ? NULL : bsearch(&wanted, floor->own, count, sizeof wanted, by_key);
}

/* Notes the effect with the cell, if it is among the first `sorted` cells; else adds the cell. */
static bb_status note(bb_floor *floor, uint32_t sorted, const char *key, double share)
{
    bb_cell_floor *own = find_own(floor, sorted, key);
    if (own != NULL) {
        own->share = fmax(own->share, share);
        return BB_OK;
    }
    if (floor->own_count == floor->own_capacity) {
        uint32_t capacity = 2 * floor->own_capacity + 64;
        bb_cell_floor *grown = realloc(floor->own, capacity * sizeof *grown);
        if (grown == NULL)
            return bb_fail(BB_FAILED, "comparison: no memory");
        floor->own = grown;
        floor->own_capacity = capacity;
    }
    char *copy = strdup(key);
    if (copy == NULL)
        return bb_fail(BB_FAILED, "comparison: no memory");
    floor->own[floor->own_count++] = (bb_cell_floor){copy, share};
    return BB_OK;
}

static bb_status take_two(bb_floor *floor, const bb_cell_set *before, const bb_cell_set *after)
{
    const uint32_t sorted = floor->own_count;
    bb_status status = BB_OK;
    for (uint32_t c = 0; c < before->count && status == BB_OK; c++) {
        const bb_measured *a = &before->cells[c], *b = bb_cell_set_find(after, a->key);
        if (a->reference || bb_is_clock(a->key) || !isfinite(bb_ratio_of_medians(a, b)))
            continue;
        bb_effect effect = bb_effect_of_runs(&a->ms, &b->ms);
        if (!isfinite(effect.low))
            continue;
        bool shows = bb_effect_excludes_one(&effect);
        floor->cells++;
        status = note(floor, sorted, a->key, shows ? expm1(fabs(log(effect.ratio))) : 0);
    }
    if (floor->own_count > sorted)
        qsort(floor->own, floor->own_count, sizeof *floor->own, by_key);
    return status;
}

bb_status bb_floor_take_runs(bb_floor *floor, const bb_side *runs, uint32_t first)
{
    for (uint32_t i = first; i + 1 < runs->count; i++)
        BB_TRY(take_two(floor, &runs->sets[i], &runs->sets[i + 1]));
    return BB_OK;
}

static int by_share(const void *a, const void *b)
{
    double x = ((const bb_cell_floor *)a)->share, y = ((const bb_cell_floor *)b)->share;
    return (x > y) - (x < y);
}

void bb_floor_finish_runs(bb_floor *floor)
{
    snprintf(floor->from, sizeof floor->from,
             "what 90 %% of the cells do not exceed between runs of one program");
    if (floor->own_count == 0) {
        floor->share = NAN;
        return;
    }
    qsort(floor->own, floor->own_count, sizeof *floor->own, by_share);
    uint32_t rank = (uint32_t)ceil(0.9 * floor->own_count);
    floor->share = fmax(BB_COMPARE_FLOOR_LEAST, floor->own[rank - 1].share);
    qsort(floor->own, floor->own_count, sizeof *floor->own, by_key);
}

double bb_floor_own(const bb_floor *floor, const char *key)
{
    const bb_cell_floor *own = find_own(floor, floor->own_count, key);
    return own != NULL ? own->share : (double)NAN;
}

void bb_floor_free(bb_floor *floor)
{
    for (uint32_t i = 0; i < floor->own_count; i++)
        free(floor->own[i].key);
    free(floor->own);
    *floor = BB_NO_FLOOR;
}
