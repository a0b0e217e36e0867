/* HLBVH (Garanzha, Pantaleoni, McAllister 2011) as builders/hlbvh/hlbvh.c defines it, by slow
 * recursion over a radix tree of 30-bit Morton codes that is given: each plane is tried by going
 * through all clusters. */
#ifndef BB_TEST_HLBVH_REFERENCE_H
#define BB_TEST_HLBVH_REFERENCE_H

#include "framework/builder/tree.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MORTON_BITS = 30, AUTO_BITS = 99 };

/* The builder's options. */
typedef struct hlbvh_choice {
    uint32_t top_bits; /* or AUTO_BITS */
    uint32_t each, bins;
    bool by_prims;
} hlbvh_choice;

typedef struct item {
    bb_box box;
    uint32_t root; /* in the radix tree */
    uint32_t size; /* primitives */
    float centroid[3];
    uint32_t bin[3];
} item;

typedef struct hlbvh_reference {
    const bb_tree *radix; /* in preorder, a primitive per leaf */
    const hlbvh_choice *choice;
    float unit;
    uint32_t *codes; /* of the radix tree's leaves, in order */
    uint32_t clusters;
    bb_node *nodes; /* the tree, in preorder */
    uint32_t *refs;
    uint32_t node_count, ref_count, depth;
} hlbvh_reference;

/* ---- codes and clusters ---- */

static inline float middle_of(const bb_node *leaf, int k)
{
    return 0.5f * leaf->lo[k] + 0.5f * leaf->hi[k];
}

static inline uint32_t morton_of(const bb_node *leaf, const float low[3], const float high[3])
{
    uint32_t cells[3], code = 0;
    for (int k = 0; k < 3; k++) {
        double extent = (double)high[k] - (double)low[k], per_unit = 1024 / extent;
        float scale = extent > 0 && per_unit <= FLT_MAX ? (float)per_unit : 0;
        float cell = (middle_of(leaf, k) - low[k]) * scale;
        cells[k] = cell < 1023 ? (uint32_t)cell : 1023;
    }
    for (int bit = 9; bit >= 0; bit--)
        for (int k = 0; k < 3; k++)
            code = code << 1 | (cells[k] >> bit & 1);
    return code;
}

static inline void make_reference_codes(hlbvh_reference *r)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    const bb_node *end = r->radix->nodes + r->radix->info.node_count;
    uint32_t at = 0;
    for (const bb_node *n = r->radix->nodes; n < end; n++)
        for (int k = 0; k < 3 && bb_node_is_leaf(n); k++) {
            low[k] = fminf(low[k], middle_of(n, k));
            high[k] = fmaxf(high[k], middle_of(n, k));
        }
    for (const bb_node *n = r->radix->nodes; n < end; n++)
        if (bb_node_is_leaf(n))
            r->codes[at++] = morton_of(n, low, high);
}

static inline bool is_border(const hlbvh_reference *r, uint32_t i, uint32_t bits)
{
    uint32_t differ = r->codes[i - 1] ^ r->codes[i];
    return differ >> (MORTON_BITS - bits) != 0;
}

static inline uint32_t count_clusters(const hlbvh_reference *r, uint32_t bits)
{
    uint32_t count = 1;
    for (uint32_t i = 1; i < r->radix->info.leaf_count; i++)
        count += is_border(r, i, bits);
    return count;
}

static inline uint32_t reference_bits(const hlbvh_reference *r)
{
    const hlbvh_choice *choice = r->choice;
    uint32_t bits = 0;
    if (choice->top_bits != AUTO_BITS)
        return choice->top_bits < MORTON_BITS ? choice->top_bits : MORTON_BITS;
    while (bits < MORTON_BITS &&
           count_clusters(r, bits + 1) <= r->radix->info.leaf_count / choice->each)
        bits++;
    return bits;
}

/* Node of the radix tree over leaves first .. first + size - 1. */
static inline uint32_t node_over(const bb_tree *radix, uint32_t first, uint32_t size)
{
    uint32_t n = 0, l = 0, count = radix->info.leaf_count;
    while (l != first || count != size) {
        uint32_t left = radix->nodes[n].first, right = radix->nodes[left].skip;
        uint32_t left_count = (right - left + 1) / 2;
        bool goes_left = first < l + left_count;
        n = goes_left ? left : right;
        l += goes_left ? 0 : left_count;
        count = goes_left ? left_count : count - left_count;
    }
    return n;
}

static inline item *make_items(hlbvh_reference *r)
{
    const uint32_t bits = reference_bits(r), leaves = r->radix->info.leaf_count;
    r->clusters = count_clusters(r, bits);
    item *items = calloc(r->clusters, sizeof *items);
    uint32_t at = 0, begin = 0;
    for (uint32_t i = 1; i <= leaves; i++) {
        if (i < leaves && !is_border(r, i, bits))
            continue;
        item *it = &items[at++];
        it->root = node_over(r->radix, begin, i - begin);
        it->size = i - begin;
        const bb_node *node = &r->radix->nodes[it->root];
        memcpy(it->box.lo, node->lo, sizeof it->box.lo);
        memcpy(it->box.hi, node->hi, sizeof it->box.hi);
        for (int k = 0; k < 3; k++)
            it->centroid[k] = it->box.lo[k] * (0.5f * r->unit) + it->box.hi[k] * (0.5f * r->unit);
        begin = i;
    }
    return items;
}

/* ---- the top tree ---- */

static inline bb_box box_over(const item *items, uint32_t count)
{
    bb_box box = items[0].box;
    for (uint32_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            if (items[i].box.lo[k] < box.lo[k])
                box.lo[k] = items[i].box.lo[k];
            if (items[i].box.hi[k] > box.hi[k])
                box.hi[k] = items[i].box.hi[k];
        }
    return box;
}

/* Bins per unit, as the device's integers make it: a quotient of 40 bits behind the point. */
static inline float bins_per_unit(float extent, uint32_t bins)
{
    if (!(extent > 0x1p-80f))
        return 0;
    int exponent;
    double fraction = ldexp(frexp((double)extent, &exponent), 24);
    uint64_t quotient = ((uint64_t)bins << 40) / (uint64_t)fraction;
    return (float)ldexp((double)(float)quotient, -40 - (exponent - 24));
}

/* False: the centroids are one on all axes. */
static inline bool make_bins(item *items, uint32_t count, uint32_t bins, bool apart[3])
{
    for (int k = 0; k < 3; k++) {
        float low = INFINITY, high = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            low = fminf(low, items[i].centroid[k]);
            high = fmaxf(high, items[i].centroid[k]);
        }
        float scale = bins_per_unit(high - low, bins);
        apart[k] = scale > 0;
        for (uint32_t i = 0; i < count; i++) {
            float bin = (items[i].centroid[k] - low) * scale;
            items[i].bin[k] = bin < (float)(bins - 1) ? (uint32_t)bin : bins - 1;
        }
    }
    return apart[0] || apart[1] || apart[2];
}

/* Area times weight of the items on one side of a plane; *found: how many they are. */
static inline float side_cost(const hlbvh_reference *r, const item *items, uint32_t count, int axis,
                              uint32_t plane, bool left, uint32_t *found)
{
    item *side = malloc(count * sizeof *side);
    uint32_t weight = 0;
    *found = 0;
    for (uint32_t i = 0; i < count; i++)
        if ((items[i].bin[axis] < plane) == left) {
            side[(*found)++] = items[i];
            weight += r->choice->by_prims ? items[i].size : 1;
        }
    float cost = 0;
    if (*found > 0) {
        bb_box box = box_over(side, *found);
        float s[3];
        for (int k = 0; k < 3; k++)
            s[k] = (box.hi[k] - box.lo[k]) * r->unit;
        cost = (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]) * (float)weight;
    }
    free(side);
    return cost;
}

static inline uint32_t least_of(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* Brings the items of the left side to the front, both sides in order; returns how many. */
static inline uint32_t divide_items(const hlbvh_reference *r, item *items, uint32_t count)
{
    const uint32_t bins = least_of(count, r->choice->bins);
    bool apart[3];
    uint32_t plane = 0, best_left = 0;
    int axis = 3;
    float best = INFINITY;
    if (count == 2)
        return 1;
    make_bins(items, count, bins, apart);
    for (int k = 0; k < 3; k++)
        for (uint32_t p = 1; p < bins && apart[k]; p++) {
            uint32_t left, right;
            float cost = side_cost(r, items, count, k, p, true, &left);
            cost += side_cost(r, items, count, k, p, false, &right);
            if (left == 0 || right == 0)
                continue;
            if (cost < best ||
                (cost == best && least_of(left, right) > least_of(best_left, count - best_left))) {
                best = cost;
                axis = k;
                plane = p;
                best_left = left;
            }
        }
    if (axis == 3)
        return count / 2;
    item *sorted = malloc(count * sizeof *sorted);
    uint32_t at = 0;
    for (int side = 0; side < 2; side++)
        for (uint32_t i = 0; i < count; i++)
            if ((items[i].bin[axis] < plane) == (side == 0))
                sorted[at++] = items[i];
    memcpy(items, sorted, count * sizeof *items);
    free(sorted);
    return best_left;
}

/* The next node; as an inner one, whose first child follows. */
static inline bb_node *write_reference_node(hlbvh_reference *r, const float lo[3],
                                            const float hi[3], uint32_t skip, uint32_t depth)
{
    bb_node *node = &r->nodes[r->node_count++];
    memcpy(node->lo, lo, sizeof node->lo);
    memcpy(node->hi, hi, sizeof node->hi);
    node->first = r->node_count;
    node->skip = skip;
    r->depth = depth > r->depth ? depth : r->depth;
    return node;
}

static inline void copy_radix(hlbvh_reference *r, uint32_t n, uint32_t skip, uint32_t depth)
{
    const bb_node *from = &r->radix->nodes[n];
    bb_node *node = write_reference_node(r, from->lo, from->hi, skip, depth);
    if (bb_node_is_leaf(from)) {
        node->first = BB_LEAF_BIT | r->ref_count;
        r->refs[r->ref_count++] = r->radix->refs[from->first & ~BB_LEAF_BIT];
        return;
    }
    uint32_t right = r->radix->nodes[from->first].skip;
    copy_radix(r, from->first, r->node_count + (right - from->first), depth + 1);
    copy_radix(r, right, skip, depth + 1);
}

static inline void make_top(hlbvh_reference *r, item *items, uint32_t count, uint32_t skip,
                            uint32_t depth)
{
    if (count == 1) {
        copy_radix(r, items[0].root, skip, depth);
        return;
    }
    bb_box box = box_over(items, count);
    write_reference_node(r, box.lo, box.hi, skip, depth);
    uint32_t left = divide_items(r, items, count), leaves = 0;
    for (uint32_t i = 0; i < left; i++)
        leaves += items[i].size;
    make_top(r, items, left, r->node_count + 2 * leaves - 1, depth + 1);
    make_top(r, items + left, count - left, skip, depth + 1);
}

static inline void free_hlbvh_reference(hlbvh_reference *r)
{
    free(r->codes);
    free(r->nodes);
    free(r->refs);
}

/* `radix` and `choice` must outlive this. */
static inline void make_hlbvh_reference(hlbvh_reference *r, const bb_tree *radix,
                                        const hlbvh_choice *choice)
{
    const bb_node *root = &radix->nodes[0];
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)root->hi[k] - (double)root->lo[k]);
    int exponent = longest > 0 ? ilogb(longest) + 1 : 0;
    *r = (hlbvh_reference){.radix = radix, .choice = choice};
    r->unit = (float)ldexp(1, exponent > 126 ? -126 : exponent < -126 ? 126 : -exponent);
    r->codes = calloc(radix->info.leaf_count, sizeof *r->codes);
    r->nodes = calloc(radix->info.node_count, sizeof *r->nodes);
    r->refs = calloc(radix->info.leaf_count, sizeof *r->refs);
    make_reference_codes(r);
    item *items = make_items(r);
    make_top(r, items, r->clusters, BB_NONE, 0);
    free(items);
}

#endif
