/* A wide tree straight from sorted keys, in the common format, without a binary tree in between.
 *
 *   open(node): its keys [l, r) are one range
 *       while there are fewer than BB_WIDE_ARITY: cut the range whose keys differ in the first bit
 *           of all, which has the largest cell, if it has more than a leaf, where that bit changes;
 *           equal keys: in halves
 *       each range becomes a child: consecutive nodes, taken from a counter
 *       a range of a leaf: writes references and the union of their boxes
 *
 * On CPUs: one work-item opens nodes breadth first, until all cores have enough (wide_top); the
 * others find all cuts below each of them, depth first, and so how many nodes there will be
 * (wide_cut), make these, and join boxes on their way back (wide_below); one work-item joins the
 * boxes above (wide_roof).
 *
 * On GPUs: all nodes of a level at once, from the root down (wide_level); boxes level by level from
 * the last one up (wide_join). A level's nodes are consecutive.
 *
 * Wide nodes straight from codes, by cutting ranges until a node is full, with leaves of a few
 * primitives: as the Morton builder of Embree 3, which cuts the range of most keys; Wald et al.
 * 2014, "Embree: A Kernel Framework for Efficient CPU Ray Tracing". The largest cell first instead
 * saves a room's primary rays (`interior`) 16 % of their nodes.
 *
 * On GPUs nodes are numbered as they come, so that runs differ, but only in numbers. No work-item
 * waits for another. -DBB_KEY64 for ulong keys; -DBB_WIDE_CPU=1 for the form for CPUs, else 0.
 */
#include "bb_device.h"

#include "fit.clh"
#include "leaf_boxes.clh"
#include "radix_keys.clh"
#include "wide_tree_shared.h"

#ifdef BB_KEY64
typedef ulong16 bb_keys;
#define KEY_LANES(comparison) convert_int16(comparison)
#else
typedef uint16 bb_keys;
#define KEY_LANES(comparison) (comparison)
#endif

/* Arguments that opening needs, and what a work-item found. */
typedef struct opener {
    global const uint *values;
    global const bb_box *boxes;
    global bb_node *nodes;
    global uint *refs;
    uint leaf;   /* most references of a leaf */
    uint ahead;  /* the last reference that the work-item will read is before this one */
    uint leaves; /* made so far */
    uint arity, depth;
} opener;

/* Returns where to cut keys [l, r), at least two of `count`: the first key of the second part. */
uint cut_of(global const bb_key *keys, uint count, uint l, uint r)
{
    bb_key first = keys[l], differ = first ^ keys[r - 1u];
    if (differ == 0)
        return l + (r - l) / 2u;
    uint shift = BB_KEY_BITS - 1u - (uint)clz(differ);
    bb_key head = first >> shift;
    uint at = l, end = r - 1u; /* keys[at] has the bit of the first, keys[end] has not */
#if BB_WIDE_CPU
    /* the last steps, which no predictor foresees, by one vector */
    while (end - at > 15u || (count < 16u && end - at > 1u)) {
#else
    while (end - at > 1u) {
#endif
        uint middle = at + (end - at) / 2u;
        bool same = keys[middle] >> shift == head;
        at = same ? middle : at;
        end = same ? end : middle;
    }
#if BB_WIDE_CPU
    if (count >= 16u) {
        uint base = BB_MIN(at, count - 16u);
        bb_keys heads = vload16(0, keys + base) >> (bb_keys)(shift);
        uint same = bb_bits16(KEY_LANES(heads == (bb_keys)(head))) >> (at - base);
        return at + (uint)popcount(same & ((1u << (end - at)) - 1u));
    }
#endif
    return end;
}

typedef BB_VECTOR(uint, BB_WIDE_ARITY) ranges_uint;
typedef BB_VECTOR(int, BB_WIDE_ARITY) ranges_int;
#define LANES ((ranges_int)(0, 1, 2, 3, 4, 5, 6, 7))
#define ONE_LATER(v) (v).s00123456

/* Returns the lane of the highest rank, the first of equals. *highest: this rank. */
uint first_to_cut(ranges_int ranks, int *highest)
{
    int4 four = max(ranks.lo, ranks.hi);
    int2 two = max(four.lo, four.hi);
    *highest = max(two.x, two.y);
    uint which = bb_bits8(ranks == *highest);
    return 31u - clz(which & (0u - which));
}

/* Returns how early a range is to be cut: 0 for a leaf, else the bits from the first that differs
 * on, and one. */
int rank_of(global const bb_key *keys, uint leaf, uint l, uint r)
{
    bb_key differ = keys[l] ^ keys[r - 1u];
    return r - l <= leaf ? 0 : (int)(BB_KEY_BITS + 1u - (uint)clz(differ));
}

/* Divides keys [l, r), more than a leaf holds. Range c is [cuts[c], cuts[c + 1]); returns their
 * number. */
uint divide(global const bb_key *keys, uint key_count, uint leaf, uint l, uint r,
            uint cuts[BB_WIDE_ARITY + 1])
{
    ranges_uint starts = r;
    starts.s0 = l;
    ranges_int ranks = LANES == 0 ? (ranges_int)(rank_of(keys, leaf, l, r)) : (ranges_int)(0);
    uint count = 1;
    cuts[BB_WIDE_ARITY] = r;
    while (count < BB_WIDE_ARITY) {
        int highest;
        uint range = first_to_cut(ranks, &highest);
        if (highest == 0)
            break;
        vstore8(starts, 0, cuts);
        uint begin = cuts[range], end = cuts[range + 1u];
        uint cut = cut_of(keys, key_count, begin, end);
        ranges_int behind = LANES > (int)range, next = LANES == (int)range + 1;
        starts = behind ? ONE_LATER(starts) : starts;
        ranks = behind ? ONE_LATER(ranks) : ranks;
        starts = next ? (ranges_uint)(cut) : starts;
        ranks = next ? (ranges_int)(rank_of(keys, leaf, cut, end)) : ranks;
        ranks = LANES == (int)range ? (ranges_int)(rank_of(keys, leaf, begin, cut)) : ranks;
        count++;
    }
    vstore8(starts, 0, cuts);
    cuts[count] = r;
    return count;
}

void write_leaf(opener *o, uint node, uint skip, uint l, uint r)
{
    float4 lo = INFINITY, hi = -INFINITY;
    for (uint at = l; at < r; at++) {
        bb_join_box_ahead(o->values, o->boxes, at, o->ahead, &lo, &hi);
        o->refs[at] = o->values[at] | (at + 1u == r ? BB_LAST_BIT : 0u);
    }
    bb_write_node(o->nodes, node, lo, hi, BB_LEAF_BIT | l, skip);
    o->leaves++;
}

/* Makes the children of an item, the first of them node number `first`; the node itself has its
 * `skip`. Returns those that are to be opened, in items[]. */
uint open_item(opener *o, bb_wide_item item, const uint cuts[BB_WIDE_ARITY + 1], uint count,
               uint first, bb_wide_item items[BB_WIDE_ARITY])
{
    uint inner = 0, end = o->nodes[item.node].skip, level = item.level + 1u;
    o->nodes[item.node].first = first;
    o->arity = BB_MAX(count, o->arity);
    o->depth = BB_MAX(level, o->depth);
    for (uint c = 0; c < count; c++) {
        uint skip = c + 1u < count ? first + c + 1u : end;
        if (cuts[c + 1u] - cuts[c] <= o->leaf) {
            write_leaf(o, first + c, skip, cuts[c], cuts[c + 1u]);
            continue;
        }
        bb_wide_item child = {first + c, cuts[c], cuts[c + 1u], level};
        o->nodes[first + c].skip = skip;
        items[inner++] = child;
    }
    return inner;
}

/* Gives an inner node the box around its children. */
void join_children(global bb_node *nodes, uint n)
{
    bb_extent e = bb_no_extent();
    uint first = nodes[n].first, end = nodes[n].skip;
    for (uint c = first; c != end;) {
        bb_extent child = bb_load_node(nodes, c);
        e = bb_joined(e, child);
        c = bb_skip_of(child);
    }
    bb_store_node(nodes, n, e, first, end);
}

/* Makes the root: the tree's only leaf, or an item. Returns whether it is an item. */
bool start_root(opener *o, uint count, bb_wide_item *root)
{
    bb_wide_item item = {0u, 0u, count, 0u};
    *root = item;
    o->nodes[0].skip = BB_NONE;
    if (count > o->leaf)
        return true;
    write_leaf(o, 0u, BB_NONE, 0u, count);
    return false;
}

/* info->node_count counts the nodes that are taken. */
void start_info(volatile global bb_tree_info *info, uint ref_count)
{
    info->root = 0;
    info->node_count = 1;
    info->leaf_count = 0;
    info->ref_count = ref_count;
    info->arity = 0;
    info->depth = 0;
}

void add_to_info(const opener *o, volatile global bb_tree_info *info)
{
    atomic_add(&info->leaf_count, o->leaves);
    atomic_max(&info->arity, o->arity);
    atomic_max(&info->depth, o->depth);
}

#define OPENER(ahead)                                                                              \
    {                                                                                              \
        values, boxes, nodes, refs, leaf, ahead, 0u, 0u, 0u                                        \
    }

#if BB_WIDE_CPU
/* ---- depth first ---- */

#define BB_WIDE_OPENED 0x80000000u /* of an item's level: its children have been made */

/* Runs in one work-item. Opens nodes with more than `share` keys until there are `most` items. */
kernel void wide_top(global const bb_key *keys, global const uint *values,
                     global const bb_box *boxes, uint count, uint leaf, uint share, uint most,
                     global bb_node *nodes, global uint *refs, global bb_tree_info *info,
                     global bb_wide_item *items, global uint *item_count, global uint *counts)
{
    opener o = OPENER(count);
    bb_wide_item root, inner[BB_WIDE_ARITY];
    uint cuts[BB_WIDE_ARITY + 1], listed = 0;
    start_info(info, count);
    if (start_root(&o, count, &root))
        items[listed++] = root;
    for (uint at = 0; at < listed && listed + BB_WIDE_ARITY <= most; at++) {
        bb_wide_item item = items[at];
        if (item.end - item.begin <= share)
            continue;
        uint children = divide(keys, count, leaf, item.begin, item.end, cuts);
        uint first = info->node_count;
        info->node_count += children;
        uint open = open_item(&o, item, cuts, children, first, inner);
        items[at].level |= BB_WIDE_OPENED;
        counts[at] = 0;
        for (uint i = 0; i < open; i++)
            items[listed++] = inner[i];
    }
    item_count[0] = listed;
    add_to_info(&o, info);
}

/* Items in an order that gives all cores their share: drivers give neighbours to one core, and
 * neighbours take equally long. Returns the number of items that there are for none. */
uint item_of(uint turns, global const bb_wide_item *items, uint item_count)
{
    uint id = get_global_id(0), rows = (uint)get_global_size(0) / turns;
    uint i = id % turns * rows + id / turns;
    return i < item_count && (items[i].level & BB_WIDE_OPENED) == 0u ? i : item_count;
}

/* Finds all cuts below each item. For each node, depth first: the number of its ranges, and where
 * all but the first begin. counts[i]: nodes below item i. */
kernel void wide_cut(global const bb_key *keys, uint count, uint leaf, uint turns,
                     global const bb_wide_item *items, global const uint *item_count,
                     global uint *all_cuts, global uint *counts)
{
    uint i = item_of(turns, items, item_count[0]);
    if (i == item_count[0])
        return;
    uint2 stack[BB_WIDE_ARITY * BB_WIDE_LEVELS + 1];
    uint top = 0, nodes = 0, cuts[BB_WIDE_ARITY + 1];
    global uint *out = all_cuts + BB_WIDE_WORDS * (ulong)items[i].begin;
    stack[top++] = (uint2)(items[i].begin, items[i].end);
    while (top > 0u) {
        uint2 range = stack[--top];
        uint children = divide(keys, count, leaf, range.x, range.y, cuts);
        nodes += children;
        *out++ = children;
        for (uint c = 1; c < children; c++)
            *out++ = cuts[c];
        for (uint c = children; c-- > 0u;)
            if (cuts[c + 1u] - cuts[c] > leaf)
                stack[top++] = (uint2)(cuts[c], cuts[c + 1u]);
    }
    counts[i] = nodes;
}

/* Makes all nodes below an item, the first of them number `next`, by its cuts. */
void open_below(opener *o, bb_wide_item item, global const uint *in, uint next)
{
    bb_wide_item stack[BB_WIDE_ARITY * BB_WIDE_LEVELS + 1], inner[BB_WIDE_ARITY];
    uint top = 0, cuts[BB_WIDE_ARITY + 1];
    stack[top++] = item;
    while (top > 0u) {
        item = stack[top - 1u];
        if ((item.level & BB_WIDE_OPENED) != 0u) {
            join_children(o->nodes, item.node);
            top--;
            continue;
        }
        stack[top - 1u].level |= BB_WIDE_OPENED;
        uint children = *in++;
        cuts[0] = item.begin;
        for (uint c = 1; c < children; c++)
            cuts[c] = *in++;
        cuts[children] = item.end;
        for (uint open = open_item(o, item, cuts, children, next, inner); open > 0u; open--)
            stack[top++] = inner[open - 1u];
        next += children;
    }
}

kernel void wide_below(global const uint *values, global const bb_box *boxes, uint leaf, uint turns,
                       global bb_node *nodes, global uint *refs,
                       volatile global bb_tree_info *info, global const bb_wide_item *items,
                       global const uint *item_count, global const uint *all_cuts,
                       global const uint *counts)
{
    uint i = item_of(turns, items, item_count[0]);
    if (i == item_count[0])
        return;
    opener o = OPENER(items[i].end);
    uint next = info->node_count; /* those of the top come first */
    for (uint before = 0; before < i; before++)
        next += counts[before];
    open_below(&o, items[i], all_cuts + BB_WIDE_WORDS * (ulong)items[i].begin, next);
    add_to_info(&o, info);
}

/* Runs in one work-item. */
kernel void wide_roof(global bb_node *nodes, global bb_tree_info *info,
                      global const bb_wide_item *items, global const uint *item_count,
                      global const uint *counts)
{
    for (uint i = item_count[0]; i-- > 0u;) {
        info->node_count += counts[i];
        if ((items[i].level & BB_WIDE_OPENED) != 0u)
            join_children(nodes, items[i].node);
    }
}

#else
/* ---- level by level ---- */

kernel void wide_root(global const bb_key *keys, global const uint *values,
                      global const bb_box *boxes, uint count, uint leaf, global bb_node *nodes,
                      global uint *refs, global bb_tree_info *info, global bb_wide_item *items,
                      global bb_wide_level *levels)
{
    if (get_global_id(0) != 0u)
        return;
    opener o = OPENER(count);
    bb_wide_item root;
    start_info(info, count);
    levels[0].first = 0;
    levels[0].nodes = 1;
    levels[0].items = start_root(&o, count, &root) ? 1u : 0u;
    items[0] = root;
    add_to_info(&o, info);
}

/* Opens the items of level `number`. Those below go on the list `next`. */
kernel void wide_level(global const bb_key *keys, global const uint *values,
                       global const bb_box *boxes, uint count, uint leaf, uint number,
                       global bb_node *nodes, global uint *refs,
                       volatile global bb_tree_info *info,
                       global const bb_wide_item *items, global bb_wide_item *next,
                       volatile global bb_wide_level *levels)
{
    volatile global bb_wide_level *below = &levels[number + 1u];
    uint begin = levels[number].first + levels[number].nodes, open_now = levels[number].items;
    if (get_global_id(0) == 0u)
        below->first = begin;
    for (uint i = get_global_id(0); i < open_now; i += (uint)get_global_size(0)) {
        opener o = OPENER(items[i].end);
        bb_wide_item inner[BB_WIDE_ARITY];
        uint cuts[BB_WIDE_ARITY + 1];
        uint children = divide(keys, count, leaf, items[i].begin, items[i].end, cuts);
        uint first = begin + atomic_add(&below->nodes, children);
        uint open = open_item(&o, items[i], cuts, children, first, inner);
        uint place = atomic_add(&below->items, open);
        for (uint k = 0; k < open; k++)
            next[place + k] = inner[k];
        atomic_add(&info->node_count, children);
        add_to_info(&o, info);
    }
}

/* Joins the boxes below each inner node of level `number`. */
kernel void wide_join(uint number, global bb_node *nodes, global const bb_wide_level *levels)
{
    uint first = levels[number].first, end = first + levels[number].nodes;
    for (uint n = first + (uint)get_global_id(0); n < end; n += (uint)get_global_size(0))
        if ((nodes[n].first & BB_LEAF_BIT) == 0)
            join_children(nodes, n);
}
#endif
