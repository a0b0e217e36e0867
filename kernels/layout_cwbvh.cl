/* The `cwbvh` layout: compressed nodes (bb_cwbvh) made from the pairs that layout_wide.cl has
 * opened, and the order of their primitives.
 *
 *   for each opened pair: count its children that are nodes and the primitives of its leaves
 *                                                                                  (cwbvh_count)
 *   exclusive scans of both: a node's children, and its primitives, are adjacent
 *   for each opened pair:                                                          (cwbvh_place)
 *       assign children to places by octant (bb_wide_arrange())
 *       number those that are nodes in the order of their places; the root is 0
 *       put references of leaves one after the other
 *   for each node: boxes in 8 bits (cwbvh_boxes.clh), and the contents of its places (cwbvh_nodes)
 *
 * Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
 * BVHs", whose text was not at hand: the format of a node and its places by octant. They assign
 * places by an auction; here the best-fitting pair of child and place is assigned first. Limits:
 * trees whose leaves have up to BB_CWBVH_LEAF_MAX references (collapse.cl divides larger ones).
 */
#include "bb_device.h"

#include "wide_boxes.clh"

/* Returns the link of a side: a pair, or with BB_LEAF_BIT the first reference of a leaf. */
uint link_of(global const bb_pair *pairs, uint side)
{
    return pairs[side >> 1].links[side & 1u];
}

uint leaf_length(global const uint *refs, uint link)
{
    uint first = link & BB_INDEX_MASK, length = 1;
    while ((refs[first + length - 1u] & BB_LAST_BIT) == 0)
        length++;
    return length;
}

kernel void cwbvh_count(global const bb_pair *pairs, uint count, global const uint *opened,
                        global const uint *marks, global const uint *refs, global uint *nodes,
                        global uint *prims)
{
    uint p = get_global_id(0), own_nodes = 0, own_prims = 0;
    if (p > count)
        return;
    for (uint c = 0; p < count && marks[p] != 0u && c < BB_WIDTH; c++) {
        uint side = opened[(ulong)p * BB_OPENED_WORDS + c];
        if (side == BB_NONE)
            continue;
        uint link = link_of(pairs, side);
        if ((link & BB_LEAF_BIT) != 0)
            own_prims += leaf_length(refs, link);
        else
            own_nodes++;
    }
    nodes[p] = own_nodes;
    prims[p] = own_prims;
}

/* nodes[], prims[]: the scans. Places are returned in opened[]. pair_of[]: the pair of each node.
 * order[]: references in the order of the nodes, each marked as the last of a leaf, since kernels
 * test them one by one. */
kernel void cwbvh_place(global const bb_pair *pairs, uint count, uint root, global uint *opened,
                        global const uint *marks, global const uint *refs,
                        global const uint *nodes, global const uint *prims, global uint *pair_of,
                        global uint *order)
{
    uint p = get_global_id(0);
    if (p >= count || marks[p] == 0u)
        return;
    bb_wide_boxes boxes;
    uint own[BB_WIDTH], children = bb_wide_take_opened(opened, p, own);
    bb_wide_put_pairs(pairs, own, &boxes);
    bb_wide_arrange(&boxes, children, own);
    uint node = 1u + nodes[p], prim = prims[p];
    for (uint c = 0; c < BB_WIDTH; c++) {
        opened[(ulong)p * BB_OPENED_WORDS + c] = own[c];
        if (own[c] == BB_NONE)
            continue;
        uint link = link_of(pairs, own[c]);
        if ((link & BB_LEAF_BIT) == 0) {
            pair_of[node++] = link;
            continue;
        }
        uint length = leaf_length(refs, link);
        for (uint i = 0; i < length; i++)
            order[prim++] = refs[(link & BB_INDEX_MASK) + i] | BB_LAST_BIT;
    }
    if (p == root)
        pair_of[0] = root;
}

/* sides: the side at each place of each node, for layouts that follow. */
kernel void cwbvh_nodes(global const bb_pair *pairs, uint count, global const uint *pair_of,
                        global const uint *opened, global const uint *refs,
                        global const uint *nodes, global const uint *prims,
                        global bb_cwbvh *out, global uint *sides)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    uint p = pair_of[n], own[BB_WIDTH], inner = 0, before = 0;
    global bb_cwbvh *node = out + n;
    bb_wide_boxes boxes;
    for (uint c = 0; c < BB_WIDTH; c++) {
        own[c] = opened[(ulong)p * BB_OPENED_WORDS + c];
        sides[(ulong)n * BB_WIDTH + c] = own[c];
        uint link = own[c] != BB_NONE ? link_of(pairs, own[c]) : 0u, meta = 0;
        if (own[c] != BB_NONE && (link & BB_LEAF_BIT) == 0) {
            meta = 1u << 5 | (24u + c);
            inner |= 1u << c;
        } else if (own[c] != BB_NONE) {
            uint length = leaf_length(refs, link);
            meta = ((1u << length) - 1u) << 5 | before;
            before += length;
        }
        node->meta[c] = (uchar)meta;
    }
    bb_wide_put_pairs(pairs, own, &boxes);
    bb_wide_write(&boxes, node);
    node->inner = (uchar)inner;
    node->nodes = 1u + nodes[p];
    node->prims = prims[p];
}
