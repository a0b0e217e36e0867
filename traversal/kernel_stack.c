/* The stack kernel: kernels/stack.cl. */
#include "traversal/traversal.h"

const bb_kernel bb_kernel_stack = {
    .name = "stack",
    .summary = "while-while on pair nodes, one stack per ray, nearer child first",
    .paper = "Aila and Laine 2009",
    .layout = "pair",
    .source = "stack.cl",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .compared = "stack",
    .tried = "stack:leaf=4",
};
