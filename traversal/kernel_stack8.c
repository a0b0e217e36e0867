/* The stack8 kernel: kernels/stack_wide.cl on nodes of 8 children. */
#include "traversal/traversal.h"

static const bb_option options[] = {
    {"order", "sorted", "sorted|octant", "children by distance, or by the octant of the direction"},
    {.name = NULL},
};

const bb_kernel bb_kernel_stack8 = {
    .name = "stack8",
    .summary = "explicit vectors over 8 children and blocks of 4 primitives, in order",
    .paper = "Wald, Benthin and Boulos 2008",
    .layout = "wide8",
    .source = "stack_wide.cl",
    .defines = "-DBB_WIDTH=8",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .options = options,
    .compared = "stack8:leaf=8",
};
