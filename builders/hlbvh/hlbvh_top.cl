/* The top tree of HLBVH, over clusters, by binned SAH: Garanzha, Pantaleoni, McAllister 2011
 * ("Simpler and Faster HLBVH with Work Queues"; see hlbvh.c).
 *
 * A task is a range of clusters and the node that will be their root. Large tasks are split by many
 * work-items, all tasks of a level at once, from one list of clusters to the other:
 *   each chunk: bins                                                                     (hl_bin)
 *   each task: adds its chunks' bins up, finds the split, places its chunks' items    (hl_divide)
 *   each chunk: moves its items, in order; boxes of the centroids on both sides         (hl_move)
 *   each task: adds these boxes up for its halves, the tasks of the next level      (hl_children)
 * Small tasks, and the small ones that large tasks end in, are split down to single clusters by one
 * work-item each (hl_subtree). hl_bin and hl_divide are in hlbvh_divide.cl for CPUs and in
 * hlbvh_divide_gpu.cl. Both kinds split alike, so the tree does not depend on what counts as small.
 *
 * Node numbers follow from positions. In the final order of clusters there is exactly one split
 * before each position but the first. It gets the two nodes that the radix tree has for the border
 * before the cluster of the same number in the old order. Hence, as in radix_tree.cl, the skip of a
 * node whose items end before position e is the right child of the split at e. Nodes inside
 * clusters stay in place; only skips along a cluster's right side change.
 */
#include "bb_device.h"
#include "hlbvh_bins_alone.clh"
#include "hlbvh_top.clh"

#define HL_STACK 33 /* the larger half waits, so log2 of the clusters is the most */

/* ---- nodes ---- */

void write_cluster(global bb_node *nodes, uint place, global const hl_item *item,
                   global const hl_root *roots, uint skip)
{
    hl_box box;
    hl_load(&box, item);
    uint first = roots[item->cluster].first;
    bb_write_node(nodes, place, box.lo, box.hi, first, skip);
    while ((first & BB_LEAF_BIT) == 0) {
        nodes[first + 1u].skip = skip;
        first = nodes[first + 1u].first;
    }
}

/* ---- small tasks ---- */

typedef struct hl_range {
    uint begin, end, place, depth;
    float4 lo, hi; /* box of the centroids */
} hl_range;

/* Moves items for the left side to the front and the others behind them, both in order. */
void divide_range(global hl_item *items, global hl_item *spare, const hl_range *range,
                  const hl_grid *grid, const hl_split *split, hl_range *left, hl_range *right)
{
    hl_box low_side = hl_no_box(), high_side = hl_no_box();
    uint next = range->begin, kept = 0;
    for (uint i = range->begin; i < range->end; i++) {
        uint4 lo = vload4(0, (global const uint *)(items + i));
        uint4 hi = vload4(1, (global const uint *)(items + i));
        hl_box box;
        hl_load(&box, items + i);
        float4 centroid = hl_centroid(&box, grid->half_unit);
        if (hl_goes_left(split, hl_bin_of(grid, centroid), i)) {
            hl_join(&low_side, centroid, centroid);
            vstore4(lo, 0, (global uint *)(items + next));
            vstore4(hi, 1, (global uint *)(items + next));
            next++;
        } else {
            hl_join(&high_side, centroid, centroid);
            vstore4(lo, 0, (global uint *)(spare + range->begin + kept));
            vstore4(hi, 1, (global uint *)(spare + range->begin + kept));
            kept++;
        }
    }
    for (uint i = 0; i < kept; i++) {
        vstore8(vload8(0, (global const uint *)(spare + range->begin + i)), 0,
                (global uint *)(items + next + i));
    }
    left->begin = range->begin;
    left->end = right->begin = next;
    right->end = range->end;
    left->lo = low_side.lo;
    left->hi = low_side.hi;
    right->lo = high_side.lo;
    right->hi = high_side.hi;
}

/* Makes the node of a range and splits the range. */
void split_range(global hl_item *items, global hl_item *spare, const hl_range *range, float unit,
                 global const uint *starts, uint clusters, global bb_node *nodes, hl_range *left,
                 hl_range *right)
{
    uint count = range->end - range->begin;
    hl_box box;
    if (count == 2u) {
        hl_load(&box, items + range->begin);
        hl_box other;
        hl_load(&other, items + range->begin + 1u);
        hl_join(&box, other.lo, other.hi);
        left->begin = range->begin;
        left->end = right->begin = range->begin + 1u;
        right->end = range->end;
    } else {
        hl_bins bins;
        hl_grid grid = hl_make_grid(range->lo, range->hi, unit, count);
        hl_clear(&bins, grid.bins);
        hl_fill(&bins, &grid, items, range->begin, range->end);
        box = box_of_bins(&bins, grid.bins);
        hl_split split;
        hl_find_split(&split, &bins, &grid, unit, range->begin, count);
        divide_range(items, spare, range, &grid, &split, left, right);
    }
    uint first = pair_at(starts, right->begin);
    left->place = first;
    right->place = first + 1u;
    left->depth = right->depth = range->depth + 1u;
    bb_write_node(nodes, range->place, box.lo, box.hi, first,
                  skip_after(starts, clusters, range->end));
}

kernel void hl_subtree(global const hl_task *tasks, uint task_count, global hl_item *items_a,
                       global hl_item *items_b, float unit, global const uint *starts,
                       uint clusters, global const hl_root *roots, global bb_node *nodes,
                       volatile global bb_tree_info *info)
{
    uint number = get_global_id(0);
    if (number >= task_count)
        return;
    const hl_task task = tasks[number];
    global hl_item *items = task.side == 0 ? items_a : items_b;
    global hl_item *spare = task.side == 0 ? items_b : items_a;
    hl_range stack[HL_STACK];
    hl_range range = {task.begin,
                      task.end,
                      task.place,
                      task.depth,
                      (float4)(task.lo[0], task.lo[1], task.lo[2], 0.0f),
                      (float4)(task.hi[0], task.hi[1], task.hi[2], 0.0f)};
    uint top = 0, depth = 0;
    for (;;) {
        if (range.end - range.begin > 1u) {
            hl_range left, right;
            split_range(items, spare, &range, unit, starts, clusters, nodes, &left, &right);
            bool left_first = left.end - left.begin <= right.end - right.begin;
            stack[top++] = left_first ? right : left;
            range = left_first ? left : right;
            continue;
        }
        global const hl_item *item = items + range.begin;
        write_cluster(nodes, range.place, item, roots, skip_after(starts, clusters, range.end));
        depth = BB_MAX(depth, range.depth + roots[item->cluster].height);
        if (top == 0)
            break;
        range = stack[--top];
    }
    atomic_max(&info->depth, depth);
}

/* ---- large tasks ---- */

void store_bounds(global float *lo, global float *hi, const hl_box *box)
{
    vstore3(box->lo.xyz, 0, lo);
    vstore3(box->hi.xyz, 0, hi);
}

kernel void hl_move(global const hl_task *tasks, global const hl_split *splits,
                    global hl_chunk *chunks, uint chunk_count, global const hl_item *from,
                    global hl_item *to, float unit)
{
    uint number = get_global_id(0);
    if (number >= chunk_count)
        return;
    const hl_chunk chunk = chunks[number];
    const hl_task task = tasks[chunk.task];
    const hl_split split = splits[chunk.task];
    hl_grid grid = grid_of(&task, unit);
    hl_box sides[2] = {hl_no_box(), hl_no_box()};
    uint next[2] = {chunk.left_at, chunk.right_at};
    for (uint i = chunk.begin; i < chunk.end; i++) {
        hl_box box;
        hl_load(&box, from + i);
        float4 centroid = hl_centroid(&box, grid.half_unit);
        uint side = hl_goes_left(&split, hl_bin_of(&grid, centroid), i) ? 0u : 1u;
        hl_join(&sides[side], centroid, centroid);
        vstore8(vload8(0, (global const uint *)(from + i)), 0,
                (global uint *)(to + next[side]));
        next[side]++;
    }
    for (uint side = 0; side < 2u; side++)
        store_bounds(chunks[number].lo[side], chunks[number].hi[side], &sides[side]);
}

/* children[2 t] and [2 t + 1] are the halves of task t. */
kernel void hl_children(global const hl_task *tasks, global const hl_split *splits, uint task_count,
                        global const hl_chunk *chunks, global const uint *starts,
                        global hl_task *children)
{
    uint number = get_global_id(0);
    if (number >= task_count)
        return;
    const hl_task task = tasks[number];
    const uint middle = splits[number].middle;
    for (uint side = 0; side < 2u; side++) {
        hl_task child = task;
        child.begin = side == 0 ? task.begin : middle;
        child.end = side == 0 ? middle : task.end;
        child.place = pair_at(starts, middle) + side;
        child.depth = task.depth + 1u;
        child.side = 1u - task.side;
        hl_box bounds = hl_no_box();
        for (uint c = 0; c < task.chunk_count; c++) {
            global const hl_chunk *chunk = chunks + task.first_chunk + c;
            hl_join(&bounds, (float4)(vload3(0, chunk->lo[side]), 0.0f),
                    (float4)(vload3(0, chunk->hi[side]), 0.0f));
        }
        children[2u * number + side] = child;
        store_bounds(children[2u * number + side].lo, children[2u * number + side].hi, &bounds);
    }
}
