/* The totals of a refit, shared by host and device. */
#ifndef BB_TURNS_SHARED_H
#define BB_TURNS_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

typedef struct bb_turn_totals {
    float area;    /* half area of the root's box */
    float cost;    /* Ct times the half areas of inner nodes plus Ci times those of references */
    float spread;  /* sum over inner nodes: area / (area of both children) */
    bb_u32 turned; /* number of rotations */
    bb_u32 roots;  /* number of roots of subtrees, for the next pass */
} bb_turn_totals;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_turn_totals) == 20, "bb_turn_totals");
#endif

#endif
