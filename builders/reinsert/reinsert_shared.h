/* What host and device know of a tree while subtrees are reinserted. */
#ifndef BB_REINSERT_SHARED_H
#define BB_REINSERT_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* An inner node, as what it has below it: both children's boxes and links. Planes of axis k, from
 * planes[4k]: lo of both children with the sign changed, then their hi; so unions are maxima alone.
 * A link is a family, or BB_LEAF_BIT | first reference. `place`: where the node itself is, 2 *
 * family + side; what is above the root is one family more, behind all others. 64 bytes. */
typedef struct bb_family {
    float planes[12];
    bb_u32 links[2];
    bb_u32 place;
    bb_u32 pad;
} bb_family;

/* A subtree that was searched for: it is at place `from`, and would go beside what is at `to`.
 * `above`: the place of its parent, before it moves. 16 bytes. */
typedef struct bb_move {
    bb_u32 from;
    bb_u32 to; /* BB_NONE: it stays */
    bb_u32 above;
    float gain; /* half area saved, in units of the scene's */
} bb_move;

/* Families whose areas are added up by one work-item. */
#define BB_COST_CHUNK 512u
/* Half areas are added up as integers, in units of 1 / BB_COST_ONE. */
#define BB_COST_ONE 0x1p40f

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_family) == 64, "bb_family");
BB_STATIC_ASSERT(sizeof(bb_move) == 16, "bb_move");
#endif

#endif
