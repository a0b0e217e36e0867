/* Compressed nodes made from the pairs that a wide layout has opened: host side of
 * kernels/layout_cwbvh.cl. */
#ifndef BB_CWBVH_H
#define BB_CWBVH_H

#include "framework/device/primitives.h"
#include "traversal/traversal.h"

typedef struct bb_cwbvh_maker {
    bb_device *device;
    bb_account *account;
    bb_primitives *primitives;
    cl_program program;
    cl_kernel count, place, nodes;
    bb_buffer own_nodes, own_prims; /* u32 per pair, and the total: number before those of the
                                     * pair */
    bb_buffer pair_of;              /* u32 per node */
    bb_buffer order;                /* u32 per reference, in the order of the nodes */
    uint32_t node_count;            /* of the last layout */
} bb_cwbvh_maker;

/* The output of layout_wide.cl: pairs, which of them are opened, and the sides that these
 * absorb. */
typedef struct bb_opened {
    const bb_buffer *pairs, *marks, *sides;
    uint32_t pair_count, root;
} bb_opened;

/* Compiles with the definitions of layout_wide.cl. `primitives` must outlive the maker. Must be
 * released even if it fails. */
bb_status bb_cwbvh_create(bb_device *device, bb_account *account, bb_primitives *primitives,
                          const char *defines, bb_cwbvh_maker *maker);
void bb_cwbvh_release(bb_cwbvh_maker *maker); /* a zeroed maker is allowed */

/* Assigns places to children and numbers to nodes, and orders references. Waits for the device. */
bb_status bb_cwbvh_number(bb_cwbvh_maker *maker, const bb_tree *tree, const bb_opened *opened);

/* Orders the references of a tree that is a single leaf. */
bb_status bb_cwbvh_order_leaf(bb_cwbvh_maker *maker, const bb_tree *tree);

/* Writes the nodes, and the side of a pair at each of their places, for layouts that follow. */
bb_status bb_cwbvh_nodes(bb_cwbvh_maker *maker, const bb_tree *tree, const bb_opened *opened,
                         const bb_buffer *nodes, const bb_buffer *sides);

#endif
