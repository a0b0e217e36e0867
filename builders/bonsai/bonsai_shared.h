/* Types and constants that host and device share for bonsai. */
#ifndef BB_BONSAI_SHARED_H
#define BB_BONSAI_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
typedef ushort bn_u16;
#else
#include "kernels/bb_shared.h"
typedef uint16_t bn_u16;
#endif

/* Nodes from this level on, in a mini-tree or in the top tree, are halved by number, so that no
 * input makes a chain.
 */
#define BN_LEVELS 48u

/* Most nodes on a level of that many elements: each has three or more. */
#define BN_SPANS(elements) ((elements) / 3u + 1u)

/* A node over elements begin .. end - 1 of the orders, at least three: of a mini-tree, of the top
 * tree. */
typedef struct bn_mini_span {
    bn_u16 begin, end;
    bb_u32 place;
} bn_mini_span;

typedef struct bn_top_span {
    bb_u32 begin, end;
    bb_u32 place;
} bn_top_span;

/* A split: the number of elements on the left along the axis; 0: no split found. */
typedef struct bn_split {
    float cost;
    bb_u32 left, axis;
} bn_split;

/* A subtree of a mini-tree and leaf of the top tree: box and link of its root, and its first
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
    bb_u32 place; /* number of its node */
    bb_u32 level; /* its node's level in the top tree */
} bn_task;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bn_mini_span) == 8, "bn_mini_span");
BB_STATIC_ASSERT(sizeof(bn_top_span) == 12, "bn_top_span");
BB_STATIC_ASSERT(sizeof(bn_split) == 12, "bn_split");
BB_STATIC_ASSERT(sizeof(bn_item) == 32, "bn_item");
BB_STATIC_ASSERT(sizeof(bn_task) == 16, "bn_task");
#endif

#endif
