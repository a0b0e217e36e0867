/* LLBVH without the linking: from boxes to the non-empty nodes of a loose octree, in preorder, and
 * their primitives.
 *
 * Gu, Jendersie, Grosch 2018 (Fast and Dynamic Construction of Bounding Volume Hierarchies based on
 * Loose Octrees), section 3.3:
 *
 *   for each primitive (llbvh_nodes):
 *       m = Morton code of its centroid (codes.cl)
 *       l = 3 * level by its size
 *       m' = m with all but the first l bits set to 0
 *       key = preorder index of node (m', l) in the complete binary tree
 *   sort primitives by key
 *   for each chunk: count the keys that differ from the previous one: leaves begin there
 *                                                                                (llbvh_heads)
 *   scan the counts
 *   for each leaf: its node, and its first primitive                            (llbvh_leaves)
 *   link: builders/common/radix_tree.cl, which replaces the paper's algorithm 1
 *
 * The preorder index. A step to the left adds 1; a step to the right passes the whole left subtree,
 * too. At level d (of L') the right step adds 1 + (2^(L' - d) - 1) = 2^(L' - d), which is twice the
 * bit of m' that the step sets. So the index is l plus, for each 1 in m', twice its value minus 1:
 * 2 m' - popcount(m') + l. Equation 4 prints - l, which would put a child before its parent and
 * give different nodes the same key. The index is at most 2^(L' + 1) - 2: it has L' + 1 bits.
 *
 * -DBB_KEY64: more than 30 bits. -DBB_FIT: a box goes one level deeper if it fits there.
 * -DBB_EVERY_OTHER: even levels only. loose_octree.clh has the size measures. Limits: 2^31 - 1
 * primitives; codes of at most 30 or 63 bits.
 */
#include "bb_device.h"
#include "loose_octree.clh"

#ifdef BB_KEY64
typedef ulong bb_key;
#else
typedef uint bb_key;
#endif
#define BB_KEY_BITS ((uint)sizeof(bb_key) * 8u)

/* keys: in: codes of 3 bits per level; out: preorder indices. Boxes for levels deeper than `upto`
 * all go to the deepest level. reach: see loose_octree.clh. low, scale: the root cell's corner, and
 * cells of the deepest level per unit. loose: a. */
kernel void llbvh_nodes(global const bb_box *restrict boxes, uint count, float4 reach, float4 low,
                        float4 scale, float loose, uint deepest, uint upto,
                        global bb_key *restrict keys, global bb_key *restrict nodes)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    global const float *box = (global const float *)(boxes + i);
    float4 lo = vload4(0, box), hi = vload4(1, box);

    uint level = bb_loose_level(hi - lo, reach, deepest);
#ifdef BB_FIT
    float4 at = ((0.5f * lo + 0.5f * hi) - low) * scale;
    if (level < deepest &&
        bb_loose_fits(at, (hi - lo) * scale, deepest, deepest - level - 1u, loose))
        level++;
#endif
#ifdef BB_EVERY_OTHER
    level = level < deepest ? level & ~1u : deepest;
#endif
    level = level <= upto ? level : deepest;

    uint dropped = 3u * (deepest - level);
    bb_key code = keys[i] >> dropped << dropped;
    keys[i] = 2 * code - popcount(code) + 3u * level;
    /* the form that the linking takes: the path from the top bit on, a 1, zeros */
    bb_key path = 2 * code + ((bb_key)1 << dropped);
    nodes[i] = path << (BB_KEY_BITS - 1u - 3u * deepest);
}

/* Returns whether a leaf begins at i. Runs of equal keys are cut so that each leaf has
 * less than twice `merge` primitives; runs of up to `merge` stay whole. `merge` is a power of two;
 * 0: all runs stay whole. */
bool is_head(global const bb_key *keys, uint i, uint merge)
{
    if (i == 0u || keys[i] != keys[i - 1u])
        return true;
    return merge > 0u && (i & (merge - 1u)) == 0u && i >= merge && keys[i] == keys[i - merge];
}

/* heads: number of leaves that begin in each chunk. */
kernel void llbvh_heads(global const bb_key *restrict keys, uint count, uint merge, uint chunk,
                        global uint *restrict heads)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk, found = 0;
    for (uint i = begin; i < end; i++)
        found += is_head(keys, i, merge) ? 1u : 0u;
    heads[get_global_id(0)] = found;
}

/* places: number of leaves that begin before each chunk. starts: one entry more than leaves. */
kernel void llbvh_leaves(global const bb_key *restrict keys, uint count, uint merge, uint chunk,
                         global const uint *restrict places, global const uint *restrict values,
                         global const bb_key *restrict nodes, global bb_key *restrict leaves,
                         global uint *restrict starts)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk;
    uint place = places[get_global_id(0)];
    for (uint i = begin; i < end; i++)
        if (is_head(keys, i, merge)) {
            leaves[place] = nodes[values[i]];
            starts[place] = i;
            place++;
        }
    if (end == count)
        starts[place] = count;
}
