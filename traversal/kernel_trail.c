/* The restart trail: kernels/short.cl without a stack. It visits the same nodes as the stack, plus
 * those of its restarts. */
#include "traversal/short.h"

const bb_kernel bb_kernel_trail = {
    .name = "trail",
    .summary = "bit trail on pair nodes: no stack, nearer child first, restarts from the root",
    .paper = "Laine 2010",
    .layout = "pair",
    .defines = "-DBB_ENTRIES=0",
    BB_SHORT_KERNEL,
};
