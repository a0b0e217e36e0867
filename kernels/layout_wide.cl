/* The wide layouts: from pair nodes (layout_pair.cl) to nodes of up to BB_WIDTH children, and from references to blocks of primitives.
 *
 *   level by level from the root (wide_open):
 *     children = both sides of the pair; while there is room: the child that is a pair and has the largest area makes
 *     place for its own two
 *     mark the pair; those of its children that are pairs are the next level
 *   index = exclusive scan of the marks                  (framework/primitives.h): nodes keep the order of the tree in memory
 *   for each marked pair: the same children; write node  (wide_nodes)
 *   first[i] = exclusive scan of the blocks that the leaf at reference i needs   (wide_count)
 *   for each leaf: write its blocks                      (wide_blocks)
 *
 * Wald, Benthin, Boulos 2008 (collapse by surface area); Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
 * Compressed Wide BVHs" (8 bits per plane). Pairs that only part the children of one node of a tree of higher
 * arity are opened before all others, so such a tree keeps its nodes as far as they have room.
 */
#include "bb_device.h"

#include "record.clh"
#include "wide.clh"

typedef struct bb_opened {
    float planes[6 * BB_WIDTH]; /* as in the node */
    uint links[BB_WIDTH];       /* to pairs and references */
    uint count;
} bb_opened;

/* The places of an opened node that have no child yet. */
void opened_empty(bb_opened *out)
{
    for (uint c = 0; c < BB_WIDTH; c++) {
        for (uint axis = 0; axis < 3; axis++) {
            out->planes[2u * axis * BB_WIDTH + c] = INFINITY;
            out->planes[(2u * axis + 1u) * BB_WIDTH + c] = -INFINITY;
        }
        out->links[c] = BB_NONE;
    }
    out->count = 0;
}

/* Puts side `side` of pair `p` in place `c`. */
void opened_place(global const bb_pair *pairs, uint p, uint side, bb_opened *out, uint c,
                  float *priority)
{
    float size[3];
    for (uint axis = 0; axis < 3; axis++) {
        float lo = pairs[p].planes[4u * axis + side], hi = pairs[p].planes[4u * axis + 2u + side];
        out->planes[2u * axis * BB_WIDTH + c] = lo;
        out->planes[(2u * axis + 1u) * BB_WIDTH + c] = hi;
        size[axis] = BB_MIN(hi - lo, FLT_MAX); /* infinity times 0 would have no order */
    }
    uint link = pairs[p].links[side];
    out->links[c] = link;
    float area = size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    if ((link & BB_LEAF_BIT) != 0)
        priority[c] = -1.0f;
    else
        priority[c] = pairs[p].parts[side] != 0u ? INFINITY : area;
}

/* The children of the wide node that pair `root` becomes. */
void opened_of(global const bb_pair *pairs, uint root, bb_opened *out)
{
    float priority[BB_WIDTH];
    opened_empty(out);
    opened_place(pairs, root, 0, out, 0, priority);
    opened_place(pairs, root, 1, out, 1, priority);
    out->count = 2;
    while (out->count < BB_WIDTH) {
        uint largest = 0;
        for (uint c = 1; c < out->count; c++)
            largest = priority[c] > priority[largest] ? c : largest;
        if (!(priority[largest] >= 0.0f))
            return;
        uint p = out->links[largest];
        opened_place(pairs, p, 0, out, largest, priority);
        opened_place(pairs, p, 1, out, out->count, priority);
        out->count++;
    }
}

/* One level. state[0]: the largest stack need so far; state[1 + level]: items of the level. */
kernel void wide_open(global const bb_pair *pairs, global const uint2 *level, /* pair, stack need above */
                      uint number, volatile global uint *state, global uint *marks,
                      global uint2 *next)
{
    uint count = state[1u + number];
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        uint2 item = level[i];
        bb_opened opened;
        opened_of(pairs, item.x, &opened);
        marks[item.x] = 1u;
        uint need = item.y + opened.count - 1u;
        atomic_max(&state[0], need);
        for (uint c = 0; c < opened.count; c++)
            if ((opened.links[c] & BB_LEAF_BIT) == 0)
                next[atomic_inc(&state[2u + number])] = (uint2)(opened.links[c], need);
    }
}

#if BB_QUANTISED
/* The largest step of up to 8 bits whose plane is not above `plane`, which is not below that of step 0. */
uint step_below(global const bb_wide *node, uint axis, float plane)
{
    float guess = (plane - node->base[axis]) / node->scale[axis];
    uint q = guess >= 255.0f ? 255u : guess >= 0.0f ? (uint)guess : 0u;
    while (q > 0u && BB_DEQUANTISE(node, axis, (float)q) > plane)
        q--;
    while (q < 255u && BB_DEQUANTISE(node, axis, (float)(q + 1u)) <= plane)
        q++;
    return q;
}

/* The smallest step whose plane is not below `plane`, which is not above that of step 255. */
uint step_above(global const bb_wide *node, uint axis, float plane)
{
    uint q = step_below(node, axis, plane);
    return BB_DEQUANTISE(node, axis, (float)q) < plane ? q + 1u : q;
}

void write_boxes(const bb_opened *opened, global bb_wide *node)
{
    for (uint axis = 0; axis < 3; axis++) {
        const float *los = opened->planes + 2u * axis * BB_WIDTH, *his = los + BB_WIDTH;
        float lo = los[0], hi = his[0];
        for (uint c = 1; c < BB_WIDTH; c++) {
            lo = BB_MIN(los[c], lo);
            hi = BB_MAX(his[c], hi);
        }
        /* the least power of two of which 255 reach from lo to hi; a box far away may need more than its extent says */
        float extent = BB_MIN(hi - lo, FLT_MAX);
        float scale = as_float(as_uint(extent / 255.0f) & 0x7F800000u);
        scale = hi > lo ? BB_MAX(scale, FLT_MIN) : 0.0f;
        node->base[axis] = lo;
        node->scale[axis] = scale;
        while (BB_DEQUANTISE(node, axis, 255.0f) < hi)
            node->scale[axis] = scale *= 2.0f;
        for (uint c = 0; c < BB_WIDTH; c++) {
            bool empty = opened->links[c] == BB_NONE;
            node->planes[2u * axis * BB_WIDTH + c] = empty ? 255u : step_below(node, axis, los[c]);
            node->planes[(2u * axis + 1u) * BB_WIDTH + c] =
                empty ? 0u : step_above(node, axis, his[c]);
        }
    }
}
#else
void write_boxes(const bb_opened *opened, global bb_wide *node)
{
    for (uint w = 0; w < 6u * BB_WIDTH; w++)
        node->planes[w] = opened->planes[w];
}
#endif

/* first[] and index[] are the scans. */
kernel void wide_nodes(global const bb_pair *pairs, uint count, global const uint *index,
                       global const uint *first, uint ref_count, global bb_wide *nodes)
{
    uint p = get_global_id(0);
    if (p >= count || index[p] == index[p + 1u])
        return;
    bb_opened opened;
    opened_of(pairs, p, &opened);
    global bb_wide *node = nodes + index[p];
    write_boxes(&opened, node);
    for (uint c = 0; c < BB_WIDTH; c++) {
        uint link = opened.links[c];
        if (link == BB_NONE)
            link = BB_LEAF_BIT | first[ref_count]; /* the block without primitives */
        else if ((link & BB_LEAF_BIT) != 0)
            link = BB_LEAF_BIT | first[link & BB_INDEX_MASK];
        else
            link = index[link];
        node->links[c] = link;
    }
    node->count = opened.count;
    for (uint w = 0; w < sizeof(node->pad) / sizeof(uint); w++)
        node->pad[w] = 0;
}

/* ---- primitives ---- */

/* Triangles and spheres of the leaf that starts at reference i. */
uint2 leaf_kinds(global const uint *refs, uint i, uint triangle_count)
{
    uint2 kinds = (uint2)(0u, 0u);
    for (bool last = false; !last; i++) {
        last = (refs[i] & BB_LAST_BIT) != 0;
        if ((refs[i] & BB_INDEX_MASK) < triangle_count)
            kinds.x++;
        else
            kinds.y++;
    }
    return kinds;
}

kernel void wide_count(global const uint *refs, uint count, uint triangle_count, global uint *blocks)
{
    uint i = get_global_id(0);
    if (i > count)
        return;
    blocks[i] = 0;
    if (i == count || (i > 0u && (refs[i - 1u] & BB_LAST_BIT) == 0))
        return;
    uint2 kinds = (leaf_kinds(refs, i, triangle_count) + BB_BLOCK_LANES - 1u) / BB_BLOCK_LANES;
    blocks[i] = kinds.x + kinds.y;
}

/* A block that nothing can hit: triangles that are points, or NaN, which fits spheres too, but costs time in the triangle test. */
void block_empty(global uint *block, uint words, uint id_word, bool points)
{
    for (uint w = 0; w < words; w++)
        block[w] = points ? 0u : as_uint(NAN);
    for (uint lane = 0; lane < BB_BLOCK_LANES; lane++)
        block[id_word + lane] = BB_NONE;
}

kernel void wide_blocks(global const uint *refs, uint count, global const float *vertices,
                        global const uint *indices, global const float *spheres,
                        uint triangle_count, uint form, uint words, global const uint *first,
                        global uint *blocks)
{
    uint i = get_global_id(0);
    uint id_word = words - BB_BLOCK_LANES;
    if (i == count)
        block_empty(blocks + (ulong)first[i] * words, words, id_word, false);
    if (i >= count || (i > 0u && (refs[i - 1u] & BB_LAST_BIT) == 0))
        return;
    uint triangles = leaf_kinds(refs, i, triangle_count).x;
    uint sphere_block = first[i] + (triangles + BB_BLOCK_LANES - 1u) / BB_BLOCK_LANES;
    for (uint b = first[i]; b < first[i + 1u]; b++)
        block_empty(blocks + (ulong)b * words, words, id_word, b < sphere_block);

    uint next[2] = {first[i] * BB_BLOCK_LANES, sphere_block * BB_BLOCK_LANES}; /* lanes */
    for (bool last = false; !last; i++) {
        last = (refs[i] & BB_LAST_BIT) != 0;
        uint prim = refs[i] & BB_INDEX_MASK;
        bool sphere = prim >= triangle_count;
        uint place = next[sphere ? 1 : 0]++;
        global uint *lane = blocks + (ulong)(place / BB_BLOCK_LANES) * words + place % BB_BLOCK_LANES;
        bb_write_primitive(lane, BB_BLOCK_LANES, form, prim, vertices, indices, spheres,
                           triangle_count);
        lane[id_word] = prim;
    }
    uint last_block = (next[1] > sphere_block * BB_BLOCK_LANES ? next[1] : next[0]) - 1u;
    blocks[(ulong)(last_block / BB_BLOCK_LANES) * words + id_word] |= BB_LAST_BIT;
}
