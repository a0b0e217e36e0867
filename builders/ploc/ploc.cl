/* PLOC: parallel locally-ordered clustering (Meister and Bittner 2018), for CPUs.
 *
 *   clusters = primitives in the order of their codes                            (ploc_leaves)
 *   until few are left:
 *       each cluster: find the nearest up to R places away; mutual pairs          (ploc_search)
 *       places of the clusters that stay, by a prefix sum                        (ploc_places)
 *       join pairs, move the others up, into the other list                      (ploc_merge)
 *   finish in one work-item, in place, until one is left                         (ploc_rest)
 *
 * ploc_cluster.clh defines which cluster is nearest and keeps the number of rounds small. Search,
 * merging and compaction go through chunks, one per work-item. At either end a chunk's search
 * covers 2 R more clusters, so that it finds the same partners of its neighbours as the next chunk
 * does. PLOC++ (Benthin et al. 2022) avoids a list of neighbours in the same way.
 *
 *   BB_RADIUS   R
 *   BB_TILE     clusters searched at a time; their distances should fit the first-level cache
 *   BB_CHUNK    clusters per work-item, a multiple of BB_TILE
 */
#define BB_WINDOW ((BB_TILE + 4 * BB_RADIUS + 7) / 8 * 8)
#include "ploc_list.clh"

#define BB_AHEAD 24u /* how many primitives ahead boxes are prefetched */

kernel void ploc_leaves(global const bb_box *boxes, global const uint *values, uint count,
                        global float *planes, global uint4 *tags, uint stride)
{
    bb_clusters list = {planes, tags, stride};
    uint begin = get_global_id(0) * BB_CHUNK, end = BB_MIN(begin + BB_CHUNK, count);
    for (uint i = begin; i < end; i++) {
        if (i + BB_AHEAD < end)
            BB_PREFETCH(boxes + values[i + BB_AHEAD]);
        ploc_write(list, i, ploc_leaf(boxes, values[i], i));
    }
}

/* actions[i]: > 0: merges with the cluster that many places higher; < 0: merges with a lower one;
 * 0: stays. kept[]: number of clusters of each chunk that stay. */
kernel void ploc_search(global float *planes, global uint4 *tags, uint stride, uint count, int mask,
                        global char *actions, global uint *kept)
{
    bb_clusters list = {planes, tags, stride};
    uint chunk = get_global_id(0) * BB_CHUNK, chunk_end = BB_MIN(chunk + BB_CHUNK, count);
    uint stay = 0;
    bb_near near;
    ploc_near_start(&near);
    for (uint begin = chunk; begin < chunk_end; begin += BB_TILE) {
        uint end = BB_MIN(begin + BB_TILE, chunk_end);
        uint from = (uint)BB_MAX((int)begin - 2 * BB_RADIUS, 0);
        uint to = BB_MIN(end + 2u * BB_RADIUS, count);
        ploc_near(ploc_from(list, from), to - from, from, mask, &near);
        for (uint i = begin; i < end; i++) {
            int action = ploc_mutual(&near, i - from);
            actions[i] = (char)action;
            stay += action >= 0 ? 1u : 0u;
        }
    }
    if (chunk < count)
        kept[get_global_id(0)] = stay;
}

/* Runs in one work-item. kept[] becomes the place of each chunk's first cluster, total[0] their
 * number. */
kernel void ploc_places(global uint *kept, uint chunks, global uint *total)
{
    uint sum = 0;
    for (uint i = 0; i < chunks; i++) {
        uint stay = kept[i];
        kept[i] = sum;
        sum += stay;
    }
    total[0] = sum;
}

kernel void ploc_merge(global float *planes, global uint4 *tags, uint stride, uint count,
                       global const char *actions, global const uint *places,
                       global float *next_planes, global uint4 *next_tags,
                       global bb_cluster_pair *pairs)
{
    bb_clusters from = {planes, tags, stride}, to = {next_planes, next_tags, stride};
    uint begin = get_global_id(0) * BB_CHUNK, end = BB_MIN(begin + BB_CHUNK, count);
    if (begin >= count)
        return;
    uint place = places[get_global_id(0)];
    for (uint i = begin; i < end; i++) {
        int action = actions[i];
        if (action < 0)
            continue;
        bb_cluster c = ploc_read(from, i);
        if (action > 0)
            c = ploc_join(c, ploc_read(from, i + (uint)action), pairs);
        ploc_write(to, place++, c);
    }
}

/* Runs in one work-item; count <= BB_WINDOW. rounds[0]: number of rounds. */
kernel void ploc_rest(global float *planes, global uint4 *tags, uint stride, uint count, int mask,
                      global bb_cluster_pair *pairs, global bb_pair_side *root, global uint *rounds)
{
    bb_clusters list = {planes, tags, stride};
    uint round = 0;
    bb_near near;
    ploc_near_start(&near);
    for (; count > 1u; round++) {
        uint left = ploc_round(list, count, mask, &near, pairs);
        mask = count - left < BB_PLOC_FEW(count) ? BB_PLOC_FORCED : BB_PLOC_EXACT;
        count = left;
    }
    ploc_write_side(root, ploc_read(list, 0));
    rounds[0] = round;
}
