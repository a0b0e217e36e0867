/* Pair nodes of a tree, on the device (kernels/layout_pair.cl): the `pair` layout, and the input of
 * the wide layouts. */
#ifndef BB_PAIRS_H
#define BB_PAIRS_H

#include "framework/device/primitives.h"
#include "traversal/traversal.h"

typedef struct bb_pairs {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel extra, nodes, sides, root;
    bb_primitives *primitives;
    bb_buffer base;   /* u32 per node, and the total */
    uint32_t made[2]; /* root and count of the last call */
    bb_buffer found;  /* also stands for the array that a source lacks */
} bb_pairs;

/* Compiles; scratch is booked on `account`. Must be destroyed even after a failure. */
bb_status bb_pairs_create(bb_device *device, bb_account *account, bb_pairs *pairs);
void bb_pairs_destroy(bb_pairs *pairs);

/* Writes the pair nodes (bb_pair) of the source's tree to `nodes`, their number to `count`, and the
 * link to start from, a pair node or the tree's only leaf, to `root`. Leaves are linked as in
 * bb_node. Waits for the device once, unless the links are those of the last call. BB_UNSUPPORTED
 * for nodes of more than 4096 children. */
bb_status bb_pairs_make(bb_pairs *pairs, const bb_layout_source *source, bb_buffer *nodes,
                        uint32_t *count, uint32_t *root);

/* Writes the children that each side of the pair nodes was made of, two uint per side (bb_siblings
 * of kernels/siblings.clh), for the tree of the last bb_pairs_make(). */
bb_status bb_pairs_sides(const bb_pairs *pairs, const bb_tree *tree, bb_buffer *sides);

/* Returns the most entries that the stack of an ordered traversal needs. */
uint32_t bb_pairs_stack_need(const bb_tree_info *info);

/* Returns an upper bound of the levels of pair nodes. */
uint64_t bb_pairs_levels(const bb_tree_info *info);

/* Returns whether the pair nodes are the tree's own: no node has one child or more than two. */
bool bb_pairs_keep_shape(const bb_tree_info *info);

#endif
