/* Groups of bonsai: splits sorted codes at spatial medians, down to `most` primitives.
 *
 * Each bit of a code halves its cell, so splitting where keys first differ is splitting at the
 * middle of the cell. A group is a node of the radix tree over the keys that has at most `most` of
 * them and whose parent has more. The tree is never built: the end of a group is found among the
 * `most` keys after its first one, and whether a group begins at a key among as many keys on either
 * side.
 *
 *   for each chunk of keys:                                                            (bn_count)
 *       find the first group that begins in it
 *       go from group to group and count them
 *   scan the counts
 *   for each chunk of keys: again, and write the first key of each group              (bn_starts)
 *
 * -DBB_KEY64 for ulong keys.
 */
#include "bb_device.h"
#include "radix_keys.clh"

/* Returns whether keys i - 1 and i are in two groups: they are if the node that is split between
 * them is too large. That node has at least all keys that share the prefix common to both. */
bool begins_group(global const bb_key *keys, uint count, uint i, uint most)
{
    if (i == 0)
        return true;
    const uint same = common_of(keys, i - 1u, i);
    uint left = 1, left_most = BB_MIN(i, most), right = 1, right_most = BB_MIN(count - i, most);
    while (left < left_most) {
        uint middle = left_most - (left_most - left) / 2u;
        if (common_of(keys, i - middle, i) >= same)
            left = middle;
        else
            left_most = middle - 1u;
    }
    while (right < right_most) {
        uint middle = right_most - (right_most - right) / 2u;
        if (common_of(keys, i - 1u, i - 1u + middle) >= same)
            right = middle;
        else
            right_most = middle - 1u;
    }
    return left + right > most;
}

/* One past the last key of the group that begins at `begin`. */
uint end_of_group(global const bb_key *keys, uint count, uint begin, uint most)
{
    uint prefix = begin == 0 ? 0 : common_of(keys, begin - 1u, begin) + 1u;
    uint high = BB_MIN(count - begin, most) + begin - 1u, last = begin;
    if (count - begin > most)
        prefix = BB_MAX(common_of(keys, begin, begin + most) + 1u, prefix);
    while (last < high) {
        uint middle = high - (high - last) / 2u;
        if (common_of(keys, begin, middle) >= prefix)
            last = middle;
        else
            high = middle - 1u;
    }
    return last + 1u;
}

/* firsts[chunk]: first key of the first group that begins in the chunk, or a later key;
 * counts[chunk]: number of groups that begin in it. */
kernel void bn_count(global const bb_key *keys, uint count, uint most, uint chunk, uint chunks,
                     global uint *firsts, global uint *counts)
{
    uint number = get_global_id(0);
    if (number >= chunks)
        return;
    const uint begin = number * chunk, end = BB_MIN(count - begin, chunk) + begin;
    uint first = begin, groups = 0;
    while (first < end && !begins_group(keys, count, first, most))
        first++;
    for (uint i = first; i < end; i = end_of_group(keys, count, i, most))
        groups++;
    firsts[number] = first;
    counts[number] = groups;
}

/* places: exclusive scan of counts. starts[g]: first key of group g; behind the last group:
 * `count`. */
kernel void bn_starts(global const bb_key *keys, uint count, uint most, uint chunk, uint chunks,
                      global const uint *firsts, global const uint *places, global uint *starts)
{
    uint number = get_global_id(0);
    if (number >= chunks)
        return;
    const uint begin = number * chunk, end = BB_MIN(count - begin, chunk) + begin;
    uint place = places[number];
    for (uint i = firsts[number]; i < end; i = end_of_group(keys, count, i, most))
        starts[place++] = i;
    if (number == chunks - 1u)
        starts[place] = count;
}
