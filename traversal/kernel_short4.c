/* The short4 kernel: kernels/short.cl on nodes of 4 children. */
#include "traversal/traversal.h"

static const bb_option options[] = {
    {"entries", "4", "1|2|4|8|16",
     "entries of the stack; what it drops is found again by the trail"},
    {.name = NULL},
};

const bb_kernel bb_kernel_short4 = {
    .name = "short4",
    .summary = "short stack and trail on nodes of 4 children, blocks of 4 primitives",
    .paper = "Vaidyanathan, Woop, Benthin 2019",
    .layout = "wide4",
    .source = "short.cl",
    .defines = "-DBB_WIDTH=4",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .compared = NULL, /* where memory for a full stack is no matter, that is faster */
    .stackless = true,
    .trail_max = BB_TRAIL_MAX,
    .options = options,
};
