/* Splits large tasks of the top tree (hlbvh_top.cl) on CPUs: one work-item per chunk and per
 * task. */
#include "bb_device.h"
#include "hlbvh_bins_alone.clh"
#include "hlbvh_divide.clh"

kernel void hl_bin(global const hl_task *tasks, global const hl_chunk *chunks, uint chunk_count,
                   global const hl_item *items, float unit, global hl_bins *found)
{
    uint number = get_global_id(0);
    if (number >= chunk_count)
        return;
    const hl_chunk chunk = chunks[number];
    const hl_task task = tasks[chunk.task];
    hl_grid grid = grid_of(&task, unit);
    hl_bins bins;
    hl_clear(&bins, HL_BINS);
    hl_fill(&bins, &grid, items, chunk.begin, chunk.end);
    found[number] = bins;
}

/* Sums up a task's bins. */
void sum_bins(hl_bins *sum, global const hl_bins *found, uint count)
{
    hl_clear(sum, HL_BINS);
    for (uint chunk = 0; chunk < count; chunk++)
        for (uint axis = 0; axis < 3u; axis++)
            for (uint k = 0; k < HL_BINS; k++)
                hl_add_bin(sum, found + chunk, axis, k);
}

kernel void hl_divide(global const hl_task *tasks, uint task_count, global const hl_bins *found,
                      float unit, global const uint *starts, uint clusters, global bb_node *nodes,
                      global hl_split *splits, global hl_chunk *chunks)
{
    uint number = get_global_id(0);
    if (number >= task_count)
        return;
    const hl_task task = tasks[number];
    hl_grid grid = grid_of(&task, unit);
    hl_bins bins;
    sum_bins(&bins, found + task.first_chunk, task.chunk_count);
    hl_split split;
    hl_find_split(&split, &bins, &grid, unit, task.begin, task.end - task.begin);
    splits[number] = split;
    finish_task(&task, &bins, &grid, &split, found, starts, clusters, nodes, chunks);
}
