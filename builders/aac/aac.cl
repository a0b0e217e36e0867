/* AAC, approximate agglomerative clustering: Gu, He, Fatahalian, Blelloch 2013.
 *
 * build(keys l .. r of a node of the radix tree):
 *   fewer than delta keys: make a cluster of each and combine them to f(delta)
 *   else: build both children, append their clusters, combine them to f(r - l + 1)
 * at the root: combine to 1
 *
 * The clusters of a node over keys l .. r are stored from place l on. A right child's clusters are
 * moved up, in place, behind its left sibling's. The launches:
 *   split the nodes of more than `large` keys, level by level from the root             (aac_split)
 *   build each small child by one work-group, in one pass over its keys               (aac_subtree)
 *   combine the large nodes, level by level up to the root                               (aac_join)
 *   finish the root (aac_finish), then set skips (aac_skips)
 * The order of the lists of large and small nodes varies; the tree does not depend on it.
 *
 * When two clusters are joined, the higher of their ids is used up and numbers the pair of
 * nodes: 2 id - 1 and 2 id. So node numbers do not depend on the order in which work-items run.
 *
 * -DBB_KEY64 for ulong keys; AAC_LANES work-items per work-group.
 */
#include "bb_device.h"
#include "radix_keys.clh"
#include "tree_info.clh"
#include "aac_combine.clh"

/* Depth of the stack of waiting left children; their levels strictly decrease. */
#define AAC_STACK (BB_PREFIX_BITS + 32u)

/* f as a table: the sizes from which on it is 1, 2, ... */
typedef struct aac_goal {
    global const uint *sizes;
    uint size_count;
    uint delta;
} aac_goal;

uint goal_of(const aac_goal *goal, uint size)
{
    uint low = 1, high = goal->size_count;
    while (low < high) {
        uint middle = (low + high + 1u) / 2u;
        if (goal->sizes[middle - 1u] <= size)
            low = middle;
        else
            high = middle - 1u;
    }
    return low;
}

/* ---- large nodes, from the top ---- */

/* Returns the last key of the left child of node l .. r, l < r. */
uint split_of(global const bb_key *keys, uint l, uint r)
{
    uint common = common_of(keys, l, r), low = l, high = r;
    while (high - low > 1u) { /* low is left of the split, high is right of it */
        uint middle = low + (high - low) / 2u;
        if (common_of(keys, l, middle) > common)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* counts[0]: number of small nodes; counts[1]: number of large nodes on the next level. */
void list_child(uint l, uint r, uint large, volatile global uint *counts, global aac_range *next,
                global aac_range *tasks)
{
    aac_range range = {l, r, 0};
    if (r - l >= large)
        next[atomic_inc(&counts[1])] = range;
    else
        tasks[atomic_inc(&counts[0])] = range;
}

/* Splits one level: nodes[at] .. nodes[at + count - 1]. The next level is written behind it. */
kernel void aac_split(global const bb_key *keys, uint at, uint count, uint large,
                      volatile global uint *counts, global aac_range *nodes,
                      global aac_range *tasks)
{
    uint number = get_global_id(0);
    if (number >= count)
        return;
    uint l = nodes[at + number].l, r = nodes[at + number].r;
    uint split = split_of(keys, l, r);
    nodes[at + number].split = split;
    list_child(l, split, large, counts, nodes + at + count, tasks);
    list_child(split + 1u, r, large, counts, nodes + at + count, tasks);
}

/* ---- clusters ---- */

/* Moves clusters from .. from + count - 1 down to `to` < from. */
void move_down(const aac_list *list, uint to, uint from, uint count)
{
    for (uint at = 0; at < count; at += AAC_LANES) { /* reads are always ahead of writes */
        uint i = at + lane_of();
        uint8 words = 0;
        uint height = 0;
        AAC_SYNC();
        if (i < count) {
            words = vload8(0, (global const uint *)(list->clusters + from + i));
            height = list->heights[from + i];
        }
        AAC_SYNC();
        if (i < count) {
            vstore8(words, 0, (global uint *)(list->clusters + to + i));
            list->heights[to + i] = height;
        }
    }
}

/* Combines the clusters of the children of node l .. r, which have `left` and `right` of them.
 * Children smaller than delta have not been combined yet, so they are combined first. combine() is
 * called in one place only, since compilers inline it. */
uint join_children(const aac_scratch *s, const aac_list *list, const aac_goal *goal, uint l,
                   uint split, uint r, uint left, uint right)
{
    const uint size = r - l + 1u, least = goal_of(goal, goal->delta);
    const uint steps = size < goal->delta ? 0 : 3u;
    uint found = size;
    for (uint step = 0; step < steps; step++) {
        uint base = l, count = left + right, target = goal_of(goal, size);
        if (step == 0) {
            count = left;
            target = split - l + 1u < goal->delta ? least : left;
        } else if (step == 1u) {
            base = split + 1u;
            count = right;
            target = r - split < goal->delta ? least : right;
        }
        move_down(list, l + left, split + 1u,
                  step == 2u && l + left != split + 1u ? right : 0);
        found = combine(s, list, base, count, target);
        left = step == 0 ? found : left;
        right = step == 1u ? found : right;
    }
    return found;
}

void start_cluster(const aac_list *list, uint i, global const uint *values,
                   global const bb_box *boxes, global uint *refs)
{
    uint prim = values[i];
    global const float *words = (global const float *)(boxes + prim);
    aac_write_cluster(list, i, vload4(0, words), vload4(1, words), BB_LEAF_BIT | i, i);
    list->heights[i] = 0;
    refs[i] = prim | BB_LAST_BIT;
}

/* Returns how many clusters a small node has. Traverses its keys as link_chunks() of radix_tree.cl
 * does. */
uint build_small(const aac_scratch *s, const aac_list *list, const aac_goal *goal,
                 global const bb_key *keys, uint count, uint begin, uint end)
{
    uint starts[AAC_STACK], counts[AAC_STACK];
    uchar levels[AAC_STACK]; /* level of the split to the left of each stack entry */
    uint top = 0, left_level = level_of(keys, count, begin - 1u);
    for (uint i = begin;; i++) {
        uint right_level = level_of(keys, count, i), level = left_level;
        uint l = i, clusters = 1;
        while (top > 0 && level < right_level) {
            top--;
            clusters =
                join_children(s, list, goal, starts[top], l - 1u, i, counts[top], clusters);
            l = starts[top];
            level = levels[top];
        }
        if (i == end)
            return clusters;
        starts[top] = l;
        counts[top] = clusters;
        levels[top] = (uchar)level;
        top++;
        left_level = right_level;
    }
}

/* live[l]: number of clusters of the node that begins at l. */
kernel __attribute__((reqd_work_group_size(AAC_LANES, 1, 1)))
void aac_subtree(global const bb_key *keys, uint count, global const aac_range *tasks,
                        uint task_count, global const uint *values, global const bb_box *boxes,
                        global uint *refs, global aac_cluster *clusters, global uint *heights,
                        global bb_node *nodes, float unit, global const uint *sizes,
                        uint size_count, uint delta, global float *scratch, uint room,
                        global uint *live)
{
    local float distances[AAC_LANES];
    local uint places[AAC_LANES];
    const aac_scratch s = {scratch + get_group_id(0) * (size_t)room * AAC_SLOT_WORDS, room,
                           distances, places};
    const aac_list list = {clusters, heights, nodes, unit};
    const aac_goal goal = {sizes, size_count, delta};
    for (uint t = get_group_id(0); t < task_count; t += get_num_groups(0)) {
        const uint l = tasks[t].l, r = tasks[t].r;
        for (uint i = l + lane_of(); i <= r; i += AAC_LANES)
            start_cluster(&list, i, values, boxes, refs);
        AAC_SYNC();
        uint found = build_small(&s, &list, &goal, keys, count, l, r);
        if (lane_of() == 0)
            live[l] = found;
    }
}

kernel __attribute__((reqd_work_group_size(AAC_LANES, 1, 1)))
void aac_join(global const aac_range *large, uint at, uint large_count,
                     global aac_cluster *clusters,
                     global uint *heights, global bb_node *nodes, float unit,
                     global const uint *sizes, uint size_count, uint delta, global float *scratch,
                     uint room, global uint *live)
{
    local float distances[AAC_LANES];
    local uint places[AAC_LANES];
    const aac_scratch s = {scratch + get_group_id(0) * (size_t)room * AAC_SLOT_WORDS, room,
                           distances, places};
    const aac_list list = {clusters, heights, nodes, unit};
    const aac_goal goal = {sizes, size_count, delta};
    for (uint t = get_group_id(0); t < large_count; t += get_num_groups(0)) {
        const aac_range node = large[at + t];
        uint found = join_children(&s, &list, &goal, node.l, node.split, node.r, live[node.l],
                                   live[node.split + 1u]);
        AAC_SYNC(); /* all work-items have read it */
        if (lane_of() == 0)
            live[node.l] = found;
    }
}

/* Runs in one work-group. */
kernel __attribute__((reqd_work_group_size(AAC_LANES, 1, 1)))
void aac_finish(uint count, global aac_cluster *clusters, global uint *heights,
                       global bb_node *nodes, float unit, global const uint *sizes,
                       uint size_count, uint delta, global float *scratch, uint room,
                       global const uint *live, global bb_tree_info *info)
{
    local float distances[AAC_LANES];
    local uint places[AAC_LANES];
    const aac_scratch s = {scratch, room, distances, places};
    const aac_list list = {clusters, heights, nodes, unit};
    const aac_goal goal = {sizes, size_count, delta};
    uint left = live[0];
    for (uint step = 0; step < 2u; step++) /* step 0: a root of fewer than delta keys */
        left = combine(&s, &list, 0, left,
                       step == 1u ? 1u : count < delta ? goal_of(&goal, delta) : left);
    if (lane_of() != 0)
        return;
    global const float *words = (global const float *)clusters;
    bb_write_node(nodes, 0, (float4)(vload3(0, words), 0.0f), (float4)(vload3(0, words + 4), 0.0f),
                  clusters[0].first, BB_NONE);
    bb_write_binary_info(info, count, count, heights[0]);
}

/* A left child, or the root, passes its skip down the chain of right children below it, all of
 * which end where it does. Each right child is visited once. */
kernel void aac_skips(uint count, global bb_node *nodes)
{
    uint pair = get_global_id(0);
    if (pair >= count)
        return;
    uint skip = pair > 0 ? 2u * pair : BB_NONE;
    uint first = nodes[pair > 0 ? 2u * pair - 1u : 0u].first;
    while ((first & BB_LEAF_BIT) == 0) {
        nodes[first + 1u].skip = skip;
        first = nodes[first + 1u].first;
    }
}
