/* The stack8q kernel: kernels/stack_wide.cl on quantised nodes of 8 children. */
#include "traversal/traversal.h"

static const bb_option options[] = {
    {"order", "sorted", "sorted|octant", "children by distance, or by the octant of the direction"},
    {.name = NULL},
};

const bb_kernel bb_kernel_stack8q = {
    .name = "stack8q",
    .summary = "as stack8, on nodes of half the bytes",
    .paper = "Ylitie, Karras and Laine 2017",
    .layout = "quant8",
    .source = "stack_wide.cl",
    .defines = "-DBB_WIDTH=8 -DBB_QUANTISED=1",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .options = options,
};
