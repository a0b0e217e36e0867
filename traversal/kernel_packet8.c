/* The packet8 kernel: kernels/packet.cl on nodes of 8 children. */
#include "traversal/packet.h"

static const bb_option options[] = {BB_PACKET_OPTIONS, {.name = NULL}};

static const bb_variants variants[] = {
    {BB_FOR_CPU, BB_ROLE_COMPARED, "packet8:leaf=8,group=256"},
    {.devices = 0},
};

const bb_kernel bb_kernel_packet8 = {
    .name = "packet8",
    .layout = "wide8",
    .defines = "-DBB_WIDTH=8",
    .options = options,
    .variants = variants,
    BB_PACKET_KERNEL,
};
