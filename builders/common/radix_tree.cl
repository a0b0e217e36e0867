/* The binary radix tree over sorted keys, with boxes.
 *
 * common(i, j) is the length of the common prefix of keys i and j; equal keys are extended by their
 * indices. level(i) counts from the other end, longest - common(i, i + 1), and is "infinite"
 * outside. Node [l, r] is the left child of the split at r if level(r) < level(l - 1), else the
 * right child of the split at l - 1. Its range gives the node's place, its children's places (2s +
 * 1 and 2s + 2 below split s) and its skip (the right child of split r).
 *
 * Apetrei 2014 (link_climb; one work-item per leaf):
 *   node = leaf i
 *   loop: write node at its place
 *         publish its far end at the parent's split, by an atomic exchange
 *         first to come: stop
 *         second to come: node = parent = [l, r], with the union of both boxes
 *
 * Without atomics, for CPUs and wherever work-groups have no fence (link_chunks: one work-item per
 * chunk of leaves, in order; then link_pieces: one per run of chunks, then per run of runs ...):
 *   left child: waits on the run's list
 *   right child whose sibling is on the list: joins it
 *   right child whose sibling is in another run: waits as well
 *   a longer run takes the nodes on the lists of its runs, in order, in place of leaves
 * On a list, right children come first, with growing levels, then left children, with falling ones:
 * never more than two for each level there is, and one for each leaf. Lists of neighbours follow
 * one another in ends[], where a longer run's list overwrites them.
 *
 * Karras 2012 (link_ranges, link_boxes):
 *   for each inner node i:
 *       direction
 *       range, by exponential and binary search
 *       split, by binary search; links of both children
 *   for each leaf: climb; the second to come joins the boxes of both children
 *
 * -DBB_KEY_NODES: keys are nodes of a binary tree, any of which may be an ancestor of others: the
 * steps from the root (0 left, 1 right) from the top bit, then a 1, then zeros; sorted in preorder.
 * Such a node stands for the string with a bit before each step, 1 to go on, and a 0 at its end.
 * Sorted strings of nodes are in preorder, and the radix tree over them is the extended tree of Gu,
 * Jendersie, Grosch 2018, section 3.3.2: a node with descendants becomes a leaf beside the subtree
 * that holds them. Common prefixes follow from the nodes themselves: if i < j, l is the level of
 * node i and d the number of first steps that both share, the prefix has 2 l bits if l <= d (i is
 * an ancestor of j), else 2 d + 1. Hence the minimum over adjacent pairs of a range is unique, and
 * none of the cases for ties of the paper's algorithm 1 (lines 2, 3 and 13) is needed.
 *
 * -DBB_LEAF_RUNS: leaf i holds the references values[starts[i]] to values[starts[i + 1] - 1], and
 * the number of leaves is on the device, in totals[0].
 *
 * No work-item waits for another. Limits: count <= 2^30, so that 2s + 2 stays below the leaf bit;
 * -DBB_KEY64 for ulong keys.
 */
#include "bb_device.h"
#include "lanes.clh"
#include "handover.clh"
#include "leaf_boxes.clh"
#include "radix_keys.clh"
#include "tree_info.clh"

typedef struct bb_work {
    float4 lo, hi; /* xyz */
    uint l, r;     /* range of leaves */
    uint first;    /* as in bb_node */
    uint height;   /* edges to the deepest leaf below */
} bb_work;

uint place_of(const bb_work *w, bool is_left)
{
    return is_left ? 2u * w->r + 1u : 2u * w->l;
}

void write_node(global bb_node *nodes, uint place, const bb_work *w, uint count)
{
    uint skip = w->r + 1u < count ? 2u * w->r + 2u : BB_NONE;
    bb_write_node(nodes, place, w->lo, w->hi, w->first, skip);
}

/* Writes the box of a node whose links are there already. */
void write_box(volatile global bb_node *node, const bb_work *w)
{
    node->lo[0] = w->lo.x;
    node->lo[1] = w->lo.y;
    node->lo[2] = w->lo.z;
    node->hi[0] = w->hi.x;
    node->hi[1] = w->hi.y;
    node->hi[2] = w->hi.z;
}

void write_root(global bb_node *nodes, global bb_tree_info *info, const bb_work *w, uint count,
                uint ref_count)
{
    write_node(nodes, 0, w, count);
    bb_write_binary_info(info, count, ref_count, w->height);
}

void join_box(bb_work *w, float4 lo, float4 hi)
{
    w->lo = BB_MIN(lo, w->lo);
    w->hi = BB_MAX(hi, w->hi);
}

/* Number of leaves over `ref_count` references. */
uint count_leaves(global const uint *totals, uint ref_count)
{
#ifdef BB_LEAF_RUNS
    return totals[0];
#else
    return ref_count;
#endif
}

void start_leaf(bb_work *w, uint i, global const uint *starts, global const uint *values,
                global const bb_box *boxes, global uint *refs)
{
#ifdef BB_LEAF_RUNS
    uint first = starts[i], last = starts[i + 1u] - 1u;
#else
    uint first = i, last = i;
#endif
    uint prim = values[first];
    global const float4 *box = (global const float4 *)(boxes + prim);
    w->lo = box[0];
    w->hi = box[1];
    w->l = i;
    w->r = i;
    w->first = BB_LEAF_BIT | first;
    w->height = 0;
    for (uint at = first; at < last; at++) {
        refs[at] = prim;
        prim = values[at + 1u];
        box = (global const float4 *)(boxes + prim);
        join_box(w, box[0], box[1]);
    }
    refs[last] = prim | BB_LAST_BIT;
}

/* Like start_leaf(), for a work-item that goes on to the references before `end`. */
void start_leaf_ahead(bb_work *w, uint i, global const uint *starts, global const uint *values,
                      global const bb_box *boxes, global uint *refs, uint end)
{
#ifdef BB_LEAF_RUNS
    uint first = starts[i], stop = starts[i + 1u];
#else
    uint first = i, stop = i + 1u;
#endif
    w->lo = (float4)(INFINITY);
    w->hi = (float4)(-INFINITY);
    w->l = i;
    w->r = i;
    w->first = BB_LEAF_BIT | first;
    w->height = 0;
    for (uint at = first; at < stop; at++) {
        bb_join_box_ahead(values, boxes, at, end, &w->lo, &w->hi);
        refs[at] = values[at] | (at + 1u == stop ? BB_LAST_BIT : 0u);
    }
}

#if BB_HANDOVER
/* Meets the sibling at split s. False: it is not there yet, and its work-item will go on. True: w
 * has become the parent. */
bool meet(bb_work *w, bool is_left, uint s, volatile global uint *ends,
          volatile global uchar *heights, volatile global bb_node *nodes)
{
    heights[2u * s + (is_left ? 1u : 2u)] = (uchar)w->height;
    BB_DEVICE_FENCE();
    uint end = atomic_xchg(&ends[s], is_left ? w->l : w->r);
    if (end == BB_NONE)
        return false;
    BB_DEVICE_FENCE();
    uint sibling = 2u * s + (is_left ? 2u : 1u);
    float4 lo = (float4)(nodes[sibling].lo[0], nodes[sibling].lo[1], nodes[sibling].lo[2], 0.0f);
    float4 hi = (float4)(nodes[sibling].hi[0], nodes[sibling].hi[1], nodes[sibling].hi[2], 0.0f);
    join_box(w, lo, hi);
    uint height = heights[sibling];
    w->height = BB_MAX(height, w->height) + 1u;
    if (is_left)
        w->r = end;
    else
        w->l = end;
    w->first = 2u * s + 1u;
    return true;
}

/* Climbs from w by atomics until a sibling is missing or the root is made. */
void climb(bb_work *w, global const bb_key *keys, uint count, volatile global uint *ends,
           volatile global uchar *heights, global bb_node *nodes, global bb_tree_info *info,
           uint ref_count)
{
    for (;;) {
        uint left = level_of(keys, count, w->l - 1u), right = level_of(keys, count, w->r);
        if (left == right) { /* both outside */
            write_root(nodes, info, w, count, ref_count);
            return;
        }
        bool is_left = right < left;
        write_node(nodes, place_of(w, is_left), w, count);
        if (!meet(w, is_left, is_left ? w->r : w->l - 1u, ends, heights, nodes))
            return;
    }
}

kernel void link_climb(global const bb_key *keys, global const uint *starts,
                       global const uint *totals, global const uint *values,
                       global const bb_box *boxes, uint ref_count, volatile global uint *ends,
                       volatile global uchar *heights, global bb_node *nodes, global uint *refs,
                       global bb_tree_info *info)
{
    uint count = count_leaves(totals, ref_count);
    uint i = get_global_id(0);
    if (i >= count)
        return;
    bb_work w;
    start_leaf(&w, i, starts, values, boxes, refs);
    climb(&w, keys, count, ends, heights, nodes, info, ref_count);
}

#endif

/* ---- without atomics ---- */

#ifndef BB_KEEP_WAITING
#define BB_KEEP_WAITING 0 /* CPUs: 1, nodes that wait are kept in the cache */
#endif

/* Most nodes that wait at once: levels of right children grow, those of left children fall. */
#define BB_WAITING_MAX (2u * (BB_PREFIX_BITS + 32u))

/* The list of a run of leaves: nodes that wait for their siblings. */
typedef struct bb_waiting {
    global uint *ends; /* last leaf of each node; the next node begins after it */
    uint begin;        /* first leaf of the run */
    uint count, right; /* number of nodes; of right children, which come first */
#if BB_KEEP_WAITING
    bb_work kept[BB_WAITING_MAX];
    uchar levels[BB_WAITING_MAX]; /* of the split to the left of each */
#endif
} bb_waiting;

/* Joins w with its sibling, the last node on the list, a left child that ends where w begins.
 * Returns the level of the split to the left of both. */
uint join_waiting(bb_work *w, bb_waiting *waiting, global const bb_key *keys, uint count,
                  global const uchar *heights, global const bb_node *nodes)
{
    uint sibling = 2u * w->l - 1u, at = --waiting->count;
    w->first = sibling;
#if BB_KEEP_WAITING
    const bb_work *left = &waiting->kept[at];
    join_box(w, left->lo, left->hi);
    w->height = BB_MAX(left->height, w->height) + 1u;
    w->l = left->l;
    return waiting->levels[at];
#else
    global const float4 *box = (global const float4 *)(nodes + sibling);
    uint height = heights[sibling];
    join_box(w, box[0], box[1]);
    w->height = BB_MAX(height, w->height) + 1u;
    w->l = at > 0 ? waiting->ends[at - 1u] + 1u : waiting->begin;
    return level_of(keys, count, w->l - 1u);
#endif
}

/* Joins w with its siblings while they are on the list, and appends it. left, right: levels of the
 * splits beside w. */
void settle(bb_work *w, uint left, uint right, bb_waiting *waiting, global const bb_key *keys,
            uint count, global uchar *heights, global bb_node *nodes, global bb_tree_info *info,
            uint ref_count)
{
    for (;;) {
        if (left == right) { /* both outside */
            write_root(nodes, info, w, count, ref_count);
            return;
        }
        bool is_left = right < left;
        uint place = place_of(w, is_left);
        write_node(nodes, place, w, count);
        heights[place] = (uchar)w->height;
        if (is_left || waiting->count == waiting->right) {
#if BB_KEEP_WAITING
            waiting->kept[waiting->count] = *w;
            waiting->levels[waiting->count] = (uchar)left;
#else
            waiting->ends[waiting->count] = w->r;
#endif
            waiting->count++;
            waiting->right += is_left ? 0u : 1u;
            return;
        }
        left = join_waiting(w, waiting, keys, count, heights, nodes);
    }
}

/* Returns how many nodes wait. */
uint finish_list(bb_waiting *waiting)
{
#if BB_KEEP_WAITING
    for (uint i = 0; i < waiting->count; i++)
        waiting->ends[i] = waiting->kept[i].r;
#endif
    return waiting->count;
}

kernel void link_chunks(global const bb_key *keys, global const uint *starts,
                        global const uint *totals, global const uint *values,
                        global const bb_box *boxes, uint ref_count, global uint *ends,
                        global uchar *heights, global bb_node *nodes, global uint *refs,
                        global bb_tree_info *info, uint chunk, global uint *lengths)
{
    uint count = count_leaves(totals, ref_count);
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk;
    bb_waiting waiting;
    waiting.ends = ends + begin;
    waiting.begin = begin;
    waiting.count = waiting.right = 0;
    uint left = level_of(keys, count, begin - 1u);
#ifdef BB_LEAF_RUNS
    uint ref_end = starts[end];
#else
    uint ref_end = end;
#endif
    for (uint i = begin; i < end; i++) {
        bb_work w;
        uint right = level_of(keys, count, i);
        start_leaf_ahead(&w, i, starts, values, boxes, refs, ref_end);
        settle(&w, left, right, &waiting, keys, count, heights, nodes, info, ref_count);
        left = right;
    }
    lengths[get_global_id(0)] = finish_list(&waiting);
}

/* Loads the finished subtree [l, r] at `place`. */
void load_piece(bb_work *w, uint l, uint r, uint place, global const uchar *heights,
                global const bb_node *nodes)
{
    global const uint4 *words = (global const uint4 *)(nodes + place);
    uint4 lo = words[0];
    w->lo = as_float4(lo);
    w->hi = as_float4(words[1]);
    w->l = l;
    w->r = r;
    w->first = lo.w;
    w->height = heights[place];
}

/* Combines runs of `span` leaves, `some` at a time. lengths[from ..] are the lengths of their
 * lists, lengths[to ..] those of the lists made of them. */
kernel void link_pieces(global const bb_key *keys, global const uint *totals, uint ref_count,
                        global uint *ends, global uchar *heights, global bb_node *nodes,
                        global bb_tree_info *info, uint span, uint some, uint from, uint to,
                        global uint *lengths)
{
    uint count = count_leaves(totals, ref_count), runs = (count + span - 1u) / span;
    uint run = get_global_id(0) * some;
    if (run >= runs)
        return;
    uint begin = run * span, l = begin, left = level_of(keys, count, l - 1u);
    bb_waiting waiting;
    waiting.ends = ends + begin;
    waiting.begin = begin;
    waiting.count = waiting.right = 0;
    for (uint k = 0; k < BB_MIN(some, runs - run); k++) {
        uint length = lengths[from + run + k];
        for (uint i = 0; i < length; i++) {
            bb_work w;
            uint r = ends[begin + k * span + i], right = level_of(keys, count, r);
            load_piece(&w, l, r, right < left ? 2u * r + 1u : 2u * l, heights, nodes);
            settle(&w, left, right, &waiting, keys, count, heights, nodes, info, ref_count);
            left = right;
            l = r + 1u;
        }
    }
    lengths[to + get_global_id(0)] = finish_list(&waiting);
}

/* ---- Karras 2012 ---- */

/* Like common_of(), for leaves i and j in either order; -1 outside. */
int prefix_of(global const bb_key *keys, uint count, uint i, long j)
{
    if (j < 0 || j >= (long)count)
        return -1;
    return (int)common_of(keys, BB_MIN(i, (uint)j), BB_MAX(i, (uint)j));
}

kernel void link_ranges(global const bb_key *keys, global const uint *totals, uint ref_count,
                        global bb_node *nodes, global uint *place_of_split)
{
    uint count = count_leaves(totals, ref_count);
    uint i = get_global_id(0);
    if (i + 1u >= count)
        return;
    /* direction of the range, and an upper bound for its length */
    long at = (long)i;
    int d = prefix_of(keys, count, i, at + 1) > prefix_of(keys, count, i, at - 1) ? 1 : -1;
    int least = prefix_of(keys, count, i, at - d);
    long bound = 2;
    while (prefix_of(keys, count, i, at + bound * d) > least)
        bound *= 2;
    /* the other end, by binary search */
    long length = 0;
    for (long step = bound / 2; step >= 1; step /= 2)
        if (prefix_of(keys, count, i, at + (length + step) * d) > least)
            length += step;
    long other = at + length * d;
    /* the split: the last leaf that shares more than the node's prefix with i */
    int common = prefix_of(keys, count, i, other);
    long split = 0, step = length;
    do {
        step = (step + 1) / 2;
        if (split + step < length + 1 &&
            prefix_of(keys, count, i, at + (split + step) * d) > common)
            split += step;
    } while (step > 1);
    uint s = (uint)(at + split * d + (d < 0 ? -1 : 0));

    uint l = (uint)(d > 0 ? at : other), r = (uint)(d > 0 ? other : at);
    uint left = level_of(keys, count, l - 1u), right = level_of(keys, count, r);
    uint place = left == right ? 0u : right < left ? 2u * r + 1u : 2u * l;
    nodes[place].first = 2u * s + 1u;
    nodes[place].skip = r + 1u < count ? 2u * r + 2u : BB_NONE;
    place_of_split[s] = place;
}

#if BB_HANDOVER
kernel void link_boxes(global const bb_key *keys, global const uint *starts,
                       global const uint *totals, global const uint *values,
                       global const bb_box *boxes, uint ref_count, volatile global uint *ends,
                       volatile global uchar *heights, volatile global bb_node *nodes,
                       global uint *refs, global bb_tree_info *info,
                       global const uint *place_of_split)
{
    uint count = count_leaves(totals, ref_count);
    uint i = get_global_id(0);
    if (i >= count)
        return;
    bb_work w;
    start_leaf(&w, i, starts, values, boxes, refs);
    uint left = level_of(keys, count, i - 1u), right = level_of(keys, count, i);
    if (left == right) {
        write_root((global bb_node *)nodes, info, &w, count, ref_count);
        return;
    }
    uint place = place_of(&w, right < left);
    write_node((global bb_node *)nodes, place, &w, count);
    while (place != 0) {
        bool is_left = (place & 1u) != 0;
        uint s = (place - 1u) / 2u;
        if (!meet(&w, is_left, s, ends, heights, nodes))
            return;
        place = place_of_split[s];
        write_box(nodes + place, &w);
    }
    write_root((global bb_node *)nodes, info, &w, count, ref_count);
}
#endif
