/* A grid of 2^bits cells along each axis of a box, shared by host and device. */
#ifndef BB_CELL_GRID_SHARED_H
#define BB_CELL_GRID_SHARED_H

#include "bb_shared.h"

#define BB_CELL_BITS_MAX 10 /* Morton codes with three times as many bits fit into 32 */

typedef struct bb_cell_grid {
    float lo[3];
    bb_u32 bits;
    float hi[3];
    bb_u32 cells;  /* 2^bits */
    float step[3]; /* 0 for a flat, or nearly flat, axis */
    bb_u32 pad;
} bb_cell_grid;

/* A node of an octree of cells, in the tree's side array "cells": its octant in its parent, of
 * which x is the highest bit, and in the other bits how many references to primitives of the
 * boundary are below it, at most BB_CELL_MARKED_MAX. A leaf lists them before all others. Children
 * of a node are adjacent, by ascending octant. */
#define BB_CELL_OCTANT 7u
#define BB_CELL_MARKED_SHIFT 3u
#define BB_CELL_MARKED_MAX 0x1FFFFFFFu

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_cell_grid) == 48, "bb_cell_grid");
#endif

#endif
