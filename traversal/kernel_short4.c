/* The short4 kernel: kernels/short.cl on nodes of 4 children. */
#include "traversal/short.h"

static const bb_option options[] = {BB_ENTRIES_OPTION("4"), {.name = NULL}};

const bb_kernel bb_kernel_short4 = {
    .name = "short4",
    .summary = "short stack and trail on nodes of 4 children, blocks of 4 primitives",
    .paper = "Vaidyanathan, Woop, Benthin 2019",
    .layout = "wide4",
    .defines = "-DBB_WIDTH=4",
    .options = options,
    BB_SHORT_KERNEL,
};
