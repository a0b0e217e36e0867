/* An index of an array: items are found by their hashes. */
#ifndef BB_TABLE_INDEX_H
#define BB_TABLE_INDEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Hashes of items, by open addressing. A zeroed one is empty; its owner frees `slots`. */
typedef struct bb_index {
    struct bb_index_slot {
        uint64_t hash;
        uint32_t item; /* its number + 1; 0: the slot is free */
    } * slots;
    uint32_t size, count; /* of slots, a power of 2; of items */
} bb_index;

/* Adds the next item: they are numbered from 0 on. False: there is no memory. */
bool bb_index_add(bb_index *index, uint64_t hash);
/* Returns the next item of that hash, from slot *at on, and moves *at behind it; UINT32_MAX: there
 * is no more. The first *at is the hash. */
uint32_t bb_index_next(const bb_index *index, uint64_t hash, uint32_t *at);
/* Makes room in *array, from malloc, for the item that the index gets next: `item` bytes. False:
 * there is no memory. */
bool bb_index_reserve(void *array, const bb_index *index, size_t item);

#endif
