/* The cwbvh kernel: kernels/cwbvh.cl. */
#include "traversal/traversal.h"

static const bb_variants variants[] = {
    {BB_FOR_GPU, BB_ROLE_COMPARED, "cwbvh:leaf=3"},
    {BB_FOR_ALL, BB_ROLE_SIMULATED, "cwbvh:leaf=3"},
    {BB_FOR_CPU, BB_ROLE_TRIED, "cwbvh:leaf=3"},
    {.devices = 0},
};

const bb_kernel bb_kernel_cwbvh = {
    .name = "cwbvh",
    .summary = "compressed nodes of 8 children, by octant, one entry of the stack per node",
    .paper = "Ylitie, Karras and Laine 2017",
    .layout = "cwbvh",
    .source = "cwbvh.cl",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .control = BB_IF_IF_BY_LEAF,
    .variants = variants,
};
