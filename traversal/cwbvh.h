/* Compressed nodes of the pairs that a wide layout has opened: the host side of
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
    bb_buffer own_nodes, own_prims; /* u32 per pair, and the total: before those of the pair */
    bb_buffer pair_of;              /* u32 per node */
    bb_buffer order;                /* u32 per reference: as the nodes have them */
    uint32_t node_count;            /* of the last making */
} bb_cwbvh_maker;

/* What layout_wide.cl has left: pairs, which of them are opened, and the sides that these take
 * in. */
typedef struct bb_opened {
    const bb_buffer *pairs, *marks, *sides;
    uint32_t pair_count, root;
} bb_opened;

/* Compiles, with the definitions of layout_wide.cl. `primitives` outlives it. To be released also
 * if it fails. */
bb_status bb_cwbvh_create(bb_device *device, bb_account *account, bb_primitives *primitives,
                          const char *defines, bb_cwbvh_maker *maker);
void bb_cwbvh_release(bb_cwbvh_maker *maker); /* of a zeroed object: does nothing */

/* Gives children places and nodes numbers, and puts references in order. Waits for the device. */
bb_status bb_cwbvh_number(bb_cwbvh_maker *maker, const bb_tree *tree, const bb_opened *opened);

/* The order of a tree that is one leaf. */
bb_status bb_cwbvh_order_leaf(bb_cwbvh_maker *maker, const bb_tree *tree);

/* The nodes, and the side of a pair at each place of them, for layouts that follow. */
bb_status bb_cwbvh_nodes(bb_cwbvh_maker *maker, const bb_tree *tree, const bb_opened *opened,
                         const bb_buffer *nodes, const bb_buffer *sides);

#endif
