/* The stackless kernel: kernels/stackless.cl. */
#include "traversal/traversal.h"

/* Not compared by default: for closest hits the stack takes half the time. But this kernel traces
 * any tree as it was built. */
static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_TRIED, "stackless:leaf=4"},
    {.devices = 0},
};

const bb_kernel bb_kernel_stackless = {
    .name = "stackless",
    .summary = "skip pointers: no stack, the tree's own nodes and order",
    .paper = "Smits 1998; Gu, Jendersie, Grosch 2018",
    .layout = "skip",
    .source = "stackless.cl",
    .queries = BB_ALONG_RAYS,
    .ordered = false,
    .control = BB_IF_IF,
    .variants = variants,
    .native = true,
    .stackless = true,
};
