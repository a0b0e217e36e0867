/* The wide layouts with the tree's own nodes: each inner node, of up to BB_WIDTH children, becomes
 * one wide node. There is no plan, no collapse of leaves, and no pair nodes.
 *
 *   for each chunk of nodes, in order: counts inner nodes, and blocks of leaves      (native_count)
 *   exclusive scans of both
 *   for each chunk: numbers its nodes, and writes the blocks of its leaves          (native_number)
 *   for each chunk: writes the wide node of each inner node                         (native_nodes)
 *
 * For trees that are as wide as the layout on purpose: it reads each node twice and each primitive
 * once.
 */
#include "bb_device.h"

#include "wide_blocks.clh"
#include "wide_boxes.clh"
#include "wide_gather.clh"

/* Returns the number of references of the leaf that starts at refs[at]. */
uint leaf_size(global const uint *refs, uint at)
{
    uint begin = at;
    while ((refs[at] & BB_LAST_BIT) == 0)
        at++;
    return at + 1u - begin;
}

/* Counts the primitives of each kind in a leaf; returns its number of blocks. */
uint leaf_blocks(global const uint *refs, uint at, const bb_prim_ends *ends,
                 uint counts[BB_KIND_COUNT])
{
    uint size = leaf_size(refs, at);
    for (uint kind = 0; kind < BB_KIND_COUNT; kind++)
        counts[kind] = 0;
    for (uint i = 0; i < size; i++)
        counts[bb_prim_kind(refs[at + i] & BB_INDEX_MASK, ends)]++;
    return bb_blocks_of(counts);
}

/* The last place of both arrays, after all chunks, is for the totals of the scans. single:
 * primitives are records in the order of the references, so leaves have no blocks. */
kernel void native_count(global const bb_node *nodes, uint count, global const uint *refs,
                         bb_prim_ends ends, uint single, uint chunk, uint chunks,
                         global uint *inner, global uint *blocks)
{
    uint c = get_global_id(0), begin = c * chunk, end = BB_MIN(begin + chunk, count);
    if (c > chunks)
        return;
    uint nodes_of = 0, blocks_of = 0, counts[BB_KIND_COUNT];
    for (uint n = begin; n < end; n++) {
        uint first = nodes[n].first;
        if ((first & BB_LEAF_BIT) == 0)
            nodes_of++;
        else if (single == 0u && bb_only_triangles(&ends))
            blocks_of += (leaf_size(refs, first & BB_INDEX_MASK) + BB_BLOCK_LANES - 1u) /
                         BB_BLOCK_LANES;
        else if (single == 0u)
            blocks_of += leaf_blocks(refs, first & BB_INDEX_MASK, &ends, counts);
    }
    inner[c] = nodes_of;
    blocks[c] = blocks_of;
}

/* Writes the blocks of a leaf from block `at` on; returns the block after them. */
uint write_leaf(const bb_block_writer *writer, global const uint *refs, uint ref, uint ref_count,
                uint at)
{
    uint next[BB_KIND_COUNT], end = at + leaf_blocks(refs, ref, &writer->ends, next);
    bool last = false;
    bb_blocks_begin(writer, at, next);
    for (; !last; ref++) {
        last = (refs[ref] & BB_LAST_BIT) != 0;
        bb_ask_ahead(refs, ref, ref_count, writer->data, writer->vertices, &writer->ends);
        bb_blocks_put(writer, refs[ref] & BB_INDEX_MASK, next);
    }
    return end;
}

/* The same for scenes of triangles only, as vertices. */
uint write_triangles(const bb_block_writer *writer, global const uint *refs, uint ref,
                     uint ref_count, uint at)
{
    for (bool last = false; !last; at++) {
        uint prims[BB_BLOCK_LANES], count = 0;
        while (!last && count < BB_BLOCK_LANES) {
            last = (refs[ref] & BB_LAST_BIT) != 0;
            bb_ask_ahead_triangles(refs, ref, ref_count, writer->data, writer->vertices);
            prims[count++] = refs[ref++] & BB_INDEX_MASK;
        }
        bb_blocks_of_triangles(writer, at, prims, count);
    }
    return at;
}

/* inner[], first_blocks[]: the scans. links[n]: the link to node n in the layout. */
kernel void native_number(global const bb_node *nodes, uint count, global const uint *refs,
                          uint ref_count, global const float *vertices, global const uint *data,
                          bb_prim_ends ends, float scale, uint format, uint block_words,
                          uint fresh, uint single, uint chunk, global const uint *inner,
                          global const uint *first_blocks, global uint *links,
                          global uint *blocks)
{
    const bb_block_writer writer = {vertices, data,        ends,  scale,
                                    format,   block_words, fresh, blocks};
    uint c = get_global_id(0), begin = c * chunk, end = BB_MIN(begin + chunk, count);
    if (begin >= count)
        return;
    uint number = inner[c], block = first_blocks[c];
    const bool triangles = format == BB_FORMAT_VERTICES && bb_only_triangles(&ends) &&
                           block_words == BB_TRIANGLE_BLOCK_WORDS;
    for (uint n = begin; n < end; n++) {
        uint first = nodes[n].first, ref = first & BB_INDEX_MASK;
        if ((first & BB_LEAF_BIT) == 0) {
            links[n] = number++;
            continue;
        }
        links[n] = single != 0u ? first : BB_LEAF_BIT | block;
        if (single != 0u)
            continue;
        block = triangles ? write_triangles(&writer, refs, ref, ref_count, block)
                          : write_leaf(&writer, refs, ref, ref_count, block);
        bb_blocks_end(&writer, block);
    }
    if (end == count && single == 0u) /* the target of links at places without a child */
        bb_block_empty(&writer, block, BB_KIND_COUNT);
}

/* Lists the children of a node; returns their number. */
uint children_of(global const bb_node *nodes, uint n, uint own[BB_WIDTH])
{
    uint children = 0;
    for (uint child = nodes[n].first, end = nodes[n].skip; child != end;
         child = nodes[child].skip)
        own[children++] = child;
    for (uint c = children; c < BB_WIDTH; c++)
        own[c] = BB_NONE;
    return children;
}

/* none: the record that nothing hits. sides: the tree's node at each place of each wide node, for
 * layouts that follow. */
kernel void native_nodes(global const bb_node *nodes, uint count, uint chunk,
                         global const uint *inner, global const uint *links, float scale,
                         uint none, uint octants, global bb_wide *wide, global uint *sides)
{
    uint c = get_global_id(0), begin = c * chunk, end = BB_MIN(begin + chunk, count);
    if (begin >= count)
        return;
    uint at = inner[c];
    for (uint n = begin; n < end; n++) {
        if ((nodes[n].first & BB_LEAF_BIT) != 0)
            continue;
        uint own[BB_WIDTH], children = children_of(nodes, n, own);
        bb_wide_boxes boxes;
        bb_gather_boxes(nodes, own, &boxes);
        bb_wide_scale_and_pad(&boxes, scale);
#if BB_WIDTH == 8
        if (octants != 0u) {
            bb_wide_arrange(&boxes, children, own);
            bb_gather_boxes(nodes, own, &boxes);
            bb_wide_scale_and_pad(&boxes, scale);
        }
#endif
        global bb_wide *node = wide + at;
        bb_wide_write(&boxes, node);
        for (uint k = 0; k < BB_WIDTH; k++) {
            node->links[k] = own[k] == BB_NONE ? BB_LEAF_BIT | none : links[own[k]];
            sides[(ulong)at * BB_WIDTH + k] = own[k];
        }
        node->count = children;
        for (uint p = 0; p < sizeof(node->pad) / sizeof(uint); p++)
            node->pad[p] = 0;
        at++;
    }
}
