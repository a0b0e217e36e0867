/* What a comparison could have seen, cell by cell. */
#include "framework/compare/compare.h"

#include <stdlib.h>
#include <string.h>

static int blindest_first(const void *left, const void *right)
{
    const bb_sight *a = left, *b = right;
    if (a->least != b->least)
        return a->least > b->least ? -1 : 1;
    return strcmp(a->cell->key, b->cell->key);
}

static int by_wall_key(const void *left, const void *right)
{
    char keys[2][BB_CELL_KEY];
    bb_wall_key(((const bb_sight *)left)->cell->key, keys[0]);
    bb_wall_key(((const bb_sight *)right)->cell->key, keys[1]);
    return strcmp(keys[0], keys[1]);
}

/* Makes one sight of those of a cell's wall time and processor time: the better one. */
static void unite_clocks(bb_comparison_result *result)
{
    bb_sight *sights = result->sights;
    uint32_t kept = 0;
    qsort(sights, result->sight_count, sizeof *sights, by_wall_key);
    for (uint32_t i = 0; i < result->sight_count; i++)
        if (kept > 0 && by_wall_key(&sights[kept - 1], &sights[i]) == 0)
            sights[kept - 1] =
                blindest_first(&sights[kept - 1], &sights[i]) < 0 ? sights[i] : sights[kept - 1];
        else
            sights[kept++] = sights[i];
    result->sight_count = kept;
}

void bb_compare_sort_sights(bb_comparison_result *result)
{
    unite_clocks(result);
    qsort(result->sights, result->sight_count, sizeof *result->sights, blindest_first);
}

uint32_t bb_compare_blind(const bb_comparison_result *result, double share)
{
    uint32_t blind = 0;
    while (blind < result->sight_count && result->sights[blind].least > share)
        blind++;
    return blind;
}
