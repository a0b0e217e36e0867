/* The stack8 kernel: kernels/stack_wide.cl on nodes of 8 children. */
#include "traversal/stack_wide.h"

static const bb_option options[] = {BB_ORDER_OPTION, {.name = NULL}};

static const bb_variants variants[] = {
    {BB_FOR_CPU, BB_ROLE_TRIED, "stack8:leaf=8,stack8:leaf=4"},
    {.devices = 0},
};

const bb_kernel bb_kernel_stack8 = {
    .name = "stack8",
    .summary = "explicit vectors over 8 children and blocks of 4 primitives, in order",
    .paper = "Wald, Benthin and Boulos 2008",
    .layout = "wide8",
    .defines = "-DBB_WIDTH=8",
    .options = options,
    .variants = variants,
    BB_STACK_WIDE_KERNEL,
};
