/* The top tree of bonsai over the subtrees of the mini-trees: full-sweep SAH, in which an item
 * weighs 1 or as much as it has primitives.
 *
 *   boxes, centroids and weights of the items                                       (bn_items)
 *   sort along each axis: one sort, with the axis above the centroid
 *   one work-group: grow until nodes have few items                                   (bn_top)
 *   a work-group for each of these nodes: grow it                                    (bn_rest)
 *
 * Its nodes take the numbers of the radix tree's nodes above the items: if item m is the first on
 * the right of a split, the children are nodes 2s - 1 and 2s, where s is the first reference of
 * item m. A leaf of the top tree is the root of a subtree; the skips of the subtree's last nodes
 * are set here.
 *
 * -DBN_LANES: work-items per group; 1 on CPUs.
 */
#define BN_SPACE global
#define BN_ID uint
#define BN_SPAN bn_top_span
#define BN_WEIGHTS
#include "bonsai_grow.clh"
#include "tree_info.clh"

/* keys: by axis, also with the axis above the centroid in sort_keys. order: the items' own order.
 * weights: by item. */
kernel void bn_items(global const bn_item *items, uint count, uint refs, uint prims_weigh,
                     global float8 *boxes, global uint *keys, global ulong *sort_keys,
                     global uint *order, global uint *weights, global bb_tree_info *info,
                     global uint *waiting)
{
    uint i = get_global_id(0);
    if (i == 0) {
        bb_write_binary_info(info, refs, refs, 0);
        *waiting = 0;
    }
    if (i >= count)
        return;
    float4 lo = vload4(0, items[i].lo), hi = vload4(0, items[i].hi);
    boxes[i] = (float8)(-lo.xyz, 0.0f, hi.xyz, 0.0f);
    uint end = i + 1u < count ? items[i + 1u].begin : refs;
    weights[i] = prims_weigh != 0 ? end - items[i].begin : 1u;
    uint found[3] = {bn_centroid_key(lo.x, hi.x), bn_centroid_key(lo.y, hi.y),
                     bn_centroid_key(lo.z, hi.z)};
    for (uint axis = 0; axis < 3u; axis++) {
        keys[axis * count + i] = found[axis];
        sort_keys[axis * count + i] = (ulong)axis << 32 | found[axis];
        order[axis * count + i] = i;
    }
}

/* ---- leaves of the top tree ---- */

uint bn_start_of(const bn_grower *g, uint i)
{
    return i < g->stride ? g->items[i].begin : g->total;
}

/* Raises the tree's depth to that below an item whose root is on `level` of the top tree. */
void bn_deepen(const bn_grower *g, uint id, uint level, uint right_levels)
{
    uint begin = g->items[id].begin, end = bn_start_of(g, id + 1u), deepest = 0;
    for (uint i = begin; i < end; i++)
        deepest = BB_MAX((uint)g->levels[i], deepest);
    /* leaves have their levels below the mini-tree's root; the last leaf is right_levels below this
     * root */
    atomic_max(&g->info->depth, level + deepest + right_levels - g->levels[end - 1u]);
}

void bn_put_leaf(const bn_grower *g, uint id, uint position, uint place, uint skip, uint level)
{
    global const uint *words = (global const uint *)(g->items + id);
    uint4 lo = vload4(0, words), hi = vload4(1, words);
    hi.w = skip;
    vstore4(lo, 0, (global uint *)(g->nodes + place));
    vstore4(hi, 1, (global uint *)(g->nodes + place));
    uint right_levels = 0;
    for (uint link = lo.w; (link & BB_LEAF_BIT) == 0; right_levels++) {
        uint last = g->nodes[link].skip;
        g->nodes[last].skip = skip;
        link = g->nodes[last].first;
    }
    bn_deepen(g, id, level, right_levels);
}

/* ---- growing ---- */

/* Leaves a small node to the second launch, in which `most` is 0. */
bool bn_put_off(const bn_grower *g, bn_span span, uint level)
{
    if (span.end - span.begin > g->most)
        return false;
    bn_task task = {span.begin, span.end, span.place, level};
    g->tasks[atomic_inc(g->waiting)] = task;
    return true;
}

#define BN_TOP_BUFFERS                                                                             \
    global const bn_item *items, uint count, uint refs, float unit, global const float8 *boxes,    \
        global const uint *keys, global uint *orders, global float4 *right, global bn_span *spans, \
        global bn_split *splits, global const uint *weights, global uchar *levels,                 \
        global bb_node *nodes, volatile global bb_tree_info *info, global bn_task *tasks,          \
        volatile global uint *waiting

/* For a node whose items begin at `first`, which is also where its scratch begins. */
#define BN_TOP_GROWER(first, least)                                                                \
    {                                                                                              \
        .boxes = boxes, .keys = keys, .orders = {orders, orders + 3u * count}, .right = right,     \
        .spans = {spans + (first), spans + count + (first)}, .splits = splits + (first),           \
        .counts = counts, .weights = weights, .stride = count, .unit = unit, .nodes = nodes,       \
        .items = items, .total = refs, .levels = levels, .info = info, .most = (least),            \
        .tasks = tasks, .waiting = waiting                                                         \
    }

/* Runs in one work-group. */
kernel __attribute__((reqd_work_group_size(BN_LANES, 1, 1))) void bn_top(BN_TOP_BUFFERS, uint most)
{
    local uint counts[2];
    bn_grower g = BN_TOP_GROWER(0, most);
    if (BN_LANE == 0) {
        bn_span root = {0, count, 0};
        counts[0] = counts[1] = 0;
        bn_put(&g, orders, root, BB_NONE, 0);
    }
    BN_BARRIER();
    bn_grow(&g, 0);
}

/* Runs in any number of work-groups, which share the tasks. */
kernel __attribute__((reqd_work_group_size(BN_LANES, 1, 1))) void bn_rest(BN_TOP_BUFFERS)
{
    local uint counts[2];
    for (uint t = get_group_id(0); t < *waiting; t += get_num_groups(0)) {
        bn_task task = tasks[t];
        bn_grower g = BN_TOP_GROWER(task.begin, 0);
        if (BN_LANE == 0) {
            bn_span span = {task.begin, task.end, task.place};
            g.spans[task.level & 1u][0] = span;
            counts[task.level & 1u] = 1;
            counts[~task.level & 1u] = 0;
        }
        BN_BARRIER();
        bn_grow(&g, task.level);
        BN_BARRIER();
    }
}
