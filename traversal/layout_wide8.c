/* The `wide8` layout: nodes of up to 8 children with their boxes side by side, and blocks of
 * primitives. */
#include "traversal/wide.h"

static bb_status create(bb_device *device, bb_account *account, void **self)
{
    return bb_wide_create(device, account, "wide8", 8, BB_WIDE_FLOATS, self);
}

const bb_layout bb_layout_wide8 = {
    .name = "wide8",
    .summary = "up to 8 children by surface area, boxes side by side; primitives in blocks of "
               "four, or one by one",
    .node_bytes = sizeof(bb_wide8),
    BB_WIDE_LAYOUT(8),
};
