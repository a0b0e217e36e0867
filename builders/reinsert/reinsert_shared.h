/* Types and constants that host and device share for reinsertion. */
#ifndef BB_REINSERT_SHARED_H
#define BB_REINSERT_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* An inner node, stored as the boxes and links of its two children. Planes of axis k begin at
 * planes[4k]: lo of both children with the sign changed, then their hi, so that unions are maxima.
 * A link is a family, or BB_LEAF_BIT | first reference. `place`: where the node itself is, as 2 *
 * family + side; one more family, the last, is above the root. 64 bytes. */
typedef struct bb_family {
    float planes[12];
    bb_u32 links[2];
    bb_u32 place;
    bb_u32 pad;
} bb_family;

/* A found move: the subtree at place `from` would go beside the node at `to`. `above`: place of its
 * parent before the move. 16 bytes. */
typedef struct bb_move {
    bb_u32 from;
    bb_u32 to; /* BB_NONE: no move */
    bb_u32 above;
    float gain; /* half area saved, in the scene's unit */
} bb_move;

/* Families whose areas one work-item adds up. */
#define BB_COST_CHUNK 512u
/* Half areas are added up as integers, in units of 1 / BB_COST_ONE. */
#define BB_COST_ONE 0x1p40f

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_family) == 64, "bb_family");
BB_STATIC_ASSERT(sizeof(bb_move) == 16, "bb_move");
#endif

#endif
