/* LOBVH as published: the dense octree in four arrays, a box, a first child, a next pointer and a
 * first and last primitive for every node. Nodes are numbered, and the tree is, as in lobvh.cl with
 * BB_CHAINS.
 *
 * Gu, Jendersie, Grosch 2018, section 3.2:
 *
 *   dense_pointers   pointer setup: S and E, where the key changes
 *   dense_setup      BVH pointer setup: F and N of all nodes
 *   dense_adjust     compaction, step 1: per level, bottom-up, the first child that is not vacant,
 *                    and the box; beside it, how many nodes follow below after compaction
 *   dense_next       compaction, step 2: N(k) = N(N(k)) as long as N(k) is vacant
 *   scan             compaction, step 3: places
 *   dense_write      the nodes that are not vacant, at their places
 *
 * A node is vacant if it has neither primitives nor a child that is not vacant. As printed, N(k)
 * never ends at the root and on paths of all sevens; here the walk ends at the root.
 */
#include "bb_device.h"
#include "leaf_boxes.clh"

bool is_vacant(global const uint *children, global const uint2 *prims, uint k)
{
    return children[k] == BB_NONE && prims[k].x == BB_NONE;
}

/* `prims` is BB_NONE before. */
kernel void dense_pointers(global const uint *restrict keys, global const uint *restrict values,
                           uint count, global uint *prims, global uint *restrict refs)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    uint key = keys[i];
    bool last = i + 1u == count || keys[i + 1u] != key;
    refs[i] = values[i] | (last ? BB_LAST_BIT : 0u);
    if (i == 0u || keys[i - 1u] != key)
        prims[2u * key] = i;
    if (last)
        prims[2u * key + 1u] = i;
}

/* `inner`: number of nodes above the deepest level. */
kernel void dense_setup(uint nodes, uint inner, global uint *restrict children,
                        global uint *restrict next)
{
    uint k = get_global_id(0), at = k;
    if (k >= nodes)
        return;
    children[k] = k < inner ? 8u * k + 1u : BB_NONE;
    while (at > 0u && ((at - 1u) & 7u) == 7u)
        at = (at - 1u) >> 3;
    next[k] = at == 0u ? BB_NONE : at + 1u;
}

/* The union of the boxes of a node's own primitives. */
void join_own(global const uint *values, global const bb_box *boxes, uint2 own, float4 *lo,
              float4 *hi)
{
    *lo = (float4)(INFINITY);
    *hi = (float4)(-INFINITY);
    for (uint i = own.x; own.x != BB_NONE && i <= own.y; i++)
        bb_join_box_ahead(values, boxes, i, own.y + 1u, lo, hi);
}

/* What has been counted of the tree. */
typedef struct tally {
    uint leaves, depth, arity;
} tally;

void adjust(uint k, uint level, uint inner, global const uint *values, global const bb_box *boxes,
            global const uint2 *prims, global uint *children, global float *node_boxes,
            global uint *sizes, tally *t)
{
    uint child = BB_NONE, count = 0;
    uint2 own = prims[k];
    float4 lo, hi;
    join_own(values, boxes, own, &lo, &hi);
    for (uint c = 8u; c-- > 0u && k < inner;) {
        uint q = 8u * k + 1u + c;
        if (is_vacant(children, prims, q))
            continue;
        global const float *box = node_boxes + 6ul * q;
        lo.xyz = BB_MIN(vload3(0, box), lo.xyz);
        hi.xyz = BB_MAX(vload3(1, box), hi.xyz);
        child = q;
        count++;
    }
    children[k] = child;
    vstore3(lo.xyz, 0, node_boxes + 6ul * k);
    vstore3(hi.xyz, 1, node_boxes + 6ul * k);
    uint size = count == 0u ? 0u : count + (own.x != BB_NONE ? 1u : 0u);
    if (k < inner)
        sizes[k] = size;
    t->arity = BB_MAX(t->arity, size);
    if (own.x != BB_NONE) {
        t->leaves++;
        t->depth = BB_MAX(t->depth, level + (count > 0u ? 1u : 0u));
    }
}

/* For the `nodes` nodes from `first` on, those of `level`, `chunk` of them per work-item; deeper
 * ones are finished. `sizes`, of nodes above the deepest level: children that stay, and a leaf for
 * primitives beside them. info is 0 before. */
kernel void dense_adjust(global const uint *restrict values, global const bb_box *restrict boxes,
                         global const uint2 *restrict prims, uint first, uint nodes, uint chunk,
                         uint level, uint inner, global uint *children, global float *node_boxes,
                         global uint *restrict sizes, volatile global bb_tree_info *info)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= nodes)
        return;
    uint end = nodes - begin < chunk ? nodes : begin + chunk;
    tally t = {0, 0, 0};
    for (uint n = begin; n < end; n++)
        adjust(first + n, level, inner, values, boxes, prims, children, node_boxes, sizes, &t);
    if (t.arity > 0u)
        atomic_max(&info->arity, t.arity);
    if (t.leaves > 0u) {
        atomic_add(&info->leaf_count, t.leaves);
        atomic_max(&info->depth, t.depth);
    }
}

kernel void dense_next(uint nodes, global const uint *restrict children,
                       global const uint2 *restrict prims, global uint *next)
{
    uint k = get_global_id(0);
    if (k >= nodes || is_vacant(children, prims, k))
        return;
    uint at = next[k]; /* pointers of vacant nodes are not written here */
    while (at != BB_NONE && is_vacant(children, prims, at))
        at = next[at];
    next[k] = at;
}

/* The place of a node that is not vacant. */
uint place_of(global const uint *children, global const uint2 *prims, global const uint *offsets,
              uint k)
{
    if (k == 0u || k == BB_NONE)
        return k;
    uint parent = (k - 1u) >> 3;
    uint place = 1u + offsets[parent] + (prims[parent].x != BB_NONE ? 1u : 0u);
    for (uint q = 8u * parent + 1u; q < k; q++)
        place += is_vacant(children, prims, q) ? 0u : 1u;
    return place;
}

kernel void dense_write(global const uint *restrict values, global const bb_box *restrict boxes,
                        global const uint2 *restrict prims, uint count, uint nodes,
                        global const uint *restrict children, global const uint *restrict next,
                        global const float *restrict node_boxes,
                        global const uint *restrict offsets, global const uint *restrict total,
                        global bb_node *restrict out, global bb_tree_info *info)
{
    uint k = get_global_id(0);
    if (k >= nodes || is_vacant(children, prims, k))
        return;
    float4 lo = (float4)(vload3(0, node_boxes + 6ul * k), 0.0f);
    float4 hi = (float4)(vload3(1, node_boxes + 6ul * k), 0.0f);
    uint2 own = prims[k];
    uint at = place_of(children, prims, offsets, k);
    uint after = place_of(children, prims, offsets, next[k]);
    if (children[k] == BB_NONE) {
        bb_write_node(out, at, lo, hi, BB_LEAF_BIT | own.x, after);
    } else {
        uint start = 1u + offsets[k];
        bb_write_node(out, at, lo, hi, start, after);
        if (own.x != BB_NONE) { /* its leaf comes before its children */
            join_own(values, boxes, own, &lo, &hi);
            bb_write_node(out, start, lo, hi, BB_LEAF_BIT | own.x, start + 1u);
        }
    }
    if (k == 0u) {
        info->root = 0;
        info->node_count = 1u + total[0];
        info->ref_count = count;
    }
}
