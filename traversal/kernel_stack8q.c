/* The stack8q kernel: kernels/stack_wide.cl on quantised nodes of 8 children. */
#include "traversal/stack_wide.h"

static const bb_option options[] = {BB_ORDER_OPTION, {.name = NULL}};

/* The order of octants spares GPUs the sorting; leaves of 4 are a block. */
static const bb_variants variants[] = {
    {BB_FOR_GPU, BB_ROLE_COMPARED, "stack8q:order=octant,leaf=4"},
    {BB_FOR_ALL, BB_ROLE_TRIED, "stack8q:leaf=8"},
    {.devices = 0},
};

const bb_kernel bb_kernel_stack8q = {
    .name = "stack8q",
    .summary = "as stack8, on nodes of half the bytes",
    .paper = "Ylitie, Karras and Laine 2017",
    .layout = "quant8",
    .defines = "-DBB_WIDTH=8 -DBB_QUANTISED=1",
    .options = options,
    .variants = variants,
    BB_STACK_WIDE_KERNEL,
};
