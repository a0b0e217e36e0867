/* The wide layouts made directly from a binary tree whose leaves have one reference each, without
 * pairs: the same nodes and blocks as by layout_wide.cl, bit for bit, for CPUs. Includes leaf
 * collapse.
 *
 *   one work-item cuts the tree into enough subtrees for all cores                     (direct_cut)
 *   for each subtree: bottom-up with a private stack, leaf collapse (collapse_cost.clh) and the
 *     plan (wide_plan.clh), or the area for greedy; one word is kept per node         (direct_plan)
 *   one work-item: the same above the subtrees; then opens nodes there, from the root (direct_top)
 *   for each node below that is to be opened: opens it and all below it; marks        (direct_open)
 *   pack the marks into bits, count and scan them: nodes keep their order in memory  (direct_count)
 *   blocks of leaves and wide nodes: layout_wide_direct_write.cl
 *
 * Data of a work-item stays in its cache, except for the tree itself, which is read twice. The only
 * atomic is for the stack's need; there is no fence.
 */
#include "bb_device.h"

#include "collapse_cost.clh"
#include "wide_blocks.clh"
#include "wide_direct.clh"

/* ---- the cut ---- */

/* Returns the first reference below a node. */
uint leftmost(global const bb_node *nodes, uint n)
{
    uint first = nodes[n].first;
    while ((first & BB_LEAF_BIT) == 0)
        first = nodes[first].first;
    return first & BB_INDEX_MASK;
}

/* Runs in one work-item. Opens nodes with more than `share` references, breadth first, until there
 * are `most` pieces. If the references are in another order than the leaves the sizes are wrong,
 * which only affects the balance. */
kernel void direct_cut(global const bb_node *nodes, uint root, uint ref_count, uint share,
                       uint most, global bb_direct_piece *pieces, global bb_direct_state *state)
{
    uint count = 1;
    bb_direct_piece whole = {root, 0u, ref_count, BB_NONE};
    pieces[0] = whole;
    for (uint at = 0; at < count; at++) {
        bb_direct_piece piece = pieces[at];
        uint first = nodes[piece.node].first;
        if ((first & BB_LEAF_BIT) != 0 || piece.end - piece.begin <= share || count + 2u > most)
            continue;
        uint right = nodes[first].skip, middle = leftmost(nodes, right);
        bb_direct_piece left_piece = {first, piece.begin, middle, BB_NONE};
        bb_direct_piece right_piece = {right, middle, piece.end, BB_NONE};
        pieces[at].child = count;
        pieces[count] = left_piece;
        pieces[count + 1u] = right_piece;
        count += 2u;
    }
    state->pieces = count;
    state->queued = 0;
    state->root_is_leaf = 0;
    state->stack_need = 0;
}

/* ---- the plan ---- */

/* `refs`: number of references, and BB_SCATTERED if they are not adjacent. */
typedef struct done {
    bb_costs costs;
    float cost;
    uint begin, refs;
    bool leaf;
} done;

/* Arguments that the whole plan needs. */
typedef struct planner {
    global const bb_node *nodes;
    global uint2 *words;
    bb_cost_model model;
    uint greedy;
} planner;

/* Always inlined: with the results in registers a node takes half the time. */
#define BB_INLINED static inline __attribute__((always_inline))

BB_INLINED void plan_leaf(const planner *p, uint n, done *d)
{
    d->costs = (bb_costs)(0.0f);
    d->cost = 0.0f;
    d->begin = p->nodes[n].first & BB_INDEX_MASK;
    d->refs = 1u;
    d->leaf = true;
    if (p->model.max_leaf > 1u) {
        d->cost = bb_collapse_area(p->nodes + n, p->model.scale) * bb_leaf_cost(&p->model, 1u);
        p->words[n] = (uint2)(1u, d->begin);
    }
}

/* Decides on the collapse of node n from its children's results: sets all of *d but the plan's
 * costs. */
BB_INLINED void collapse_node(const planner *p, uint n, const done *left, const done *right,
                              done *d)
{
    const bb_cost_model *model = &p->model;
    uint left_refs = left->refs & BB_INDEX_MASK, many = left_refs + (right->refs & BB_INDEX_MASK);
    bool scattered = ((left->refs | right->refs) & BB_SCATTERED) != 0 ||
                     right->begin != left->begin + left_refs;
    float area = bb_collapse_area(p->nodes + n, model->scale);
    float cost = left->cost + right->cost;
    cost += bb_inner_cost(model, area, 2u);
    d->leaf = bb_better_leaf(model, area, many, &cost);
    d->cost = cost;
    d->begin = left->begin;
    d->refs = many | (scattered ? BB_SCATTERED : 0u);
    if (d->leaf)
        p->words[n] = (uint2)(d->refs, d->begin);
}

/* Handles inner node n, whose children are planned. *d may be one of theirs. */
BB_INLINED void plan_node(const planner *p, uint n, uint left, uint right, const done *l,
                          const done *r, uint flags, done *d)
{
    bb_costs left_costs = l->costs, right_costs = r->costs;
    flags |= (l->leaf ? BB_LEFT_LEAF : 0u) | (r->leaf ? BB_RIGHT_LEAF : 0u) |
             (right != left + 1u ? BB_FAR_RIGHT : 0u);
    d->leaf = false;
    if (p->model.max_leaf > 1u)
        collapse_node(p, n, l, r, d);
    d->costs = (bb_costs)(0.0f);
    if (d->leaf)
        return;
    global const float *a = (global const float *)(p->nodes + left);
    global const float *b = (global const float *)(p->nodes + right);
    float4 a_lo = vload4(0, a), b_lo = vload4(0, b), a_hi = vload4(1, a), b_hi = vload4(1, b);
    float4 size = BB_MAX(b_hi, a_hi) - BB_MIN(b_lo, a_lo);
    float scale = p->model.scale;
    float area = bb_finite_half_area(size.x * scale, size.y * scale, size.z * scale);
    uint splits;
    if (p->greedy != 0u) {
        splits = (uint)bb_greedy_size(area);
    } else if ((flags & (BB_LEFT_LEAF | BB_RIGHT_LEAF)) == (BB_LEFT_LEAF | BB_RIGHT_LEAF)) {
        /* the result of bb_plan_pair() for leaves */
        splits = (area > 0.0f ? 1u << 4u : 0u) | 1u << 4u * (BB_WIDTH - 1u);
        d->costs.s0 = area;
    } else {
        d->costs = bb_plan_pair(left_costs, right_costs, area, &splits);
    }
    p->words[n] = (uint2)(splits | flags, left);
}

/* Inner nodes whose left children are being planned, or are planned. */
typedef struct waiting {
    done left;
    uint node, first;
    bool has_left;
} waiting;

/* How many nodes ahead of a leaf memory is prefetched: in most trees leaves are in order. */
#define BB_AHEAD 96u

/* Plans node n and all below it. */
BB_INLINED void plan_subtree(const planner *p, uint n, done *d)
{
    waiting stack[BB_DIRECT_DEPTH];
    uint top = 0;
    for (;;) {
        uint first = p->nodes[n].first;
        while ((first & BB_LEAF_BIT) == 0) {
            stack[top].node = n;
            stack[top].first = first;
            stack[top].has_left = false;
            top++;
            n = first;
            first = p->nodes[n].first;
        }
        BB_PREFETCH(p->nodes + n + BB_AHEAD);
        BB_PREFETCH(p->nodes + n + BB_AHEAD + 1u);
        plan_leaf(p, n, d);
        while (top > 0u && stack[top - 1u].has_left) {
            top--;
            uint left = stack[top].first;
            plan_node(p, stack[top].node, left, p->nodes[left].skip, &stack[top].left, d, 0u, d);
        }
        if (top == 0u)
            return;
        stack[top - 1u].left = *d;
        stack[top - 1u].has_left = true;
        n = p->nodes[stack[top - 1u].first].skip;
    }
}

void put_done(const done *d, global bb_direct_done *at)
{
    BB_VECTOR(vstore, BB_WIDTH)(d->costs, 0, at->costs);
    at->cost = d->cost;
    at->begin = d->begin;
    at->refs = d->refs;
    at->leaf = d->leaf ? 1u : 0u;
}

done get_done(global const bb_direct_done *at)
{
    done d;
    d.costs = BB_VECTOR(vload, BB_WIDTH)(0, at->costs);
    d.cost = at->cost;
    d.begin = at->begin;
    d.refs = at->refs;
    d.leaf = at->leaf != 0u;
    return d;
}

kernel void direct_plan(global const bb_node *nodes, float scale, float traversal,
                        float intersection, uint max_leaf, uint greedy,
                        global const bb_direct_piece *pieces, global const bb_direct_state *state,
                        global uint2 *words, global bb_direct_done *results)
{
    /* every 32nd piece: drivers give neighbours to one core, and the subtrees are the last
     * pieces */
    uint i = get_global_id(0) % 32u * (BB_DIRECT_PIECES / 32u) + get_global_id(0) / 32u;
    if (i >= state->pieces || pieces[i].child != BB_NONE)
        return;
    const bb_cost_model model = {scale, traversal, intersection, BB_BLOCK_LANES, max_leaf};
    const planner p = {nodes, words, model, greedy};
    done d;
    plan_subtree(&p, pieces[i].node, &d);
    put_done(&d, results + i);
}

/* ---- which nodes become wide nodes ---- */

/* Arguments for opening nodes. `collapsed`: leaves have blocks. one_kind: the scene has primitives
 * of one kind. */
typedef struct opener {
    global const bb_node *nodes;
    global const uint *refs;
    global const uint2 *words;
    global uchar *marks;
    bb_prim_ends ends;
    uint collapsed, one_kind, greedy;
} opener;

/* Sides are nodes, with BB_LEAF_BIT for leaves. */
typedef struct bb_side_source {
    global const bb_node *nodes;
    global const uint2 *words;
} bb_side_source;

#include "wide_sides.clh"

uint bb_side_link(const bb_side_source *source, uint side)
{
    (void)source;
    return side;
}

uint2 bb_node_sides(const bb_side_source *source, uint n)
{
    uint2 word = source->words[n];
    return (uint2)(bb_left_side(word), bb_right_side(source->nodes, word));
}

uint bb_node_splits(const bb_side_source *source, uint n)
{
    return source->words[n].x;
}

int bb_node_size(const bb_side_source *source, uint n)
{
    return (int)(source->words[n].x & ~15u);
}

/* Returns the number of blocks of the leaf that node n became. */
uint blocks_of_leaf(const opener *o, uint n)
{
    uint2 word = o->words[n];
    if (o->one_kind != 0u)
        return ((word.x & BB_INDEX_MASK) + BB_BLOCK_LANES - 1u) / BB_BLOCK_LANES;
    uint prims[BB_LEAF_MAX], counts[BB_KIND_COUNT];
    bb_count_kinds(prims, bb_direct_prims(o->nodes, o->refs, n, word, prims), &o->ends, counts);
    return bb_blocks_of(counts);
}

/* Marks node n and the leaves of its wide node. Puts children that are nodes into sides[] and
 * returns their number. *need: entries of the stack. */
uint open_node(const opener *o, uint n, uint sides[BB_WIDTH], uint *need)
{
    uint own[BB_WIDTH], inner = 0;
    const bb_side_source source = {o->nodes, o->words};
    uint children = o->greedy != 0u ? bb_greedy_sides(&source, n, own)
                                    : bb_planned_sides(&source, n, own);
    for (uint c = 0; c < children; c++)
        BB_PREFETCH(o->words + (own[c] & BB_INDEX_MASK) + 4u * BB_AHEAD);
    *need += children - 1u;
    o->marks[n] = BB_MARK_NODE;
    for (uint c = 0; c < children; c++)
        if ((own[c] & BB_LEAF_BIT) == 0)
            sides[inner++] = own[c];
        else if (o->collapsed != 0u)
            o->marks[own[c] & BB_INDEX_MASK] = (uchar)blocks_of_leaf(o, own[c] & BB_INDEX_MASK);
    return inner;
}

/* Runs in one work-item. Plans the nodes above the subtrees and opens them. Nodes in subtrees stay
 * on the queue, each with the stack's need above it. */
kernel void direct_top(global const bb_node *nodes, global const uint *refs, bb_prim_ends ends,
                       float scale, float traversal, float intersection, uint max_leaf, uint greedy,
                       uint root, global const bb_direct_piece *pieces,
                       global uint2 *words,
                       global bb_direct_done *results, global uchar *marks, uint one_kind,
                       global uint2 *queue, global bb_direct_state *state)
{
    const bb_cost_model model = {scale, traversal, intersection, BB_BLOCK_LANES, max_leaf};
    const planner p = {nodes, words, model, greedy};
    const opener o = {nodes, refs, words, marks, ends, max_leaf > 1u ? 1u : 0u, one_kind, greedy};
    for (uint i = state->pieces; i-- > 0u;) {
        uint child = pieces[i].child;
        if (child == BB_NONE)
            continue;
        done left = get_done(results + child), right = get_done(results + child + 1u);
        done d = left;
        plan_node(&p, pieces[i].node, pieces[child].node, pieces[child + 1u].node, &left, &right,
                  BB_TOP, &d);
        put_done(&d, results + i);
    }
    if (results[0].leaf != 0u) {
        state->root_is_leaf = 1u;
        if (max_leaf > 1u)
            marks[root] = (uchar)blocks_of_leaf(&o, root);
        return;
    }
    uint count = 1, deepest = 0;
    queue[0] = (uint2)(root, 0u);
    for (uint at = 0; at < count; at++) {
        uint2 item = queue[at];
        if ((words[item.x].x & BB_TOP) == 0u)
            continue;
        uint sides[BB_WIDTH], need = item.y;
        uint inner = open_node(&o, item.x, sides, &need);
        deepest = BB_MAX(need, deepest);
        for (uint c = 0; c < inner; c++)
            queue[count++] = (uint2)(sides[c], need);
    }
    state->queued = count;
    state->stack_need = deepest;
}

kernel void direct_open(global const bb_node *nodes, global const uint *refs, bb_prim_ends ends,
                        uint collapsed, uint one_kind, uint greedy, global const uint2 *words,
                        global uchar *marks, global const uint2 *queue,
                        volatile global bb_direct_state *state)
{
    const opener o = {nodes, refs, words, marks, ends, collapsed, one_kind, greedy};
    uint2 stack[(BB_WIDTH - 1) * BB_DIRECT_DEPTH + 1];
    uint top = 0, deepest = 0, sides[BB_WIDTH];
    for (uint i = get_global_id(0); i < state->queued; i += (uint)get_global_size(0)) {
        if ((words[queue[i].x].x & BB_TOP) != 0u)
            continue;
        stack[top++] = queue[i];
        while (top > 0u) {
            uint2 item = stack[--top];
            uint need = item.y, inner = open_node(&o, item.x, sides, &need);
            deepest = BB_MAX(need, deepest);
            while (inner > 0u)
                stack[top++] = (uint2)(sides[--inner], need);
        }
    }
    atomic_max(&state->stack_need, deepest);
}

/* ---- numbers ---- */

/* For each word of marks: bits[], and its numbers of wide nodes and of blocks of leaves. */
kernel void direct_count(global const ulong *marks, uint words, global ulong *bits,
                         global uint *nodes, global uint *blocks)
{
    uint w = get_global_id(0);
    if (w > words)
        return;
    ulong all = 0;
    uint sum = 0;
    for (uint k = 0; k < BB_DIRECT_WORD / 8 && w < words; k++) {
        ulong eight = marks[(ulong)w * (BB_DIRECT_WORD / 8) + k];
        ulong nodes_of = eight >> 7 & 0x0101010101010101ul;
        /* one bit per byte; the sum of the bytes */
        all |= (nodes_of * 0x0102040810204080ul >> 56) << 8u * k;
        sum += (uint)((eight & 0x7F7F7F7F7F7F7F7Ful) * 0x0101010101010101ul >> 56);
    }
    bits[w] = all;
    nodes[w] = (uint)popcount(all);
    blocks[w] = sum;
}
