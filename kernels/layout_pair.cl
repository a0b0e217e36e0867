/* The `pair` layout: from the common tree to pair nodes. (The primitives: leaf_prims.cl.)
 *
 *   extra[n] = children(n) - 1 for inner nodes, 0 for leaves     (pair_extra)
 *   base = exclusive scan of extra                                (framework/device/primitives.h)
 *   inner node n with k children owns pair nodes base[n] .. base[n] + k - 2, one per gap between
 *   two children: a balanced
 *   binary tree over them, whose root is the gap in the middle    (pair_nodes)
 *
 *   boxes are scaled and padded (padding.clh)
 *
 * Aila and Laine 2009 (both children's boxes in the parent). Reads any tree of any arity; a binary
 * tree keeps its shape and its order in memory; a node with one child is passed through. Limits:
 * 2^31 - 1 pair nodes; one work-item writes all pair nodes of a node, in time that grows with the
 * square of its children, so the host refuses more than 4096.
 */
#include "bb_device.h"
#include "padding.clh"

kernel void pair_extra(global const bb_node *nodes, uint count, global uint *extra)
{
    uint n = get_global_id(0);
    if (n > count)
        return;
    uint children = 1;
    if (n < count && (nodes[n].first & BB_LEAF_BIT) == 0) {
        uint end = nodes[n].skip;
        children = 0;
        for (uint c = nodes[n].first; c != end; c = nodes[c].skip)
            children++;
    }
    extra[n] = children - 1u; /* extra[count] is 0: its place in the scan is the total */
}

/* Link to node n: a leaf, or the pair node in the middle of its children. A node with one child is
 * passed through. */
uint pair_link(global const bb_node *nodes, global const uint *base, uint n)
{
    for (;;) {
        uint first = nodes[n].first;
        if ((first & BB_LEAF_BIT) != 0)
            return first;
        uint children = base[n + 1] - base[n] + 1u;
        if (children > 1u)
            return base[n] + children / 2u - 1u;
        n = first;
    }
}

/* Box, reach and link of children [from, to) of node n: a child, or the pair node of the gap in
 * their middle. `reach` may be NULL. */
void pair_side(global const bb_node *nodes, global const uint *base, global const float *reach,
               uint n, uint from, uint to, float *lo, float *hi, float *longest, uint *link)
{
    uint child = nodes[n].first;
    for (uint i = 0; i < from; i++)
        child = nodes[child].skip;
    *link = to - from == 1u ? pair_link(nodes, base, child) : base[n] + (from + to) / 2u - 1u;
    for (uint k = 0; k < 3; k++) {
        lo[k] = nodes[child].lo[k];
        hi[k] = nodes[child].hi[k];
    }
    *longest = reach != NULL ? reach[child] : 0.0f;
    for (uint i = from + 1u; i < to; i++) {
        child = nodes[child].skip;
        for (uint k = 0; k < 3; k++) {
            lo[k] = BB_MIN(nodes[child].lo[k], lo[k]);
            hi[k] = BB_MAX(nodes[child].hi[k], hi[k]);
        }
        if (reach != NULL)
            *longest = BB_MAX(reach[child], *longest);
    }
}

/* `reach` per node, used if has_reach: else a box's own longest side. */
kernel void pair_nodes(global const bb_node *nodes, uint count, global const uint *base,
                       float scale, global const float *reach, uint has_reach,
                       global bb_pair *pairs)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) != 0)
        return;
    uint children = base[n + 1] - base[n] + 1u;
    for (uint gap = 1; gap < children; gap++) {
        uint from = 0, to = children;
        while ((from + to) / 2u != gap) {
            if (gap < (from + to) / 2u)
                to = (from + to) / 2u;
            else
                from = (from + to) / 2u;
        }
        bb_pair pair;
        pair.pad[0] = pair.pad[1] = 0;
        for (uint side = 0; side < 2; side++) {
            float lo[3], hi[3], longest;
            uint link;
            pair_side(nodes, base, has_reach != 0 ? reach : NULL, n, side == 0 ? from : gap,
                      side == 0 ? gap : to, lo, hi, &longest, &link);
            bb_scale_and_pad(lo, hi, scale, has_reach != 0 ? longest : -1.0f);
            pair.links[side] = link;
            for (uint k = 0; k < 3; k++) {
                pair.planes[4 * k + side] = lo[k];
                pair.planes[4 * k + 2 + side] = hi[k];
            }
        }
        pairs[base[n] + gap - 1u] = pair;
    }
}

/* The link to start from, and the number of pair nodes. */
kernel void pair_root(global const bb_node *nodes, uint count, uint root, global const uint *base,
                      global uint *out)
{
    out[0] = pair_link(nodes, base, root);
    out[1] = base[count];
}
