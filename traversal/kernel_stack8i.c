/* The stack8i kernel: kernels/stack_interleaved.cl on nodes of 8 children. */
#include "traversal/stack_wide.h"

static const bb_option options[] = {
    {"rays", "32", "1|4|8|16|32|64", "rays in flight per work-item, which advance in turns"},
    BB_ORDER_OPTION,
    {.name = NULL},
};

/* For CPUs only: a work-item that traces a whole group has at least 26 KB of private memory, and on
 * a GPU each work-item would have a group's work. */
static const bb_variants variants[] = {
    {BB_FOR_CPU, BB_ROLE_COMPARED, "stack8i:leaf=8,group=256"},
    {BB_FOR_CPU, BB_ROLE_TRIED, "stack8i:leaf=4,group=256"},
    {.devices = 0},
};

const bb_kernel bb_kernel_stack8i = {
    .name = "stack8i",
    .summary = "like stack8, with many rays in flight in turns, without branches: for CPUs",
    .paper = "Kocberber, Falsafi and Grot 2015",
    .layout = "wide8",
    .source = "stack_interleaved.cl",
    .defines = "-DBB_WIDTH=8",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .batched = true,
    .options = options,
    .variants = variants,
};
