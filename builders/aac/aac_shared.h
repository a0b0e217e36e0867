/* What host and device share of AAC (aac.c, aac.cl). */
#ifndef BB_AAC_SHARED_H
#define BB_AAC_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Words that a slot of a work-group's scratch has: box, distance, nearest. */
#define AAC_SLOT_WORDS 8

/* A cluster: box and links as its node has them. Of all pairs of nodes, which are numbered by the
 * primitives from 1 on, it has used up those of its primitives but the first, `id`. */
typedef struct aac_cluster {
    float lo[3];
    bb_u32 first;
    float hi[3];
    bb_u32 id;
} aac_cluster;

/* Keys l .. r; a node of the radix tree. Of nodes that many work-groups share out: split, the last
 * key of the left child. */
typedef struct aac_range {
    bb_u32 l, r, split;
} aac_range;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(aac_cluster) == sizeof(bb_node), "aac_cluster");
BB_STATIC_ASSERT(sizeof(aac_range) == 12, "aac_range");
#endif

#endif
