/* The stackless kernel: kernels/stackless.cl. */
#include "traversal/traversal.h"

const bb_kernel bb_kernel_stackless = {
    .name = "stackless",
    .summary = "skip pointers: no stack, the tree's own nodes and order",
    .paper = "Smits 1998; Gu, Jendersie, Grosch 2018",
    .layout = "skip",
    .source = "stackless.cl",
    .queries = BB_ALONG_RAYS,
    .ordered = false,
    /* closest hits take the stack half the time; but this traces any tree as it was built */
    .compared = NULL,
    .tried = "stackless:leaf=4",
    .native = true,
    .stackless = true,
};
