#include "framework/table/index.h"

#include <stdlib.h>

static void put_in_slot(bb_index *index, uint64_t hash, uint32_t item)
{
    uint32_t at = (uint32_t)hash & (index->size - 1);
    while (index->slots[at].item != 0)
        at = (at + 1) & (index->size - 1);
    index->slots[at].hash = hash;
    index->slots[at].item = item;
}

static bool grow(bb_index *index)
{
    bb_index larger = {.size = index->size > 0 ? 2 * index->size : 16, .count = index->count};
    larger.slots = calloc(larger.size, sizeof *larger.slots);
    if (larger.slots == NULL)
        return false;
    for (uint32_t i = 0; i < index->size; i++)
        if (index->slots[i].item != 0)
            put_in_slot(&larger, index->slots[i].hash, index->slots[i].item);
    free(index->slots);
    *index = larger;
    return true;
}

bool bb_index_add(bb_index *index, uint64_t hash)
{
    if (2 * (index->count + 1) > index->size && !grow(index))
        return false;
    put_in_slot(index, hash, ++index->count);
    return true;
}

uint32_t bb_index_next(const bb_index *index, uint64_t hash, uint32_t *at)
{
    while (index->size > 0 && index->slots[*at & (index->size - 1)].item != 0) {
        const struct bb_index_slot *slot = &index->slots[(*at)++ & (index->size - 1)];
        if (slot->hash == hash)
            return slot->item - 1;
    }
    return UINT32_MAX;
}

bool bb_index_reserve(void *array, const bb_index *index, size_t item)
{
    void **items = array;
    if (index->count > 0 && (index->count & (index->count - 1)) != 0)
        return true;
    const size_t room = index->count > 0 ? 2 * (size_t)index->count : 1;
    void *larger = realloc(*items, room * item);
    if (larger == NULL)
        return false;
    *items = larger;
    return true;
}
