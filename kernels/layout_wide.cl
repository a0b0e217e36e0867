/* The wide layouts: converts pair nodes (layout_pair.cl) to nodes of up to BB_WIDTH children, and
 * references to blocks of primitives.
 *
 *   for each pair, bottom-up; the last of its two sides to finish goes on with it (handover.clh):
 *       its costs as 1, 2, ... children, and its splits (wide_plan.clh); not for the greedy plan
 *                                  (wide_parents, then wide_plan, or plan_leaves and plan_level)
 *   for each pair of the level, from the root down:                                   (wide_open)
 *       open it by its plan, and mark it
 *       store the sides of the pairs that it absorbs, in place of its plan
 *       its children that are pairs form the next level
 *   index = exclusive scan of the marks: nodes keep the order of the tree in memory
 *   for each marked pair: write the node of its sides                                (wide_nodes)
 *   first[i] = exclusive scan of the blocks that the leaf at reference i needs       (wide_count)
 *   for each leaf: write its blocks                                                 (wide_blocks)
 *
 * If only boxes and positions have changed: layout_wide_follow.cl, and wide_blocks again.
 *
 * Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
 * BVHs": the plan (the collapse with the least area for given leaves) and places by octant. The
 * paper's text was not at hand (wide_plan.clh). Their node is made by layout_cwbvh.cl; nodes of 128
 * bytes with 8 bits per plane are our own. Accepts any tree.
 */
#include "bb_device.h"

#include "handover.clh"
#include "wide_blocks.clh"
#include "wide_boxes.clh"
#include "wide_plan.clh"

#define OPEN_LATER 64

/* ---- which pairs become nodes ---- */

kernel void wide_parents(global const bb_pair *pairs, uint count, global uint *parents,
                         global uint *missing, global uint *marks)
{
    uint p = get_global_id(0);
    if (p > count)
        return;
    marks[p] = 0;
    if (p == count)
        return;
    uint inner = 0;
    for (uint side = 0; side < 2; side++)
        if ((pairs[p].links[side] & BB_LEAF_BIT) == 0) {
            parents[pairs[p].links[side]] = p;
            inner++;
        }
    missing[p] = inner;
}

/* Returns the costs of the subtree at `link`. */
bb_costs plan_costs(volatile global const bb_wide_plan *plans, uint link)
{
    float costs[BB_WIDTH];
    if ((link & BB_LEAF_BIT) != 0)
        return (bb_costs)(0.0f);
    for (uint n = 0; n + 1u < BB_WIDTH; n++)
        costs[n] = plans[link].cost[n];
    costs[BB_WIDTH - 1] = 0.0f;
    return BB_VECTOR(vload, BB_WIDTH)(0, costs);
}

void plan_pair(global const bb_pair *pairs, uint p, volatile global bb_wide_plan *plans)
{
    uint splits;
    float costs[BB_WIDTH];
    bb_costs best = bb_plan_pair(plan_costs(plans, pairs[p].links[0]),
                                 plan_costs(plans, pairs[p].links[1]), pairs[p].area, &splits);
    BB_VECTOR(vstore, BB_WIDTH)(best, 0, costs);
    for (uint n = 0; n + 1u < BB_WIDTH; n++)
        plans[p].cost[n] = costs[n];
    plans[p].splits = splits;
}

#if BB_HANDOVER
kernel void wide_plan(global const bb_pair *pairs, uint count, uint root,
                      global const uint *parents, volatile global uint *missing,
                      volatile global bb_wide_plan *plans)
{
    uint p = get_global_id(0);
    if (p >= count || (pairs[p].links[0] & pairs[p].links[1] & BB_LEAF_BIT) == 0)
        return;
    plan_pair(pairs, p, plans);
    while (p != root) {
        p = parents[p];
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            return;
        BB_DEVICE_FENCE();
        plan_pair(pairs, p, plans);
    }
}
#endif

kernel void plan_leaves(global const bb_pair *pairs, uint count, uint root,
                        global const uint *parents, volatile global uint *missing,
                        volatile global bb_wide_plan *plans, volatile global uint *counts,
                        global uint *next)
{
    uint p = get_global_id(0);
    if (p >= count || (pairs[p].links[0] & pairs[p].links[1] & BB_LEAF_BIT) == 0)
        return;
    plan_pair(pairs, p, plans);
    if (p != root && atomic_dec(&missing[parents[p]]) == 1u)
        bb_put_on_list(parents[p], 0u, counts, next);
}

void plan_listed(uint p, global const bb_pair *pairs, uint root, global const uint *parents,
                 volatile global uint *missing, volatile global bb_wide_plan *plans, uint number,
                 volatile global uint *counts, global uint *next)
{
    plan_pair(pairs, p, plans);
    if (p != root && atomic_dec(&missing[parents[p]]) == 1u)
        bb_put_on_list(parents[p], number, counts, next);
}

kernel void plan_level(global const bb_pair *pairs, uint root, global const uint *parents,
                       volatile global uint *missing, volatile global bb_wide_plan *plans,
                       global uint *list, uint number, volatile global uint *counts,
                       global uint *next)
{
#define PLAN(p) plan_listed(p, pairs, root, parents, missing, plans, number, counts, next)
    BB_FOR_LISTS(PLAN, 1u)
}

/* ---- what a wide node absorbs: sides of pairs, 2 * pair + side ---- */

typedef struct bb_side_source {
    global const bb_pair *pairs;
    global const bb_wide_plan *plans;
} bb_side_source;

#include "wide_sides.clh"

uint bb_side_link(const bb_side_source *source, uint side)
{
    return source->pairs[side >> 1].links[side & 1u];
}

uint2 bb_node_sides(const bb_side_source *source, uint pair)
{
    return (uint2)(2u * pair, 2u * pair + 1u);
}

uint bb_node_splits(const bb_side_source *source, uint pair)
{
    return source->plans[pair].splits;
}

int bb_node_size(const bb_side_source *source, uint pair)
{
    return bb_greedy_size(source->pairs[pair].area);
}

/* Pairs that one work-item still has to open. */
typedef struct open_list {
    uint2 items[OPEN_LATER]; /* pair, stack need above */
    uint count;
    uint need; /* largest stack need found */
} open_list;

/* Returns the most stack entries for one node: one for each child but the first or, for a
 * compressed node, one for all. */
uint stack_need(global const bb_pair *pairs, const uint sides[BB_WIDTH], uint children)
{
#if BB_COMPRESSED
    uint inner = 0;
    for (uint c = 0; c < children; c++)
        inner += (pairs[sides[c] >> 1].links[sides[c] & 1u] & BB_LEAF_BIT) == 0 ? 1u : 0u;
    return inner > 1u ? 1u : 0u;
#else
    return children - 1u;
#endif
}

/* Opens a pair. Its children that are pairs go on the list, the last first, or, if it is full, to
 * the next level. The pair's plan is no longer needed: `opened` takes its place. */
void open_pair(global const bb_pair *pairs, global const bb_wide_plan *plans, uint greedy,
               uint2 item, open_list *list, global uint *marks, global uint *opened,
               volatile global uint *next_count, global uint2 *next)
{
    uint sides[BB_WIDTH];
    const bb_side_source source = {pairs, plans};
    uint children = greedy != 0u ? bb_greedy_sides(&source, item.x, sides)
                                 : bb_planned_sides(&source, item.x, sides);
    uint need = item.y + stack_need(pairs, sides, children);
    list->need = BB_MAX(need, list->need);
    marks[item.x] = 1u;
    for (uint c = 0; c < BB_WIDTH; c++)
        opened[(ulong)item.x * BB_OPENED_WORDS + c] = c < children ? sides[c] : BB_NONE;
    for (uint c = children; c-- > 0u;) {
        uint link = pairs[sides[c] >> 1].links[sides[c] & 1u];
        if ((link & BB_LEAF_BIT) != 0)
            continue;
        if (list->count < OPEN_LATER)
            list->items[list->count++] = (uint2)(link, need);
        else
            next[atomic_inc(next_count)] = (uint2)(link, need);
    }
}

/* Opens one level and, from level `deeper` on, everything below it as long as the list has room, so
 * that neighbours are opened one after the other. state[0]: largest stack need so far. state[1 +
 * level]: number of items of the level. */
kernel void wide_open(global const bb_pair *pairs, global const bb_wide_plan *plans, uint greedy,
                      global const uint2 *level, uint number, uint deeper,
                      volatile global uint *state, global uint *marks, global uint *opened,
                      global uint2 *next)
{
    uint count = state[1u + number];
    volatile global uint *next_count = &state[2u + number];
    open_list list;
    list.need = 0;
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        list.count = number < deeper ? OPEN_LATER : 0u;
        open_pair(pairs, plans, greedy, level[i], &list, marks, opened, next_count, next);
        while (number >= deeper && list.count > 0u)
            open_pair(pairs, plans, greedy, list.items[--list.count], &list, marks, opened,
                      next_count, next);
    }
    if (list.need > 0u)
        atomic_max(&state[0], list.need);
}

#if !BB_COMPRESSED /* layout_cwbvh.cl writes compressed nodes */
/* Returns a leaf's link in the layout. `single`: primitives are records in the order of the
 * references. */
uint leaf_link(global const uint *first, uint ref, uint single)
{
    return BB_LEAF_BIT | (single != 0u ? ref : first[ref]);
}

/* first[], index[]: the scans. sides: the side at each place of each node, for layouts that
 * follow. */
kernel void wide_nodes(global const bb_pair *pairs, uint count, global const uint *opened,
                       global const uint *index, global const uint *first, uint ref_count,
                       uint single, uint octants, global bb_wide *nodes, global uint *sides)
{
    uint p = get_global_id(0);
    if (p >= count || index[p] == index[p + 1u])
        return;
    global bb_wide *node = nodes + index[p];
    bb_wide_boxes boxes;
    uint own[BB_WIDTH], children = bb_wide_take_opened(opened, p, own);
    bb_wide_put_pairs(pairs, own, &boxes);
#if BB_WIDTH == 8
    if (octants != 0u) {
        bb_wide_arrange(&boxes, children, own);
        bb_wide_put_pairs(pairs, own, &boxes);
    }
#endif
    bb_wide_write(&boxes, node);
    for (uint c = 0; c < BB_WIDTH; c++) {
        uint link = leaf_link(first, ref_count, single); /* the block without primitives */
        if (own[c] != BB_NONE) {
            link = pairs[own[c] >> 1].links[own[c] & 1u];
            link = (link & BB_LEAF_BIT) != 0 ? leaf_link(first, link & BB_INDEX_MASK, single)
                                             : index[link];
        }
        node->links[c] = link;
        sides[(ulong)index[p] * BB_WIDTH + c] = own[c];
    }
    node->count = children;
    for (uint w = 0; w < sizeof(node->pad) / sizeof(uint); w++)
        node->pad[w] = 0;
}
#endif

/* ---- primitives ---- */

/* Counts the primitives of each kind in the leaf that starts at reference i. */
void leaf_kinds(global const uint *refs, uint i, const bb_prim_ends *ends,
                uint counts[BB_KIND_COUNT])
{
    for (uint kind = 0; kind < BB_KIND_COUNT; kind++)
        counts[kind] = 0;
    for (bool last = false; !last; i++) {
        last = (refs[i] & BB_LAST_BIT) != 0;
        counts[bb_prim_kind(refs[i] & BB_INDEX_MASK, ends)]++;
    }
}

kernel void wide_count(global const uint *refs, uint count, bb_prim_ends ends, global uint *blocks)
{
    uint i = get_global_id(0);
    if (i > count)
        return;
    blocks[i] = 0;
    if (i == count || (i > 0u && (refs[i - 1u] & BB_LAST_BIT) == 0))
        return;
    uint counts[BB_KIND_COUNT];
    leaf_kinds(refs, i, &ends, counts);
    blocks[i] = bb_blocks_of(counts);
}

/* fresh = 0: the blocks have held the same primitives before, so that empty lanes are already
 * empty. */
kernel void wide_blocks(global const uint *refs, uint count, global const float *vertices,
                        global const uint *data, bb_prim_ends ends, float scale, uint format,
                        uint words, global const uint *first, uint fresh, global uint *blocks)
{
    uint i = get_global_id(0);
    const bb_block_writer writer = {vertices, data, ends, scale, format, words, fresh, blocks};
    /* the target of links at places without a child, for any kinds in the scene */
    if (i == count)
        bb_block_empty(&writer, first[i], BB_KIND_COUNT);
    if (i >= count || (i > 0u && (refs[i - 1u] & BB_LAST_BIT) == 0))
        return;
    uint next[BB_KIND_COUNT]; /* counts, then lanes */
    leaf_kinds(refs, i, &ends, next);
    bb_blocks_begin(&writer, first[i], next);
    bool last = false;
    for (uint at = i; !last; at++) {
        last = (refs[at] & BB_LAST_BIT) != 0;
        bb_blocks_put(&writer, refs[at] & BB_INDEX_MASK, next);
    }
    bb_blocks_end(&writer, first[i + 1u]);
}
