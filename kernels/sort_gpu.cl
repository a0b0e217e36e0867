/* Stable radix sort of key-value pairs, one digit of at most 4 bits per pass from the lowest up
 * (LSD); form for GPU devices: work-groups co-operate through local memory.
 *
 * Source: Satish, Harris, Garland, Designing Efficient Sorting Algorithms for Manycore GPUs (IPDPS
 * 2009), section IV; the ranks inside a tile by counters per item and digit value, as in its
 * references, instead of four 1-bit splits.
 *
 *     for each digit:
 *         sort_count:    for each tile (one group):
 *                            counts[digit value][tile] = number of the tile's keys with it
 *         the scan:      counts = exclusive prefix sum of counts, digit-major: the place of each
 *                            tile's first key of a value
 *         sort_scatter:  for each tile (one group):
 *                            each item counts the digit values of its SORT_ITEMS neighbours
 *                            ranks = exclusive prefix sum of those counts, digit-major: places
 *                                inside the sorted tile
 *                            sort the tile in local memory
 *                            write it out run by run, neighbours to neighbours
 *
 * Limits: BB_KEY is uint or ulong; BB_GROUP (the local size) is any power of two whose tile fits in
 * local memory; no group waits for another.
 */
#include "bb_device.h"
#include "group_scan.clh"

/* Pairs per work-item; the host uses the same number. */
#define SORT_ITEMS 4
#define TILE (BB_GROUP * SORT_ITEMS)
#define BUCKETS_MAX 16
#define DIGIT(key) ((uint)((key) >> shift) & mask)

/* Launched on one group per tile; the last tile may be shorter. */
__kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void sort_count(__global const BB_KEY *keys,
                const uint count,
                const uint shift,      /* where the digit begins */
                const uint mask,       /* its values are 0 to mask */
                __global uint *counts) /* (mask + 1) * tiles */
{
    __local uint buckets[BUCKETS_MAX];
    const uint item = get_local_id(0);
    const uint base = get_group_id(0) * TILE;
    const uint size = min((uint)TILE, count - base);

    for (uint d = item; d <= mask; d += BB_GROUP)
        buckets[d] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint k = item; k < size; k += BB_GROUP)
        atomic_inc(&buckets[DIGIT(keys[base + k])]);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint d = item; d <= mask; d += BB_GROUP)
        counts[d * get_num_groups(0) + get_group_id(0)] = buckets[d];
}

/* Launched as sort_count. */
__kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void sort_scatter(__global const BB_KEY *keys,
                  __global const uint *values,
                  const uint count,
                  const uint shift,
                  const uint mask,
                  __global const uint *places, /* the scanned counts */
                  __global BB_KEY *keys_out,
                  __global uint *values_out)
{
    __local BB_KEY tile_keys[TILE];
    __local uint tile_values[TILE];
    __local ushort ranks[BUCKETS_MAX * BB_GROUP]; /* [digit value][item] */
    __local uint sums[BB_GROUP];
    __local uint moves[BUCKETS_MAX]; /* from the place in the sorted tile to that in the output */
    const uint item = get_local_id(0);
    const uint base = get_group_id(0) * TILE;
    const uint size = min((uint)TILE, count - base);

    for (uint k = item; k < size; k += BB_GROUP) {
        tile_keys[k] = keys[base + k];
        tile_values[k] = values[base + k];
    }
    for (uint d = 0; d < BUCKETS_MAX; d++)
        ranks[d * BB_GROUP + item] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);

    /* Each item takes neighbours, so that equal keys keep their order. */
    BB_KEY key[SORT_ITEMS];
    uint value[SORT_ITEMS];
    uint rank[SORT_ITEMS];
    const uint first = item * SORT_ITEMS;
    const uint mine = first < size ? min((uint)SORT_ITEMS, size - first) : 0;
    for (uint k = 0; k < mine; k++) {
        key[k] = tile_keys[first + k];
        value[k] = tile_values[first + k];
        rank[k] = ranks[DIGIT(key[k]) * BB_GROUP + item]++;
    }
    barrier(CLK_LOCAL_MEM_FENCE);

    uint sum = 0, total;
    for (uint d = 0; d < BUCKETS_MAX; d++)
        sum += ranks[item * BUCKETS_MAX + d];
    uint running = bb_group_scan(sum, sums, &total);
    for (uint d = 0; d < BUCKETS_MAX; d++) {
        const uint here = ranks[item * BUCKETS_MAX + d];
        ranks[item * BUCKETS_MAX + d] = (ushort)running;
        running += here;
    }
    barrier(CLK_LOCAL_MEM_FENCE);

    for (uint d = item; d <= mask; d += BB_GROUP)
        moves[d] = places[d * get_num_groups(0) + get_group_id(0)] - ranks[d * BB_GROUP];
    for (uint k = 0; k < mine; k++) {
        const uint place = ranks[DIGIT(key[k]) * BB_GROUP + item] + rank[k];
        tile_keys[place] = key[k];
        tile_values[place] = value[k];
    }
    barrier(CLK_LOCAL_MEM_FENCE);

    for (uint k = item; k < size; k += BB_GROUP) {
        const BB_KEY sorted = tile_keys[k];
        const uint place = moves[DIGIT(sorted)] + k;
        keys_out[place] = sorted;
        values_out[place] = tile_values[k];
    }
}
