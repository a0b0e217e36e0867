/* The `cwbvh` layout: compressed nodes of 8 children, placed by octant, and single primitives
 * (kernels/layout_cwbvh.cl). */
#include "traversal/wide.h"

static bb_status create(bb_device *device, bb_account *account, void **self)
{
    return bb_wide_create(device, account, "cwbvh", 8, BB_WIDE_COMPRESSED, self);
}

const bb_layout bb_layout_cwbvh = {
    .name = "cwbvh",
    .summary = "up to 8 children in 80 bytes, by octant; primitives one by one, up to 3 of a leaf",
    .node_bytes = sizeof(bb_cwbvh),
    .width = 8,
    .block = 1,
    .leaf_max = BB_CWBVH_LEAF_MAX,
    .create = create,
    .make = bb_wide_make,
    .destroy = bb_wide_destroy,
};
