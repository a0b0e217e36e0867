/* The extended tree over nodes of a binary tree, by slow recursion from its definition (Gu,
 * Jendersie, Grosch 2018, section 3.3.2), without keys, prefixes or sorting: walk down the binary
 * tree, partition the primitives on the way. */
#ifndef LOOSE_REFERENCE_H
#define LOOSE_REFERENCE_H

#include "framework/builder/tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A node of a complete binary tree of `length` levels below the root: the steps to it as the top
 * `level` of `length` bits, 0 left, 1 right; the bits below are 0. */
typedef struct loose_node {
    uint64_t path;
    uint32_t level;
} loose_node;

typedef struct loose_reference {
    const bb_box *boxes;
    const loose_node *places; /* of each primitive */
    uint32_t length;
    uint32_t merge; /* as the builder's option; 0: any number */
    bb_node *nodes; /* in preorder */
    uint32_t *refs;
    uint32_t *ends; /* per node: the first that is not below it */
    uint32_t node_count, leaf_count, ref_count, depth;
} loose_reference;

static inline uint32_t loose_open(loose_reference *r, uint32_t depth)
{
    r->depth = depth > r->depth ? depth : r->depth;
    bb_node *node = &r->nodes[r->node_count];
    *node = (bb_node){.lo = {INFINITY, INFINITY, INFINITY},
                      .hi = {-INFINITY, -INFINITY, -INFINITY},
                      .first = r->node_count + 1};
    return r->node_count++;
}

static inline void loose_join(bb_node *node, const float lo[3], const float hi[3])
{
    for (int k = 0; k < 3; k++) {
        node->lo[k] = fminf(node->lo[k], lo[k]);
        node->hi[k] = fmaxf(node->hi[k], hi[k]);
    }
}

static inline void loose_close(loose_reference *r, uint32_t n)
{
    bb_node *node = &r->nodes[n];
    r->ends[n] = r->node_count;
    for (uint32_t c = n + 1; c < r->node_count; c = r->ends[c])
        loose_join(node, r->nodes[c].lo, r->nodes[c].hi);
}

/* Leaves from <= i < to of the tree, leaf i holding cuts[i] .. cuts[i + 1] - 1 of prims; told apart
 * by i. */
static inline void loose_leaves(loose_reference *r, const uint32_t *prims, const uint32_t *cuts,
                                uint32_t from, uint32_t to, uint32_t depth)
{
    uint32_t n = loose_open(r, depth);
    if (to - from == 1) {
        r->nodes[n].first = BB_LEAF_BIT | r->ref_count;
        for (uint32_t i = cuts[0]; i < cuts[1]; i++) {
            const bb_box *box = &r->boxes[prims[i]];
            r->refs[r->ref_count++] = prims[i];
            loose_join(&r->nodes[n], box->lo, box->hi);
        }
        r->refs[r->ref_count - 1] |= BB_LAST_BIT;
        r->leaf_count++;
    } else {
        uint32_t bit = 1u << (31 - __builtin_clz(from ^ (to - 1))), middle = from;
        while ((middle & bit) == 0)
            middle++;
        loose_leaves(r, prims, cuts, from, middle, depth + 1);
        loose_leaves(r, prims, cuts + (middle - from), middle, to, depth + 1);
    }
    loose_close(r, n);
}

/* The primitives of one node, in one leaf or cut into several. */
static inline void loose_own(loose_reference *r, const uint32_t *prims, uint32_t count,
                             uint32_t depth)
{
    uint32_t *cuts = malloc((count + 1) * sizeof *cuts), leaves = 0, from = r->ref_count;
    for (uint32_t i = 0; i < count; i++)
        if (i == 0 || (r->merge > 0 && i >= r->merge && (from + i) % r->merge == 0))
            cuts[leaves++] = i;
    cuts[leaves] = count;
    loose_leaves(r, prims, cuts, r->leaf_count, r->leaf_count + leaves, depth);
    free(cuts);
}

/* Primitives at and below the node that is `level` steps down. */
static inline void loose_subtree(loose_reference *r, const uint32_t *prims, uint32_t count,
                                 uint32_t level, uint32_t depth)
{
    uint32_t *parts[3], sizes[3] = {0, 0, 0}; /* left, right, own */
    for (int k = 0; k < 3; k++)
        parts[k] = malloc((count + 1) * sizeof *parts[k]);
    for (uint32_t i = 0; i < count; i++) {
        const loose_node *at = &r->places[prims[i]];
        uint32_t part =
            at->level == level ? 2 : (uint32_t)(at->path >> (r->length - 1 - level) & 1);
        parts[part][sizes[part]++] = prims[i];
    }
    uint32_t below = (sizes[0] > 0) + (sizes[1] > 0), opened[2], opens = 0;
    if (sizes[2] > 0 && below > 0)
        opened[opens++] = loose_open(r, depth++);
    if (sizes[2] > 0)
        loose_own(r, parts[2], sizes[2], depth);
    if (below == 2)
        opened[opens++] = loose_open(r, depth++);
    for (int k = 0; k < 2; k++)
        if (sizes[k] > 0)
            loose_subtree(r, parts[k], sizes[k], level + 1, depth);
    while (opens > 0)
        loose_close(r, opened[--opens]);
    for (int k = 0; k < 3; k++)
        free(parts[k]);
}

static inline void loose_reference_make(loose_reference *r, const bb_box *boxes,
                                        const loose_node *places, uint32_t count, uint32_t length,
                                        uint32_t merge)
{
    *r = (loose_reference){.boxes = boxes, .places = places, .length = length, .merge = merge};
    r->nodes = calloc(2 * (size_t)count, sizeof *r->nodes);
    r->refs = calloc(count, sizeof *r->refs);
    r->ends = calloc(2 * (size_t)count, sizeof *r->ends);
    uint32_t *prims = malloc(count * sizeof *prims);
    for (uint32_t i = 0; i < count; i++)
        prims[i] = i;
    loose_subtree(r, prims, count, 0, 0);
    for (uint32_t n = 0; n < r->node_count; n++)
        r->nodes[n].skip = r->ends[n] < r->node_count ? r->ends[n] : BB_NONE;
    free(prims);
}

static inline void loose_reference_release(loose_reference *r)
{
    free(r->nodes);
    free(r->refs);
    free(r->ends);
}

/* Is the tree, in preorder, the reference, bit for bit? */
static inline bool loose_reference_equals(const loose_reference *r, const bb_tree *tree)
{
    return tree->info.depth == r->depth && tree->info.node_count == r->node_count &&
           tree->info.leaf_count == r->leaf_count && tree->info.ref_count == r->ref_count &&
           memcmp(tree->nodes, r->nodes, r->node_count * sizeof(bb_node)) == 0 &&
           memcmp(tree->refs, r->refs, r->ref_count * sizeof(uint32_t)) == 0;
}

#endif
