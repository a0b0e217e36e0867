/* AAC (Gu, He, Fatahalian, Blelloch 2013) as builders/aac/aac.c defines it, by slow recursion over
 * a radix tree that is given: distances are made anew for every comparison, clusters are trees. */
#ifndef BB_TEST_AAC_REFERENCE_H
#define BB_TEST_AAC_REFERENCE_H

#include "framework/builder/tree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { CLUSTERS_MOST = 1024 };

typedef struct cluster {
    bb_box box;
    const struct cluster *left, *right; /* NULL: one primitive */
    uint32_t size;                      /* primitives */
    uint32_t prim;                      /* of a single one */
    uint32_t near;                      /* slot of the nearest, as last looked up */
} cluster;

typedef struct aac_reference {
    const bb_tree *radix; /* in preorder, a primitive per leaf */
    uint32_t delta;
    double epsilon;
    float unit;
    cluster *all; /* 2 * primitives - 1 */
    uint32_t made;
    bb_node *nodes; /* the tree, in preorder */
    uint32_t *refs;
    uint32_t node_count, ref_count, depth;
} aac_reference;

static inline uint32_t reference_goal(const aac_reference *r, uint32_t size)
{
    double c = 0.5 * pow(r->delta, 0.5 + r->epsilon), goal = c * pow(size, 0.5 - r->epsilon);
    return goal < 1.5 ? 1 : (uint32_t)lround(goal);
}

/* The power of two in which the scene is between a half and 1 long. */
static inline float reference_unit(const bb_box *scene)
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)scene->hi[k] - (double)scene->lo[k]);
    int exponent = longest > 0 ? ilogb(longest) + 1 : 0;
    return (float)ldexp(1, exponent > 126 ? -126 : exponent < -126 ? 126 : -exponent);
}

static inline float reference_distance(const aac_reference *r, const cluster *a, const cluster *b)
{
    float side[3];
    for (int k = 0; k < 3; k++)
        side[k] = fmaxf(a->box.hi[k] * r->unit, b->box.hi[k] * r->unit) -
                  fminf(a->box.lo[k] * r->unit, b->box.lo[k] * r->unit);
    return (side[0] * side[1] + side[1] * side[2]) + side[2] * side[0];
}

static inline uint32_t reference_nearest(const aac_reference *r, cluster *const *list,
                                         uint32_t count, uint32_t i)
{
    uint32_t at = i == 0 ? 1 : 0;
    for (uint32_t j = at + 1; j < count; j++)
        if (j != i &&
            reference_distance(r, list[i], list[j]) < reference_distance(r, list[i], list[at]))
            at = j;
    return at;
}

static inline cluster *reference_join(aac_reference *r, const cluster *a, const cluster *b)
{
    cluster *both = &r->all[r->made++];
    *both = (cluster){.box = a->box, .left = a, .right = b, .size = a->size + b->size};
    for (int k = 0; k < 3; k++) {
        if (b->box.lo[k] < a->box.lo[k])
            both->box.lo[k] = b->box.lo[k];
        if (b->box.hi[k] > a->box.hi[k])
            both->box.hi[k] = b->box.hi[k];
    }
    return both;
}

/* Who has lost its nearest looks again; who had the last as its nearest finds it in its new
 * slot. */
static inline void reference_look_again(const aac_reference *r, cluster **list, uint32_t count,
                                        uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t near = list[i]->near;
        if (i == a || near == a || near == b)
            list[i]->near = reference_nearest(r, list, count, i);
        else if (near == count)
            list[i]->near = b;
    }
}

/* Combines list[0 .. count - 1] until `target` are left; returns how many are. */
static inline uint32_t reference_combine(aac_reference *r, cluster **list, uint32_t count,
                                         uint32_t target)
{
    if (count <= target)
        return count;
    for (uint32_t i = 0; i < count; i++)
        list[i]->near = reference_nearest(r, list, count, i);
    while (count > target) {
        uint32_t one = 0;
        for (uint32_t i = 1; i < count; i++)
            if (reference_distance(r, list[i], list[list[i]->near]) <
                reference_distance(r, list[one], list[list[one]->near]))
                one = i;
        uint32_t two = list[one]->near, a = one < two ? one : two, b = one < two ? two : one;
        list[a] = reference_join(r, list[a], list[b]);
        list[b] = list[--count];
        if (count > 1)
            reference_look_again(r, list, count, a, b);
    }
    return count;
}

static inline uint32_t reference_leaves(const aac_reference *r, uint32_t n)
{
    const bb_node *node = &r->radix->nodes[n];
    uint32_t end = node->skip == BB_NONE ? r->radix->info.node_count : node->skip;
    return (end - n + 1) / 2;
}

static inline cluster *reference_primitive(aac_reference *r, const bb_node *leaf)
{
    cluster *c = &r->all[r->made++];
    *c = (cluster){.size = 1, .prim = r->radix->refs[leaf->first & ~BB_LEAF_BIT] & ~BB_LAST_BIT};
    for (int k = 0; k < 3; k++) {
        c->box.lo[k] = leaf->lo[k];
        c->box.hi[k] = leaf->hi[k];
    }
    return c;
}

/* The clusters of node n of the radix tree, at most CLUSTERS_MOST. */
static inline uint32_t reference_build(aac_reference *r, uint32_t n, cluster **list)
{
    const bb_node *node = &r->radix->nodes[n];
    const uint32_t size = reference_leaves(r, n);
    uint32_t count = 0;
    if (size < r->delta) {
        for (uint32_t k = n; count < size; k++)
            if (bb_node_is_leaf(&r->radix->nodes[k]))
                list[count++] = reference_primitive(r, &r->radix->nodes[k]);
        return reference_combine(r, list, count, reference_goal(r, r->delta));
    }
    count = reference_build(r, node->first, list);
    count += reference_build(r, r->radix->nodes[node->first].skip, list + count);
    assert(count <= CLUSTERS_MOST);
    return reference_combine(r, list, count, reference_goal(r, size));
}

/* In preorder a subtree over k primitives takes 2k - 1 nodes. */
static inline void reference_write(aac_reference *r, const cluster *c, uint32_t skip,
                                   uint32_t depth)
{
    uint32_t n = r->node_count++;
    bb_node *node = &r->nodes[n];
    r->depth = depth > r->depth ? depth : r->depth;
    for (int k = 0; k < 3; k++) {
        node->lo[k] = c->box.lo[k];
        node->hi[k] = c->box.hi[k];
    }
    node->skip = skip;
    if (c->left == NULL) {
        node->first = BB_LEAF_BIT | r->ref_count;
        r->refs[r->ref_count++] = c->prim | BB_LAST_BIT;
        return;
    }
    node->first = n + 1;
    reference_write(r, c->left, n + 2 * c->left->size, depth + 1);
    reference_write(r, c->right, skip, depth + 1);
}

static inline void free_aac_reference(aac_reference *r)
{
    free(r->all);
    free(r->nodes);
    free(r->refs);
}

/* `radix` must outlive this; its leaves' boxes are the primitives'. */
static inline void make_aac_reference(aac_reference *r, const bb_tree *radix, uint32_t delta,
                                      double epsilon)
{
    const bb_node *root = &radix->nodes[0];
    bb_box scene = {.lo = {root->lo[0], root->lo[1], root->lo[2]},
                    .hi = {root->hi[0], root->hi[1], root->hi[2]}};
    cluster *list[CLUSTERS_MOST];
    *r = (aac_reference){.radix = radix, .delta = delta, .epsilon = epsilon};
    r->unit = reference_unit(&scene);
    r->all = calloc(radix->info.node_count, sizeof *r->all);
    r->nodes = calloc(radix->info.node_count, sizeof *r->nodes);
    r->refs = calloc(radix->info.leaf_count, sizeof *r->refs);
    uint32_t count = reference_build(r, 0, list);
    reference_combine(r, list, count, 1);
    reference_write(r, list[0], BB_NONE, 0);
}

#endif
