/* Refit of a binary tree that also keeps its books: what the tree costs, and, if asked for, one
 * rotation per node on the way up (rotation.clh).
 *
 *   a subtree below a root of the cut (subtrees.h): leaf: union of its primitives' boxes; behind a
 *   second child: its parent
 *   above: the last of two children to come                                    (turn_subtrees)
 *   roots of the next cut: a node's children are final once its parent has been turned; those of a
 *   node with many nodes below that have few themselves are put on the list          (put_roots)
 *   then, if anything was turned: skips of last children, since subtrees are elsewhere (turn_skips)
 * Where work-groups hand over by levels, all of it goes up by them (turn_leaves, turn_level), and
 * skips are written from the leaves up (turn_skips_of_leaves).
 *
 * Rotations in the pass of a refit: Kopta, Ize, Spjut, Brunvand, Davis, Kensler 2012 (Fast,
 * Effective BVH Updates for Animated Scenes), section 3. The order of the list of roots is that of
 * the work-groups; nothing but the order of work depends on it.
 */
#include "bb_device.h"
#include "handover.clh"
#include "rotation.clh"
#include "turns_shared.h"

void put_totals(const turn_tree *tree, uint root, global bb_turn_totals *totals)
{
    totals->area = bb_extent_area(bb_load_node(tree->nodes, root));
#if BB_TURN_ROTATES
    totals->height = tree->heights[root] & ~TURN_BIT;
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
/* The children of n, which stay where they are from now on, that are roots of subtrees. */
void put_roots(const turn_tree *tree, uint n, uint most, global uint *next,
               volatile global bb_turn_totals *totals)
{
    if (tree->sizes[n] <= most)
        return;
    uint a = tree->nodes[n].first, b = tree->nodes[a].skip;
    if (tree->sizes[a] <= most)
        next[atomic_inc(&totals->roots)] = a;
    if (tree->sizes[b] <= most)
        next[atomic_inc(&totals->roots)] = b;
}
#endif

/* Rotations made. */
uint turn_below(const turn_tree *tree, global const uint *refs, global const bb_box *boxes,
                uint root, uint may_turn)
{
    uint turned = 0;
    for (uint n = root;;) {
        uint first = tree->nodes[n].first;
        if ((first & BB_LEAF_BIT) == 0) {
            n = first;
            continue;
        }
        fit_turn_leaf(tree, refs, boxes, n, first);
        while (n != root) {
            uint p = tree->parents[n];
            if (tree->nodes[p].first == n)
                break; /* not the last child */
            turned += turn_pair(tree, p, may_turn);
            n = p;
        }
        if (n == root)
            return turned;
        n = tree->nodes[n].skip;
    }
}

/* The books that are not kept are not touched. */
kernel void turn_subtrees(volatile global bb_node *nodes, global const uint *refs,
                          global const bb_box *boxes, global const uint *roots, uint root_count,
                          uint most, uint may_turn, global uint *parents,
                          volatile global uint *missing, volatile global uint *sizes,
                          volatile global uint *heights, volatile global float *costs,
                          volatile global float *spreads, global uint *next,
                          global bb_turn_totals *totals)
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
        missing[p] = 2u; /* for the next time */
        uint a = nodes[p].first, b = nodes[a].skip;
        turned += turn_pair(&tree, p, may_turn);
#if BB_TURN_ROTATES
        put_roots(&tree, a, most, next, totals);
        put_roots(&tree, b, most, next, totals);
#endif
    }
    if (p == BB_NONE) {
        put_totals(&tree, n, totals);
#if BB_TURN_ROTATES
        if (sizes[n] <= most)
            next[atomic_inc(&totals->roots)] = n;
        else
            put_roots(&tree, n, most, next, totals);
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
                        global bb_turn_totals *totals)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    const turn_tree tree = {nodes, parents, 0, heights, costs, spreads};
    uint p = parents[n];
    fit_turn_leaf(&tree, refs, boxes, n, nodes[n].first);
    if (p == BB_NONE)
        put_totals(&tree, n, totals);
    else if (atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, 0u, counts, next);
}

kernel void turn_level(volatile global bb_node *nodes, uint may_turn, global uint *parents,
                       volatile global uint *missing, volatile global uint *heights,
                       volatile global float *costs, volatile global float *spreads,
                       global const uint *level, uint number, volatile global uint *counts,
                       global uint *next, global bb_turn_totals *totals)
{
    const turn_tree tree = {nodes, parents, 0, heights, costs, spreads};
    uint count = counts[number], turned = 0;
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        uint n = level[i], p = parents[n];
        missing[n] = 2u;
        turned += turn_pair(&tree, n, may_turn);
        if (p == BB_NONE)
            put_totals(&tree, n, totals);
        else if (atomic_dec(&missing[p]) == 1u)
            bb_put_on_list(p, number, counts, next);
    }
    if (turned != 0u)
        atomic_add(&totals->turned, turned);
}

/* ---- skips ---- */

/* Writes the skip that n, and all that n is the last node below, have in common: n is the last
 * child of the last child ... of one that has a sibling after it. Nobody writes that one's. */
void skip_above(global bb_node *nodes, uint n, global const uint *parents)
{
    uint top = n;
    while (parents[top] != BB_NONE && nodes[parents[top]].first != top)
        top = parents[top];
    if (top == n)
        return;
    uint skip = nodes[top].skip;
    for (; n != top; n = parents[n])
        nodes[n].skip = skip;
}

#if BB_TURN_ROTATES
#if BB_HANDOVER
/* Skips of last children below root, whose own is right. Where nothing was turned they agree with
 * that of the node on top, and do so as long as the first of them does. */
void skip_below(global bb_node *nodes, uint root, volatile global const uint *heights)
{
    uint end = nodes[root].skip;
    for (uint n = root; n != end;) {
        uint first = nodes[n].first, skip = nodes[n].skip;
        if ((first & BB_LEAF_BIT) != 0) {
            n = skip;
            continue;
        }
        uint last = nodes[first].skip;
        bool turned = (heights[n] & TURN_BIT) != 0;
        bool stale = nodes[last].skip != skip;
        nodes[last].skip = skip;
        if (turned)
            n = first;
        else
            n = stale ? last : skip;
    }
}

kernel void turn_skips(global bb_node *nodes, global const uint *roots, uint root_count,
                       global const uint *parents, volatile global const uint *heights,
                       global const bb_turn_totals *totals, global bb_tree_info *info)
{
    uint i = get_global_id(0);
    if (i == 0)
        info->depth = totals->height;
    if (i >= root_count)
        return;
    skip_above(nodes, roots[i], parents);
    skip_below(nodes, roots[i], heights);
}
#endif

kernel void turn_skips_of_leaves(global bb_node *nodes, uint count, global const uint *parents,
                                 global const bb_turn_totals *totals, global bb_tree_info *info)
{
    uint n = get_global_id(0);
    if (n == 0)
        info->depth = totals->height;
    if (n < count && (nodes[n].first & BB_LEAF_BIT) != 0)
        skip_above(nodes, n, parents);
}
#endif
