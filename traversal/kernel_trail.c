/* The restart trail: kernels/short.cl without a stack. */
#include "traversal/traversal.h"

const bb_kernel bb_kernel_trail = {
    .name = "trail",
    .summary = "bit trail on pair nodes: no stack, nearer child first, restarts from the root",
    .paper = "Laine 2010",
    .layout = "pair",
    .source = "short.cl",
    .defines = "-DBB_ENTRIES=0",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .compared = NULL, /* the stack's visits, and those of the restarts */
    .stackless = true,
    .trail_max = BB_TRAIL_MAX,
};
