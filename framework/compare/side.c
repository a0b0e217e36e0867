/* One side of a comparison: for pairs, all of its counting runs together. */
#include "framework/compare/compare.h"

#include <stdio.h>
#include <string.h>

uint32_t bb_side_first(const bb_side *side)
{
    return side->count > 1 ? 1 : 0;
}

const bb_measured *bb_side_find(const bb_side *side, const char *key)
{
    const bb_measured *found = NULL;
    for (uint32_t i = bb_side_first(side); i < side->count; i++) {
        const bb_measured *cell = bb_cell_set_find(&side->sets[i], key);
        if (cell != NULL && strcmp(cell->status, "ok") != 0)
            return cell;
        found = found != NULL ? found : cell;
    }
    return found;
}

static bool occurs_before(const bb_side *side, uint32_t set, const char *key)
{
    for (uint32_t i = bb_side_first(side); i < set; i++)
        if (bb_cell_set_find(&side->sets[i], key) != NULL)
            return true;
    return false;
}

const char *bb_side_next(const bb_side *side, bb_side_place *place)
{
    if (place->set < bb_side_first(side))
        place->set = bb_side_first(side);
    while (place->set < side->count) {
        const bb_cell_set *set = &side->sets[place->set];
        if (place->cell == set->count) {
            place->set++;
            place->cell = 0;
            continue;
        }
        const char *key = set->cells[place->cell++].key;
        if (!occurs_before(side, place->set, key))
            return key;
    }
    return NULL;
}

uint32_t bb_side_lacks(const bb_side *side, const char *key)
{
    uint32_t lacks = 0;
    for (uint32_t i = bb_side_first(side); i < side->count; i++)
        lacks += bb_cell_set_find(&side->sets[i], key) == NULL;
    return lacks;
}

bb_status bb_side_check(const bb_side *side)
{
    const bb_origin *first = &side->sets[0].origin;
    for (uint32_t i = 1; i < side->count; i++) {
        const bb_origin *o = &side->sets[i].origin;
        bool host, machine = bb_same_machine(first, o, &host);
        const char *what = strcmp(first->revision, o->revision) != 0 ? "revision"
                           : !machine || !host                       ? "machine"
                           : strcmp(first->seed, o->seed) != 0       ? "seed"
                                                                     : NULL;
        if (what != NULL)
            return bb_fail(BB_INVALID,
                           "compare: %s is of another %s in pair %u than in pair 0: all pairs "
                           "must be of one program on one machine",
                           o->what, what, i);
    }
    return BB_OK;
}
