/* Turns pairs of clusters into the common tree, top-down; pair_tree.h has the numbering.
 *
 *   open(node with references [base, end) and pair p):
 *       s = base + p.left.count - 1; node.first = 2s + 1
 *       node 2s + 1: left's box,  references [base, s + 1), skip = 2s + 2
 *       node 2s + 2: right's box, references [s + 1, end),  skip = 2 end, or none
 *
 * CPUs (pair_tree_top, pair_tree_walk): one work-item opens nodes until there are enough subtrees
 * for all cores, then one work-item walks each, the smaller child first. GPUs (pair_tree_start,
 * pair_tree_level): by lists (handover.clh).
 *
 * Limits: count <= 2^30, as in radix_tree.cl.
 */
#include "bb_device.h"
#include "handover.clh"
#include "lanes.clh"
#include "leaf_boxes.clh"
#include "pair_shared.h"
#include "tree_info.clh"

/* Writes a child's node; true, with *child, if it has children to open. */
bool place_side(uint4 lo, uint4 hi, bb_pair_task at, uint skip, global bb_node *nodes,
                global uint *refs, bb_pair_task *child)
{
    bool leaf = (lo.w & BB_LEAF_BIT) != 0;
    bb_write_node(nodes, at.place, as_float4(lo), as_float4(hi), BB_LEAF_BIT | at.base, skip);
    if (leaf)
        refs[at.base] = (lo.w & BB_INDEX_MASK) | BB_LAST_BIT;
    at.link = lo.w;
    *child = at;
    return !leaf;
}

/* Opens a node; returns how many of its two children have children, in open[]. */
uint open_pair(bb_pair_task task, global const bb_cluster_pair *pairs, uint count,
               global bb_node *nodes, global uint *refs, bb_pair_task *open)
{
    /* integers, which no device flushes or quiets */
    global const uint *words = (global const uint *)(pairs + task.link);
    uint4 left_lo = vload4(0, words), left_hi = vload4(1, words);
    uint4 right_lo = vload4(2, words), right_hi = vload4(3, words);
    uint split = task.base + left_hi.w - 1u, depth = task.depth + 1u;
    nodes[task.place].first = 2u * split + 1u;
    bb_pair_task left = {0, 2u * split + 1u, task.base, split + 1u, depth};
    bb_pair_task right = {0, 2u * split + 2u, split + 1u, task.end, depth};
    uint skip = task.end < count ? 2u * task.end : BB_NONE, inner = 0;
    inner += place_side(left_lo, left_hi, left, right.place, nodes, refs, &open[inner]) ? 1u : 0u;
    inner += place_side(right_lo, right_hi, right, skip, nodes, refs, &open[inner]) ? 1u : 0u;
    return inner;
}

/* Writes the root's node and the tree's info; false if the root is a leaf. */
bool start(global const bb_pair_side *root, uint count, global bb_node *nodes, global uint *refs,
           global bb_tree_info *info, bb_pair_task *task)
{
    global const uint *words = (global const uint *)root;
    bb_pair_task at = {0, 0, 0, count, 0};
    bb_write_binary_info(info, count, count, 0);
    return place_side(vload4(0, words), vload4(1, words), at, BB_NONE, nodes, refs, task);
}

/* ---- CPUs ---- */

/* One work-item. Writes subtrees of up to `share` references to tasks[], larger ones if there would
 * be more than `most`, and their number to total[0]. */
kernel void pair_tree_top(global const bb_pair_side *root, global const bb_cluster_pair *pairs,
                          uint count, global bb_node *nodes, global uint *refs,
                          global bb_tree_info *info, uint share, uint most,
                          global bb_pair_task *tasks, global uint *total)
{
    bb_pair_task task, open[2];
    uint waiting = 0, deepest = 0;
    if (start(root, count, nodes, refs, info, &task))
        tasks[waiting++] = task;
    for (uint at = 0; at < waiting;) {
        task = tasks[at];
        if (task.end - task.base <= share || waiting == most) {
            at++;
            continue;
        }
        uint inner = open_pair(task, pairs, count, nodes, refs, open);
        if (inner < 2u)
            deepest = BB_MAX(task.depth + 1u, deepest);
        tasks[at] = inner > 0 ? open[0] : tasks[--waiting];
        if (inner == 2u)
            tasks[waiting++] = open[1];
    }
    info->depth = deepest;
    total[0] = waiting;
}

/* Room for subtrees that wait. A walk goes on with the smaller child, which has at most half of the
 * references: each halving leaves one subtree waiting, and a 32-bit count halves at most 32 times.
 */
#define BB_WAITING_MAX 32

typedef struct pair_walk {
    bb_pair_task task;
    uint waiting;
    bb_pair_task stack[BB_WAITING_MAX];
} pair_walk;

/* One step of a walk; false if it is done. */
bool walk_on(pair_walk *walk, global const bb_cluster_pair *pairs, uint count,
             global bb_node *nodes, global uint *refs, uint *deepest)
{
    bb_pair_task open[2];
    uint inner = open_pair(walk->task, pairs, count, nodes, refs, open);
    if (inner < 2u)
        *deepest = BB_MAX(walk->task.depth + 1u, *deepest);
    if (inner == 2u) {
        bool first = open[0].end - open[0].base < open[1].end - open[1].base;
        walk->task = open[first ? 0 : 1];
        walk->stack[walk->waiting++] = open[first ? 1 : 0];
    } else if (inner == 1u) {
        walk->task = open[0];
    } else if (walk->waiting > 0) {
        walk->task = walk->stack[--walk->waiting];
    } else {
        return false;
    }
    BB_PREFETCH(pairs + walk->task.link);
    return true;
}

/* One work-item per BB_PAIR_WALKS tasks. */
kernel void pair_tree_walk(global const bb_cluster_pair *pairs, uint count, global bb_node *nodes,
                           global uint *refs, volatile global bb_tree_info *info,
                           global const bb_pair_task *tasks, global const uint *total)
{
    pair_walk walks[BB_PAIR_WALKS];
    uint first = get_global_id(0) * BB_PAIR_WALKS, active = 0, deepest = 0;
    for (; active < BB_PAIR_WALKS && first + active < total[0]; active++) {
        walks[active].task = tasks[first + active];
        walks[active].waiting = 0;
    }
    while (active > 0)
        for (uint k = 0; k < active;)
            if (walk_on(&walks[k], pairs, count, nodes, refs, &deepest))
                k++;
            else
                walks[k] = walks[--active];
    if (deepest > 0)
        atomic_max(&info->depth, deepest);
}

/* ---- GPUs ---- */

/* One work-item. The root is level 1 if it has children. spans[p] is the task of pair p, without
 * its link. */
kernel void pair_tree_start(global const bb_pair_side *root, uint count, global bb_node *nodes,
                            global uint *refs, global bb_tree_info *info, global uint4 *spans,
                            volatile global uint *counts, global uint *list)
{
    bb_pair_task task;
    if (!start(root, count, nodes, refs, info, &task))
        return;
    spans[task.link] = (uint4)(task.place, task.base, task.end, task.depth);
    bb_put_on_list(task.link, 0, counts, list);
}

void open_listed(uint pair, global const bb_cluster_pair *pairs, uint count, global bb_node *nodes,
                 global uint *refs, volatile global bb_tree_info *info, global uint4 *spans,
                 uint number, volatile global uint *counts, global uint *next)
{
    uint4 span = spans[pair];
    bb_pair_task task = {pair, span.x, span.y, span.z, span.w}, open[2];
    uint inner = open_pair(task, pairs, count, nodes, refs, open);
    if (inner < 2u)
        atomic_max(&info->depth, task.depth + 1u);
    for (uint k = 0; k < inner; k++) {
        bb_pair_task t = open[k];
        spans[t.link] = (uint4)(t.place, t.base, t.end, t.depth);
        bb_put_on_list(t.link, number, counts, next);
    }
}

kernel void pair_tree_level(global const bb_cluster_pair *pairs, uint count, global bb_node *nodes,
                            global uint *refs, volatile global bb_tree_info *info,
                            global uint4 *spans, uint number, volatile global uint *counts,
                            global uint *list, global uint *next)
{
#define OPEN(pair) open_listed(pair, pairs, count, nodes, refs, info, spans, number, counts, next)
    BB_FOR_LISTS(OPEN, 1u)
}
