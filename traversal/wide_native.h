/* Wide layouts with the tree's own nodes (kernels/layout_wide_native.cl): plan=native of wide.c. */
#ifndef BB_WIDE_NATIVE_H
#define BB_WIDE_NATIVE_H

#include "framework/device/primitives.h"
#include "traversal/traversal.h"

typedef struct bb_wide_native {
    bb_device *device;
    bb_account *account;
    bb_primitives *primitives;
    const char *defines;
    cl_program program; /* compiled when first needed */
    cl_kernel count, number, nodes;
    bb_buffer inner, first_blocks; /* u32 per chunk, and the total: what comes before it */
    bb_buffer links;               /* u32 per node of the tree: the link to it */
    /* of the last layout; root: the link to start from */
    uint32_t node_count, block_count, root;
} bb_wide_native;

void bb_wide_native_release(bb_wide_native *native); /* a zeroed object is allowed */

/* Numbers the tree's nodes, and writes the blocks of its leaves to `blocks`. `single`: primitives
 * are records in the order of the references, and no blocks are written. Waits for the device,
 * unless source->same_links. BB_UNSUPPORTED for nodes of more than `width` children. */
bb_status bb_wide_native_number(bb_wide_native *native, const bb_layout_source *source,
                                uint32_t width, bool single, uint32_t format, bb_buffer *blocks,
                                uint64_t *bytes);

/* Writes the wide nodes, and the tree's node at each of their places, for layouts that follow. */
bb_status bb_wide_native_nodes(bb_wide_native *native, const bb_layout_source *source, bool single,
                               const bb_buffer *nodes, const bb_buffer *sides);

#endif
