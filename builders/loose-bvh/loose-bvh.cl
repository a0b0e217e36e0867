/* Loose BVH: the binary tree of 3N levels, linked bottom-up from the cells with primitives.
 *
 * Eisemann, Grosch, Mueller, Magnor 2007, section 3.2. Level 3k of the complete binary tree that
 * halves x, y, z in turn is a grid of 2^k cells per axis:
 *
 *   loose_keys    for each primitive: level k = floor(log2(min over the axes of S / O)), clamped to
 *                 0 .. N (equation 3), plus `deeper`, at most N; on each axis cell i = floor(2^k
 *                 (mid - min) / S), at most 2^k - 1 (equation 4); key = in-order index of that node
 *   sort primitives by key
 *   loose_heads   count runs of equal keys
 *   scan the counts
 *   loose_cells   each run is a cell: its start, and the split between it and the next
 *   loose_leaves  for each cell: a leaf with its primitives, their box
 *   loose_spans   the same for cells shared by several work-items
 *   loose_chunks, loose_rest (CPUs), loose_level (GPUs)
 *                 deepest first, for each node with two children, or a child and primitives:
 *                 links, box of the children
 *
 * The paper keeps all 2^(3N + 1) - 1 nodes in an array, clears and refits them all, and lets a node
 * with a single child and no primitives point past it ("skip index"; here: a chain). Here a node is
 * made only if it remains after chains are dropped, which neighbours in the sorted order determine:
 *
 * Keys. From the top bit of 3N + 1 bits: the steps from the root (0 low, 1 high), then a 1, then
 * zeros. Sorted keys give the nodes in-order: those below the low half, the node, those below the
 * high half. All nodes below p differ from p by less than its lowest 1.
 *
 * Splits. The lowest node above or equal to both neighbours s and s + 1 in the order is a node that
 * stays, and all inner nodes that stay are found this way. A node with primitives and children on
 * both sides is found twice, left and right of its own cell: the second split then adds its third
 * child. The node's depth is where the two paths part, or where the shorter one ends.
 *
 * Places. The root is node 0. Split s has the places from bases[s] on: two for the first two
 * children of its node, or one for a third child. So bases[s] = 1 + 2 s - (third children before
 * s). The first child of a node with primitives is the leaf that has them.
 *
 * No work-item waits for another or reads what another has written in the same launch: work-groups
 * hand over only between launches.
 *
 * -DBB_CUBE: the root cell is a cube. -DBB_LANES: boxes whose keys are computed at once, 1 or 8.
 * Limits: 10 levels (32-bit keys); 2^30 primitives. Where sides are denormal a primitive may be
 * nearer to the root than equation 3 says.
 */
#include "bb_device.h"
#include "leaf_boxes.clh"
#include "loose_bvh_shared.h"

#ifndef BB_LANES
#define BB_LANES 1
#endif

/* ---- keys ---- */

/* One axis of several boxes side by side. Cells are converted by way of int, for which every vector
 * unit has a conversion. */
#if BB_LANES == 8
typedef float8 bb_floats;
typedef int8 bb_ints;
typedef uint8 bb_uints;
#define BB_AS_INTS as_int8
#define BB_AS_UINTS as_uint8
#define BB_TO_CELLS(x) as_uint8(convert_int8(x))
#else
typedef float bb_floats;
typedef int bb_ints;
typedef uint bb_uints;
#define BB_AS_INTS as_int
#define BB_AS_UINTS as_uint
#define BB_TO_CELLS(x) (uint)(x)
#endif

/* The root cell: its low corner and its sides, both halved, so that no difference overflows. */
typedef struct root_cell {
    float low[3], whole[3];
} root_cell;

root_cell root_of(global const bb_box *bounds)
{
    root_cell root;
    for (uint axis = 0; axis < 3; axis++) {
        root.low[axis] = 0.5f * bounds->lo[axis];
        root.whole[axis] = 0.5f * bounds->hi[axis] - root.low[axis];
    }
#ifdef BB_CUBE
    float side = BB_MAX(BB_MAX(root.whole[0], root.whole[1]), root.whole[2]);
    root.whole[0] = root.whole[1] = root.whole[2] = side;
#endif
    return root;
}

/* Spreads the bits of cells, at most 10, three places apart. */
bb_uints spread(bb_uints v)
{
    v = (v | (v << 16)) & 0x030000FFu;
    v = (v | (v << 8)) & 0x0300F00Fu;
    v = (v | (v << 4)) & 0x030C30C3u;
    return (v | (v << 2)) & 0x09249249u;
}

/* An axis without extent sets no limit and has one cell. On the others floor(log2(whole / part)) is
 * the difference of the floats' bits, cut to the exponent; a part of 0 sets no limit either. */
bb_uints keys_of(const root_cell *root, const bb_floats *lo, const bb_floats *hi, uint levels,
                 uint deeper)
{
    const bb_ints last = (bb_ints)(int)levels;
    const float cells = (float)(1u << levels);
    bb_ints level = last;
    bb_uints path = (bb_uints)0u;
    for (uint axis = 0; axis < 3; axis++) {
        float whole = root->whole[axis];
        path <<= 1u;
        if (!(whole > 0.0f))
            continue;
        bb_ints part = BB_AS_INTS(0.5f * hi[axis] - 0.5f * lo[axis]);
        bb_ints octaves = ((bb_ints)as_int(whole) - part) >> 23;
        octaves = part != 0 ? octaves : last;
        level = BB_MIN(octaves, level);
        bb_floats middle = 0.5f * (0.5f * lo[axis]) + 0.5f * (0.5f * hi[axis]);
        bb_floats at = (middle - root->low[axis]) / whole * cells;
        at = BB_MIN(at, (bb_floats)(cells - 1.0f));
        path |= spread(BB_TO_CELLS(at));
    }
    level = BB_MAX(level, (bb_ints)0) + (bb_ints)(int)deeper;
    level = BB_MIN(level, last);
    bb_uints dropped = BB_AS_UINTS(3 * (last - level));
    return (path >> dropped << 1u | 1u) << dropped;
}

#if BB_LANES == 8
/* Loads word `word` of eight boxes. */
float8 eight(global const float *words, uint word)
{
    words += word;
    return (float8)(words[0], words[8], words[16], words[24], words[32], words[40], words[48],
                    words[56]);
}
#endif

/* bounds[0]: bounds of the boxes. */
kernel void loose_keys(global const bb_box *restrict boxes, global const bb_box *restrict bounds,
                       uint count, uint levels, uint deeper, global uint *restrict keys,
                       global uint *restrict values)
{
    uint i = get_global_id(0) * BB_LANES;
    if (i >= count)
        return;
    const root_cell root = root_of(bounds);
    bb_floats lo[3], hi[3];
#if BB_LANES == 8
    if (count - i >= 8u) {
        global const float *words = (global const float *)(boxes + i);
        for (uint axis = 0; axis < 3; axis++) {
            lo[axis] = eight(words, axis);
            hi[axis] = eight(words, 4u + axis);
        }
        vstore8(keys_of(&root, lo, hi, levels, deeper), i >> 3, keys);
        vstore8(i + (uint8)(0, 1, 2, 3, 4, 5, 6, 7), i >> 3, values);
        return;
    }
#endif
    for (uint end = BB_MIN(i + BB_LANES, count); i < end; i++) {
        for (uint axis = 0; axis < 3; axis++) {
            lo[axis] = (bb_floats)boxes[i].lo[axis];
            hi[axis] = (bb_floats)boxes[i].hi[axis];
        }
#if BB_LANES == 8
        keys[i] = keys_of(&root, lo, hi, levels, deeper).s0;
#else
        keys[i] = keys_of(&root, lo, hi, levels, deeper);
#endif
        values[i] = i;
    }
}

/* ---- cells ---- */

/* A split, in a byte: the depth of its node plus 1; whether the node is the cell to the right, or
 * the cell to the left, or the latter and the split adds a third child. 0: outside of the order. */
#define BB_SPLIT_DEPTH 31u
#define BB_SPLIT_RIGHT 32u
#define BB_SPLIT_LEFT 64u
#define BB_SPLIT_THIRD 128u

uint lowest_one(uint key)
{
    return key & -key;
}

/* Returns whether node p is above node q. */
bool is_above(uint p, uint q)
{
    return p != q && abs_diff(p, q) < lowest_one(p);
}

/* Returns the split between two neighbours in the order, without BB_SPLIT_THIRD. Its depth is the
 * highest bit at which the paths part or one of them ends. */
uint split_of(uint left, uint right, uint bits)
{
    uint left_end = lowest_one(left), right_end = lowest_one(right);
    uint ends = (left ^ right) | left_end | right_end;
    return (bits + clz(ends) - 30u) | (ends < 2u * right_end ? BB_SPLIT_RIGHT : 0u) |
           (ends < 2u * left_end ? BB_SPLIT_LEFT : 0u);
}

/* Returns whether the split before the cell that begins at i > 0 only adds a third child: the cell
 * before it is above its neighbours on both sides. The beginning of that cell, which may have any
 * number of primitives, is found by steps that double, then halve. */
bool adds_third(global const uint *keys, uint i)
{
    uint own = keys[i - 1u], start = i - 1u, step = 1;
    if (!is_above(own, keys[i]))
        return false;
    for (; start >= step && keys[start - step] == own; step *= 2u)
        start -= step;
    while (step > 0u)
        if (start >= step && keys[start - step] == own)
            start -= step;
        else
            step /= 2u;
    return start > 0u && is_above(own, keys[start - 1u]);
}

bool is_head(global const uint *keys, uint i)
{
    return i == 0u || keys[i] != keys[i - 1u];
}

/* heads: cells that begin in each chunk; then, for all chunks, third children. */
kernel void loose_heads(global const uint *restrict keys, uint count, uint chunk, uint chunks,
                        global uint *restrict heads)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk, found = 0, third = 0;
    for (uint i = begin; i < end; i++)
        if (is_head(keys, i)) {
            found++;
            third += i > 0u && adds_third(keys, i) ? 1u : 0u;
        }
    heads[get_global_id(0)] = found;
    heads[chunks + get_global_id(0)] = third;
}

/* heads: scanned, so heads[chunks] is the number of cells, and third children are counted from
 * there. totals: numbers of cells and third children. starts: one entry more than cells. firsts,
 * lasts: first cell of the node that ends at a cell, last cell of the node that begins there; here
 * the cell itself. spans: see loose_leaves. */
kernel void loose_cells(global const uint *restrict keys, uint count, uint chunk, uint chunks,
                        uint bits, global const uint *restrict heads, global uint *restrict totals,
                        global uint *restrict cells, global uint *restrict starts,
                        global uint *restrict bases, global uchar *restrict splits,
                        global uint *restrict firsts, global uint *restrict lasts,
                        global uint *restrict spans)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk;
    uint c = heads[get_global_id(0)], third = heads[chunks + get_global_id(0)] - heads[chunks];
    for (uint k = 0; k < BB_LOOSE_SPAN_WORDS; k++)
        spans[get_global_id(0) * BB_LOOSE_SPAN_WORDS + k] = 0xFFFFFFFFu;
    for (uint i = begin; i < end; i++)
        if (is_head(keys, i)) {
            uint split = i > 0u ? split_of(keys[i - 1u], keys[i], bits) : 0u;
            if ((split & BB_SPLIT_LEFT) != 0u && adds_third(keys, i)) {
                split ^= BB_SPLIT_LEFT | BB_SPLIT_THIRD;
                third++;
            }
            splits[c] = (uchar)split;
            cells[c] = keys[i];
            starts[c] = i;
            bases[c] = 1u + 2u * c - third;
            firsts[c] = c;
            lasts[c] = c;
            c++;
        }
    if (end == count) {
        starts[c] = count;
        splits[c] = 0;
        totals[0] = c;
        totals[1] = third;
    }
}

/* ---- where nodes go ---- */

/* The cells in order, and the tree that is made from them. */
typedef struct loose {
    global const uint *bases;
    global const uchar *splits; /* left of each cell, and of the end */
    uint count;                 /* number of cells */
    uint thirds;
    uint prims;
    global bb_node *nodes;
    global uchar *heights;
    global bb_tree_info *info;
} loose;

/* Returns the place of a node over the cells first .. last, other than a leaf with the primitives
 * of a node that has children. Its parent is at the deeper of the splits around it. */
uint place_of(const loose *l, uint first, uint last)
{
    uint before = l->splits[first], after = l->splits[last + 1u];
    if ((before | after) == 0u)
        return 0u;
    if ((after & BB_SPLIT_DEPTH) > (before & BB_SPLIT_DEPTH)) /* after the parent's leaf, if any */
        return l->bases[last] + ((after & BB_SPLIT_RIGHT) != 0u ? 1u : 0u);
    return l->bases[first - 1u] + ((before & BB_SPLIT_THIRD) != 0u ? 0u : 1u);
}

/* Returns the skip of a node that ends with cell `last`, other than such a leaf. */
uint skip_of(const loose *l, uint last)
{
    uint after = l->splits[last + 1u];
    while ((after & BB_SPLIT_RIGHT) != 0u) {
        /* the parent's own cell comes next: its leaf came first, its upper half may follow */
        last++;
        after = l->splits[last + 1u];
        if ((after & BB_SPLIT_THIRD) != 0u)
            return l->bases[last];
    }
    return after != 0u ? l->bases[last] + 1u : BB_NONE;
}

void write_info(const loose *l, uint height)
{
    bb_tree_info found;
    found.root = 0;
    found.node_count = 2u * l->count - 1u - l->thirds;
    found.leaf_count = l->count;
    found.ref_count = l->prims;
    found.arity = l->count == 1u ? 0u : l->thirds > 0u ? 3u : 2u;
    found.depth = height;
    *l->info = found;
}

/* ---- leaves ---- */

void write_leaf(const loose *l, uint c, uint start, float4 lo, float4 hi)
{
    uint place, skip;
    if ((l->splits[c] & BB_SPLIT_RIGHT) != 0u) { /* has children on the left */
        place = l->bases[c - 1u];
        skip = place + 1u;
    } else if ((l->splits[c + 1u] & BB_SPLIT_LEFT) != 0u) { /* all children are on the right */
        place = l->bases[c];
        skip = place + 1u;
    } else {
        place = place_of(l, c, c);
        skip = skip_of(l, c);
    }
    bb_write_node(l->nodes, place, lo, hi, BB_LEAF_BIT | start, skip);
    l->heights[place] = 0;
    if (place == 0u)
        write_info(l, 0);
}

/* Converts floats to integers of the same order. */
uint ordered(float f)
{
    uint bits = as_uint(f);
    return bits >> 31 ? ~bits : bits | 0x80000000u;
}

float from_ordered(uint bits)
{
    return as_float(bits >> 31 ? bits & 0x7FFFFFFFu : ~bits);
}

/* span: lo, then the complement of hi, so that minima are taken of all words; all bits set
 * before. */
void join_span(volatile global uint *span, float4 lo, float4 hi)
{
    atomic_min(span, ordered(lo.x));
    atomic_min(span + 1, ordered(lo.y));
    atomic_min(span + 2, ordered(lo.z));
    atomic_min(span + 3, ~ordered(hi.x));
    atomic_min(span + 4, ~ordered(hi.y));
    atomic_min(span + 5, ~ordered(hi.z));
}

/* A cell may have all primitives. Those in one chunk are joined by one work-item; the parts of a
 * cell that continues in further chunks are joined in the span of the chunk where it begins. 0 is
 * added so that no box has a -0, which would depend on the order of joins. */
kernel void loose_leaves(global const uint *restrict values, global const bb_box *restrict boxes,
                         uint count, uint chunk, global const uint *restrict heads,
                         global const uint *restrict starts, global const uint *bases,
                         global const uchar *splits, global const uint *totals,
                         volatile global uint *spans, global uint *restrict refs,
                         global bb_node *nodes, global uchar *heights, global bb_tree_info *info)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk;
    const loose l = {bases, splits, totals[0], totals[1], count, nodes, heights, info};
    uint c = heads[get_global_id(0)]; /* first cell that begins here */
    if (starts[c] > begin)
        c--;
    for (uint i = begin; i < end; c++) {
        uint start = starts[c], stop = starts[c + 1u], to = BB_MIN(stop, end);
        float4 lo = (float4)(INFINITY), hi = (float4)(-INFINITY);
        for (; i < to; i++) {
            bb_join_box_ahead(values, boxes, i, end, &lo, &hi);
            refs[i] = values[i] | (i + 1u == stop ? BB_LAST_BIT : 0u);
        }
        lo += 0.0f;
        hi += 0.0f;
        if (start >= begin && stop <= end)
            write_leaf(&l, c, start, lo, hi);
        else
            join_span(spans + BB_LOOSE_SPAN_WORDS * (start / chunk), lo, hi);
    }
}

/* Makes the leaf of the last cell that begins in each chunk, if it continues in the next. */
kernel void loose_spans(uint count, uint chunk, uint chunks, global const uint *restrict heads,
                        global const uint *restrict starts, global const uint *bases,
                        global const uchar *splits, global const uint *totals,
                        global const uint *spans, global bb_node *nodes, global uchar *heights,
                        global bb_tree_info *info)
{
    uint n = get_global_id(0);
    if (n >= chunks)
        return;
    uint c = (n + 1u < chunks ? heads[n + 1u] : totals[0]) - 1u;
    if (starts[c] / chunk != n || (starts[c + 1u] - 1u) / chunk == n)
        return;
    const loose l = {bases, splits, totals[0], totals[1], count, nodes, heights, info};
    global const uint *span = spans + BB_LOOSE_SPAN_WORDS * n;
    float4 lo = (float4)(from_ordered(span[0]), from_ordered(span[1]), from_ordered(span[2]), 0.0f);
    float4 hi =
        (float4)(from_ordered(~span[3]), from_ordered(~span[4]), from_ordered(~span[5]), 0.0f);
    write_leaf(&l, c, starts[c], lo, hi);
}

/* ---- inner nodes ---- */

/* Makes the node of the split between cells s and s + 1, which does not add a third child. The
 * node's children are finished. */
void make_inner(const loose *l, uint s, global uint *firsts, global uint *lasts)
{
    uint first = firsts[s], last = lasts[s + 1u], child = l->bases[s];
    global const float *box = (global const float *)(l->nodes + child);
    float4 lo = BB_MIN(vload4(0, box), vload4(2, box));
    float4 hi = BB_MAX(vload4(1, box), vload4(3, box));
    uint height = BB_MAX((uint)l->heights[child], (uint)l->heights[child + 1u]);
    if ((l->splits[s + 1u] & BB_SPLIT_RIGHT) != 0u && (l->splits[s + 2u] & BB_SPLIT_THIRD) != 0u) {
        uint third = l->bases[s + 1u];
        box = (global const float *)(l->nodes + third);
        lo = BB_MIN(vload4(0, box), lo);
        hi = BB_MAX(vload4(1, box), hi);
        height = BB_MAX((uint)l->heights[third], height);
        last = lasts[s + 2u];
    }
    uint place = place_of(l, first, last);
    bb_write_node(l->nodes, place, lo, hi, child, skip_of(l, last));
    l->heights[place] = (uchar)(height + 1u);
    firsts[last] = first;
    lasts[first] = last;
    if (place == 0u)
        write_info(l, height + 1u);
}

/* Handles all splits of one depth, given plus 1; deeper ones are finished. */
kernel void loose_level(global const uint *bases, global const uchar *splits,
                        global const uint *totals, uint prims, uint depth, global uint *firsts,
                        global uint *lasts, global bb_node *nodes, global uchar *heights,
                        global bb_tree_info *info)
{
    uint s = get_global_id(0);
    const loose l = {bases, splits, totals[0], totals[1], prims, nodes, heights, info};
    if (s + 1u < l.count && (splits[s + 1u] & (BB_SPLIT_DEPTH | BB_SPLIT_THIRD)) == depth)
        make_inner(&l, s, firsts, lasts);
}

/* A split waits until a less deep one, or the end, follows. Waiting splits get strictly deeper, so
 * there is at most one of each depth. */
#define BB_WAIT_MAX 32u

/* Handles the splits in each chunk of cells, in order, whose nodes are inside of the chunk. rest:
 * the other splits, in order, BB_LOOSE_REST_MAX entries per chunk. */
kernel void loose_chunks(global const uint *bases, global const uchar *splits,
                         global const uint *totals, uint prims, uint chunk, global uint *firsts,
                         global uint *lasts, global bb_node *nodes, global uchar *heights,
                         global bb_tree_info *info, global uint *restrict rest,
                         global uint *restrict rest_counts)
{
    const loose l = {bases, splits, totals[0], totals[1], prims, nodes, heights, info};
    uint begin = get_global_id(0) * chunk, left = 0, top = 0;
    uint waiting[BB_WAIT_MAX], depths[BB_WAIT_MAX];
    rest_counts[get_global_id(0)] = 0;
    if (begin >= l.count)
        return;
    rest += get_global_id(0) * BB_LOOSE_REST_MAX;
    uint end = l.count - begin < chunk ? l.count : begin + chunk;
    uint outside = splits[begin] & BB_SPLIT_DEPTH;
    for (uint s = begin; s < end; s++) {
        uint split = splits[s + 1u], depth = split & BB_SPLIT_DEPTH;
        if ((split & BB_SPLIT_THIRD) != 0u)
            continue;
        for (; top > 0u && depths[top - 1u] > depth; top--) {
            if (top == 1u && outside >= depths[0])
                rest[left++] = waiting[0];
            else
                make_inner(&l, waiting[top - 1u], firsts, lasts);
        }
        if (depth > 0u) {
            waiting[top] = s;
            depths[top++] = depth;
        }
    }
    for (uint i = 0; i < top; i++)
        rest[left++] = waiting[i];
    rest_counts[get_global_id(0)] = left;
}

/* Handles the splits that remain of all chunks, in one work-item. */
kernel void loose_rest(global const uint *bases, global const uchar *splits,
                       global const uint *totals, uint prims, uint chunks, global uint *firsts,
                       global uint *lasts, global bb_node *nodes, global uchar *heights,
                       global bb_tree_info *info, global const uint *restrict rest,
                       global const uint *restrict rest_counts)
{
    const loose l = {bases, splits, totals[0], totals[1], prims, nodes, heights, info};
    uint waiting[BB_WAIT_MAX], depths[BB_WAIT_MAX], top = 0;
    if (get_global_id(0) > 0u)
        return;
    for (uint n = 0; n < chunks; n++)
        for (uint i = 0; i < rest_counts[n]; i++) {
            uint s = rest[n * BB_LOOSE_REST_MAX + i], depth = splits[s + 1u] & BB_SPLIT_DEPTH;
            for (; top > 0u && depths[top - 1u] > depth; top--)
                make_inner(&l, waiting[top - 1u], firsts, lasts);
            waiting[top] = s;
            depths[top++] = depth;
        }
    for (; top > 0u; top--)
        make_inner(&l, waiting[top - 1u], firsts, lasts);
}
