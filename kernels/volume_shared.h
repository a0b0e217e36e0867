/* Volumes, shared by host and device: the positions of voxels and bricks, and the range of a
 * transfer function that values can reach.
 *
 * A volume is a lattice of values, the voxels; values in between are interpolated. Voxel (0, 0, 0)
 * is at the origin. A cell has eight voxels at its corners. Bricks are cubes of cells; a brick
 * stores all voxels of its cells, including those on its upper faces, which its neighbours also
 * store.
 */
#ifndef BB_VOLUME_SHARED_H
#define BB_VOLUME_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Entries of a transfer function's table, over the values from 0 to the largest. */
#define BB_TRANSFER_STEPS 1024

/* 15 words. */
typedef struct bb_volume_grid {
    float cell[3];     /* sides of a cell, in scene units */
    float per_cell[3]; /* the reciprocals */
    float margin;      /* by which the boxes of bricks are enlarged on each side */
    bb_u32 cells[3];   /* along x, y, z: one less than voxels */
    bb_u32 bricks[3];
    bb_u32 side;  /* cells along a brick: a power of two */
    bb_u32 white; /* largest value that a voxel can have: 255 or 65535 */
} bb_volume_grid;

/* An entry of a transfer function's table. 16 bytes. */
typedef struct bb_transfer_entry {
    float rgb[3];     /* emitted in proportion to absorption, 0 to 1 */
    float extinction; /* per unit of length */
} bb_transfer_entry;

/* Parameters of a march along a ray. */
typedef struct bb_march_args {
    bb_volume_grid grid;
    float step;   /* distance between samples, in scene units */
    float cutoff; /* the march ends when less light from behind than this is left; 0: never */
} bb_march_args;

/* Result of a march: light that reaches the eye, and the share of the light from behind. 16
 * bytes. */
typedef struct bb_light {
    float rgb[3];
    float left;
} bb_light;

/* Returns the number of voxels that a brick stores. */
static inline bb_u32 bb_brick_voxels(bb_u32 side)
{
    return (side + 1) * (side + 1) * (side + 1);
}

/* Return the planes of the box of a brick at `place` along an axis that has `cells` cells. */
static inline float bb_brick_lo(bb_u32 place, bb_u32 side, float cell, float margin)
{
    return (float)(place * side) * cell - margin;
}

static inline float bb_brick_hi(bb_u32 place, bb_u32 side, bb_u32 cells, float cell, float margin)
{
    bb_u32 end = (place + 1) * side;
    return (float)(end < cells ? end : cells) * cell + margin;
}

/* Return the first and the last entry of the table on which values interpolated between `lo` and
 * `hi` may depend: one more at either end than in exact arithmetic, for rounding. */
static inline bb_u32 bb_transfer_first(bb_u32 lo, bb_u32 white)
{
    bb_u32 step = lo * (BB_TRANSFER_STEPS - 1) / white;
    return step > 0 ? step - 1 : 0;
}

static inline bb_u32 bb_transfer_last(bb_u32 hi, bb_u32 white)
{
    bb_u32 step = (hi * (BB_TRANSFER_STEPS - 1) + white - 1) / white + 1;
    return step < BB_TRANSFER_STEPS ? step : BB_TRANSFER_STEPS - 1;
}

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_volume_grid) == 60, "bb_volume_grid");
BB_STATIC_ASSERT(sizeof(bb_transfer_entry) == 16, "bb_transfer_entry");
BB_STATIC_ASSERT(sizeof(bb_march_args) == 68, "bb_march_args");
BB_STATIC_ASSERT(sizeof(bb_light) == 16, "bb_light");
#endif

#endif
