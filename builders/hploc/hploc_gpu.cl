/* H-PLOC for GPUs. hploc.cl describes the method; the pairs are the same.
 *
 *   for each split of the radix tree:                                                (hploc_ranges)
 *       find the range of its node
 *       count its children that hold more than T primitives
 *       if it holds more and no child does: put it on the list of level 1
 *   for each level: for each of its nodes, by one work-group:                         (hploc_level)
 *       append the right child's clusters to the left child's
 *       merge until at most T are left
 *       the last child to finish puts the parent on the next level's list
 *
 * Levels are lists (handover.clh), so no fence between work-groups is needed. The live[l] clusters
 * of node [l, r] are at l, l + 1, ...
 *
 *   BB_RADIUS, BB_GOAL, BB_KEY64   as in hploc.cl
 *   BB_GROUP                       size of a work-group, at least 2 BB_GOAL
 */
#define BB_CLUSTER_SPACE local
#define BB_CLUSTER_FENCE CLK_LOCAL_MEM_FENCE
#define BB_FEW BB_HPLOC_FEW
#include "ploc_group.clh"
#include "handover.clh"
#include "radix_keys.clh"

kernel void hploc_leaves(global const bb_box *boxes, global const uint *values, uint count,
                         global bb_pair_side *clusters, global uint *heads,
                         global bb_pair_side *root)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    bb_cluster c = ploc_leaf(boxes, values[i], i);
    ploc_write_side(&clusters[i], c);
    heads[i] = i;
    if (count == 1u)
        ploc_write_side(root, c);
}

/* Returns whether keys i < j share more than `same` bits. */
bool share_more(global const bb_key *keys, uint i, uint j, uint same)
{
    return common_of(keys, i, j) > same;
}

/* Returns the range of the node below the split between keys s and s + 1. */
uint2 range_of(global const bb_key *keys, uint count, uint s)
{
    uint same = common_of(keys, s, s + 1u), reach = 1, l = s, r = s + 1u;
    while (reach <= s && share_more(keys, s - reach, s, same))
        reach *= 2u;
    for (uint step = reach; step > 0; step /= 2u)
        if (step <= l && share_more(keys, l - step, s, same))
            l -= step;
    reach = 1;
    while (reach < count - s - 1u && share_more(keys, s + 1u, s + 1u + reach, same))
        reach *= 2u;
    for (uint step = reach; step > 0; step /= 2u)
        if (step < count - r && share_more(keys, s + 1u, r + step, same))
            r += step;
    return (uint2)(l, r);
}

kernel void hploc_ranges(global const bb_key *keys, uint count, global uint2 *ranges,
                         global uint *missing, volatile global uint *counts, global uint *list)
{
    uint s = get_global_id(0);
    if (s + 1u >= count)
        return;
    uint2 range = range_of(keys, count, s);
    ranges[s] = range;
    uint large = (s - range.x >= BB_GOAL ? 1u : 0u) + (range.y - s > BB_GOAL ? 1u : 0u);
    missing[s] = large;
    bool whole = range.y - range.x + 1u == count;
    if (large == 0 && (range.y - range.x >= BB_GOAL || whole))
        bb_put_on_list(s, 0, counts, list);
}

void load(global const bb_pair_side *clusters, global const uint *heads, uint from,
          bb_clusters list, uint at)
{
    global const uint *words = (global const uint *)(clusters + from);
    uint4 lo = vload4(0, words), hi = vload4(1, words);
    bb_cluster c = {as_float3(lo.xyz), as_float3(hi.xyz), (uint4)(lo.w, hi.w, heads[from], 0u)};
    ploc_write(list, at, c);
}

/* The arrays that nodes are made from. */
typedef struct hploc_tree {
    global const bb_key *keys;
    uint count;
    global bb_pair_side *clusters;
    global uint *heads, *live;
    global const uint2 *ranges;
    volatile global uint *missing;
    global bb_cluster_pair *pairs;
    global bb_pair_side *root;
} hploc_tree;

/* Makes the node below split s, by all work-items of a group; `own` and the parameters after it are
 * the group's. */
void reduce_node(const hploc_tree *t, uint s, bb_clusters own, local int *partners,
                 local uint *sums, uint *rounds, uint number, volatile global uint *counts,
                 global uint *next)
{
    uint i = get_local_id(0), l = t->ranges[s].x, r = t->ranges[s].y;
    uint left = s - l + 1u, right = r - s;
    left = left > BB_GOAL ? t->live[l] : left;
    right = right > BB_GOAL ? t->live[s + 1u] : right;
    bool whole = r - l + 1u == t->count;
    if (i < left + right)
        load(t->clusters, t->heads, i < left ? l + i : s + 1u + i - left, own, i);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    uint stay = ploc_group(own, left + right, whole ? 1u : BB_GOAL, BB_PLOC_EXACT, t->pairs,
                           partners, sums, rounds);
    if (i < stay) {
        bb_cluster c = ploc_read(own, i);
        ploc_write_side(whole ? t->root : &t->clusters[l + i], c);
        t->heads[l + i] = c.tag.z;
    }
    if (i == 0 && !whole) {
        t->live[l] = stay;
        bool is_left = level_of(t->keys, t->count, r) < level_of(t->keys, t->count, l - 1u);
        uint parent = is_left ? r : l - 1u;
        if (atomic_dec(&t->missing[parent]) == 1u)
            bb_put_on_list(parent, number, counts, next);
    }
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
}

kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void hploc_level(global const bb_key *keys, uint count, global bb_pair_side *clusters,
                        global uint *heads, global uint *live, global const uint2 *ranges,
                        volatile global uint *missing, global bb_cluster_pair *pairs,
                        global bb_pair_side *root, uint number, volatile global uint *counts,
                        global uint *list, global uint *next)
{
    local float planes[6 * BB_GROUP];
    local uint4 tags[BB_GROUP];
    local int partners[BB_GROUP];
    local uint sums[BB_GROUP];
    const hploc_tree tree = {keys, count, clusters, heads, live, ranges, missing, pairs, root};
    bb_clusters own = {planes, tags, BB_GROUP};
    uint rounds = 0;
#define REDUCE(s) reduce_node(&tree, s, own, partners, sums, &rounds, number, counts, next)
    BB_FOR_LISTS(REDUCE, (uint)get_local_size(0))
}
