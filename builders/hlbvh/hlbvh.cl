/* Clusters of HLBVH: runs of sorted keys whose top m bits are equal (Garanzha, Pantaleoni,
 * McAllister 2011; see hlbvh.c).
 *
 *   for each pair of neighbours: find the first bit in which they differ          (hl_levels)
 *   host: choose m from the number of pairs that first differ in each bit
 *   a cluster begins where that bit is among the top m:                (hl_counts, hl_starts)
 *   find each cluster's root in the radix tree over all keys                      (hl_gather)
 *
 * Work-items go through chunks of keys. -DBB_KEY64: keys are ulong. -DHL_BY_PRIMS: a cluster weighs
 * as much as it has primitives.
 */
#include "bb_device.h"
#include "hlbvh_shared.h"
#include "radix_keys.clh"

/* Returns the bit, from the top of a code of `bits`, in which keys i and i + 1 first differ; 64 if
 * they are equal. */
uint first_difference(global const bb_key *keys, uint i, uint bits)
{
    bb_key differ = keys[i] ^ keys[i + 1u];
    return differ == 0 ? HL_LEVELS - 1u : (uint)clz(differ) - (BB_KEY_BITS - bits);
}

/* levels[chunk][b], totals[b] (0 before): number of pairs that first differ in bit b. */
kernel void hl_levels(global const bb_key *keys, uint count, uint bits, uint chunk,
                      global uint *levels, volatile global uint *totals)
{
    uint number = get_global_id(0), begin = number * chunk;
    if (begin >= count)
        return;
    uint end = BB_MIN(count - 1u - begin, chunk) + begin;
    uint found[HL_LEVELS];
    for (uint b = 0; b < HL_LEVELS; b++)
        found[b] = 0;
    for (uint i = begin; i < end; i++)
        found[first_difference(keys, i, bits)]++;
    for (uint b = 0; b < HL_LEVELS; b++) {
        levels[number * HL_LEVELS + b] = found[b];
        if (found[b] != 0)
            atomic_add(&totals[b], found[b]);
    }
}

/* counts[chunk]: number of pairs with a border between clusters. */
kernel void hl_counts(global const uint *levels, uint chunks, uint top_bits, global uint *counts)
{
    uint number = get_global_id(0);
    if (number >= chunks)
        return;
    uint sum = 0;
    for (uint b = 0; b < top_bits; b++)
        sum += levels[number * HL_LEVELS + b];
    counts[number] = sum;
}

/* places: exclusive scan of counts. starts[c]: first key of cluster c; behind the last: `count`. */
kernel void hl_starts(global const bb_key *keys, uint count, uint bits, uint top_bits, uint chunk,
                      global const uint *places, uint clusters, global uint *starts)
{
    uint number = get_global_id(0), begin = number * chunk;
    if (begin >= count)
        return;
    uint end = BB_MIN(count - 1u - begin, chunk) + begin;
    uint next = places[number] + 1u;
    if (number == 0) {
        starts[0] = 0;
        starts[clusters] = count;
    }
    for (uint i = begin; i < end; i++)
        if (first_difference(keys, i, bits) < top_bits)
            starts[next++] = i + 1u;
}

/* Returns the node of the radix tree over keys l .. r, which differ from at least one neighbour in
 * a top bit. It is a left child if it shares more bits with its right neighbour than with its left
 * one. */
uint place_of_run(global const bb_key *keys, uint count, uint l, uint r)
{
    bool is_left = true;
    if (r + 1u == count)
        is_left = false;
    else if (l > 0)
        is_left = clz(keys[r] ^ keys[r + 1u]) > clz(keys[l - 1u] ^ keys[l]);
    return is_left ? 2u * r + 1u : 2u * l;
}

/* Needs at least two clusters. */
kernel void hl_gather(global const bb_key *keys, uint count, global const uint *starts,
                      uint clusters, global const bb_node *nodes, global const uchar *heights,
                      global hl_item *items, global hl_root *roots, global bb_tree_info *info)
{
    uint c = get_global_id(0);
    if (c >= clusters)
        return;
    if (c == 0)
        info->depth = 0; /* raised by the top tree's leaves */
    uint l = starts[c], r = starts[c + 1u] - 1u;
    uint place = place_of_run(keys, count, l, r);
    global const uint *words = (global const uint *)(nodes + place);
    uint4 lo = vload4(0, words), hi = vload4(1, words);
    hl_root root = {lo.w, heights[place]};
    roots[c] = root;
    lo.w = c;
#ifdef HL_BY_PRIMS
    hi.w = r + 1u - l;
#else
    hi.w = 1u;
#endif
    vstore4(lo, 0, (global uint *)(items + c));
    vstore4(hi, 1, (global uint *)(items + c));
}
