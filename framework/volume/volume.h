/* A volume: a lattice of values, kept in bricks (kernels/volume_shared.h has the geometry).
 *
 * Zellmann, Hellmann, Lang 2019 (A Linear Time BVH Construction Algorithm for Sparse Volumes),
 * section 3.2: bricks are made once, when a volume is loaded.
 */
#ifndef BB_VOLUME_H
#define BB_VOLUME_H

#include "framework/base/status.h"
#include "framework/volume/transfer.h"
#include "kernels/volume_shared.h"

#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

enum {
    BB_BRICK_SIDE = 8,          /* of the paper; the default */
    BB_BRICK_SIDE_MAX = 32,     /* a power of two from 4 on */
    BB_BRICKS_ALONG_MAX = 1024, /* 30-bit codes tell them apart */
};

/* Voxels as a file has them, x fastest. */
typedef struct bb_voxels {
    uint32_t dims[3];  /* along x, y, z; 2 at least */
    double spacing[3]; /* of neighbours, in scene units; finite, above 0 */
    uint32_t bytes;    /* of a voxel: 1 or 2, in the byte order of the host */
    void *values;      /* from bb_host_alloc() */
} bb_voxels;

/* Room for the values; sets voxels->values. BB_INVALID or BB_REFUSED, with `name`, for dimensions
 * that no volume has or that bb_volume_make() would not take, with bricks of `side` cells. */
bb_status bb_voxels_reserve(const char *name, uint32_t side, bb_voxels *voxels);
void bb_voxels_free(bb_voxels *voxels);

typedef struct bb_volume {
    bb_volume_grid grid;
    uint32_t bytes;       /* of a voxel */
    uint32_t brick_count; /* all of them, x fastest */
    /* brick after brick, each of bb_brick_voxels(side) values, x fastest; what lies beyond the
     * lattice repeats its last value */
    void *bricks;
    uint32_t *ranges;     /* of each brick: smallest value | largest << 16 */
    uint64_t bricks_hash; /* XXH3 of the bricks */
    uint64_t hash;        /* of dimensions and spacing, too */
    bb_transfer transfer;
    /* seen[i]: how many entries of the transfer function's table before i absorb; so a range of
     * them absorbs nowhere if seen[] is the same on both of its sides */
    uint32_t seen[BB_TRANSFER_STEPS + 1];
} bb_volume;

/* Makes the bricks, on all cores. Frees nothing of `voxels`. The volume has no transfer function
 * yet. Owned by the caller. */
bb_status bb_volume_make(const char *name, const bb_voxels *voxels, uint32_t side, bb_volume **out);
void bb_volume_free(bb_volume *volume); /* NULL is allowed */

/* The same voxels, the last first along all axes, with the same transfer function. Owned by the
 * caller. */
bb_status bb_volume_turn(const bb_volume *volume, const char *name, bb_volume **out);

/* Bytes of the bricks. */
uint64_t bb_volume_bytes(const bb_volume *volume);

/* The shortest side of a cell: the width that a transfer function's ALPHA is for. */
double bb_volume_voxel(const bb_volume *volume);

void bb_volume_set_transfer(bb_volume *volume, const bb_transfer *transfer);

/* Whether anything in a brick of values from `lo` to `hi` is seen. */
static inline int bb_volume_sees(const bb_volume *volume, uint32_t lo, uint32_t hi)
{
    uint32_t white = volume->grid.white;
    return volume->seen[bb_transfer_last(hi, white) + 1] >
           volume->seen[bb_transfer_first(lo, white)];
}

/* Writes the numbers of the bricks in which something is seen to `active`, which has room for all,
 * in order; their number. */
uint32_t bb_volume_active(const bb_volume *volume, uint32_t *active);

/* Lower and upper corner of a brick's box, with its margin. */
void bb_volume_brick_box(const bb_volume_grid *grid, uint32_t brick, float corners[6]);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
