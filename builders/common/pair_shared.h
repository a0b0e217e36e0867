/* A binary tree as agglomerative builders leave it, shared by host and device (pair_tree.h). */
#ifndef BB_PAIR_SHARED_H
#define BB_PAIR_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Walks that a work-item interleaves on CPUs: each prefetches its next pair while the others go on,
 * so that a cache miss delays only one of them. */
#define BB_PAIR_WALKS 8

/* A cluster: its box, its contents and its number of primitives. */
typedef struct bb_pair_side {
    float lo[3];
    bb_u32 link; /* BB_LEAF_BIT | primitive, or the pair that it was merged from */
    float hi[3];
    bb_u32 count;
} bb_pair_side;

/* Two clusters that were merged. */
typedef struct bb_cluster_pair {
    bb_pair_side side[2];
} bb_cluster_pair;

/* A cluster whose node has a place, but no children yet. */
typedef struct bb_pair_task {
    bb_u32 link;      /* of its pair */
    bb_u32 place;     /* of its node */
    bb_u32 base, end; /* references of its primitives */
    bb_u32 depth;
} bb_pair_task;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_pair_side) == 32, "bb_pair_side");
BB_STATIC_ASSERT(sizeof(bb_cluster_pair) == 64, "bb_cluster_pair");
BB_STATIC_ASSERT(sizeof(bb_pair_task) == 20, "bb_pair_task");
#endif

#endif
