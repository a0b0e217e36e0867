/* Wide layouts directly from binary trees (kernels/layout_wide_direct.cl): the CPU form of wide.c,
 * including leaf collapse, for the trees that it accepts. */
#ifndef BB_WIDE_DIRECT_H
#define BB_WIDE_DIRECT_H

#include "framework/device/primitives.h"
#include "traversal/traversal.h"
#include "traversal/wide_follow.h"

typedef struct bb_wide_direct {
    bb_device *device;
    bb_account *account;
    bb_primitives *primitives;
    const char *defines;
    cl_program program, write_program;
    cl_kernel cut, plan, top, open, count, blocks, nodes;
    bb_buffer pieces, results; /* for the cut: bb_direct_piece, bb_direct_done */
    bb_buffer state;           /* bb_direct_state */
    bb_buffer queue;           /* uint2: nodes to open */
    bb_buffer words;           /* uint2 per node of the tree */
    bb_buffer marks;           /* u8 per node */
    bb_buffer bits;            /* u64 per BB_DIRECT_WORD nodes: which become wide nodes */
    bb_buffer before;          /* u32 per word of bits, and the total: wide nodes before it */
    bb_buffer blocks_before;   /* the same: blocks before it */
    bb_buffer firsts;          /* u32 per node: first block of a leaf that collapse made */
    /* of the last layout */
    uint32_t node_count, block_count, root, stack_need;
} bb_wide_direct;

/* Compiles. `primitives` and `defines` (layout_wide.cl's) must outlive it. Must be released even if
 * it fails. */
bb_status bb_wide_direct_create(bb_device *device, bb_account *account, bb_primitives *primitives,
                                const char *defines, bb_wide_direct *direct);
void bb_wide_direct_release(bb_wide_direct *direct); /* a zeroed object is allowed */

/* Returns whether it accepts this tree, which is on the device: binary, one reference per leaf,
 * each primitive once, not too deep; and the device's form is that for CPUs. */
bool bb_wide_direct_takes(const bb_device *device, const bb_tree *tree);

/* Finds the layout's nodes and leaves, and their numbers, with leaves of up to source->leaf
 * references. Waits for the device. */
bb_status bb_wide_direct_number(bb_wide_direct *direct, const bb_layout_source *source);

/* Writes blocks of leaves that collapse made to `blocks`, for a source->leaf above 1. */
bb_status bb_wide_direct_blocks(bb_wide_direct *direct, const bb_layout_source *source,
                                uint32_t format, bb_buffer *blocks, uint64_t *bytes);

/* Writes the wide nodes, and the tree's node at each of their places, for layouts that follow. */
bb_status bb_wide_direct_nodes(bb_wide_direct *direct, const bb_layout_source *source,
                               const bb_buffer *nodes, const bb_buffer *sides);

#endif
