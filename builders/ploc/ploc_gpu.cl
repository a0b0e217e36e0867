/* PLOC for GPUs. ploc.cl describes the method; the pairs are the same.
 *
 *   until few are left, one launch over all clusters for each step:
 *       find each cluster's nearest                                         (ploc_find)
 *       mark the clusters that merge and those that stay                    (ploc_mark)
 *       places of the clusters that stay, by a prefix sum                   (bb_scan_u32)
 *       join pairs, move the others up, into the other list                 (ploc_merge_each)
 *   finish in one work-group, in place, until one is left                   (ploc_rest_group)
 */
#define BB_CLUSTER_SPACE global
#define BB_CLUSTER_FENCE (CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#define BB_FEW BB_PLOC_FEW
#include "ploc_group.clh"

kernel void ploc_leaves_each(global const bb_box *boxes, global const uint *values, uint count,
                             global float *planes, global uint4 *tags, uint stride)
{
    bb_clusters list = {planes, tags, stride};
    uint i = get_global_id(0);
    if (i < count)
        ploc_write(list, i, ploc_leaf(boxes, values[i], i));
}

kernel void ploc_find(global float *planes, global uint4 *tags, uint stride, uint count, int mask,
                      global char *partners)
{
    bb_clusters list = {planes, tags, stride};
    uint i = get_global_id(0);
    if (i < count)
        partners[i] = (char)ploc_nearest(list, count, i, mask);
}

/* stays[i]: 0 if i merges into a lower cluster, else 1. */
kernel void ploc_mark(global const char *partners, uint count, global uint *stays)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    int partner = partners[i];
    stays[i] = partner < 0 && partners[(int)i + partner] == -partner ? 0u : 1u;
}

/* places[]: exclusive prefix sum of stays[]. */
kernel void ploc_merge_each(global float *planes, global uint4 *tags, uint stride, uint count,
                            global const char *partners, global const uint *places,
                            global float *next_planes, global uint4 *next_tags,
                            global bb_cluster_pair *pairs)
{
    bb_clusters from = {planes, tags, stride}, to = {next_planes, next_tags, stride};
    uint i = get_global_id(0);
    if (i >= count)
        return;
    int partner = partners[i];
    bool mutual = partner != 0 && partners[(int)i + partner] == -partner;
    if (mutual && partner < 0)
        return;
    bb_cluster c = ploc_read(from, i);
    if (mutual)
        c = ploc_join(c, ploc_read(from, i + (uint)partner), pairs);
    ploc_write(to, places[i], c);
}

/* Runs in one work-group of BB_GROUP items; count <= BB_GROUP. rounds[0]: number of rounds. */
kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void ploc_rest_group(global float *planes, global uint4 *tags, uint stride, uint count,
                            int mask, global bb_cluster_pair *pairs, global bb_pair_side *root,
                            global uint *rounds)
{
    local int partners[BB_GROUP];
    local uint sums[BB_GROUP];
    bb_clusters list = {planes, tags, stride};
    uint round = 0;
    ploc_group(list, count, 1u, mask, pairs, partners, sums, &round);
    if (get_local_id(0) == 0) {
        ploc_write_side(root, ploc_read(list, 0));
        rounds[0] = round;
    }
}
