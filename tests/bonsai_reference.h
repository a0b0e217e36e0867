/* Bonsai (Ganestam, Barringer, Doggett, Akenine-Moller 2015) as builders/bonsai/bonsai.c defines
 * it, by slow recursion over a radix tree of codes that is given: each split is tried by going
 * through all that is on either side, and every node sorts. */
#ifndef BB_TEST_BONSAI_REFERENCE_H
#define BB_TEST_BONSAI_REFERENCE_H

#include "framework/builder/tree.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHAIN_MOST = 48, ITEMS_SHARE = 8 };

/* The builder's options. */
typedef struct bonsai_choice {
    uint32_t group;
    double prune;
    bool by_prims;
} bonsai_choice;

/* A node of the tree to be. */
typedef struct twig {
    bb_box box;
    uint32_t size;         /* primitives */
    uint32_t prim;         /* of a leaf */
    struct twig *sides[2]; /* NULL: a leaf */
} twig;

/* What a tree is grown over. */
typedef struct seedling {
    twig *root;
    uint32_t index;
    uint32_t weight;
    float centroid[3];
} seedling;

typedef struct bonsai_reference {
    const bonsai_choice *choice;
    float unit;
    uint32_t groups, items, depth;
    twig *twigs; /* all there are */
    uint32_t twig_count;
    bb_node *nodes; /* the tree, in preorder */
    uint32_t *refs;
    uint32_t node_count, ref_count;
} bonsai_reference;

static inline twig *new_twig(bonsai_reference *r, const bb_box *box)
{
    twig *t = &r->twigs[r->twig_count++];
    t->box = *box;
    t->size = 1;
    return t;
}

static inline void join_box(bb_box *box, const bb_box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = other->lo[k] < box->lo[k] ? other->lo[k] : box->lo[k];
        box->hi[k] = other->hi[k] > box->hi[k] ? other->hi[k] : box->hi[k];
    }
}

static inline float area_of_box(const bb_box *box, float unit)
{
    float s[3];
    for (int k = 0; k < 3; k++)
        s[k] = box->hi[k] * unit - box->lo[k] * unit;
    return s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
}

/* ---- growing by full-sweep SAH ---- */

static int sort_axis;

static inline int compare_seedlings(const void *a, const void *b)
{
    const seedling *s = a, *t = b;
    float x = s->centroid[sort_axis], y = t->centroid[sort_axis];
    if (x != y)
        return x < y ? -1 : 1;
    return s->index < t->index ? -1 : 1;
}

static inline void sort_seedlings(seedling *s, uint32_t count, int axis)
{
    sort_axis = axis;
    qsort(s, count, sizeof *s, compare_seedlings);
}

static inline bb_box box_of_all(const seedling *s, uint32_t count)
{
    bb_box box = s[0].root->box;
    for (uint32_t i = 1; i < count; i++)
        join_box(&box, &s[i].root->box);
    return box;
}

static inline float cost_of_all(const bonsai_reference *r, const seedling *s, uint32_t count)
{
    bb_box box = box_of_all(s, count);
    uint32_t weight = 0;
    for (uint32_t i = 0; i < count; i++)
        weight += s[i].weight;
    return area_of_box(&box, r->unit) * (float)weight;
}

static inline uint32_t lesser(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* Leaves the elements in the order of the split; returns how many are on the left. */
static inline uint32_t split_seedlings(const bonsai_reference *r, seedling *s, uint32_t count,
                                       uint32_t level)
{
    uint32_t best_left = 0;
    int best_axis = 0;
    float best = INFINITY;
    for (int axis = 0; axis < 3 && level < CHAIN_MOST; axis++) {
        sort_seedlings(s, count, axis);
        if (s[0].centroid[axis] == s[count - 1].centroid[axis])
            continue;
        for (uint32_t left = 1; left < count; left++) {
            float cost = cost_of_all(r, s, left);
            cost += cost_of_all(r, s + left, count - left);
            if (cost < best || (cost == best && lesser(left, count - left) >
                                                    lesser(best_left, count - best_left))) {
                best = cost;
                best_axis = axis;
                best_left = left;
            }
        }
    }
    sort_seedlings(s, count, best_axis);
    return best_left > 0 ? best_left : count / 2;
}

/* Two elements cost the same either way: by the first axis that tells them apart, as if costs were
 * looked at. */
static inline twig *grow_reference(bonsai_reference *r, seedling *s, uint32_t count, uint32_t level)
{
    if (count == 1)
        return s[0].root;
    uint32_t left = split_seedlings(r, s, count, count == 2 ? 0 : level);
    bb_box box = box_of_all(s, count);
    twig *t = new_twig(r, &box);
    t->sides[0] = grow_reference(r, s, left, level + 1);
    t->sides[1] = grow_reference(r, s + left, count - left, level + 1);
    t->size = t->sides[0]->size + t->sides[1]->size;
    return t;
}

static inline seedling seedling_of(twig *root, uint32_t index, uint32_t weight)
{
    seedling s = {.root = root, .index = index, .weight = weight};
    for (int k = 0; k < 3; k++)
        s.centroid[k] = 0.5f * root->box.lo[k] + 0.5f * root->box.hi[k];
    return s;
}

/* ---- groups ---- */

static inline uint32_t leaves_below(const bb_tree *radix, uint32_t n)
{
    uint32_t skip = radix->nodes[n].skip;
    return ((skip == BB_NONE ? radix->info.node_count : skip) - n + 1) / 2;
}

static inline twig *grow_group(bonsai_reference *r, const bb_tree *radix, uint32_t n, uint32_t size)
{
    seedling *s = malloc(size * sizeof *s);
    uint32_t found = 0;
    for (uint32_t i = n; found < size; i++) {
        const bb_node *node = &radix->nodes[i];
        if (!bb_node_is_leaf(node))
            continue;
        bb_box box = {0};
        memcpy(box.lo, node->lo, sizeof box.lo);
        memcpy(box.hi, node->hi, sizeof box.hi);
        twig *leaf = new_twig(r, &box);
        leaf->prim = radix->refs[node->first & ~BB_LEAF_BIT];
        s[found] = seedling_of(leaf, found, 1);
        found++;
    }
    twig *root = grow_reference(r, s, size, 0);
    free(s);
    return root;
}

/* The largest subtrees of the radix tree that have few enough leaves, from left to right. */
static inline void grow_groups(bonsai_reference *r, const bb_tree *radix, twig **roots)
{
    for (uint32_t n = 0; n < radix->info.node_count;) {
        uint32_t size = leaves_below(radix, n);
        if (size <= r->choice->group) {
            roots[r->groups++] = grow_group(r, radix, n, size);
            n += 2 * size - 1;
        } else {
            n++;
        }
    }
}

/* ---- pruning ---- */

/* Appends what is left of a subtree. */
static inline void prune_twig(bonsai_reference *r, twig *t, float limit, seedling *items)
{
    if (t->sides[0] != NULL && area_of_box(&t->box, r->unit) > limit) {
        prune_twig(r, t->sides[0], limit, items);
        prune_twig(r, t->sides[1], limit, items);
        return;
    }
    items[r->items] = seedling_of(t, r->items, r->choice->by_prims ? t->size : 1);
    r->items++;
}

static inline void prune_all(bonsai_reference *r, twig *const *roots, uint32_t count,
                             seedling *items)
{
    double sum = 0;
    uint32_t most = count / ITEMS_SHARE > r->groups ? count / ITEMS_SHARE : r->groups;
    for (uint32_t g = 0; g < r->groups; g++)
        sum += area_of_box(&roots[g]->box, r->unit);
    float limit = fmaxf((float)(r->choice->prune * (sum / r->groups)), FLT_MIN);
    do {
        r->items = 0;
        for (uint32_t g = 0; g < r->groups; g++)
            prune_twig(r, roots[g], limit, items);
        limit *= 2;
    } while (r->items > most);
}

/* ---- the tree ---- */

static inline void write_twig(bonsai_reference *r, const twig *t, uint32_t skip, uint32_t depth)
{
    bb_node *node = &r->nodes[r->node_count++];
    memcpy(node->lo, t->box.lo, sizeof node->lo);
    memcpy(node->hi, t->box.hi, sizeof node->hi);
    node->skip = skip;
    r->depth = depth > r->depth ? depth : r->depth;
    if (t->sides[0] == NULL) {
        node->first = BB_LEAF_BIT | r->ref_count;
        r->refs[r->ref_count++] = t->prim;
        return;
    }
    node->first = r->node_count;
    write_twig(r, t->sides[0], r->node_count + 2 * t->sides[0]->size - 1, depth + 1);
    write_twig(r, t->sides[1], skip, depth + 1);
}

static inline void free_bonsai_reference(bonsai_reference *r)
{
    free(r->twigs);
    free(r->nodes);
    free(r->refs);
}

/* `radix`: in preorder, a primitive per leaf. `choice` must outlive this. */
static inline void make_bonsai_reference(bonsai_reference *r, const bb_tree *radix,
                                         const bonsai_choice *choice)
{
    const bb_node *root = &radix->nodes[0];
    const uint32_t count = radix->info.leaf_count;
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)root->hi[k] - (double)root->lo[k]);
    int exponent = longest > 0 ? ilogb(longest) + 1 : 0;
    *r = (bonsai_reference){.choice = choice};
    r->unit = (float)ldexp(1, exponent > 126 ? -126 : exponent < -126 ? 126 : -exponent);
    r->twigs = calloc(3 * (size_t)count, sizeof *r->twigs);
    r->nodes = calloc(2 * (size_t)count, sizeof *r->nodes);
    r->refs = calloc(count, sizeof *r->refs);
    twig **roots = malloc(count * sizeof *roots);
    seedling *items = malloc(count * sizeof *items);
    grow_groups(r, radix, roots);
    prune_all(r, roots, count, items);
    write_twig(r, grow_reference(r, items, r->items, 0), BB_NONE, 0);
    free(roots);
    free(items);
}

#endif
