/* The wide layouts: from pair nodes (layout_pair.cl) to nodes of up to BB_WIDTH children, and from
 * references to blocks of primitives.
 *
 *   plan, bottom-up; the last of a pair's two sides to come hands over to it (handover.clh)
 *                                                (wide_parents, wide_plan, or plan_leaves and
 *                                                plan_level)
 *     cost(p, 1) = A(p) + cost(p as BB_WIDTH)               p becomes a node
 *     cost(p, n) = min over k of cost(left, k) + cost(right, n - k), or cost(p, n - 1)      p makes
 *     way for up to n of those below it
 *   level by level from the root: open the pair by its plan, mark it; those of its children that
 *   are pairs are the next
 *     level; keep the sides of pairs that it takes in, in place of its plan       (wide_open)
 *   index = exclusive scan of the marks                    (framework/device/primitives.h): nodes
 *   keep the order of the tree in memory
 *   for each marked pair: write the node of its sides      (wide_nodes)
 *   first[i] = exclusive scan of the blocks that the leaf at reference i needs     (wide_count)
 *   for each leaf: write its blocks                        (wide_blocks)
 *
 * When only boxes and positions have changed: layout_wide_follow.cl, and wide_blocks again.
 *
 * Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
 * BVHs", section 3.1 (the plan: of all collapses the one with the least area, leaves being given),
 * 3.2 (8 bits per plane), 3.4 (places by octant). Reads any tree.
 */
#include "bb_device.h"

#include "handover.clh"
#include "prims.clh"
#include "wide_boxes.clh"

#define OPEN_LATER 64

/* Words from one pair's opened sides to the next's. */
#define OPENED_WORDS (sizeof(bb_wide_plan) / sizeof(uint))

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

/* Cost of what `link` leads to, as up to `places` children. */
float plan_cost(volatile global const bb_wide_plan *plans, uint link, uint places)
{
    return (link & BB_LEAF_BIT) != 0 ? 0.0f : plans[link].cost[places - 1u];
}

void plan_pair(global const bb_pair *pairs, uint p, volatile global bb_wide_plan *plans)
{
    float size[3];
    for (uint axis = 0; axis < 3; axis++) {
        global const float *planes = pairs[p].planes + 4u * axis;
        float lo = BB_MIN(planes[0], planes[1]), hi = BB_MAX(planes[2], planes[3]);
        size[axis] = BB_MIN(hi - lo, FLT_MAX); /* infinity times 0 would have no order */
    }
    float area = bb_half_area(size[0], size[1], size[2]);
    uint left = pairs[p].links[0], right = pairs[p].links[1], splits = 0;
    float best[BB_WIDTH + 1];
    for (uint places = 2; places <= BB_WIDTH; places++) {
        best[places] = INFINITY;
        uint split = 0;
        for (uint k = 1; k < places; k++) {
            float cost = plan_cost(plans, left, k) + plan_cost(plans, right, places - k);
            if (split == 0u || cost < best[places]) {
                best[places] = cost;
                split = k;
            }
        }
        splits |= split << 4u * (places - 1u);
    }
    best[1] = area + best[BB_WIDTH];
    for (uint places = 2; places < BB_WIDTH; places++)
        if (best[places - 1u] <= best[places]) {
            best[places] = best[places - 1u];
            splits &= ~(15u << 4u * (places - 1u));
        }
    for (uint places = 1; places < BB_WIDTH; places++)
        plans[p].cost[places - 1u] = best[places];
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

kernel void plan_level(global const bb_pair *pairs, uint root, global const uint *parents,
                       volatile global uint *missing, volatile global bb_wide_plan *plans,
                       global const uint *level, uint number, volatile global uint *counts,
                       global uint *next)
{
    uint count = counts[number];
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        uint p = level[i];
        plan_pair(pairs, p, plans);
        if (p != root && atomic_dec(&missing[parents[p]]) == 1u)
            bb_put_on_list(parents[p], number, counts, next);
    }
}

/* What the wide node that pair `root` becomes takes in: sides of pairs, 2 * pair + side, one per
 * child, left to right. How many; the rest of `sides` is BB_NONE. */
uint opened_sides(global const bb_pair *pairs, global const bb_wide_plan *plans, uint root,
                  uint sides[BB_WIDTH])
{
    uint2 stack[BB_WIDTH]; /* side of a pair, places */
    uint top = 0, count = 0;
    uint split = plans[root].splits >> 4u * (BB_WIDTH - 1u) & 15u;
    stack[top++] = (uint2)(2u * root + 1u, BB_WIDTH - split);
    stack[top++] = (uint2)(2u * root, split);
    while (top > 0u) {
        uint2 item = stack[--top];
        uint link = pairs[item.x >> 1].links[item.x & 1u], places = item.y;
        split = 0;
        if ((link & BB_LEAF_BIT) == 0)
            for (; places > 1u && split == 0u; places -= split == 0u ? 1u : 0u)
                split = plans[link].splits >> 4u * (places - 1u) & 15u;
        if (split != 0u) {
            stack[top++] = (uint2)(2u * link + 1u, places - split);
            stack[top++] = (uint2)(2u * link, split);
        } else {
            sides[count++] = item.x;
        }
    }
    for (uint c = count; c < BB_WIDTH; c++)
        sides[c] = BB_NONE;
    return count;
}

/* Pairs that one work-item has still to open. */
typedef struct open_list {
    uint2 items[OPEN_LATER]; /* pair, stack need above */
    uint count;
    uint need; /* the largest stack need met */
} open_list;

/* Opens a pair. Those of its children that are pairs go on the list, the last first, or, where it
 * is full, to the next level. An opened pair's plan is not needed any more: `opened` is in its
 * place. */
void open_pair(global const bb_pair *pairs, global const bb_wide_plan *plans, uint2 item,
               open_list *list, global uint *marks, global uint *opened,
               volatile global uint *next_count, global uint2 *next)
{
    uint sides[BB_WIDTH];
    uint children = opened_sides(pairs, plans, item.x, sides);
    uint need = item.y + children - 1u;
    list->need = BB_MAX(need, list->need);
    marks[item.x] = 1u;
    for (uint c = 0; c < BB_WIDTH; c++)
        opened[(ulong)item.x * OPENED_WORDS + c] = sides[c];
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

/* One level, and from level `deeper` on all that is below it, as long as the list has room: what
 * lies together is then opened one after the other. state[0]: the largest stack need so far;
 * state[1 + level]: items of the level. */
kernel void wide_open(global const bb_pair *pairs, global const bb_wide_plan *plans,
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
        open_pair(pairs, plans, level[i], &list, marks, opened, next_count, next);
        while (number >= deeper && list.count > 0u)
            open_pair(pairs, plans, list.items[--list.count], &list, marks, opened,
                      next_count, next);
    }
    if (list.need > 0u)
        atomic_max(&state[0], list.need);
}

/* Boxes of the children that a node has in its places. */
void put_boxes(global const bb_pair *pairs, const uint sides[BB_WIDTH], bb_wide_boxes *boxes)
{
    bb_wide_clear(boxes);
    for (uint c = 0; c < BB_WIDTH; c++) {
        if (sides[c] == BB_NONE)
            continue;
        global const float *planes = pairs[sides[c] >> 1].planes + (sides[c] & 1u);
        for (uint axis = 0; axis < 3; axis++) {
            boxes->planes[2u * axis * BB_WIDTH + c] = planes[4u * axis];
            boxes->planes[(2u * axis + 1u) * BB_WIDTH + c] = planes[4u * axis + 2u];
        }
        boxes->places |= 1u << c;
    }
}

#if BB_WIDTH == 8
/* Puts the first `count` sides in places such that place ^ octant is roughly the order in which
 * rays of that octant meet them: bit a of an octant is set where rays go down axis a, bit a of a
 * place where its child should lie high on axis a. The pair of child and place that fits best
 * first. */
void arrange(const bb_wide_boxes *boxes, uint count, uint sides[BB_WIDTH])
{
    float fit[BB_WIDTH][BB_WIDTH]; /* of child and place */
    uint arranged[BB_WIDTH];
    uint children = 0, places = 0; /* done */
    for (uint c = 0; c < BB_WIDTH; c++)
        arranged[c] = BB_NONE;
    for (uint c = 0; c < count; c++)
        for (uint place = 0; place < BB_WIDTH; place++) {
            fit[c][place] = 0.0f;
            for (uint axis = 0; axis < 3; axis++) {
                const float *plane = boxes->planes + 2u * axis * BB_WIDTH + c;
                float middle = 0.5f * plane[0] + 0.5f * plane[BB_WIDTH];
                fit[c][place] += (place >> axis & 1u) != 0u ? middle : -middle;
            }
        }
    for (uint i = 0; i < count; i++) {
        uint child = BB_NONE, place = 0;
        for (uint c = 0; c < count; c++)
            for (uint p = 0; p < BB_WIDTH; p++)
                if (((children >> c | places >> p) & 1u) == 0u &&
                    (child == BB_NONE || fit[c][p] > fit[child][place])) {
                    child = c;
                    place = p;
                }
        children |= 1u << child;
        places |= 1u << place;
        arranged[place] = sides[child];
    }
    for (uint c = 0; c < BB_WIDTH; c++)
        sides[c] = arranged[c];
}
#endif

/* What a leaf's link becomes. `single`: primitives are records in the order of the references. */
uint leaf_link(global const uint *first, uint ref, uint single)
{
    return BB_LEAF_BIT | (single != 0u ? ref : first[ref]);
}

/* first[] and index[] are the scans. sides: of each place of each node, for layouts that follow. */
kernel void wide_nodes(global const bb_pair *pairs, uint count, global const uint *opened,
                       global const uint *index, global const uint *first, uint ref_count,
                       uint single, uint octants, global bb_wide *nodes, global uint *sides)
{
    uint p = get_global_id(0);
    if (p >= count || index[p] == index[p + 1u])
        return;
    global bb_wide *node = nodes + index[p];
    bb_wide_boxes boxes;
    uint own[BB_WIDTH], children = 0;
    for (uint c = 0; c < BB_WIDTH; c++) {
        own[c] = opened[(ulong)p * OPENED_WORDS + c];
        children += own[c] != BB_NONE ? 1u : 0u;
    }
    put_boxes(pairs, own, &boxes);
#if BB_WIDTH == 8
    if (octants != 0u) {
        arrange(&boxes, children, own);
        put_boxes(pairs, own, &boxes);
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

/* ---- primitives ---- */

/* Primitives of each kind in the leaf that starts at reference i. */
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
    uint counts[BB_KIND_COUNT], total = 0;
    leaf_kinds(refs, i, &ends, counts);
    for (uint kind = 0; kind < BB_KIND_COUNT; kind++)
        total += (counts[kind] + BB_BLOCK_LANES - 1u) / BB_BLOCK_LANES;
    blocks[i] = total;
}

/* A block that nothing can hit. */
void block_empty(global uint *block, uint words, uint id_word, uint kind)
{
    uint empty = as_uint(NAN);
#define BB_EMPTY(NAME, name, words, kept) empty = kind == BB_##NAME ? BB_##NAME##_EMPTY : empty;
    BB_PRIM_KINDS(BB_EMPTY)
#undef BB_EMPTY
    for (uint w = 0; w < words; w++)
        block[w] = empty;
    for (uint lane = 0; lane < BB_BLOCK_LANES; lane++)
        block[id_word + lane] = BB_NONE;
}

/* fresh = 0: the blocks have held the same primitives before, so that empty lanes are empty. */
kernel void wide_blocks(global const uint *refs, uint count, global const float *vertices,
                        global const uint *data, bb_prim_ends ends, float scale, uint format,
                        uint words, global const uint *first, uint fresh, global uint *blocks)
{
    uint i = get_global_id(0);
    uint id_word = words - BB_BLOCK_LANES;
    /* what the links of places without a child lead to, whatever the scene's kinds */
    if (i == count)
        block_empty(blocks + (ulong)first[i] * words, words, id_word, BB_KIND_COUNT);
    if (i >= count || (i > 0u && (refs[i - 1u] & BB_LAST_BIT) == 0))
        return;
    uint next[BB_KIND_COUNT]; /* counts, then lanes */
    uint block = first[i], end = first[i + 1u];
    leaf_kinds(refs, i, &ends, next);
    for (uint kind = 0; kind < BB_KIND_COUNT; kind++) {
        uint last_block = block + (next[kind] + BB_BLOCK_LANES - 1u) / BB_BLOCK_LANES;
        next[kind] = block * BB_BLOCK_LANES;
        for (; block < last_block; block++)
            if (fresh != 0)
                block_empty(blocks + (ulong)block * words, words, id_word, kind);
    }
    for (bool last = false; !last; i++) {
        last = (refs[i] & BB_LAST_BIT) != 0;
        uint prim = refs[i] & BB_INDEX_MASK;
        uint place = next[bb_prim_kind(prim, &ends)]++;
        global uint *lane =
            blocks + (ulong)(place / BB_BLOCK_LANES) * words + place % BB_BLOCK_LANES;
        bb_prim_write(lane, BB_BLOCK_LANES, format, prim, data, vertices, &ends, scale);
        lane[id_word] = prim;
    }
    blocks[(ulong)(end - 1u) * words + id_word] |= BB_LAST_BIT;
}
