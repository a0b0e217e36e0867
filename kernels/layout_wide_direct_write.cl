/* The wide layouts straight from a binary tree (layout_wide_direct.cl): blocks of the leaves that
 * collapse made, and wide nodes, for each chunk of the tree's nodes, in their order.
 */
#include "bb_device.h"

#include "wide_blocks.clh"
#include "wide_boxes.clh"
#include "wide_direct.clh"

/* Blocks of the leaves that collapse made, and firsts[n]: where those of leaf n begin. before[]:
 * the blocks before each word of marks. */
kernel void direct_blocks(global const bb_node *nodes, global const uint *refs,
                          global const uint2 *words, global const uchar *marks, uint count,
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
    for (uint n = begin; n < end; n++) {
        if (marks[n] == 0 || marks[n] == BB_MARK_NODE)
            continue;
        uint prims[BB_LEAF_MAX], next[BB_KIND_COUNT];
        uint many = bb_direct_prims(nodes, refs, n, words[n], prims);
        for (uint i = 0; i < many; i++)
            bb_ask_ahead(refs, words[n].y + i, ref_count, data, vertices, &ends);
        bb_count_kinds(prims, many, &ends, next);
        firsts[n] = at;
        bb_blocks_begin(&writer, at, next);
        for (uint i = 0; i < many; i++)
            bb_blocks_put(&writer, prims[i], next);
        at += marks[n];
        bb_blocks_end(&writer, at);
    }
    if (end == count) /* what the links of places without a child lead to */
        bb_block_empty(&writer, at, BB_KIND_COUNT);
}

/* Boxes of the nodes that have the places, as the tree has them. */
void gather_boxes(global const bb_node *nodes, const uint sides[BB_WIDTH], bb_wide_boxes *boxes)
{
    bb_wide_clear(boxes);
    for (uint c = 0; c < BB_WIDTH; c++) {
        if (sides[c] == BB_NONE)
            continue;
        global const bb_node *node = nodes + (sides[c] & BB_INDEX_MASK);
        for (uint axis = 0; axis < 3; axis++) {
            boxes->planes[2u * axis * BB_WIDTH + c] = node->lo[axis];
            boxes->planes[(2u * axis + 1u) * BB_WIDTH + c] = node->hi[axis];
        }
        boxes->places |= 1u << c;
    }
}

/* What writing a node needs; `none`: the record that nothing hits. */
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

/* `own`: what the node of node n takes in, `children` of it. */
void write_node(const node_writer *w, uint own[BB_WIDTH], uint children, global bb_wide *node,
                global uint *sides)
{
    bb_wide_boxes boxes;
    for (uint c = children; c < BB_WIDTH; c++)
        own[c] = BB_NONE;
    gather_boxes(w->nodes, own, &boxes);
    bb_wide_scale_and_pad(&boxes, w->scale);
#if BB_WIDTH == 8
    if (w->octants != 0u) {
        bb_wide_arrange(&boxes, children, own);
        gather_boxes(w->nodes, own, &boxes);
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

/* Nodes that a work-item has found and not written: it asks for all their children's boxes at once,
 * which lie anywhere, and so waits for memory once, not once per node. */
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
        for (uint k = 0; k < BB_DIRECT_WORD; k += 8u) /* words, a cache line each */
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
