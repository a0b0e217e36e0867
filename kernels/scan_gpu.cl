/* Exclusive prefix sum of u32, form for GPU devices: work-groups co-operate through local memory.
 *
 * Source: reduce-then-scan over blocks, Blelloch, Prefix Sums and Their Applications
 * (CMU-CS-90-190, 1990); Sengupta, Harris, Zhang, Owens, Scan Primitives for GPU Computing
 * (Graphics Hardware 2007).
 *
 *     scan_tiles:  for each tile (one group; in a short scan one group for all tiles, in order):
 *                  load it; each item sums its SCAN_ITEMS neighbours; scan those sums over the
 *                  group; out[tile] = prefix sums inside the group's tiles; sums[group] = their sum
 *     the host:    sums = exclusive prefix sum of sums, by the same kernels, until there is one
 *                  tile
 *     scan_add:    out[i] += sums[tile of i]
 *
 * Limits: BB_GROUP (the local size) is any power of two; in and out may be the same buffer; sums
 * wrap modulo 2^32; no group waits for another.
 */
#include "bb_device.h"
#include "group_scan.clh"

/* Elements of a work-item; the host knows the number too. */
#define SCAN_ITEMS 8
#define TILE (BB_GROUP * SCAN_ITEMS)

/* Launched on one group per `tiles` tiles; the last tile may be shorter. */
__kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void scan_tiles(__global const uint *in,
                __global uint *out,
                const uint count,
                const uint tiles,
                __global uint *sums) /* one per group */
{
    __local uint tile[TILE];
    __local uint item_sums[BB_GROUP];
    const uint item = get_local_id(0);
    uint before = 0; /* sum of the group's earlier tiles */

    for (uint t = 0; t < tiles; t++) {
        const uint base = (get_group_id(0) * tiles + t) * TILE;
        const uint size = min((uint)TILE, count - base);
        for (uint k = item; k < TILE; k += BB_GROUP)
            tile[k] = k < size ? in[base + k] : 0;
        barrier(CLK_LOCAL_MEM_FENCE);

        uint sum = 0;
        for (uint k = 0; k < SCAN_ITEMS; k++)
            sum += tile[item * SCAN_ITEMS + k];
        uint total;
        uint running = before + bb_group_scan(sum, item_sums, &total);
        before += total;
        for (uint k = 0; k < SCAN_ITEMS; k++) {
            const uint value = tile[item * SCAN_ITEMS + k];
            tile[item * SCAN_ITEMS + k] = running;
            running += value;
        }
        barrier(CLK_LOCAL_MEM_FENCE);

        for (uint k = item; k < size; k += BB_GROUP)
            out[base + k] = tile[k];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    if (item == 0)
        sums[get_group_id(0)] = before;
}

/* Launched as scan_tiles, on one group per tile. */
__kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void scan_add(__global uint *out,
              const uint count,
              __global const uint *sums)
{
    const uint base = get_group_id(0) * TILE;
    const uint size = min((uint)TILE, count - base);
    const uint before = sums[get_group_id(0)];
    for (uint k = get_local_id(0); k < size; k += BB_GROUP)
        out[base + k] += before;
}
