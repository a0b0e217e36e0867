/* The cwbvh kernel: kernels/cwbvh.cl. */
#include "traversal/traversal.h"

const bb_kernel bb_kernel_cwbvh = {
    .name = "cwbvh",
    .summary = "compressed nodes of 8 children, by octant, one entry of the stack per node",
    .paper = "Ylitie, Karras and Laine 2017",
    .layout = "cwbvh",
    .source = "cwbvh.cl",
    .queries = BB_ALONG_RAYS,
    .ordered = true,
    .tried = "cwbvh:leaf=3",
};
