/* Wide trees from sorted keys, shared by host and device: wide_tree.cl. */
#ifndef BB_WIDE_TREE_SHARED_H
#define BB_WIDE_TREE_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Most children of a node. */
#define BB_WIDE_ARITY 8
/* Levels of nodes that a work-item's stack has room for: one for each bit of a key and of an
 * index. */
#define BB_WIDE_LEVELS 96

/* Words of scratch per key: a node takes one for each of its children. */
#define BB_WIDE_WORDS 2

/* A node with its box, links and children still to be made: its keys, and its level. */
typedef struct bb_wide_item {
    bb_u32 node;
    bb_u32 begin, end;
    bb_u32 level;
} bb_wide_item;

/* A level of the tree, from its first node on, and its items, which are listed. The node after the
 * last is the first of the next level. */
typedef struct bb_wide_level {
    bb_u32 first, nodes, items;
    bb_u32 pad;
} bb_wide_level;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_wide_item) == 16, "bb_wide_item");
BB_STATIC_ASSERT(sizeof(bb_wide_level) == 16, "bb_wide_level");
#endif

#endif
