/* The short8 kernel: kernels/short.cl on nodes of 8 children. */
#include "traversal/short.h"

static const bb_option options[] = {BB_ENTRIES_OPTION("8"), {.name = NULL}};

const bb_kernel bb_kernel_short8 = {
    .name = "short8",
    .summary = "short stack and trail on nodes of 8 children, blocks of 4 primitives",
    .paper = "Vaidyanathan, Woop, Benthin 2019",
    .layout = "wide8",
    .defines = "-DBB_WIDTH=8",
    .options = options,
    BB_SHORT_KERNEL,
};
