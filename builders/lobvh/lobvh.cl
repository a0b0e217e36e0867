/* LOBVH: a densely numbered octree over the loose octree's cells, compacted into an 8-ary tree.
 *
 * Gu, Jendersie, Grosch 2018 (Fast and Dynamic Construction of Bounding Volume Hierarchies based on
 * Loose Octrees), sections 3.1 and 3.2. Dense octree nodes are numbered in breadth-first order: the
 * root is 0, the children of k are 8k + 1 .. 8k + 8, its parent is (k - 1) / 8, and level l begins
 * at D(l) = (8^l - 1) / 7.
 *
 *   lobvh_keys     initialization: for each primitive, level l by equation 1 and the fit test, key
 *                  k = D(l) + morton(cell at l)
 *   sort the primitives by key
 *   lobvh_mark     pointer setup: a node's primitives end where the key changes: mark the node,
 *                  close its leaf
 *   lobvh_vacancy  per level, bottom-up: a node is vacant if it has no primitive and all its
 *                  children are vacant
 *   lobvh_sizes    compaction: for each node, count the children that stay, plus a leaf if it
 *                  has primitives besides children
 *   scan the sizes: the places of each node's children
 *   lobvh_leaves   for each node with primitives: its leaf, with box and next pointer
 *   lobvh_inner    per level, bottom-up: first-child pointer, next pointer, box of the children
 *
 * The paper keeps box, first child, next, first and last primitive for every dense node: 40 bytes.
 * Here a node takes 1.6 bits, so deeper octrees fit. occupied: a bit per node, set if it is not
 * vacant; the bits of k's children are byte k + 7, so this is also F(k). own: a bit per node above
 * the deepest level, set if it has primitives; the bits of k's children are byte k + 1. The eight
 * siblings below p are ulong word p + 1 of the masks, byte p + 1 of own, entry p + 1 of offsets;
 * the root is the last of eight in entry 0. N(k) and the place after compaction are computed from
 * these when needed. The last primitive of a node is marked in the references (BB_LAST_BIT); its
 * leaf points to the first.
 *
 * As printed in the paper, N(k) never ends at the root and on paths of all sevens; here the walk
 * ends at the root.
 *
 * Kernels with `chunk` go through that many elements per work-item: hundreds on CPUs, one on GPUs.
 * -DBB_SIDE: the size measure. -DBB_FIT: with the fit test. -DBB_CHAINS: keep nodes that only have
 * one child.
 *
 * Limits: 10 levels (32-bit keys); 2^31 - 1 primitives; little-endian devices. A single work-item
 * joins the boxes of all primitives of a node.
 */
#include "bb_device.h"
#include "leaf_boxes.clh"
#include "morton.clh"

#define BB_SIDE_SMALLEST 0
#define BB_SIDE_LARGEST 1
#define BB_SIDE_MEAN 2
#define BB_SIDE_VOLUME 3
#ifndef BB_SIDE
#define BB_SIDE BB_SIDE_SMALLEST
#endif

/* ---- initialization ---- */

/* D(l), the number of nodes above level l: l ones in octal. */
uint nodes_above(uint level)
{
    return 0x09249249u & ((1u << 3u * level) - 1u);
}

uint pick(uint4 v, uint axis)
{
    return axis == 0u ? v.x : axis == 1u ? v.y : v.z;
}

/* Equation 1 for a root cell of length 1: returns the deepest level l at which the measure is at
 * most (a - 1) / 2^l. The integer part of the logarithm of the ratio of two positive floats is the
 * difference of their bits, cut to the exponent. A volume is compared with the cube of (a - 1), so
 * its logarithm counts three times. A measure of 0 is below all limits. */
uint level_of(float4 sides, float looseness, uint levels)
{
#if BB_SIDE == BB_SIDE_SMALLEST
    float d = BB_MIN(BB_MIN(sides.x, sides.y), sides.z), limit = looseness;
    int per_level = 1;
#elif BB_SIDE == BB_SIDE_LARGEST
    float d = BB_MAX(BB_MAX(sides.x, sides.y), sides.z), limit = looseness;
    int per_level = 1;
#elif BB_SIDE == BB_SIDE_MEAN
    float d = sides.x + sides.y + sides.z, limit = 3.0f * looseness;
    int per_level = 1;
#else
    float d = sides.x * sides.y * sides.z, limit = looseness * looseness * looseness;
    int per_level = 3;
#endif
    int level = ((as_int(limit) - as_int(d)) >> 23) / per_level;
    return (uint)clamp(level, 0, (int)levels);
}

/* Returns whether the box fits into the enlarged cell of its centroid at `level`. cells: the
 * centroid's cell at `levels`. */
bool fits(float4 lo, float4 hi, uint4 cells, float looseness, uint level, uint levels)
{
    float per_unit = (float)(1u << level), margin = 0.5f * looseness;
    float4 cell = convert_float4(cells >> (levels - level));
    float4 below = cell - lo * per_unit, above = hi * per_unit - cell - 1.0f;
    float4 out = BB_MAX(below, above);
    return BB_MAX(BB_MAX(out.x, out.y), out.z) <= margin;
}

/* bounds[0]: bounds of the boxes (bb_reduce_boxes). The root cell is a cube at its low corner, as
 * long as its longest side. Halves of coordinates are subtracted, so that no difference overflows.
 * axes, flips: bb_axis_order. */
kernel void lobvh_keys(global const bb_box *restrict boxes, global const bb_box *restrict bounds,
                       uint count, uint levels, float looseness, /* a - 1 */
                       uint first_axis, uint second_axis, uint third_axis, uint flips,
                       global uint *restrict keys, global uint *restrict values)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    global const float *outer = (global const float *)bounds;
    global const float *box = (global const float *)(boxes + i);
    float4 low = 0.5f * vload4(0, outer);
    float4 extent = 0.5f * vload4(1, outer) - low;
    float scale = 1.0f / BB_MAX(BB_MAX(extent.x, extent.y), extent.z);
    bool extended = scale <= FLT_MAX; /* false if all is at one point */
    scale = extended ? scale : 0.0f;
    float4 lo = (0.5f * vload4(0, box) - low) * scale;
    float4 hi = (0.5f * vload4(1, box) - low) * scale;

    float cells_per_axis = (float)(1u << levels);
    uint4 cells = convert_uint4(
        BB_MIN((0.5f * lo + 0.5f * hi) * cells_per_axis, (float4)(cells_per_axis - 1.0f)));
    uint level = extended ? level_of(hi - lo, looseness, levels) : 0u;
#ifdef BB_FIT
    uint deeper = BB_MIN(level + 1u, levels);
    level = fits(lo, hi, cells, looseness, deeper, levels) ? deeper : level;
#endif
    uint last = (1u << levels) - 1u;
    uint4 flip = (uint4)(flips & 1u, flips >> 1 & 1u, flips >> 2 & 1u, 0u) * last;
    cells ^= flip;
    uint4 ordered =
        (uint4)(pick(cells, first_axis), pick(cells, second_axis), pick(cells, third_axis), 0u);
    keys[i] = nodes_above(level) + (bb_morton_30(ordered) >> 3u * (levels - level));
    values[i] = i;
}

/* ---- pointer setup ---- */

/* `inner`: D(levels), the number of nodes above the deepest level. Bits are gathered per word
 * before they are written, since neighbours in the order share words. */
kernel void lobvh_mark(global const uint *restrict keys, global const uint *restrict values,
                       uint count, uint inner, uint chunk, volatile global uint *occupied,
                       volatile global uint *own, global uint *restrict refs)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk;
    uint word = 0, bits = 0, own_word = 0, own_bits = 0;
    uint key = keys[begin];
    for (uint i = begin; i < end; i++) {
        uint next = i + 1u < count ? keys[i + 1u] : BB_NONE;
        if (key == next) {
            refs[i] = values[i];
            continue;
        }
        refs[i] = values[i] | BB_LAST_BIT;
        if (key > 0u) {
            uint at = key + 55u; /* byte parent + 7, bit (key - 1) % 8 */
            if (at >> 5 != word) {
                if (bits != 0u)
                    atomic_or(&occupied[word], bits);
                word = at >> 5;
                bits = 0;
            }
            bits |= 1u << (at & 31u);
        }
        if (key < inner) {
            uint at = key + 7u;
            if (at >> 5 != own_word) {
                if (own_bits != 0u)
                    atomic_or(&own[own_word], own_bits);
                own_word = at >> 5;
                own_bits = 0;
            }
            own_bits |= 1u << (at & 31u);
        }
        key = next;
    }
    if (bits != 0u)
        atomic_or(&occupied[word], bits);
    if (own_bits != 0u)
        atomic_or(&own[own_word], own_bits);
}

/* ---- eight siblings at once: a byte per node ---- */

#define BB_ONES 0x0101010101010101ul

/* Returns 1 in each byte that is not 0. */
ulong nonzero_bytes(ulong v)
{
    const ulong low = 0x7F7F7F7F7F7F7F7Ful;
    return ((((v & low) + low) | v) >> 7) & BB_ONES;
}

/* Spreads bit c of `bits` to byte c, as 0 or 1. */
ulong spread_bits(uint bits)
{
    return nonzero_bytes(bits * BB_ONES & 0x8040201008040201ul);
}

ulong count_bits_of_bytes(ulong v)
{
    v -= v >> 1 & 0x5555555555555555ul;
    v = (v & 0x3333333333333333ul) + (v >> 2 & 0x3333333333333333ul);
    return (v + (v >> 4)) & 0x0F0F0F0F0F0F0F0Ful;
}

/* Returns for each of eight siblings, as a byte, how many nodes are below it after compaction. A
 * node with a single child and no primitives is replaced by the child, unless chains stay: its byte
 * is 0. */
ulong block_sizes(ulong children, uint own_bits)
{
    ulong own = spread_bits(own_bits) & nonzero_bytes(children);
    ulong sizes = count_bits_of_bytes(children) + own;
#ifndef BB_CHAINS
    sizes &= nonzero_bytes(sizes ^ BB_ONES) * 0xFFul;
#endif
    return sizes;
}

/* Returns the sum of the bytes below byte c; of all eight for c = 8. */
uint sum_bytes(ulong bytes, uint c)
{
    ulong below = c < 8u ? bytes & ((1ul << 8u * c) - 1ul) : bytes;
    return (uint)(below * BB_ONES >> 56);
}

/* ---- vacancy and compaction ---- */

/* For the `nodes` nodes from `first` on, all of one level: the bits of their children's own
 * primitives are set; this adds bits for children with children. */
kernel void lobvh_vacancy(global uchar *masks, global const ulong *words, uint first, uint nodes)
{
    uint n = get_global_id(0);
    if (n >= nodes)
        return;
    uint k = first + n;
    masks[k + 7u] |= (uchar)(nonzero_bytes(words[k + 1u]) * 0x0102040810204080ul >> 56);
}

kernel void lobvh_sizes(global const ulong *restrict words, global const uchar *restrict own,
                        uint count, global uint *restrict sizes)
{
    uint w = get_global_id(0);
    if (w < count)
        sizes[w] = sum_bytes(block_sizes(words[w], own[w]), 8u);
}

/* ---- places and pointers after compaction ---- */

typedef struct dense {
    global const ulong *words;
    global const uchar *own;
    global const uint *offsets; /* scan of the sizes */
} dense;

/* Returns the children of k that are not vacant, as bits. */
uint mask_of(global const ulong *words, uint k)
{
    return ((global const uchar *)words)[k + 7u];
}

/* A node above the deepest level, its children, and the nodes below it. */
typedef struct family {
    uint mask;  /* children that are not vacant */
    uint size;  /* nodes below it; 0 if it is vacant, a leaf, or replaced by its child */
    uint start; /* place of the first of these */
    uint leaf;  /* 1: the first is a leaf with the node's own primitives */
} family;

family family_of(const dense *octree, uint k)
{
    uint w = (k + 7u) >> 3, c = (k + 7u) & 7u;
    ulong children = octree->words[w];
    uint own_bits = octree->own[w];
    ulong sizes = block_sizes(children, own_bits);
    family f;
    f.mask = (uint)(children >> 8u * c) & 0xFFu;
    f.size = (uint)(sizes >> 8u * c) & 0xFFu;
    f.start = 1u + octree->offsets[w] + sum_bytes(sizes, c);
    f.leaf = f.mask != 0u ? own_bits >> c & 1u : 0u;
    return f;
}

/* Returns the place of child c. */
uint place_in(const family *f, uint c)
{
    return f->start + f->leaf + popcount(f->mask & ((1u << c) - 1u));
}

/* Returns the place of node k, or of its child if that replaces it. */
uint place_of(const dense *octree, uint k)
{
    while (k > 0u) {
        family parent = family_of(octree, (k - 1u) >> 3);
        if (parent.size > 0u)
            return place_in(&parent, (k - 1u) & 7u);
        k = (k - 1u) >> 3;
    }
    return 0u;
}

/* Returns the place of the node after node k: the next sibling that is not vacant, of k or of the
 * nearest ancestor that has one. */
uint next_of(const dense *octree, uint k)
{
    while (k > 0u) {
        uint parent = (k - 1u) >> 3, c = (k - 1u) & 7u;
        uint mask = mask_of(octree->words, parent);
        if (mask >> (c + 1u) != 0u) {
            family f = family_of(octree, parent);
            return place_in(&f, c) + 1u;
        }
        k = parent;
    }
    return BB_NONE;
}

/* Returns place and next of child c of `parent`, whose children are `siblings`, computed once for
 * all of them. */
uint2 place_and_next(const dense *octree, const family *siblings, uint parent, uint c)
{
    uint2 at;
    at.x = siblings->size > 0u ? place_in(siblings, c) : place_of(octree, parent);
    at.y = siblings->mask >> (c + 1u) != 0u ? at.x + 1u : next_of(octree, parent);
    return at;
}

/* ---- link ---- */

/* Joins the boxes of each node's primitives, by the work-item in whose chunk they begin. info is 0
 * before. */
kernel void lobvh_leaves(global const uint *restrict keys, global const uint *restrict values,
                         global const bb_box *restrict boxes, uint count, uint inner, uint chunk,
                         global const ulong *words, global const uchar *own,
                         global const uint *offsets, global bb_node *restrict nodes,
                         global uchar *restrict heights, volatile global bb_tree_info *info)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk;
    const dense octree = {words, own, offsets};
    uint leaves = 0, parent = BB_NONE;
    family siblings = {0, 0, 0, 0};
    uint i = begin;
    /* leave primitives of a node that began before this chunk to another work-item */
    if (begin > 0u)
        while (i < end && keys[i] == keys[begin - 1u])
            i++;
    while (i < end) {
        uint key = keys[i], from = i;
        float4 lo = (float4)(INFINITY), hi = (float4)(-INFINITY);
        do {
            bb_join_box_ahead(values, boxes, i, count, &lo, &hi);
            i++;
        } while (i < count && keys[i] == key);
        uint2 at = (uint2)(0u, BB_NONE); /* the root's */
        if (key < inner && mask_of(words, key) != 0u) { /* its leaf comes before its children */
            uint start = family_of(&octree, key).start;
            at = (uint2)(start, start + 1u);
        } else if (key > 0u) {
            if ((key - 1u) >> 3 != parent) {
                parent = (key - 1u) >> 3;
                siblings = family_of(&octree, parent);
            }
            at = place_and_next(&octree, &siblings, parent, (key - 1u) & 7u);
        }
        bb_write_node(nodes, at.x, lo, hi, BB_LEAF_BIT | from, at.y);
        heights[at.x] = 0;
        leaves++;
    }
    if (leaves > 0u)
        atomic_add(&info->leaf_count, leaves);
}

/* Handles the sibling words first .. first + count - 1, which are the nodes of one level; their
 * children are finished. */
kernel void lobvh_inner(global const ulong *words, global const uchar *own,
                        global const uint *offsets, global const uint *total,
                        uint prims, uint first, uint count, uint chunk, global bb_node *nodes,
                        global uchar *heights, volatile global bb_tree_info *info)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk;
    const dense octree = {words, own, offsets};
    uint arity = 0;
    for (uint n = begin; n < end; n++) {
        uint w = first + n;
        if (words[w] == 0ul)
            continue;
        ulong sizes = block_sizes(words[w], own[w]);
        if (sizes == 0ul)
            continue;
        family siblings = {0, 0, 0, 0};
        if (w > 0u)
            siblings = family_of(&octree, w - 1u);
        uint start = 1u + offsets[w];
        for (uint c = 0; c < 8u; c++) {
            uint size = (uint)(sizes >> 8u * c) & 0xFFu;
            if (size == 0u)
                continue;
            float4 lo = (float4)(INFINITY), hi = (float4)(-INFINITY);
            uint height = 0;
            for (uint k = start; k < start + size; k++) {
                global const float *box = (global const float *)(nodes + k);
                lo = BB_MIN(vload4(0, box), lo);
                hi = BB_MAX(vload4(1, box), hi);
                height = BB_MAX((uint)heights[k], height);
            }
            uint2 at = (uint2)(0u, BB_NONE); /* the root's */
            if (w > 0u)
                at = place_and_next(&octree, &siblings, w - 1u, c);
            bb_write_node(nodes, at.x, lo, hi, start, at.y);
            heights[at.x] = (uchar)(height + 1u);
            arity = BB_MAX(size, arity);
            start += size;
        }
    }
    if (arity > 0u)
        atomic_max(&info->arity, arity);
    if (first == 0u) { /* the root's word has no siblings */
        info->root = 0;
        info->node_count = 1u + total[0];
        info->ref_count = prims;
        info->depth = heights[0];
    }
}
