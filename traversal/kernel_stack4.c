/* The stack4 kernel: kernels/stack_wide.cl on nodes of 4 children. */
#include "traversal/stack_wide.h"

static const bb_variants variants[] = {
    {BB_FOR_CPU, BB_ROLE_TRIED, "stack4:leaf=4"},
    {.devices = 0},
};

const bb_kernel bb_kernel_stack4 = {
    .name = "stack4",
    .summary = "explicit vectors over 4 children and blocks of 4 primitives, sorted by distance",
    .paper = "Wald, Benthin and Boulos 2008",
    .layout = "wide4",
    .defines = "-DBB_WIDTH=4",
    .variants = variants,
    BB_STACK_WIDE_KERNEL,
};
