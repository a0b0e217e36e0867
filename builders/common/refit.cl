/* Refit of a tree's boxes, bottom-up from the leaves (refit.h).
 *
 *   parent of each node, and how many children it has                     (refit_parents)
 *   leaf: union of its primitives' boxes
 *   up: the last of a node's children to come joins all of them           (refit_climb, or
 *   refit_leaves and refit_level)
 *
 * Last to come goes on: Karras 2012, section 4; how the children's boxes reach it: handover.clh. No
 * work-item waits for another. Limits: a node's children are joined by one work-item.
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
kernel void refit_climb(volatile global bb_node *nodes, global const uint *refs,
                        global const bb_box *boxes, uint count, global const uint *parents,
                        volatile global uint *missing)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    fit_leaf(nodes, refs, boxes, n);
    for (uint p = parents[n]; p != BB_NONE; p = parents[p]) {
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
