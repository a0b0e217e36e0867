/* The packet kernel: kernels/packet.cl on pair nodes. */
#include "traversal/packet.h"

static const bb_option options[] = {BB_PACKET_OPTIONS, {.name = NULL}};

/* Of the kernels that keep the shape of binary trees, it is the fastest. */
static const bb_variants variants[] = {
    {BB_FOR_CPU, BB_ROLE_COMPARED, "packet:group=256"},
    {BB_FOR_CPU, BB_ROLE_TRIED, "packet:leaf=4,group=256"},
    {.devices = 0},
};

const bb_kernel bb_kernel_packet = {
    .name = "packet",
    .layout = "pair",
    .defines = "-DBB_WIDTH=2",
    .options = options,
    .variants = variants,
    BB_PACKET_KERNEL,
};
