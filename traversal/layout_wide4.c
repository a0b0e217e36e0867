/* The `wide4` layout: nodes of up to 4 children with their boxes side by side, and blocks of
 * primitives. */
#include "traversal/wide.h"

static bb_status create(bb_device *device, bb_account *account, void **self)
{
    return bb_wide_create(device, account, "wide4", 4, BB_WIDE_FLOATS, self);
}

const bb_layout bb_layout_wide4 = {
    .name = "wide4",
    .summary = "up to 4 children by surface area, boxes side by side; primitives in blocks of "
               "four, or one by one",
    .node_bytes = sizeof(bb_wide4),
    BB_WIDE_LAYOUT(4),
};
