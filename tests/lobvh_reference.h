/* LOBVH by slow recursion from its definition (Gu, Jendersie, Grosch 2018, sections 3.1 and 3.2):
 * levels by equation 1 as it stands, items sorted by their paths, nodes made from the root down. */
#ifndef BB_TEST_LOBVH_REFERENCE_H
#define BB_TEST_LOBVH_REFERENCE_H

#include "builders/common/view_order.h"
#include "framework/builder/tree.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { SMALLEST, LARGEST, MEAN, VOLUME };

/* A variant of the builder, as options and as the reference takes it. */
typedef struct variant {
    const char *options;
    int side;
    bool fit;
    bool chains;
    double a;
    double direction[3];
} variant;

/* ---- levels and cells ---- */

typedef struct item {
    /* three bits per level, from the root's children down to the deepest level; 0 below its own
     * level */
    uint64_t path;
    uint32_t level;
    uint32_t prim;
} item;

static inline float smallest(const float v[3])
{
    return fminf(fminf(v[0], v[1]), v[2]);
}

static inline float largest(const float v[3])
{
    return fmaxf(fmaxf(v[0], v[1]), v[2]);
}

/* Equation 1 as it stands: the deepest level at which the measure is small enough. */
static inline uint32_t level_by_size(const float sides[3], const variant *v, uint32_t levels)
{
    float a = (float)(v->a - 1);
    uint32_t level = 0;
    for (uint32_t l = 1; l <= levels; l++) {
        float limit = ldexpf(a, -(int)l);
        bool enough = v->side == SMALLEST  ? smallest(sides) <= limit
                      : v->side == LARGEST ? largest(sides) <= limit
                      : v->side == MEAN
                          ? sides[0] + sides[1] + sides[2] <= ldexpf(3 * a, -(int)l)
                          : sides[0] * sides[1] * sides[2] <= ldexpf(a * a * a, -3 * (int)l);
        if (enough)
            level = l;
    }
    return level;
}

static inline bool fits(const float lo[3], const float hi[3], const float centre[3], double a,
                        uint32_t level)
{
    float length = ldexpf(1, (int)level), margin = 0.5f * (float)(a - 1);
    for (int k = 0; k < 3; k++) {
        float cell = fminf(floorf(centre[k] * length), length - 1);
        if (cell - lo[k] * length > margin || hi[k] * length - cell - 1 > margin)
            return false;
    }
    return true;
}

static inline item item_of(const bb_box *box, const bb_box *bounds, const variant *v,
                           uint32_t levels)
{
    float lo[3], hi[3], sides[3], centre[3], extent[3];
    for (int k = 0; k < 3; k++)
        extent[k] = 0.5f * bounds->hi[k] - 0.5f * bounds->lo[k];
    float scale = 1 / largest(extent);
    bool extended = scale <= FLT_MAX;
    for (int k = 0; k < 3; k++) {
        lo[k] = extended ? (0.5f * box->lo[k] - 0.5f * bounds->lo[k]) * scale : 0;
        hi[k] = extended ? (0.5f * box->hi[k] - 0.5f * bounds->lo[k]) * scale : 0;
        sides[k] = hi[k] - lo[k];
        centre[k] = 0.5f * lo[k] + 0.5f * hi[k];
    }
    item it = {.level = extended ? level_by_size(sides, v, levels) : 0};
    if (v->fit && it.level < levels && fits(lo, hi, centre, v->a, it.level + 1))
        it.level++;
    bb_axis_order order = bb_axis_order_of(v->direction);
    float count = ldexpf(1, (int)levels);
    for (uint32_t l = 1; l <= levels; l++)
        for (int place = 0; place < 3; place++) {
            uint32_t axis = order.axis[place];
            uint32_t cell = (uint32_t)fminf(floorf(centre[axis] * count), count - 1);
            uint32_t bit = (cell >> (levels - l) & 1) ^ (order.flips >> axis & 1);
            it.path = it.path << 1 | (l <= it.level ? bit : 0);
        }
    return it;
}

/* ---- the tree of the definition ---- */

typedef struct reference {
    const bb_box *boxes;
    const item *items;
    uint32_t levels;
    bool chains;
    bb_node *nodes;
    uint32_t *refs;
    uint32_t node_count, ref_count, leaf_count, depth, arity;
} reference;

/* An octree node's own items come first, then those of each child. */
typedef struct family {
    uint32_t own;
    uint32_t child_count;
    uint32_t ends[8];
} family;

static inline family family_of(const reference *r, uint32_t from, uint32_t to, uint32_t level)
{
    family f = {0};
    uint32_t i = from;
    while (i < to && r->items[i].level == level)
        i++;
    f.own = i - from;
    uint32_t shift = 3 * (r->levels - level - 1);
    while (i < to) {
        uint64_t digit = r->items[i].path >> shift & 7;
        while (i < to && (r->items[i].path >> shift & 7) == digit)
            i++;
        f.ends[f.child_count++] = i;
    }
    return f;
}

static inline uint32_t count_nodes(const reference *r, uint32_t from, uint32_t to, uint32_t level)
{
    family f = family_of(r, from, to, level);
    bool chain = f.own == 0 && f.child_count == 1 && !r->chains;
    uint32_t count = !chain + (f.own > 0 && f.child_count > 0);
    uint32_t at = from + f.own;
    for (uint32_t c = 0; c < f.child_count; c++) {
        count += count_nodes(r, at, f.ends[c], level + 1);
        at = f.ends[c];
    }
    return count;
}

static inline void grow(bb_node *node, const float lo[3], const float hi[3])
{
    for (int k = 0; k < 3; k++) {
        node->lo[k] = fminf(node->lo[k], lo[k]);
        node->hi[k] = fmaxf(node->hi[k], hi[k]);
    }
}

static inline bb_node *add_node(reference *r, uint32_t skip, uint32_t depth)
{
    bb_node *node = &r->nodes[r->node_count++];
    *node = (bb_node){{INFINITY, INFINITY, INFINITY}, 0, {-INFINITY, -INFINITY, -INFINITY}, skip};
    r->depth = depth > r->depth ? depth : r->depth;
    return node;
}

static inline void add_leaf(reference *r, uint32_t from, uint32_t to, uint32_t skip, uint32_t depth)
{
    bb_node *node = add_node(r, skip, depth);
    node->first = BB_LEAF_BIT | r->ref_count;
    r->leaf_count++;
    for (uint32_t i = from; i < to; i++) {
        uint32_t prim = r->items[i].prim;
        grow(node, r->boxes[prim].lo, r->boxes[prim].hi);
        r->refs[r->ref_count++] = prim | (i + 1 == to ? BB_LAST_BIT : 0);
    }
}

/* In preorder. */
static inline void add_nodes(reference *r, uint32_t from, uint32_t to, uint32_t level,
                             uint32_t skip, uint32_t depth)
{
    family f = family_of(r, from, to, level);
    if (f.child_count == 0) {
        add_leaf(r, from, to, skip, depth);
        return;
    }
    if (f.own == 0 && f.child_count == 1 && !r->chains) {
        add_nodes(r, from, to, level + 1, skip, depth);
        return;
    }
    bb_node *node = add_node(r, skip, depth);
    node->first = r->node_count;
    uint32_t at = from + f.own, arity = f.child_count + (f.own > 0);
    r->arity = arity > r->arity ? arity : r->arity;
    if (f.own > 0)
        add_leaf(r, from, at, r->node_count + 1, depth + 1);
    for (uint32_t c = 0; c < f.child_count; c++) {
        uint32_t next = r->node_count + count_nodes(r, at, f.ends[c], level + 1);
        add_nodes(r, at, f.ends[c], level + 1, c + 1 < f.child_count ? next : skip, depth + 1);
        at = f.ends[c];
    }
    uint32_t end = r->node_count;
    for (uint32_t child = node->first; child < end; child++)
        grow(node, r->nodes[child].lo, r->nodes[child].hi);
}

static inline int compare_items(const void *a, const void *b)
{
    const item *x = a, *y = b;
    if (x->path != y->path)
        return x->path < y->path ? -1 : 1;
    if (x->level != y->level)
        return x->level < y->level ? -1 : 1;
    return x->prim < y->prim ? -1 : 1;
}

static inline bb_box bounds_of(const bb_box *boxes, uint32_t count)
{
    bb_box bounds = boxes[0];
    for (uint32_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            bounds.lo[k] = fminf(bounds.lo[k], boxes[i].lo[k]);
            bounds.hi[k] = fmaxf(bounds.hi[k], boxes[i].hi[k]);
        }
    return bounds;
}

/* items[].level and .path are set. */
static inline void make_tree(reference *r, const bb_box *boxes, item *items, uint32_t count,
                             uint32_t levels, bool chains)
{
    qsort(items, count, sizeof *items, compare_items);
    *r = (reference){.boxes = boxes, .items = items, .levels = levels, .chains = chains};
    size_t most = (levels + 2) * (size_t)count;
    r->nodes = calloc(most, sizeof *r->nodes);
    r->refs = calloc(count, sizeof *r->refs);
    add_nodes(r, 0, count, 0, BB_NONE, 0);
}

static inline void make_reference(reference *r, const bb_box *boxes, uint32_t count,
                                  const variant *v, uint32_t levels)
{
    bb_box bounds = bounds_of(boxes, count);
    item *items = malloc(count * sizeof *items);
    for (uint32_t i = 0; i < count; i++) {
        items[i] = item_of(&boxes[i], &bounds, v, levels);
        items[i].prim = i;
    }
    make_tree(r, boxes, items, count, levels, v->chains);
    free(items);
}

#endif
