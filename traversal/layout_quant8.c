/* The `quant8` layout: like wide8, with boxes in 8 bits per plane that contain the exact ones. */
#include "traversal/wide.h"

static bb_status create(bb_device *device, bb_account *account, void **self)
{
    return bb_wide_create(device, account, "quant8", 8, BB_WIDE_QUANTISED, self);
}

const bb_layout bb_layout_quant8 = {
    .name = "quant8",
    .summary = "as wide8, boxes in 8 bits per plane: half the bytes",
    .node_bytes = sizeof(bb_quant8),
    BB_WIDE_LAYOUT(8),
};
