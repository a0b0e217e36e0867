/* The wide layouts made directly from a binary tree (layout_wide_direct.cl): writes blocks of
 * collapsed leaves and wide nodes, for each chunk of the tree's nodes, in their order.
 */
#include "bb_device.h"

#include "wide_blocks.clh"
#include "wide_boxes.clh"
#include "wide_direct.clh"
#include "wide_gather.clh"

/* Writes the blocks of the leaf that node n became, from block `at` on. */
void write_prims(const bb_block_writer *writer, global const bb_node *nodes,
                 global const uint *refs, uint n, uint2 word, uint ref_count, uint at)
{
    uint prims[BB_LEAF_MAX], next[BB_KIND_COUNT];
    uint many = bb_direct_prims(nodes, refs, n, word, prims);
    for (uint i = 0; i < many; i++)
        bb_ask_ahead(refs, word.y + i, ref_count, writer->data, writer->vertices, &writer->ends);
    bb_count_kinds(prims, many, &writer->ends, next);
    bb_blocks_begin(writer, at, next);
    for (uint i = 0; i < many; i++)
        bb_blocks_put(writer, prims[i], next);
}

/* The same for scenes of triangles only, as vertices. */
void write_triangles(const bb_block_writer *writer, global const bb_node *nodes,
                     global const uint *refs, uint n, uint2 word, uint ref_count, uint at)
{
    uint prims[BB_LEAF_MAX];
    uint many = bb_direct_prims(nodes, refs, n, word, prims);
    for (uint i = 0; i < many; i++)
        bb_ask_ahead_triangles(refs, word.y + i, ref_count, writer->data, writer->vertices);
    bb_blocks_of_triangles(writer, at, prims, many);
}

/* Writes the blocks of collapsed leaves. firsts[n]: first block of leaf n. before[]: number of
 * blocks before each word of marks. */
kernel void direct_blocks(global const bb_node *nodes, global const uint *refs,
                          global const uint2 *words, global const ulong *marks, uint count,
                          uint ref_count, global const uint *before,
                          global const float *vertices,
                          global const uint *data, bb_prim_ends ends, float scale, uint format,
                          uint block_words, uint fresh, global uint *firsts, global uint *blocks)
{
    const bb_block_writer writer = {vertices, data,        ends,  scale,
                                    format,   block_words, fresh, blocks};
    uint begin = get_global_id(0) * BB_DIRECT_CHUNK, end = BB_MIN(begin + BB_DIRECT_CHUNK, count);
    if (begin >= count)
        return;
    uint at = before[begin / BB_DIRECT_WORD];
    const bool triangles = format == BB_FORMAT_VERTICES && bb_only_triangles(&ends) &&
                           block_words == BB_TRIANGLE_BLOCK_WORDS;
    for (uint n = begin; n < end; n += 8u) {
        ulong eight = marks[n / 8u];
        /* bit 7 of each byte that is a number of blocks */
        ulong leaves = (eight & 0x7F7F7F7F7F7F7F7Ful) + 0x7F7F7F7F7F7F7F7Ful;
        for (leaves &= 0x8080808080808080ul; leaves != 0ul; leaves &= leaves - 1ul) {
            uint byte = (uint)popcount((leaves & (0ul - leaves)) - 1ul) / 8u;
            uint own = (uint)(eight >> 8u * byte) & 0x7Fu;
            firsts[n + byte] = at;
            if (triangles)
                write_triangles(&writer, nodes, refs, n + byte, words[n + byte], ref_count, at);
            else
                write_prims(&writer, nodes, refs, n + byte, words[n + byte], ref_count, at);
            at += own;
            bb_blocks_end(&writer, at);
        }
    }
    if (end == count) /* the target of links at places without a child */
        bb_block_empty(&writer, at, BB_KIND_COUNT);
}

/* Arguments for writing a node. `none`: the record that nothing hits. */
typedef struct node_writer {
    global const bb_node *nodes;
    global const uint2 *words;
    global const ulong *bits;
    global const uint *before, *firsts;
    float scale;
    uint collapsed, none, octants;
} node_writer;

uint link_of(const node_writer *w, uint side)
{
    uint n = side & BB_INDEX_MASK;
    if (side == BB_NONE)
        return BB_LEAF_BIT | w->none;
    if ((side & BB_LEAF_BIT) == 0)
        return bb_direct_number(w->bits, w->before, n);
    return w->collapsed != 0u ? BB_LEAF_BIT | w->firsts[n] : w->nodes[n].first;
}

/* `own`: the sides that the node of node n absorbs, `children` of them. */
void write_node(const node_writer *w, uint own[BB_WIDTH], uint children, global bb_wide *node,
                global uint *sides)
{
    bb_wide_boxes boxes;
    for (uint c = children; c < BB_WIDTH; c++)
        own[c] = BB_NONE;
    bb_gather_boxes(w->nodes, own, &boxes);
    bb_wide_scale_and_pad(&boxes, w->scale);
#if BB_WIDTH == 8
    if (w->octants != 0u) {
        bb_wide_arrange(&boxes, children, own);
        bb_gather_boxes(w->nodes, own, &boxes);
        bb_wide_scale_and_pad(&boxes, w->scale);
    }
#endif
    bb_wide_write(&boxes, node);
    for (uint c = 0; c < BB_WIDTH; c++) {
        node->links[c] = link_of(w, own[c]);
        sides[c] = own[c] == BB_NONE ? BB_NONE : own[c] & BB_INDEX_MASK;
    }
    node->count = children;
    for (uint p = 0; p < sizeof(node->pad) / sizeof(uint); p++)
        node->pad[p] = 0;
}

/* Nodes that a work-item has found but not written. It prefetches all their children's boxes, which
 * are scattered, and so waits for memory once, not once per node. */
#define BATCH 32
typedef struct batch {
    uint sides[BATCH][BB_WIDTH];
    uint children[BATCH];
    uint count;
} batch;

void add_to_batch(const node_writer *w, uint n, batch *b)
{
    uint *own = b->sides[b->count];
    uint children = bb_direct_sides(w->nodes, w->words, w->bits, n, own);
    for (uint c = 0; c < children; c++) {
        uint side = own[c] & BB_INDEX_MASK;
        BB_PREFETCH(w->nodes + side);
        if (w->collapsed != 0u && side != own[c])
            BB_PREFETCH(w->firsts + side);
    }
    b->children[b->count++] = children;
}

/* sides: the tree's node at each place of each wide node, for layouts that follow. */
kernel void direct_nodes(global const bb_node *nodes, global const uint2 *words, uint count,
                         global const ulong *bits, global const uint *before,
                         global const uint *firsts, float scale, uint collapsed, uint none,
                         uint octants, global bb_wide *wide, global uint *sides)
{
    const node_writer w = {nodes, words, bits, before, firsts, scale, collapsed, none, octants};
    uint begin = get_global_id(0) * BB_DIRECT_CHUNK, end = BB_MIN(begin + BB_DIRECT_CHUNK, count);
    if (begin >= count)
        return;
    uint at = before[begin / BB_DIRECT_WORD];
    batch b;
    b.count = 0;
    for (uint n = begin; n < end; n += BB_DIRECT_WORD) {
        for (uint k = 0; k < BB_DIRECT_WORD; k += 8u) /* one cache line of words */
            BB_PREFETCH(words + n + 4u * BB_DIRECT_WORD + k);
        for (ulong left = bits[n / BB_DIRECT_WORD]; left != 0ul; left &= left - 1ul) {
            add_to_batch(&w, n + (uint)popcount((left & (0ul - left)) - 1ul), &b);
            if (b.count < BATCH)
                continue;
            for (uint i = 0; i < BATCH; i++, at++)
                write_node(&w, b.sides[i], b.children[i], wide + at, sides + (ulong)at * BB_WIDTH);
            b.count = 0;
        }
    }
    for (uint i = 0; i < b.count; i++, at++)
        write_node(&w, b.sides[i], b.children[i], wide + at, sides + (ulong)at * BB_WIDTH);
}
