/* Refit of a binary tree that also keeps its books: what the tree costs, and, if asked for, one
 * rotation per node on the way up.
 *
 *   leaf: union of its primitives' boxes                                       (turn_leaf)
 *   up, the last of two children to come: of the four exchanges of one child with a child of the
 *   other, and the two of a child of one with a child of the other, take the one that shrinks the
 *   children's boxes most, if one does; join both                              (turn_pair)
 *   then: skips of last children, since subtrees are elsewhere                 (turn_skips)
 *
 * Kensler 2008, section 3; in the pass of a refit: Kopta, Ize, Spjut, Brunvand, Davis, Kensler 2012
 * (Fast, Effective BVH Updates for Animated Scenes), section 3. Whoever comes last owns the whole
 * subtree, so that links below it are changed by nobody else. Links of first children to their
 * siblings are kept right all the time; a node's second child is its first one's skip.
 */
#include "bb_device.h"
#include "handover.clh"
#include "parents.clh"
#include "turns_shared.h"

typedef struct turn_box {
    float lo[3], hi[3];
} turn_box;

kernel void turn_parents(global const bb_node *nodes, uint count, uint root, global uint *parents,
                         global uint *missing)
{
    uint n = get_global_id(0);
    if (n < count)
        missing[n] = bb_make_parent(nodes, n, root, parents);
}

/* ---- boxes ---- */

turn_box joined(volatile global const bb_node *nodes, uint a, uint b)
{
    turn_box box;
    for (int axis = 0; axis < 3; axis++) {
        float a_lo = nodes[a].lo[axis], b_lo = nodes[b].lo[axis];
        float a_hi = nodes[a].hi[axis], b_hi = nodes[b].hi[axis];
        box.lo[axis] = BB_MIN(a_lo, b_lo);
        box.hi[axis] = BB_MAX(a_hi, b_hi);
    }
    return box;
}

float area_of_box(const turn_box *box)
{
    return bb_half_area(box->hi[0] - box->lo[0], box->hi[1] - box->lo[1], box->hi[2] - box->lo[2]);
}

float area_of_both(volatile global const bb_node *nodes, uint a, uint b)
{
    turn_box box = joined(nodes, a, b);
    return area_of_box(&box);
}

float area_of(volatile global const bb_node *nodes, uint n)
{
    return area_of_both(nodes, n, n);
}

/* ---- books ---- */

void turn_leaf(volatile global bb_node *nodes, global const uint *refs, global const bb_box *boxes,
               uint n, volatile global bb_turn_state *states)
{
    turn_box box;
    uint ref = nodes[n].first & BB_INDEX_MASK, last, count = 0;
    for (int axis = 0; axis < 3; axis++) {
        box.lo[axis] = INFINITY;
        box.hi[axis] = -INFINITY;
    }
    do {
        global const bb_box *own = boxes + (refs[ref] & BB_INDEX_MASK);
        for (int axis = 0; axis < 3; axis++) {
            box.lo[axis] = BB_MIN(own->lo[axis], box.lo[axis]);
            box.hi[axis] = BB_MAX(own->hi[axis], box.hi[axis]);
        }
        last = refs[ref++] & BB_LAST_BIT;
        count++;
    } while (last == 0);
    for (int axis = 0; axis < 3; axis++) {
        nodes[n].lo[axis] = box.lo[axis];
        nodes[n].hi[axis] = box.hi[axis];
    }
    states[n].cost = area_of_box(&box) * (float)count * BB_TURN_CI;
    states[n].spread = 0.0f;
    states[n].height = 0;
    states[n].turned = 0;
}

/* Box and state of an inner node from those of its children. */
void join_pair(volatile global bb_node *nodes, uint n, volatile global bb_turn_state *states)
{
    uint a = nodes[n].first, b = nodes[a].skip;
    turn_box box = joined(nodes, a, b);
    float area = area_of_box(&box), below = area_of(nodes, a) + area_of(nodes, b);
    uint a_height = states[a].height, b_height = states[b].height;
    for (int axis = 0; axis < 3; axis++) {
        nodes[n].lo[axis] = box.lo[axis];
        nodes[n].hi[axis] = box.hi[axis];
    }
    states[n].cost = area * BB_TURN_CT + (states[a].cost + states[b].cost);
    states[n].spread = (below > 0.0f ? area / below : 1.0f) + (states[a].spread + states[b].spread);
    states[n].height = 1u + BB_MAX(a_height, b_height);
    states[n].turned = states[a].turned + states[b].turned;
}

/* ---- rotations ---- */

void set_children(volatile global bb_node *nodes, uint n, uint a, uint b, global uint *parents)
{
    nodes[n].first = a;
    nodes[a].skip = b;
    parents[a] = n;
    parents[b] = n;
}

/* The best so far: the children of both children, and which of n's children is exchanged for one of
 * the other's: then that other one stays inner, and has `kept` and the child that came down. */
typedef struct turn {
    float saved;
    uint up, down, into, kept; /* `down` goes below `into`, beside `kept`; `up` takes its place */
    uint cross[4];             /* children of the first child, of the second */
    bool both;                 /* cross counts, else the four above */
} turn;

/* `down`, a child, with either child of its sibling `into`. */
void try_uncle(volatile global const bb_node *nodes, uint down, uint into, turn *best)
{
    if ((nodes[into].first & BB_LEAF_BIT) != 0)
        return;
    uint c = nodes[into].first, d = nodes[c].skip;
    float before = area_of(nodes, into);
    float with_c = before - area_of_both(nodes, down, c);
    float with_d = before - area_of_both(nodes, down, d);
    if (with_d > best->saved) {
        best->saved = with_d;
        best->up = c;
        best->kept = d;
        best->down = down;
        best->into = into;
        best->both = false;
    }
    if (with_c > best->saved) {
        best->saved = with_c;
        best->up = d;
        best->kept = c;
        best->down = down;
        best->into = into;
        best->both = false;
    }
}

void try_cousins(volatile global const bb_node *nodes, uint a, uint b, turn *best)
{
    if (((nodes[a].first | nodes[b].first) & BB_LEAF_BIT) != 0)
        return;
    uint e = nodes[a].first, f = nodes[e].skip, c = nodes[b].first, d = nodes[c].skip;
    float before = area_of(nodes, a) + area_of(nodes, b);
    for (uint k = 0; k < 2; k++) {
        uint mine = k == 0u ? c : d, theirs = k == 0u ? d : c;
        float saved =
            before - (area_of_both(nodes, mine, f) + area_of_both(nodes, e, theirs));
        if (saved > best->saved) {
            best->saved = saved;
            best->cross[0] = mine;
            best->cross[1] = f;
            best->cross[2] = e;
            best->cross[3] = theirs;
            best->both = true;
        }
    }
}

/* n has two children, whose boxes are there. turns: whether it may be rotated. */
void turn_pair(volatile global bb_node *nodes, uint n, uint turns, global uint *parents,
               volatile global bb_turn_state *states)
{
    uint a = nodes[n].first, b = nodes[a].skip;
    turn best = {.saved = 0.0f};
    if (turns != 0u) {
        try_uncle(nodes, a, b, &best);
        try_uncle(nodes, b, a, &best);
        try_cousins(nodes, a, b, &best);
    }
    if (best.saved > 0.0f) {
        if (best.both) {
            set_children(nodes, a, best.cross[0], best.cross[1], parents);
            set_children(nodes, b, best.cross[2], best.cross[3], parents);
            join_pair(nodes, a, states);
            join_pair(nodes, b, states);
        } else {
            set_children(nodes, best.into, best.down, best.kept, parents);
            set_children(nodes, n, best.up, best.into, parents);
            join_pair(nodes, best.into, states);
        }
    }
    join_pair(nodes, n, states);
    states[n].turned += best.saved > 0.0f ? 1u : 0u;
}

/* ---- the way up ---- */

#if BB_HANDOVER
kernel void turn_climb(volatile global bb_node *nodes, global const uint *refs,
                       global const bb_box *boxes, uint count, uint turns, global uint *parents,
                       volatile global uint *missing, volatile global bb_turn_state *states)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    turn_leaf(nodes, refs, boxes, n, states);
    for (uint p = parents[n]; p != BB_NONE; p = parents[p]) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            return;
        BB_DEVICE_FENCE();
        missing[p] = 2u; /* for the next time */
        turn_pair(nodes, p, turns, parents, states);
    }
}
#endif

kernel void turn_leaves(volatile global bb_node *nodes, global const uint *refs,
                        global const bb_box *boxes, uint count, global const uint *parents,
                        volatile global uint *missing, volatile global bb_turn_state *states,
                        volatile global uint *counts, global uint *next)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    turn_leaf(nodes, refs, boxes, n, states);
    uint p = parents[n];
    if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, 0u, counts, next);
}

kernel void turn_level(volatile global bb_node *nodes, uint turns, global uint *parents,
                       volatile global uint *missing, volatile global bb_turn_state *states,
                       global const uint *level, uint number, volatile global uint *counts,
                       global uint *next)
{
    uint count = counts[number];
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        uint n = level[i], p = parents[n];
        missing[n] = 2u;
        turn_pair(nodes, n, turns, parents, states);
        if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
            bb_put_on_list(p, number, counts, next);
    }
}

/* ---- afterwards ---- */

/* The skip of a first child, or of the root, holds for the last child below, and its last child. */
kernel void turn_skips(global bb_node *nodes, uint count, uint root, global const uint *parents,
                       global const bb_turn_state *states, global bb_tree_info *info)
{
    uint n = get_global_id(0);
    if (n >= count || (n != root && nodes[parents[n]].first != n))
        return;
    uint skip = n == root ? BB_NONE : nodes[n].skip;
    for (uint m = n; (nodes[m].first & BB_LEAF_BIT) == 0;) {
        m = nodes[nodes[m].first].skip;
        nodes[m].skip = skip;
    }
    if (n == root)
        info->depth = states[n].height;
}
