/* Refit of a binary tree that also keeps books of its cost and, if enabled, applies at most one
 * rotation per node on the way up (rotation.clh).
 *
 *   each subtree below a root of the cut (subtrees.h):                            (turn_subtrees)
 *       each leaf: union of its primitives' boxes
 *       each inner node, from the lowest level up: turn_pair()
 *   above the cut: the last of two children to finish goes on with the parent
 *   roots of the next cut: a node's children are final once its parent is finished; small children
 *       of a node with many nodes below are listed                                    (put_roots)
 * Where work-groups hand over by levels, everything goes up by levels  (turn_leaves, turn_level).
 *
 * Rotations during a refit: Kopta, Ize, Spjut, Brunvand, Davis, Kensler 2012 (Fast, Effective BVH
 * Updates for Animated Scenes). The order of the list of roots depends on the work-groups; only the
 * order of work depends on it.
 */
#include "bb_device.h"
#include "handover.clh"
#include "rotation.clh"
#include "turns_shared.h"

/* Finishes the root. */
void finish(const turn_tree *tree, uint root, global bb_turn_totals *totals,
            global bb_tree_info *info)
{
    totals->area = bb_extent_area(bb_load_box(tree->nodes, root));
#if BB_TURN_ROTATES
    uint height = tree->heights[root];
    info->depth = height & ~TURN_BIT;
    if ((height & TURN_BIT) != 0u) {
        settle(tree, root);
        settle_last(tree, root, BB_NONE);
    }
#endif
#if BB_TURN_COSTS
    totals->cost = tree->costs[root];
#endif
#if BB_TURN_SPREADS
    totals->spread = tree->spreads[root];
#endif
}

#if BB_HANDOVER
#if BB_TURN_ROTATES
/* Lists the children of n, which do not move any more, that are roots of subtrees. */
void put_roots(const turn_tree *tree, uint n, global uint *next,
               volatile global bb_turn_totals *totals)
{
    if (tree->sizes[n] <= BB_SUBTREE_MOST)
        return;
    uint a = tree->nodes[n].first, b = tree->nodes[a].skip;
    if (tree->sizes[a] <= BB_SUBTREE_MOST)
        next[atomic_inc(&totals->roots)] = a;
    if (tree->sizes[b] <= BB_SUBTREE_MOST)
        next[atomic_inc(&totals->roots)] = b;
}
#endif

void fit_or_queue(const turn_tree *tree, global const uint *refs, global const bb_box *boxes,
                  uint n, uint *queue, uint *count)
{
    uint first = tree->nodes[n].first;
    if ((first & BB_LEAF_BIT) != 0)
        fit_turn_leaf(tree, refs, boxes, n, first);
    else
        queue[(*count)++] = n;
}

/* Goes from the root down level by level, computing the leaves' boxes, and back up. In this order
 * no node waits for the previous one, so many loads overlap. Returns the number of rotations. */
uint turn_below(const turn_tree *tree, global const uint *refs, global const bb_box *boxes,
                uint root, uint may_turn)
{
    uint queue[BB_SUBTREE_MOST], count = 0, turned = 0;
    fit_or_queue(tree, refs, boxes, root, queue, &count);
    for (uint i = 0; i < count; i++) {
        uint a = tree->nodes[queue[i]].first, b = tree->nodes[a].skip;
        fit_or_queue(tree, refs, boxes, a, queue, &count);
        fit_or_queue(tree, refs, boxes, b, queue, &count);
    }
    while (count-- > 0)
        turned += turn_pair(tree, queue[count], may_turn) != BB_NONE ? 1u : 0u;
    return turned;
}

/* Books that are not kept are not accessed. */
kernel void turn_subtrees(volatile global bb_node *nodes, global const uint *refs,
                          global const bb_box *boxes, global const uint *roots, uint root_count,
                          uint may_turn, global uint *parents,
                          volatile global uint *missing, volatile global uint *sizes,
                          volatile global uint *heights, volatile global float *costs,
                          volatile global float *spreads, global uint *next,
                          global bb_turn_totals *totals, global bb_tree_info *info)
{
    uint i = get_global_id(0);
    if (i >= root_count)
        return;
    const turn_tree tree = {nodes, parents, sizes, heights, costs, spreads};
    uint n = roots[i], p = parents[n];
    uint turned = turn_below(&tree, refs, boxes, n, may_turn);
    for (; p != BB_NONE; n = p, p = parents[p]) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            break;
        BB_DEVICE_FENCE();
        missing[p] = 2u; /* for the next pass */
        uint moved = turn_pair(&tree, p, may_turn);
        turned += moved != BB_NONE ? 1u : 0u;
#if BB_TURN_ROTATES
        uint2 children = where_children_are(&tree, p, moved);
        put_roots(&tree, children.x, next, totals);
        put_roots(&tree, children.y, next, totals);
#endif
    }
    if (p == BB_NONE) {
        finish(&tree, n, totals, info);
#if BB_TURN_ROTATES
        if (sizes[n] <= BB_SUBTREE_MOST)
            next[atomic_inc(&totals->roots)] = n;
        else
            put_roots(&tree, n, next, totals);
#endif
    }
    if (turned != 0u)
        atomic_add(&totals->turned, turned);
}
#endif

kernel void turn_leaves(volatile global bb_node *nodes, global const uint *refs,
                        global const bb_box *boxes, uint count, global uint *parents,
                        volatile global uint *missing, volatile global uint *heights,
                        volatile global float *costs, volatile global float *spreads,
                        volatile global uint *counts, global uint *next,
                        global bb_turn_totals *totals, global bb_tree_info *info)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    const turn_tree tree = {nodes, parents, 0, heights, costs, spreads};
    uint p = parents[n];
    fit_turn_leaf(&tree, refs, boxes, n, nodes[n].first);
    if (p == BB_NONE)
        finish(&tree, n, totals, info);
    else if (atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, 0u, counts, next);
}

/* Returns the number of rotations. */
uint turn_listed(const turn_tree *tree, uint n, uint may_turn, volatile global uint *missing,
                 uint number, volatile global uint *counts, global uint *next,
                 global bb_turn_totals *totals, global bb_tree_info *info)
{
    uint p = tree->parents[n];
    missing[n] = 2u;
    uint turned = turn_pair(tree, n, may_turn) != BB_NONE ? 1u : 0u;
    if (p == BB_NONE)
        finish(tree, n, totals, info);
    else if (atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, number, counts, next);
    return turned;
}

kernel void turn_level(volatile global bb_node *nodes, uint may_turn, global uint *parents,
                       volatile global uint *missing, volatile global uint *heights,
                       volatile global float *costs, volatile global float *spreads,
                       global uint *list, uint number, volatile global uint *counts,
                       global uint *next, global bb_turn_totals *totals, global bb_tree_info *info)
{
    const turn_tree tree = {nodes, parents, 0, heights, costs, spreads};
    uint turned = 0;
#define TURN(n)                                                                                    \
    turned += turn_listed(&tree, n, may_turn, missing, number, counts, next, totals, info)
    BB_FOR_LISTS(TURN, 1u)
    if (turned != 0u)
        atomic_add(&totals->turned, turned);
}
