/* What host and device know of a subtree when it is refitted. */
#ifndef BB_TURNS_SHARED_H
#define BB_TURNS_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Of a subtree; of the whole tree that of the root. */
typedef struct bb_turn_state {
    float cost;    /* Ct times the half areas of its inner nodes, Ci times those of references */
    float spread;  /* sum over its inner nodes: half area over that of both children */
    bb_u32 height; /* inner nodes on the longest way down */
    bb_u32 turned; /* rotations made in it */
} bb_turn_state;

#endif
