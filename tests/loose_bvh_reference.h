/* The Loose BVH as its paper has it (Eisemann, Grosch, Mueller, Magnor 2007, section 3.2), slowly:
 * all nodes of the complete tree in an array, primitives inserted by a descent, refitted backwards,
 * chains skipped. */
#ifndef BB_TEST_LOOSE_BVH_REFERENCE_H
#define BB_TEST_LOOSE_BVH_REFERENCE_H

#include "framework/builder/tree.h"

#include <math.h>
#include <stdlib.h>

typedef enum root { CUBE, BOX } root;
static const char *const root_names[] = {"cube", "box"};

/* ---- the paper's tree ---- */

/* Breadth-first: the children of node i are 2i + 1 and 2i + 2. */
typedef struct dense {
    size_t count;     /* 2^(3N + 1) - 1 */
    uint32_t *own;    /* the node's last primitive so far, plus 1; 0: none */
    uint32_t *before; /* of each primitive: the node's one before it, plus 1 */
    uint8_t *filled;  /* of each node: not empty */
} dense;

/* The scene's box as the builder halves it, or exactly. */
typedef struct frame {
    double low[3], whole[3];
    bool exact;
} frame;

static inline frame frame_of(const bb_box *boxes, uint32_t count, root root, bool exact)
{
    frame f = {.exact = exact};
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        float lo = INFINITY, hi = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            lo = fminf(lo, boxes[i].lo[k]);
            hi = fmaxf(hi, boxes[i].hi[k]);
        }
        f.low[k] = 0.5f * lo;
        f.whole[k] = 0.5f * hi - 0.5f * lo;
        longest = fmax(longest, f.whole[k]);
    }
    for (int k = 0; k < 3 && root == CUBE; k++)
        f.whole[k] = longest;
    return f;
}

/* Options, and whether coordinates are such that nothing is rounded. */
typedef struct way {
    uint32_t levels;
    root root;
    uint32_t deeper;
    bool exact;
} way;

/* The deepest level whose cells are as large as the box on each axis that counts. */
static inline uint32_t level_of(const frame *f, const bb_box *box, uint32_t levels)
{
    for (uint32_t level = levels; level > 0; level--) {
        bool fits = true;
        for (int k = 0; k < 3; k++) {
            float side = 0.5f * box->hi[k] - 0.5f * box->lo[k];
            fits = fits && (side == 0 || f->whole[k] == 0 ||
                            (double)side <= ldexp(f->whole[k], -(int)level));
        }
        if (fits)
            return level;
    }
    return 0;
}

/* The part of the way from the low to the high end of the root cell. */
static inline double part_of(const frame *f, const bb_box *box, int k)
{
    if (f->whole[k] == 0)
        return 0;
    if (f->exact)
        return (0.25 * ((double)box->lo[k] + (double)box->hi[k]) - f->low[k]) / f->whole[k];
    float middle = 0.5f * (0.5f * box->lo[k]) + 0.5f * (0.5f * box->hi[k]);
    return (middle - (float)f->low[k]) / (float)f->whole[k];
}

/* Walks down, one halving at a time. */
static inline size_t node_of(const frame *f, const bb_box *box, const way *w)
{
    uint32_t level = level_of(f, box, w->levels) + w->deeper;
    level = level < w->levels ? level : w->levels;
    double part[3];
    size_t node = 0;
    for (int k = 0; k < 3; k++)
        part[k] = part_of(f, box, k);
    for (uint32_t step = 0; step < 3 * level; step++) {
        double *p = &part[step % 3];
        bool upper = *p >= 0.5;
        *p = upper ? 2 * *p - 1 : 2 * *p;
        node = 2 * node + 1 + upper;
    }
    return node;
}

static inline void dense_make(dense *d, const frame *f, const bb_box *boxes, uint32_t count,
                              const way *w)
{
    *d = (dense){.count = ((size_t)2 << 3 * w->levels) - 1};
    d->own = calloc(d->count, sizeof *d->own);
    d->filled = calloc(d->count, 1);
    d->before = calloc(count, sizeof *d->before);
    for (uint32_t i = 0; i < count; i++) {
        size_t node = node_of(f, &boxes[i], w);
        d->before[i] = d->own[node];
        d->own[node] = i + 1;
    }
    for (size_t i = d->count; i-- > 0;)
        d->filled[i] = d->own[i] != 0 || (2 * i + 2 < d->count &&
                                          (d->filled[2 * i + 1] != 0 || d->filled[2 * i + 2] != 0));
}

static inline void dense_release(dense *d)
{
    free(d->own);
    free(d->filled);
    free(d->before);
}

/* A node's child that is not empty; 0: none. */
static inline size_t child_of(const dense *d, size_t node, int upper)
{
    size_t child = 2 * node + 1 + (size_t)upper;
    return child < d->count && d->filled[child] != 0 ? child : 0;
}

/* The paper's skip index. */
static inline size_t skip_chain(const dense *d, size_t node)
{
    for (;;) {
        size_t low = child_of(d, node, 0), high = child_of(d, node, 1);
        if (d->own[node] != 0 || (low != 0) == (high != 0))
            return node;
        node = low + high;
    }
}

/* ---- the same as a common tree, in preorder ---- */

typedef struct reference {
    const bb_box *boxes;
    bb_node *nodes;
    uint32_t *refs;
    uint32_t node_count, ref_count, leaf_count, depth, arity;
} reference;

static inline void grow(bb_node *node, const float lo[3], const float hi[3])
{
    for (int k = 0; k < 3; k++) {
        node->lo[k] = fminf(node->lo[k], lo[k] + 0.0f);
        node->hi[k] = fmaxf(node->hi[k], hi[k] + 0.0f);
    }
}

static inline uint32_t add_node(reference *r, uint32_t depth)
{
    r->depth = depth > r->depth ? depth : r->depth;
    r->nodes[r->node_count] = (bb_node){
        {INFINITY, INFINITY, INFINITY}, r->node_count + 1, {-INFINITY, -INFINITY, -INFINITY}, 0};
    return r->node_count++;
}

static inline void add_leaf(reference *r, const dense *d, size_t node, uint32_t depth)
{
    bb_node *leaf = &r->nodes[add_node(r, depth)];
    uint32_t count = 0;
    leaf->first = BB_LEAF_BIT | r->ref_count;
    for (uint32_t i = d->own[node]; i != 0; i = d->before[i - 1])
        count++;
    for (uint32_t i = d->own[node], n = count; i != 0; i = d->before[i - 1]) {
        r->refs[r->ref_count + --n] = i - 1;
        grow(leaf, r->boxes[i - 1].lo, r->boxes[i - 1].hi);
    }
    r->ref_count += count;
    r->refs[r->ref_count - 1] |= BB_LAST_BIT;
    r->leaf_count++;
}

/* Skips are the number of the node after the subtree. */
static inline void add_subtree(reference *r, const dense *d, size_t node, uint32_t depth)
{
    node = skip_chain(d, node);
    size_t low = child_of(d, node, 0), high = child_of(d, node, 1);
    uint32_t first = r->node_count;
    if (low == 0 && high == 0) {
        add_leaf(r, d, node, depth);
    } else {
        uint32_t arity = (d->own[node] != 0) + (low != 0) + (high != 0);
        r->arity = arity > r->arity ? arity : r->arity;
        add_node(r, depth);
        if (d->own[node] != 0) {
            add_leaf(r, d, node, depth + 1);
            r->nodes[r->node_count - 1].skip = r->node_count;
        }
        if (low != 0)
            add_subtree(r, d, low, depth + 1);
        if (high != 0)
            add_subtree(r, d, high, depth + 1);
        for (uint32_t i = first + 1; i < r->node_count; i++)
            grow(&r->nodes[first], r->nodes[i].lo, r->nodes[i].hi);
    }
    r->nodes[first].skip = r->node_count;
}

static inline void make_reference(reference *r, const bb_box *boxes, uint32_t count, const way *w)
{
    frame f = frame_of(boxes, count, w->root, w->exact);
    dense d;
    dense_make(&d, &f, boxes, count, w);
    *r = (reference){.boxes = boxes};
    r->nodes = calloc(2 * (size_t)count, sizeof *r->nodes);
    r->refs = calloc(count, sizeof *r->refs);
    add_subtree(r, &d, 0, 0);
    for (uint32_t i = 0; i < r->node_count; i++)
        if (r->nodes[i].skip == r->node_count)
            r->nodes[i].skip = BB_NONE;
    dense_release(&d);
}

static inline void release_reference(reference *r)
{
    free(r->nodes);
    free(r->refs);
}

#endif
