/* A grid of 2^bits cells along each axis of a box. Structs that host and device share. */
#ifndef BB_CELL_GRID_SHARED_H
#define BB_CELL_GRID_SHARED_H

#include "bb_shared.h"

#define BB_CELL_BITS_MAX 10 /* codes of three times as many bits fit into 32 */

typedef struct bb_cell_grid {
    float lo[3];
    bb_u32 bits;
    float hi[3];
    bb_u32 cells;  /* 2^bits */
    float step[3]; /* 0 of an axis that is flat, or as good as */
    bb_u32 pad;
} bb_cell_grid;

/* What a node of an octree of cells says of itself, in the tree's side array "cells". Children of a
 * node lie one after the other, by ascending octant. */
#define BB_CELL_OCTANT 7u   /* its place among the eight of its parent: x highest */
#define BB_CELL_BOUNDARY 8u /* a primitive of the boundary is listed below it */

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_cell_grid) == 48, "bb_cell_grid");
#endif

#endif
