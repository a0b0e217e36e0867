/* The stack kernel: kernels/stack.cl. */
#include "traversal/traversal.h"

/* The persistent form is Aila and Laine's; on CPUs the driver distributes work as well, and
 * simulations do not tell it from the other form. On CPUs, kernels that use the lanes of vectors
 * are compared: by one ray at a time, none is near them. */
static const bb_variants variants[] = {
    {BB_FOR_GPU, BB_ROLE_COMPARED, "stack,stack:persistent=yes"},
    {BB_FOR_ALL, BB_ROLE_SIMULATED, "stack"},
    {BB_FOR_CPU, BB_ROLE_TRIED, "stack"},
    {BB_FOR_ALL, BB_ROLE_TRIED, "stack:leaf=4"},
    {.devices = 0},
};

const bb_kernel bb_kernel_stack = {
    .name = "stack",
    .summary = "while-while on pair nodes, one stack per ray, nearer child first",
    .paper = "Aila and Laine 2009",
    .layout = "pair",
    .source = "stack.cl",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .control = BB_WHILE_WHILE,
    .variants = variants,
};
