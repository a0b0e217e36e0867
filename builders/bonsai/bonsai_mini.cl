/* Mini-trees of bonsai, and the subtrees of them that the top tree is built over.
 *
 *   for each group, by one work-group:                                               (bn_mini)
 *       copy boxes and centroids to local memory
 *       sort along each axis
 *       grow (bonsai_grow.clh)
 *   for each mini-tree: the area of its root                                        (bn_areas)
 *   for each mini-tree, from the root down: open nodes larger than a limit; count what remains
 *                                                                                   (bn_prune)
 *   scan the counts
 *   list what remains                                                                (bn_list)
 *
 * Nodes are numbered like those of a radix tree: with the references in the order of the leaves,
 * the children below the split between references s and s + 1 are nodes 2s + 1 and 2s + 2. The root
 * of the group that begins at reference s is node 2s until the top tree is built. The top tree sets
 * the skips of nodes that end where their group ends.
 *
 * -DBN_GROUP: most primitives of a group, a power of two, 2 to 4096. -DBN_LANES: work-items that
 * share a group, 1 on CPUs.
 */
#define BN_SPACE local
#define BN_ID ushort
#define BN_SPAN bn_mini_span
#include "bonsai_grow.clh"
#include "bonsai_sort.clh"

uint bn_start_of(const bn_grower *g, uint i)
{
    return g->base + i;
}

bool bn_put_off(const bn_grower *g, bn_span span, uint level)
{
    return false;
}

void bn_put_leaf(const bn_grower *g, uint id, uint position, uint place, uint skip, uint level)
{
    uint ref = g->base + position;
    global bb_node *node = g->nodes + place;
    bn_write_box(node, g->boxes[id]);
    node->first = BB_LEAF_BIT | ref;
    node->skip = skip;
    g->refs[ref] = g->values[id] | BB_LAST_BIT;
    g->levels[ref] = (uchar)level;
}

kernel __attribute__((reqd_work_group_size(BN_LANES, 1, 1)))
void bn_mini(global const uint *starts, uint groups, global const uint *values,
                    global const bb_box *boxes, float unit, global bb_node *nodes,
                    global uint *refs, global uchar *levels)
{
    local float8 own[BN_GROUP];
    local uint keys[3 * BN_GROUP];
    local ushort orders[2][3 * BN_GROUP];
    local float4 right[BN_GROUP];
    local bn_span spans[2][BN_SPANS(BN_GROUP)];
    local bn_split splits[BN_SPANS(BN_GROUP)];
    local uint counts[2];
    const uint group = get_group_id(0);
    if (group >= groups)
        return;
    const uint base = starts[group], count = starts[group + 1u] - base;
    values += base;
    for (uint i = BN_LANE; i < count; i += BN_LANES) {
        global const float *box = (global const float *)(boxes + values[i]);
        float4 lo = vload4(0, box), hi = vload4(1, box);
        own[i] = (float8)(-lo.xyz, 0.0f, hi.xyz, 0.0f);
        keys[i] = bn_centroid_key(lo.x, hi.x);
        keys[BN_GROUP + i] = bn_centroid_key(lo.y, hi.y);
        keys[2 * BN_GROUP + i] = bn_centroid_key(lo.z, hi.z);
    }
    if (BN_LANE == 0)
        counts[0] = counts[1] = 0;
    BN_BARRIER();
    bn_sort_axes(keys, orders[0], orders[1], BN_GROUP, count);
    bn_grower g = {.boxes = own,
                   .keys = keys,
                   .orders = {orders[0], orders[1]},
                   .right = right,
                   .spans = {spans[0], spans[1]},
                   .splits = splits,
                   .counts = counts,
                   .stride = BN_GROUP,
                   .unit = unit,
                   .nodes = nodes,
                   .base = base,
                   .total = BB_NONE,
                   .refs = refs,
                   .values = values,
                   .levels = levels};
    if (BN_LANE == 0) {
        bn_span root = {0, (ushort)count, 2u * base};
        bn_put(&g, orders[0], root, 2u * (base + count), 0);
    }
    BN_BARRIER();
    bn_grow(&g, 0);
}

/* ---- pruning ---- */

float bn_node_area(global const bb_node *node, float unit)
{
    float4 side = vload4(0, node->hi) * unit - vload4(0, node->lo) * unit;
    return bb_half_area(side.x, side.y, side.z);
}

kernel void bn_areas(global const uint *starts, uint groups, global const bb_node *nodes,
                     float unit, global float *areas)
{
    uint group = get_global_id(0);
    if (group < groups)
        areas[group] = bn_node_area(nodes + 2u * starts[group], unit);
}

bool bn_opens(global const bb_node *node, float unit, float limit)
{
    return (node->first & BB_LEAF_BIT) == 0 && bn_node_area(node, unit) > limit;
}

/* counts[group]: number of subtrees left of it. opened[0], 0 before: number of groups that are
 * opened. */
kernel void bn_prune(global const uint *starts, uint groups, global const bb_node *nodes,
                     float unit, float limit, global uint *counts, volatile global uint *opened)
{
    uint group = get_global_id(0);
    if (group >= groups)
        return;
    const uint end = 2u * starts[group + 1u];
    uint found = 0;
    for (uint n = 2u * starts[group]; n != end;) {
        bool open = bn_opens(nodes + n, unit, limit);
        found += open ? 0u : 1u;
        n = open ? nodes[n].first : nodes[n].skip;
    }
    counts[group] = found;
    if (found > 1u)
        atomic_inc(opened);
}

/* places: exclusive scan of counts. */
kernel void bn_list(global const uint *starts, uint groups, global const bb_node *nodes, float unit,
                    float limit, global const uint *places, global bn_item *items)
{
    uint group = get_global_id(0);
    if (group >= groups)
        return;
    const uint root = 2u * starts[group], end = 2u * starts[group + 1u];
    uint place = places[group], begin = starts[group];
    for (uint n = root; n != end;) {
        global const uint *words = (global const uint *)(nodes + n);
        uint4 lo = vload4(0, words), hi = vload4(1, words);
        if (bn_opens(nodes + n, unit, limit)) {
            n = lo.w;
            continue;
        }
        n = hi.w;
        hi.w = begin;
        vstore4(lo, 0, (global uint *)(items + place));
        vstore4(hi, 1, (global uint *)(items + place));
        place++;
        begin = n / 2u; /* a skip is a right child or the group's end */
    }
}
