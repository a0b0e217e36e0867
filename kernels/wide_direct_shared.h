/* Wide layouts made directly from binary trees, shared by host and device:
 * layout_wide_direct.cl. */
#ifndef BB_WIDE_DIRECT_SHARED_H
#define BB_WIDE_DIRECT_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Levels of nodes that a work-item's stack has room for. */
#define BB_DIRECT_DEPTH 128
/* Most pieces that a tree is cut into. */
#define BB_DIRECT_PIECES 1024
/* Nodes that share a word of marks. */
#define BB_DIRECT_WORD 64
/* Nodes that one work-item numbers and writes. */
#define BB_DIRECT_CHUNK 2048

/* A piece of the cut: a node, the number of references below it if they are in the order of the
 * tree, and the first of its two children among the pieces; BB_NONE: it is a subtree. */
typedef struct bb_direct_piece {
    bb_u32 node;
    bb_u32 begin, end;
    bb_u32 child;
} bb_direct_piece;

/* The planned result for a subtree. */
typedef struct bb_direct_done {
    float costs[8]; /* of its plan */
    float cost;     /* of its collapse */
    bb_u32 begin, refs;
    bb_u32 leaf; /* 1: it is a leaf */
} bb_direct_done;

/* Results for the host. */
typedef struct bb_direct_state {
    bb_u32 pieces;
    bb_u32 queued; /* nodes to open */
    bb_u32 root_is_leaf;
    bb_u32 stack_need;
} bb_direct_state;

#ifndef __OPENCL_VERSION__
_Static_assert(sizeof(bb_direct_piece) == 16, "bb_direct_piece");
_Static_assert(sizeof(bb_direct_done) == 48, "bb_direct_done");
_Static_assert(sizeof(bb_direct_state) == 16, "bb_direct_state");
#endif

#endif
