/* Refit of a tree's boxes, bottom-up from the leaves (refit.h).
 *
 * Once for the links of a tree:
 *   parent of each node, and how many children it has                            (refit_parents)
 *   nodes below each node, up: the last of its children to come adds them up     (refit_sizes)
 *   roots = nodes with few below, whose parents have many                        (refit_mark)
 * Each time:
 *   a subtree below a root: its nodes in preorder; a leaf: union of its primitives' boxes; behind
 *   the last child of a node: union of its children's                            (refit_subtrees)
 *   above: the last of a node's children to come joins all of them
 * Where work-groups hand over by levels, all of it goes up by them    (refit_leaves, refit_level).
 *
 * Last to come goes on: Karras 2012, section 4; how the children's boxes reach it: handover.clh. No
 * work-item waits for another. Subtrees by one work-item each spare an atomic operation and two
 * fences per node, which took most of the time. Limits: a node's children are joined by one
 * work-item.
 */
#include "bb_device.h"
#include "handover.clh"
#include "parents.clh"

typedef struct bb_extent {
    float lo[3], hi[3];
} bb_extent;

kernel void refit_parents(global const bb_node *nodes, uint count, uint root, global uint *parents,
                          global uint *missing)
{
    uint n = get_global_id(0);
    if (n < count)
        missing[n] = bb_make_parent(nodes, n, root, parents);
}

void start(bb_extent *e)
{
    for (int axis = 0; axis < 3; axis++) {
        e->lo[axis] = INFINITY;
        e->hi[axis] = -INFINITY;
    }
}

/* The links of nodes are left alone: others read them. */
void put_box(volatile global bb_node *node, const bb_extent *e)
{
    for (int axis = 0; axis < 3; axis++) {
        node->lo[axis] = e->lo[axis];
        node->hi[axis] = e->hi[axis];
    }
}

void fit_leaf(volatile global bb_node *nodes, global const uint *refs, global const bb_box *boxes,
              uint n)
{
    bb_extent e;
    uint ref = nodes[n].first & BB_INDEX_MASK, last;
    start(&e);
    do {
        global const bb_box *box = boxes + (refs[ref] & BB_INDEX_MASK);
        for (int axis = 0; axis < 3; axis++) {
            e.lo[axis] = BB_MIN(box->lo[axis], e.lo[axis]);
            e.hi[axis] = BB_MAX(box->hi[axis], e.hi[axis]);
        }
        last = refs[ref++] & BB_LAST_BIT;
    } while (last == 0);
    put_box(nodes + n, &e);
}

/* How many children there are. */
uint fit_inner(volatile global bb_node *nodes, uint n)
{
    bb_extent e;
    uint end = nodes[n].skip, children = 0;
    start(&e);
    for (uint c = nodes[n].first; c != end; c = nodes[c].skip, children++)
        for (int axis = 0; axis < 3; axis++) {
            float lo = nodes[c].lo[axis], hi = nodes[c].hi[axis];
            e.lo[axis] = BB_MIN(lo, e.lo[axis]);
            e.hi[axis] = BB_MAX(hi, e.hi[axis]);
        }
    put_box(nodes + n, &e);
    return children;
}

#if BB_HANDOVER
/* Of a leaf 1. Leaves missing[] as it was. */
kernel void refit_sizes(global const bb_node *nodes, uint count, global const uint *parents,
                        volatile global uint *missing, volatile global uint *sizes)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    sizes[n] = 1u;
    for (uint p = parents[n]; p != BB_NONE; p = parents[p]) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            return;
        BB_DEVICE_FENCE();
        uint end = nodes[p].skip, children = 0, size = 1u;
        for (uint c = nodes[p].first; c != end; c = nodes[c].skip, children++)
            size += sizes[c];
        sizes[p] = size;
        missing[p] = children;
    }
}

kernel void refit_mark(global const uint *sizes, uint count, uint root, uint most,
                       global const uint *parents, global uint *marks)
{
    uint n = get_global_id(0);
    if (n < count)
        marks[n] = sizes[n] <= most && (n == root || sizes[parents[n]] > most) ? 1u : 0u;
}

/* Nodes as two vectors, lo and first, hi and skip: what one work-item alone reads and writes. */
float4 load_lo(global const bb_node *nodes, uint n)
{
    return vload4(0, nodes[n].lo);
}

float4 load_hi(global const bb_node *nodes, uint n)
{
    return vload4(0, nodes[n].hi);
}

void store_box(global bb_node *nodes, uint n, float4 lo, float4 hi, uint first, uint skip)
{
    lo.w = as_float(first);
    hi.w = as_float(skip);
    vstore4(lo, 0, nodes[n].lo);
    vstore4(hi, 0, nodes[n].hi);
}

/* Boxes of a subtree, its nodes in preorder, each inner one when its last child is done. */
void fit_subtree(global bb_node *nodes, global const uint *refs, global const bb_box *boxes,
                 uint root, global const uint *parents)
{
    uint n = root;
    for (;;) {
        uint first = nodes[n].first, skip = nodes[n].skip;
        if ((first & BB_LEAF_BIT) == 0) {
            n = first;
            continue;
        }
        float4 lo = INFINITY, hi = -INFINITY;
        for (uint ref = first & BB_INDEX_MASK, last = 0; last == 0; ref++) {
            global const bb_box *box = boxes + (refs[ref] & BB_INDEX_MASK);
            float4 box_lo = vload4(0, box->lo), box_hi = vload4(0, box->hi);
            lo = select(lo, box_lo, box_lo < lo);
            hi = select(hi, box_hi, box_hi > hi);
            last = refs[ref] & BB_LAST_BIT;
        }
        store_box(nodes, n, lo, hi, first, skip);
        while (n != root) {
            uint p = parents[n], end = nodes[p].skip;
            if (skip != end)
                break; /* not the last child */
            first = nodes[p].first;
            for (uint c = first; c != end; c = nodes[c].skip) {
                float4 c_lo = load_lo(nodes, c), c_hi = load_hi(nodes, c);
                lo = select(lo, c_lo, c_lo < lo);
                hi = select(hi, c_hi, c_hi > hi);
            }
            store_box(nodes, p, lo, hi, first, end);
            n = p;
        }
        if (n == root)
            return;
        n = skip;
    }
}

kernel void refit_subtrees(global bb_node *nodes, global const uint *refs,
                           global const bb_box *boxes, global const uint *roots,
                           global const uint *root_count, global const uint *parents,
                           volatile global uint *missing)
{
    uint i = get_global_id(0);
    if (i >= root_count[0])
        return;
    uint root = roots[i];
    fit_subtree(nodes, refs, boxes, root, parents);
    for (uint p = parents[root]; p != BB_NONE; p = parents[p]) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            return;
        BB_DEVICE_FENCE();
        missing[p] = fit_inner(nodes, p); /* for the next time */
    }
}
#endif

kernel void refit_leaves(volatile global bb_node *nodes, global const uint *refs,
                         global const bb_box *boxes, uint count, global const uint *parents,
                         volatile global uint *missing, volatile global uint *counts,
                         global uint *next)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    fit_leaf(nodes, refs, boxes, n);
    uint p = parents[n];
    if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, 0u, counts, next);
}

kernel void refit_level(volatile global bb_node *nodes, global const uint *parents,
                        volatile global uint *missing, global const uint *level, uint number,
                        volatile global uint *counts, global uint *next)
{
    uint count = counts[number];
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        uint n = level[i], p = parents[n];
        missing[n] = fit_inner(nodes, n);
        if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
            bb_put_on_list(p, number, counts, next);
    }
}
