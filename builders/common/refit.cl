/* Refit of a tree's boxes, bottom-up from the leaves (refit.h).
 *
 *   a subtree below a root of the cut (subtrees.h): leaf: union of its primitives' boxes; then the
 *   inner nodes from the lowest level up: union of the children's
 *   above: the last of a node's children to come joins all of them              (refit_subtrees)
 * Where work-groups hand over by levels, all of it goes up by them    (refit_leaves, refit_level).
 *
 * Last to come goes on: Karras 2012, section 4; how the children's boxes reach it: handover.clh. No
 * work-item waits for another. Limits: a node's children are joined by one work-item.
 */
#include "bb_device.h"
#include "fit.clh"
#include "handover.clh"

/* How many children there are. */
uint fit_inner(volatile global bb_node *nodes, uint n)
{
    bb_extent e = bb_no_extent();
    uint end = nodes[n].skip, children = 0;
    for (uint c = nodes[n].first; c != end; c = nodes[c].skip, children++)
        e = bb_joined(e, bb_load_box(nodes, c));
    bb_store_box(nodes, n, e);
    return children;
}

void fit_leaf(volatile global bb_node *nodes, global const uint *refs, global const bb_box *boxes,
              uint n, uint first)
{
    uint prims;
    bb_store_box(nodes, n, bb_fit_leaf(refs, boxes, first & BB_INDEX_MASK, &prims));
}

#if BB_HANDOVER
/* From the root down, level by level, the leaves, and back: in that order no node waits for the one
 * before it, so that nodes and primitives come from memory many at a time. */
void fit_subtree(volatile global bb_node *nodes, global const uint *refs,
                 global const bb_box *boxes, uint root)
{
    uint queue[BB_SUBTREE_MOST], count = 0, first = nodes[root].first;
    if ((first & BB_LEAF_BIT) != 0)
        fit_leaf(nodes, refs, boxes, root, first);
    else
        queue[count++] = root;
    for (uint i = 0; i < count; i++) {
        uint n = queue[i], end = nodes[n].skip;
        for (uint c = nodes[n].first; c != end; c = nodes[c].skip) {
            first = nodes[c].first;
            if ((first & BB_LEAF_BIT) != 0)
                fit_leaf(nodes, refs, boxes, c, first);
            else
                queue[count++] = c;
        }
    }
    while (count-- > 0)
        fit_inner(nodes, queue[count]);
}

kernel void refit_subtrees(volatile global bb_node *nodes, global const uint *refs,
                           global const bb_box *boxes, global const uint *roots,
                           global const uint *root_count, global const uint *parents,
                           volatile global uint *missing)
{
    uint i = get_global_id(0);
    if (i >= root_count[0])
        return;
    uint root = roots[i];
    fit_subtree(nodes, refs, boxes, root);
    for (uint p = parents[root]; p != BB_NONE; p = parents[p]) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            return;
        BB_DEVICE_FENCE();
        missing[p] = fit_inner(nodes, p); /* for the next time */
    }
}
#endif

kernel void refit_leaves(volatile global bb_node *nodes, global const uint *refs,
                         global const bb_box *boxes, uint count, global const uint *parents,
                         volatile global uint *missing, volatile global uint *counts,
                         global uint *next)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    fit_leaf(nodes, refs, boxes, n, nodes[n].first);
    uint p = parents[n];
    if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, 0u, counts, next);
}

kernel void refit_level(volatile global bb_node *nodes, global const uint *parents,
                        volatile global uint *missing, global const uint *level, uint number,
                        volatile global uint *counts, global uint *next)
{
    uint count = counts[number];
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        uint n = level[i], p = parents[n];
        missing[n] = fit_inner(nodes, n);
        if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
            bb_put_on_list(p, number, counts, next);
    }
}
