/* The `pair` layout: converts the common tree to pair nodes. (leaf_prims.cl has the primitives.)
 *
 *   extra[n] = children(n) - 1 for inner nodes, 0 for leaves                         (pair_extra)
 *   base = exclusive scan of extra
 *   for each inner node n, of k children:                                            (pair_nodes)
 *       pair nodes base[n] .. base[n] + k - 2, one per gap between two children, form a balanced
 *           binary tree over them, whose root is the gap in the middle
 *       write each with its boxes scaled and padded (padding.clh)
 *
 * Aila and Laine 2009 (both children's boxes in the parent). Accepts any tree of any arity; a
 * binary tree keeps its shape and its order in memory; a node with one child is skipped. Limits:
 * 2^31 - 1 pair nodes; one work-item writes all pair nodes of a node, in time quadratic in its
 * children, so the host refuses more than 4096.
 */
#include "bb_device.h"
#include "padding.clh"
#include "siblings.clh"

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
    extra[n] = children - 1u; /* extra[count] is 0, so the total is at its place in the scan */
}

/* Returns the link to node n: a leaf, or the pair node in the middle of its children. A node with
 * one child is skipped. */
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

/* Returns children [from, to) of node n. */
bb_siblings pair_siblings(global const bb_node *nodes, uint n, uint from, uint to)
{
    bb_siblings siblings = {nodes[n].first, to - from};
    for (uint i = 0; i < from; i++)
        siblings.first = nodes[siblings.first].skip;
    return siblings;
}

/* Computes which of `children` the pair node of gap `gap` covers: [*from, *to). */
void pair_range(uint gap, uint children, uint *from, uint *to)
{
    *from = 0;
    *to = children;
    while ((*from + *to) / 2u != gap) {
        if (gap < (*from + *to) / 2u)
            *to = (*from + *to) / 2u;
        else
            *from = (*from + *to) / 2u;
    }
}

/* `reach`: per node, used if has_reach; otherwise a box's own longest side is used. */
kernel void pair_nodes(global const bb_node *nodes, uint count, global const uint *base,
                       float scale, global const float *reach, uint has_reach,
                       global bb_pair *pairs)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) != 0)
        return;
    uint children = base[n + 1] - base[n] + 1u;
    for (uint gap = 1; gap < children; gap++) {
        uint from, to;
        pair_range(gap, children, &from, &to);
        global bb_pair *pair = pairs + base[n] + gap - 1u;
        float both_lo[3], both_hi[3];
        for (uint side = 0; side < 2; side++) {
            uint begin = side == 0 ? from : gap, end = side == 0 ? gap : to;
            bb_siblings siblings = pair_siblings(nodes, n, begin, end);
            float lo[3], hi[3], longest;
            bb_siblings_box(nodes, has_reach != 0 ? reach : NULL, siblings, lo, hi, &longest);
            for (uint k = 0; k < 3; k++) {
                both_lo[k] = side == 0 ? lo[k] : BB_MIN(lo[k], both_lo[k]);
                both_hi[k] = side == 0 ? hi[k] : BB_MAX(hi[k], both_hi[k]);
            }
            bb_scale_and_pad(lo, hi, scale, has_reach != 0 ? longest : -1.0f);
            pair->links[side] = siblings.count == 1u ? pair_link(nodes, base, siblings.first)
                                                     : base[n] + (begin + end) / 2u - 1u;
            for (uint k = 0; k < 3; k++) {
                pair->planes[4 * k + side] = lo[k];
                pair->planes[4 * k + 2 + side] = hi[k];
            }
        }
        pair->area = bb_finite_half_area((both_hi[0] - both_lo[0]) * scale,
                                         (both_hi[1] - both_lo[1]) * scale,
                                         (both_hi[2] - both_lo[2]) * scale);
        pair->pad = 0;
    }
}

/* sides[2 * pair + side]: the children that the side was made of. */
kernel void pair_sides(global const bb_node *nodes, uint count, global const uint *base,
                       global bb_siblings *sides)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) != 0)
        return;
    uint children = base[n + 1] - base[n] + 1u;
    for (uint gap = 1; gap < children; gap++) {
        uint from, to;
        pair_range(gap, children, &from, &to);
        global bb_siblings *pair = sides + 2u * (base[n] + gap - 1u);
        pair[0] = pair_siblings(nodes, n, from, gap);
        pair[1] = pair_siblings(nodes, n, gap, to);
    }
}

/* Writes the link to start from, and the number of pair nodes. */
kernel void pair_root(global const bb_node *nodes, uint count, uint root, global const uint *base,
                      global uint *out)
{
    out[0] = pair_link(nodes, base, root);
    out[1] = base[count];
}
