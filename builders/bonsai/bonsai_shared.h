/* What host and device share of bonsai. */
#ifndef BB_BONSAI_SHARED_H
#define BB_BONSAI_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Nodes this deep in a mini-tree, or in the top tree, are halved by number: no input makes a chain.
 */
#define BN_LEVELS 48u

/* A subtree of a mini-tree, a leaf of the top tree: the box and the link of its root, and its first
 * reference. It ends where the next one begins. */
typedef struct bn_item {
    float lo[3];
    bb_u32 first; /* as in bb_node */
    float hi[3];
    bb_u32 begin;
} bn_item;

/* A node that the top tree's first launch leaves to the second: items begin .. end - 1 of the top
 * tree's order. */
typedef struct bn_task {
    bb_u32 begin, end;
    bb_u32 place; /* of its node */
    bb_u32 level; /* of its node in the top tree */
} bn_task;

#endif
