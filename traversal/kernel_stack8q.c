/* The stack8q kernel: kernels/stack_wide.cl on quantised nodes of 8 children. */
#include "traversal/stack_wide.h"

static const bb_option options[] = {BB_ORDER_OPTION, {.name = NULL}};

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_TRIED, "stack8q:leaf=8"},
    {.devices = 0},
};

const bb_kernel bb_kernel_stack8q = {
    .name = "stack8q",
    .summary = "8-bit 8-wide: like stack8, on nodes of half the bytes",
    .paper = "Wald, Benthin and Boulos 2008",
    .layout = "quant8",
    .defines = "-DBB_WIDTH=8 -DBB_QUANTISED=1",
    .options = options,
    .variants = variants,
    BB_STACK_WIDE_KERNEL,
};
