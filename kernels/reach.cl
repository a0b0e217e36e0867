/* Computes the longest side of the primitives below each node, for trees whose leaves contain parts
 * of primitives.
 *
 *   find the parent of each node                                              (reach_parents)
 *   for each leaf:                                                              (reach_climb)
 *       r = longest side of the boxes of its primitives
 *       for the leaf and its ancestors: reach = max(reach, r); stop where it was not smaller
 *
 * Layouts pad boxes in proportion to the primitives in them (padding.clh). If a leaf's box contains
 * its primitives whole, the box itself bounds their length; a cut box does not. Lengths are not
 * negative, so their bits have the same order, and atomic_max needs no order among work-items: one
 * that stops leaves the rest of the way to the one that was there before with no smaller value.
 * Limits: none.
 */
#include "bb_device.h"
#include "parents.clh"

kernel void reach_parents(global const bb_node *nodes, uint count, uint root, global uint *parents,
                          global uint *reach)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    reach[n] = 0;
    bb_make_parent(nodes, n, root, parents);
}

float longest_side(global const bb_box *box)
{
    float x = box->hi[0] - box->lo[0], y = box->hi[1] - box->lo[1], z = box->hi[2] - box->lo[2];
    float longest = BB_MAX(x, y);
    return BB_MAX(z, longest);
}

kernel void reach_climb(global const bb_node *nodes, global const uint *refs,
                        global const bb_box *boxes, uint count, global const uint *parents,
                        volatile global uint *reach)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    float longest = 0.0f;
    for (uint at = nodes[n].first & BB_INDEX_MASK, ref = 0; (ref & BB_LAST_BIT) == 0; at++) {
        ref = refs[at];
        longest = BB_MAX(longest_side(boxes + (ref & BB_INDEX_MASK)), longest);
    }
    uint bits = as_uint(longest);
    while (n != BB_NONE && atomic_max(&reach[n], bits) < bits)
        n = parents[n];
}
