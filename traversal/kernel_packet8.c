/* The packet8 kernel: kernels/packet.cl on nodes of 8 children. */
#include "traversal/traversal.h"

static const bb_option options[] = {
    {"rays", "8", "8|16", "rays of a packet"},
    {"few", "2", "0|1|2|3|4|5|6|8", "rays left in a packet that are traced one by one"},
    {"sort", "no", "no|batch", "rays of one octant and main axis in a group go together"},
    {.name = NULL},
};

static const bb_variants variants[] = {
    {.devices = 0},
};

const bb_kernel bb_kernel_packet8 = {
    .name = "packet8",
    .summary = "packets of rays side by side, bounded by intervals: for CPUs",
    .paper = "Wald et al. 2001; Boulos et al. 2006; Benthin et al. 2012",
    .layout = "wide8",
    .source = "packet.cl",
    .defines = "-DBB_WIDTH=8",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .batched = true,
    .options = options,
    .variants = variants,
};
