/* Updates boxes of wide nodes in place (kernels/layout_wide_follow.cl). */
#ifndef BB_WIDE_FOLLOW_H
#define BB_WIDE_FOLLOW_H

#include "traversal/pairs.h"

typedef struct bb_wide_follow {
    bb_device *device;
    bb_account *account;
    uint32_t width;
    cl_program program; /* compiled when first needed */
    cl_kernel sources_kernel, nodes_sources, follow;
    bb_buffer sides;   /* u32 per place of a node: a side of a pair, or a node of the tree */
    bb_buffer sources; /* the tree's nodes at these; known after the first bb_wide_follow_boxes() */
    bool known;
} bb_wide_follow;

void bb_wide_follow_release(bb_wide_follow *self);

/* Reserves room for the sides of `node_count` new nodes. Earlier sources are forgotten. */
bb_status bb_wide_follow_reserve(bb_wide_follow *self, uint32_t node_count);

/* Computes new boxes for all nodes. `pairs`: numbering of the tree's pairs, NULL if sides are nodes
 * of the tree (wide_direct.h). `defines`: those that layout_wide.cl was compiled with. */
bb_status bb_wide_follow_boxes(bb_wide_follow *self, const bb_pairs *pairs, const char *defines,
                               const bb_layout_source *source, uint32_t node_count,
                               const bb_buffer *nodes);

#endif
