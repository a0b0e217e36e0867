/* A volume is a lattice of values, stored in bricks (kernels/volume_shared.h has the geometry).
 *
 * Zellmann, Hellmann, Lang 2019 (A Linear Time BVH Construction Algorithm for Sparse Volumes),
 * section 3.2: bricks are made once, when a volume is loaded.
 */
#ifndef BB_VOLUME_H
#define BB_VOLUME_H

#include "framework/base/status.h"
#include "framework/scene/transfer.h"
#include "kernels/volume_shared.h"

#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

enum {
    BB_BRICK_SIDE = 8,          /* the default, as in the paper */
    BB_BRICK_SIDE_MAX = 32,     /* sides are powers of two from 4 on */
    BB_BRICKS_ALONG_MAX = 1024, /* the most that 30-bit codes can tell apart */
};

/* Voxels in the order of a file, x fastest. */
typedef struct bb_voxels {
    uint32_t dims[3];  /* along x, y, z, at least 2 */
    double spacing[3]; /* of neighbours in scene units, finite and above 0 */
    uint32_t bytes;    /* per voxel, 1 or 2, in the host's byte order */
    void *values;      /* from bb_host_alloc() */
} bb_voxels;

/* Allocates voxels->values. BB_INVALID or BB_REFUSED, with `name`, if bb_volume_make() would not
 * take these dimensions with bricks of `side` cells. */
bb_status bb_voxels_reserve(const char *name, uint32_t side, bb_voxels *voxels);
void bb_voxels_free(bb_voxels *voxels);

typedef struct bb_volume {
    bb_volume_grid grid;
    uint32_t bytes;       /* per voxel */
    uint32_t brick_count; /* of all bricks, x fastest */
    /* brick after brick, each with bb_brick_voxels(side) values, x fastest; values beyond the
     * lattice repeat its last value */
    void *bricks;
    uint32_t *ranges;     /* per brick: smallest value | largest << 16 */
    uint64_t bricks_hash; /* XXH3 of the bricks */
    uint64_t hash;        /* of bricks, dimensions and spacing */
    bb_transfer transfer;
    /* seen[i]: how many entries before i of the transfer function's table absorb; a range of
     * entries absorbs nothing if seen[] is equal at both of its ends */
    uint32_t seen[BB_TRANSFER_STEPS + 1];
} bb_volume;

/* Makes the bricks on all cores, from `voxels`, which stay the caller's. The volume has no transfer
 * function yet. The caller owns the volume. */
bb_status bb_volume_make(const char *name, const bb_voxels *voxels, uint32_t side, bb_volume **out);
void bb_volume_free(bb_volume *volume); /* NULL is allowed */

/* Mirrors the voxels along all axes and keeps the transfer function. The caller owns the copy. */
bb_status bb_volume_turn(const bb_volume *volume, const char *name, bb_volume **out);

/* Returns the bytes of all bricks. */
uint64_t bb_volume_bytes(const bb_volume *volume);

/* Returns the shortest side of a cell, the width to which a transfer function's ALPHA applies. */
double bb_volume_voxel(const bb_volume *volume);

void bb_volume_set_transfer(bb_volume *volume, const bb_transfer *transfer);

/* Returns whether a brick with values from `lo` to `hi` may be visible. */
static inline int bb_volume_sees(const bb_volume *volume, uint32_t lo, uint32_t hi)
{
    uint32_t white = volume->grid.white;
    return volume->seen[bb_transfer_last(hi, white) + 1] >
           volume->seen[bb_transfer_first(lo, white)];
}

/* Writes the ascending numbers of the visible bricks to `active`, which has room for all bricks.
 * Returns how many there are. */
uint32_t bb_volume_active(const bb_volume *volume, uint32_t *active);

/* Sets the lower and the upper corner of a brick's box, margin included. */
void bb_volume_brick_box(const bb_volume_grid *grid, uint32_t brick, float corners[6]);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
