/* The sparse-volume LBVH's own phases (vlbvh.c):
 *
 *   vote: mark brick i if the transfer function is visible anywhere between the brick's smallest
 *         and largest value. These come from its voxels (vote_voxels, vote_voxels_group), or were
 *         computed when the volume was loaded (vote_ranges)
 *   codes: Morton code of each marked brick's position, without its lowest bits if leaves are
 *          larger than a brick
 *   boxes: of each marked brick, in scene units
 *   heads: where one code ends and the next begins
 *
 *   -DBB_VOXEL=uchar|ushort; -DBB_GROUP: work-items of a group that votes on a brick
 */
#include "bb_device.h"
#include "morton.clh"
#include "volume_shared.h"

#ifndef BB_VOXEL
#define BB_VOXEL uchar
#endif
#define BB_JOIN2(a, b) a##b
#define BB_JOIN(a, b) BB_JOIN2(a, b)
typedef BB_JOIN(BB_VOXEL, 16) bb_voxels16;

uint brick_is_seen(uint lo, uint hi, uint white, global const uint *seen)
{
    return seen[bb_transfer_last(hi, white) + 1u] > seen[bb_transfer_first(lo, white)] ? 1u : 0u;
}

/* ---- votes ---- */

/* For CPUs: one work-item per chunk of bricks; voxels are read as vectors. */
kernel void vote_voxels(global const BB_VOXEL *bricks, bb_volume_grid grid, uint count, uint chunk,
                        global const uint *seen, global uint *marks)
{
    const uint voxels = bb_brick_voxels(grid.side);
    uint first = (uint)get_global_id(0) * chunk, end = min(first + chunk, count);
    for (uint brick = first; brick < end; brick++) {
        global const BB_VOXEL *values = bricks + (ulong)brick * voxels;
        bb_voxels16 least = vload16(0, values), most = least;
        /* the last vector overlaps the previous one */
        for (uint i = 16; i < voxels; i += 16) {
            bb_voxels16 v = vload16(0, values + min(i, voxels - 16u));
            least = min(least, v);
            most = max(most, v);
        }
        BB_VOXEL lo[16], hi[16];
        vstore16(least, 0, lo);
        vstore16(most, 0, hi);
        for (uint i = 1; i < 16; i++) {
            lo[0] = min(lo[0], lo[i]);
            hi[0] = max(hi[0], hi[i]);
        }
        marks[brick] = brick_is_seen(lo[0], hi[0], grid.white, seen);
    }
}

/* For GPUs: one work-group per brick; its items join their results in local memory, as in the
 * paper. */
kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void vote_voxels_group(global const BB_VOXEL *bricks, bb_volume_grid grid, uint count,
                       uint chunk, global const uint *seen, global uint *marks)
{
    local uint lo, hi;
    const uint voxels = bb_brick_voxels(grid.side), brick = (uint)get_group_id(0);
    uint least = ~0u, most = 0;
    if (get_local_id(0) == 0) {
        lo = ~0u;
        hi = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    global const BB_VOXEL *values = bricks + (ulong)brick * voxels;
    for (uint i = (uint)get_local_id(0); i < voxels; i += BB_GROUP) {
        uint v = values[i];
        least = min(least, v);
        most = max(most, v);
    }
    atomic_min(&lo, least);
    atomic_max(&hi, most);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0 && brick < count)
        marks[brick] = brick_is_seen(lo, hi, grid.white, seen);
}

kernel void vote_ranges(global const uint *ranges, bb_volume_grid grid, uint count,
                        global const uint *seen, global uint *marks)
{
    uint brick = (uint)get_global_id(0);
    if (brick < count)
        marks[brick] =
            brick_is_seen(ranges[brick] & 0xFFFFu, ranges[brick] >> 16, grid.white, seen);
}

/* ---- visible bricks ---- */

uint4 brick_place(uint brick, const bb_volume_grid *grid)
{
    uint rest = brick / grid->bricks[0];
    return (uint4)(brick - rest * grid->bricks[0], rest % grid->bricks[1], rest / grid->bricks[1],
                   0u);
}

kernel void brick_codes(global const uint *active, bb_volume_grid grid, uint count, uint dropped,
                        global uint *keys, global uint *values)
{
    uint i = (uint)get_global_id(0);
    if (i >= count)
        return;
    keys[i] = bb_morton_30(brick_place(active[i], &grid)) >> dropped;
    values[i] = i;
}

kernel void brick_boxes(global const uint *active, bb_volume_grid grid, uint count,
                        global bb_box *boxes)
{
    uint i = (uint)get_global_id(0);
    if (i >= count)
        return;
    uint4 at = brick_place(active[i], &grid);
    const uint place[3] = {at.x, at.y, at.z};
    bb_box box;
    box.pad0 = box.pad1 = 0;
    for (uint k = 0; k < 3; k++) {
        box.lo[k] = bb_brick_lo(place[k], grid.side, grid.cell[k], grid.margin);
        box.hi[k] = bb_brick_hi(place[k], grid.side, grid.cells[k], grid.cell[k], grid.margin);
    }
    boxes[i] = box;
}

kernel void brick_heads(global const uint *keys, uint count, global uint *marks)
{
    uint i = (uint)get_global_id(0);
    if (i < count)
        marks[i] = i == 0 || keys[i] != keys[i - 1u] ? 1u : 0u;
}

/* Writes the end of the last run. */
kernel void brick_end(global const uint *total, uint count, global uint *starts)
{
    starts[total[0]] = count;
}
