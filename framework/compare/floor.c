/* What a program shows against itself on a machine. Pairs have labels that may be exchanged, so
 * that their p-values are exact (family.c), and the floor is but a measure of what matters: that of
 * the typical cell, and the cell's own. Between two runs by themselves much may differ that all
 * rounds of a run share: there the largest effect of any cell is the floor. Those whose interval
 * has 1 in it raise no alarm anyway and are left out, or the noisiest cell would set the floor for
 * all. */
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

double bb_ratio_of_medians(const bb_measured *before, const bb_measured *after)
{
    if (before == NULL || after == NULL || !has_times(before) || !has_times(after) ||
        !bb_same_input(before, after))
        return NAN;
    double ratio = bb_samples_median(&after->ms) / bb_samples_median(&before->ms);
    return isfinite(ratio) && ratio > 0 ? ratio : (double)NAN;
}

static void start(bb_floor *floor)
{
    *floor = (bb_floor){.share = BB_COMPARE_FLOOR_LEAST};
}

static void take(bb_floor *floor, const bb_effect *effect)
{
    if (!isfinite(effect->low))
        return;
    floor->cells++;
    if (bb_effect_excludes_one(effect))
        floor->share = fmax(floor->share, expm1(fabs(log(effect->ratio))));
}

static void finish(bb_floor *floor)
{
    if (floor->cells == 0)
        floor->share = NAN;
}

/* Pairs 1 and 2, 3 and 4 ...: of each side the ratio from one to the other. They are as many as the
 * pairs, and have the noise of two of them, as the ratios of old and new have. */
double bb_floor_of_cell(const bb_side *before, const bb_side *after, const char *key)
{
    const bb_side *sides[] = {before, after};
    bb_samples ratios = {0};
    bb_samples_add(&ratios, 1); /* in the place of the one that does not count */
    for (uint32_t s = 0; s < 2; s++)
        for (uint32_t i = 1; i + 1 < sides[s]->count; i += 2) {
            double ratio = bb_ratio_of_medians(bb_cell_set_find(&sides[s]->sets[i], key),
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

bb_status bb_floor_of_pairs(const bb_side *before, const bb_side *after, bb_floor *floor)
{
    uint32_t cells = 0;
    bb_side_place place = {0, 0};
    while (bb_side_next(before, &place) != NULL)
        cells++;
    double *effects = calloc(cells + 1, sizeof *effects);
    if (effects == NULL)
        return bb_fail(BB_FAILED, "comparison: no memory");
    start(floor);
    place = (bb_side_place){0, 0};
    for (const char *key; (key = bb_side_next(before, &place)) != NULL;) {
        double effect = bb_floor_of_cell(before, after, key);
        if (isfinite(effect))
            effects[floor->cells++] = effect;
    }
    qsort(effects, floor->cells, sizeof *effects, rising);
    if (floor->cells > 0)
        floor->share = fmax(floor->share, effects[floor->cells / 2]);
    finish(floor);
    free(effects);
    snprintf(floor->from, sizeof floor->from,
             "the median effect of each side against itself, from pair to pair; each cell's own "
             "counts too");
    return BB_OK;
}

bb_status bb_floor_of_runs(const bb_side *runs, uint32_t first, bb_floor *floor)
{
    start(floor);
    for (uint32_t i = first; i + 1 < runs->count; i++)
        for (uint32_t c = 0; c < runs->sets[i].count; c++) {
            const bb_measured *a = &runs->sets[i].cells[c];
            const bb_measured *b = bb_cell_set_find(&runs->sets[i + 1], a->key);
            if (!isfinite(bb_ratio_of_medians(a, b)))
                continue;
            bb_effect effect = bb_effect_of_runs(&a->ms, &b->ms);
            take(floor, &effect);
        }
    finish(floor);
    snprintf(floor->from, sizeof floor->from, "the largest effect between runs of one program");
    return BB_OK;
}
