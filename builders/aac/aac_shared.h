/* Types and constants that host and device share for AAC (aac.c, aac.cl). */
#ifndef BB_AAC_SHARED_H
#define BB_AAC_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Words per slot of a work-group's scratch: box, distance, nearest. */
#define AAC_SLOT_WORDS 8

/* A cluster: the box and links that its node will have. Pairs of nodes are numbered by primitives,
 * from 1 on. A cluster of n primitives has used n - 1 of their numbers; the lowest, `id`, is
 * left. */
typedef struct aac_cluster {
    float lo[3];
    bb_u32 first;
    float hi[3];
    bb_u32 id;
} aac_cluster;

/* A node of the radix tree over keys l .. r. For large nodes, split is the last key of the left
 * child. */
typedef struct aac_range {
    bb_u32 l, r, split;
} aac_range;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(aac_cluster) == sizeof(bb_node), "aac_cluster");
BB_STATIC_ASSERT(sizeof(aac_range) == 12, "aac_range");
#endif

#endif
