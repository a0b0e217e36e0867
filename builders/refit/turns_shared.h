/* What host and device know of a tree when it has been refitted. */
#ifndef BB_TURNS_SHARED_H
#define BB_TURNS_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

typedef struct bb_turn_totals {
    float area;    /* half that of the root's box */
    float cost;    /* Ct times the half areas of inner nodes, Ci times those of references */
    float spread;  /* sum over inner nodes: half area over that of both children */
    bb_u32 turned; /* rotations made */
    bb_u32 roots;  /* of subtrees, for the next pass */
} bb_turn_totals;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_turn_totals) == 20, "bb_turn_totals");
#endif

#endif
