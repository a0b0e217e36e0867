/* Splits large tasks of the top tree (hlbvh_top.cl) on GPUs: one work-group per chunk and per task,
 * with the bins in local memory.
 *
 *   hl_bin: for each tile of items: each work-item finds the bins of one item, then adds to its
 *           own bins what the tile has for them
 *   hl_divide: each work-item sums up its own bins; three find the best plane of an axis each; the
 *              first continues as on CPUs
 *
 * Each bin adds its items, and each task its chunks, in order and without atomics, so the tree
 * equals that of the form for CPUs, bit for bit.
 */
#include "bb_device.h"
#define HL_SPACE local
#include "hlbvh_divide.clh"

/* A work-item's own bins: every HL_GROUP-th of those of all axes. */
#define HL_OWN_BINS(b) uint b = (uint)get_local_id(0); b < 3u * HL_BINS; b += HL_GROUP

void clear_own(local hl_bins *bins)
{
    for (HL_OWN_BINS(b))
        hl_clear_bin(bins, b / HL_BINS, b % HL_BINS);
}

kernel __attribute__((reqd_work_group_size(HL_GROUP, 1, 1)))
void hl_bin(global const hl_task *tasks, global const hl_chunk *chunks, uint chunk_count,
                   global const hl_item *items, float unit, global hl_bins *found)
{
    local hl_bins bins;
    local hl_box boxes[HL_GROUP];
    local int4 places[HL_GROUP];
    local uint weights[HL_GROUP];
    const uint me = (uint)get_local_id(0);
    const hl_chunk chunk = chunks[get_group_id(0)];
    const hl_task task = tasks[chunk.task];
    hl_grid grid = grid_of(&task, unit);
    clear_own(&bins);
    for (uint begin = chunk.begin; begin < chunk.end; begin += HL_GROUP) {
        uint count = BB_MIN(chunk.end - begin, (uint)HL_GROUP);
        if (me < count) {
            hl_box box;
            hl_load(&box, items + begin + me);
            boxes[me] = box;
            places[me] = hl_bin_of(&grid, hl_centroid(&box, grid.half_unit));
            weights[me] = items[begin + me].weight;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        for (HL_OWN_BINS(b))
            for (uint i = 0; i < count; i++)
                if ((uint)hl_lane(places[i], b / HL_BINS) == b % HL_BINS) {
                    hl_box box = boxes[i];
                    hl_add(&bins, b / HL_BINS, b % HL_BINS, &box, weights[i]);
                }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    global hl_bins *out = found + get_group_id(0);
    for (HL_OWN_BINS(b)) {
        uint axis = b / HL_BINS, k = b % HL_BINS;
        out->lo[axis][k] = bins.lo[axis][k];
        out->hi[axis][k] = bins.hi[axis][k];
        out->count[axis][k] = bins.count[axis][k];
#ifdef HL_BY_PRIMS
        out->weight[axis][k] = bins.weight[axis][k];
#endif
    }
}

kernel __attribute__((reqd_work_group_size(HL_GROUP, 1, 1)))
void hl_divide(global const hl_task *tasks, uint task_count, global const hl_bins *found,
                      float unit, global const uint *starts, uint clusters, global bb_node *nodes,
                      global hl_split *splits, global hl_chunk *chunks)
{
    local hl_bins bins;
    local float right_costs[3][HL_BINS];
    local hl_best bests[3];
    const uint me = (uint)get_local_id(0), number = (uint)get_group_id(0);
    const hl_task task = tasks[number];
    const uint count = task.end - task.begin;
    hl_grid grid = grid_of(&task, unit);
    clear_own(&bins);
    for (uint c = 0; c < task.chunk_count; c++)
        for (HL_OWN_BINS(b))
            hl_add_bin(&bins, found + task.first_chunk + c, b / HL_BINS, b % HL_BINS);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (me < 3u) {
        hl_best best = HL_NO_BEST;
        float scale = me == 0 ? grid.scale.x : me == 1u ? grid.scale.y : grid.scale.z;
        if (scale > 0.0f)
            hl_try_axis(&bins, me, grid.bins, count, unit, right_costs[me], &best);
        bests[me] = best;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (me != 0)
        return;
    hl_best best = HL_NO_BEST;
    for (uint axis = 0; axis < 3u; axis++) {
        hl_best other = bests[axis];
        hl_take_better(&best, &other, count);
    }
    hl_split split;
    hl_split_at(&split, &best, task.begin, count);
    splits[number] = split;
    finish_task(&task, &bins, &grid, &split, found, starts, clusters, nodes, chunks);
}
