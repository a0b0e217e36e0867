/* A tree cut into subtrees (subtrees.h):
 *
 *   parent and number of children of each node                               (subtrees_parents)
 *   nodes below each node, bottom-up: its last child to come adds them up      (subtrees_sizes)
 *   roots = nodes with few below, whose parents have many                       (subtrees_mark)
 *
 * The last to come goes on: Karras 2012; handover.clh says how the others' results reach it.
 */
#include "bb_device.h"
#include "handover.clh"
#include "parents.clh"

kernel void subtrees_parents(global const bb_node *nodes, uint count, uint root,
                             global uint *parents, global uint *missing)
{
    uint n = get_global_id(0);
    if (n < count)
        missing[n] = bb_make_parent(nodes, n, root, parents);
}

#if BB_HANDOVER
/* A leaf has size 1. Restores missing[]. */
kernel void subtrees_sizes(global const bb_node *nodes, uint count, global const uint *parents,
                           volatile global uint *missing, volatile global uint *sizes)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    sizes[n] = 1u;
    for (uint p = parents[n]; p != BB_NONE; p = parents[p]) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            return;
        BB_DEVICE_FENCE();
        uint end = nodes[p].skip, children = 0, size = 1u;
        for (uint c = nodes[p].first; c != end; c = nodes[c].skip, children++)
            size += sizes[c];
        sizes[p] = size;
        missing[p] = children;
    }
}

kernel void subtrees_mark(global const uint *sizes, uint count, uint root,
                          global const uint *parents, global uint *marks)
{
    uint n = get_global_id(0);
    if (n < count)
        marks[n] = sizes[n] <= BB_SUBTREE_MOST &&
                           (n == root || sizes[parents[n]] > BB_SUBTREE_MOST)
                       ? 1u
                       : 0u;
}
#endif
