/* Refit of a tree's boxes, bottom-up from the leaves (refit.h).
 *
 *   each subtree below a root of the cut (subtrees.h): for each of its nodes, in preorder:
 *       a leaf: union of its primitives' boxes
 *       behind the last child of a node: union of its children's boxes
 *   above the cut: the last child of a node to come joins all of them           (refit_subtrees)
 * If work-groups hand over by levels, the whole tree goes by levels (refit_leaves, refit_level).
 *
 * The last to come goes on: Karras 2012; handover.clh says how the children's boxes reach it. No
 * work-item waits for another. Limits: one work-item joins a node's children.
 */
#include "bb_device.h"
#include "fit.clh"
#include "handover.clh"

/* Refits an inner node; returns the number of its children. */
uint fit_inner(volatile global bb_node *nodes, uint n)
{
    bb_extent e = bb_no_extent();
    uint end = nodes[n].skip, children = 0;
    for (uint c = nodes[n].first; c != end; children++) {
        bb_extent child = bb_load_node(nodes, c);
        e = bb_joined(e, child);
        c = bb_skip_of(child);
    }
    bb_store_box(nodes, n, e);
    return children;
}

#if BB_HANDOVER
/* Refits a subtree in preorder, each inner node when its last child is done. */
void fit_subtree(global bb_node *nodes, global const uint *refs, global const bb_box *boxes,
                 uint root, global const uint *parents)
{
    uint n = root, count;
    for (;;) {
        uint first = nodes[n].first, skip = nodes[n].skip;
        if ((first & BB_LEAF_BIT) == 0) {
            n = first;
            continue;
        }
        bb_extent e = bb_fit_leaf(refs, boxes, first & BB_INDEX_MASK, &count);
        bb_store_node(nodes, n, e, first, skip);
        while (n != root) {
            uint p = parents[n], end = nodes[p].skip;
            if (skip != end)
                break; /* not the last child */
            first = nodes[p].first;
            for (uint c = first; c != end; c = nodes[c].skip)
                e = bb_joined(e, bb_load_node(nodes, c));
            bb_store_node(nodes, p, e, first, end);
            n = p;
        }
        if (n == root)
            return;
        n = skip;
    }
}

kernel void refit_subtrees(global bb_node *nodes, global const uint *refs,
                           global const bb_box *boxes, global const uint *roots,
                           global const uint *root_count, global const uint *parents,
                           volatile global uint *missing)
{
    uint i = get_global_id(0);
    if (i >= root_count[0])
        return;
    uint root = roots[i];
    fit_subtree(nodes, refs, boxes, root, parents);
    for (uint p = parents[root]; p != BB_NONE; p = parents[p]) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            return;
        BB_DEVICE_FENCE();
        missing[p] = fit_inner(nodes, p); /* for the next refit */
    }
}
#endif

kernel void refit_leaves(volatile global bb_node *nodes, global const uint *refs,
                         global const bb_box *boxes, uint count, global const uint *parents,
                         volatile global uint *missing, volatile global uint *counts,
                         global uint *next)
{
    uint n = get_global_id(0), prims;
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    bb_store_box(nodes, n, bb_fit_leaf(refs, boxes, nodes[n].first & BB_INDEX_MASK, &prims));
    uint p = parents[n];
    if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, 0u, counts, next);
}

void fit_listed(uint n, volatile global bb_node *nodes, global const uint *parents,
                volatile global uint *missing, uint number, volatile global uint *counts,
                global uint *next)
{
    uint p = parents[n];
    missing[n] = fit_inner(nodes, n);
    if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, number, counts, next);
}

kernel void refit_level(volatile global bb_node *nodes, global const uint *parents,
                        volatile global uint *missing, global uint *list, uint number,
                        volatile global uint *counts, global uint *next)
{
#define FIT(n) fit_listed(n, nodes, parents, missing, number, counts, next)
    BB_FOR_LISTS(FIT, 1u)
}
