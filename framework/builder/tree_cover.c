/* Checks the coverage of a primitive by several boxes, by subtracting the boxes from it.
 *
 *   regions = { box of the primitive }
 *   while there is a region R:
 *       shrink R to the part of the primitive's surface in it; drop R if there is none
 *       if a box contains R: it is covered
 *       else if a box overlaps R: cut R along the box, keep the up to six pieces outside
 *       else: the part of the primitive in R is not covered
 *
 * If many boxes overlap a region, it is halved first, and each half is only compared with the boxes
 * that overlap it: otherwise a large primitive among small ones, in m leaves of an octree, would
 * take m^2. Halves that share too many boxes are not made, and at most a few per box.
 *
 * The kind of the primitive computes its part in R (shrink() of prim.h). All in double; the boxes
 * are grown by 2^-40 of the largest coordinate, so that rounding here (2^-53) cannot open a gap
 * between adjacent boxes. A gap of one float between boxes is 2^-24 of its coordinate; where that
 * is less than 2^-16 of the primitive's largest coordinate, a gap of a few floats is not found.
 */
#include "framework/builder/tree_cover.h"

#include "framework/scene/prim.h"

#include <math.h>
#include <string.h>

typedef struct region {
    double lo[3], hi[3];
} region;

typedef struct region_stack {
    region *items;
    size_t count, capacity;
} region_stack;

static bb_status push(region_stack *stack, const region *item)
{
    if (stack->count == stack->capacity) {
        size_t capacity = stack->capacity == 0 ? 64 : 2 * stack->capacity;
        region *items = NULL;
        BB_TRY(bb_host_alloc(NULL, capacity * sizeof *items, "check of the tree", &items));
        if (stack->count > 0)
            memcpy(items, stack->items, stack->count * sizeof *items);
        bb_host_free(stack->items);
        stack->items = items;
        stack->capacity = capacity;
    }
    stack->items[stack->count++] = *item;
    return BB_OK;
}

/* A primitive, its boxes, and lists of boxes, one after the other. */
typedef struct cover {
    const bb_scene *scene;
    uint32_t prim;
    const bb_box *boxes;
    double margin;
    uint32_t *list;
    size_t top, capacity;
    uint64_t halvings; /* halvings that may still be made */
    region left;       /* the part that is not covered */
} cover;

static bool shrink(const bb_scene *scene, uint32_t prim, region *r)
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
    return kind->shrink(scene, i, r->lo, r->hi);
}

/* ---- regions and boxes ---- */

static region grown(const bb_box *box, double margin)
{
    region r;
    for (int axis = 0; axis < 3; axis++) {
        r.lo[axis] = box->lo[axis] - margin;
        r.hi[axis] = box->hi[axis] + margin;
    }
    return r;
}

static bool holds(const region *box, const region *r)
{
    bool inside = true;
    for (int axis = 0; axis < 3; axis++)
        inside = inside && box->lo[axis] <= r->lo[axis] && r->hi[axis] <= box->hi[axis];
    return inside;
}

/* Returns whether they overlap enough for a cut: more than touching, unless the region is flat
 * there. */
static bool overlaps(const region *box, const region *r)
{
    for (int axis = 0; axis < 3; axis++) {
        bool flat = r->lo[axis] == r->hi[axis];
        if (flat ? r->lo[axis] < box->lo[axis] || r->lo[axis] > box->hi[axis]
                 : r->hi[axis] <= box->lo[axis] || r->lo[axis] >= box->hi[axis])
            return false;
    }
    return true;
}

/* Pushes the parts of `r` outside of `box`. */
static bb_status cut(region_stack *stack, const region *box, const region *r)
{
    region rest = *r;
    for (int axis = 0; axis < 3; axis++) {
        if (rest.lo[axis] < box->lo[axis]) {
            region piece = rest;
            piece.hi[axis] = rest.lo[axis] = box->lo[axis];
            BB_TRY(push(stack, &piece));
        }
        if (rest.hi[axis] > box->hi[axis]) {
            region piece = rest;
            piece.lo[axis] = rest.hi[axis] = box->hi[axis];
            BB_TRY(push(stack, &piece));
        }
    }
    return BB_OK;
}

/* Handles one region; *covered is false if a part of it is covered by no box. */
static bb_status cover_region(const cover *c, region_stack *stack, const region *r, size_t first,
                              uint32_t count, bool *covered)
{
    uint32_t cutter = BB_NONE;
    *covered = true;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t number = c->list[first + i];
        region box = grown(&c->boxes[number], c->margin);
        if (holds(&box, r))
            return BB_OK;
        if (cutter == BB_NONE && overlaps(&box, r))
            cutter = number;
    }
    *covered = cutter != BB_NONE;
    if (!*covered)
        return BB_OK;
    region box = grown(&c->boxes[cutter], c->margin);
    return cut(stack, &box, r);
}

/* Checks coverage by the boxes of a short list. */
static bb_status cover_by_few(cover *c, const region *whole, size_t first, uint32_t count,
                              bool *covered)
{
    region_stack stack = {0};
    bb_status status = push(&stack, whole);
    while (status == BB_OK && *covered && stack.count > 0) {
        region r = stack.items[--stack.count];
        if (shrink(c->scene, c->prim, &r))
            status = cover_region(c, &stack, &r, first, count, covered);
        c->left = r;
    }
    bb_host_free(stack.items);
    return status;
}

/* Appends those boxes of a list that overlap the region; *chosen: their number. */
static bb_status choose(cover *c, const region *r, size_t first, uint32_t count, uint32_t *chosen)
{
    *chosen = 0;
    if (c->top + count > c->capacity) {
        size_t capacity = 2 * (c->top + count);
        uint32_t *list = NULL;
        BB_TRY(bb_host_alloc(NULL, capacity * sizeof *list, "check of the tree", &list));
        memcpy(list, c->list, c->top * sizeof *list);
        bb_host_free(c->list);
        c->list = list;
        c->capacity = capacity;
    }
    for (uint32_t i = 0; i < count; i++) {
        region box = grown(&c->boxes[c->list[first + i]], c->margin);
        if (overlaps(&box, r))
            c->list[c->top + (*chosen)++] = c->list[first + i];
    }
    return BB_OK;
}

enum { FEW = 24, HALVINGS_PER_BOX = 4 };

/* Checks coverage by halving, as long as that pays: boxes that coincide, or are thinner than the
 * margin, would come into both halves again and again. */
static bb_status cover_by_list(cover *c, region r, size_t first, uint32_t count, bool *covered)
{
    const size_t top = c->top;
    if (count <= FEW || c->halvings == 0)
        return cover_by_few(c, &r, first, count, covered);
    c->halvings--;
    if (!shrink(c->scene, c->prim, &r))
        return BB_OK;
    int axis = 0;
    for (int k = 1; k < 3; k++)
        axis = r.hi[k] - r.lo[k] > r.hi[axis] - r.lo[axis] ? k : axis;
    region part[2] = {r, r};
    uint32_t chosen[2] = {0};
    part[0].hi[axis] = part[1].lo[axis] = 0.5 * r.lo[axis] + 0.5 * r.hi[axis];
    bb_status status = BB_OK;
    for (int half = 0; half < 2 && status == BB_OK; half++) {
        status = choose(c, &part[half], first, count, &chosen[half]);
        c->top += chosen[half];
    }
    if (status == BB_OK && (uint64_t)chosen[0] + chosen[1] > count + (uint64_t)count / 4)
        status = cover_by_few(c, &r, first, count, covered);
    else
        for (int half = 0; half < 2 && status == BB_OK && *covered; half++)
            status = cover_by_list(c, part[half], half == 0 ? top : top + chosen[0], chosen[half],
                                   covered);
    c->top = top;
    return status;
}

bb_status bb_cover_primitive(const bb_scene *scene, uint32_t prim, const bb_box *boxes,
                             uint32_t count, bool *covered, double point[3])
{
    region r = grown(&scene->boxes[prim], 0.0);
    cover c = {.scene = scene, .prim = prim, .boxes = boxes, .left = r};
    double largest = 0.0;
    for (int axis = 0; axis < 3; axis++)
        largest = fmax(largest, fmax(fabs(r.lo[axis]), fabs(r.hi[axis])));
    c.margin = ldexp(largest, -40);

    *covered = true;
    for (uint32_t i = 0; i < count; i++) { /* most primitives are in one leaf, whole */
        region box = grown(&boxes[i], 0.0);
        if (holds(&box, &r))
            return BB_OK;
    }
    bb_status status =
        bb_host_alloc(NULL, (count + 1) * sizeof *c.list, "check of the tree", &c.list);
    c.capacity = count + (size_t)1;
    c.halvings = (uint64_t)HALVINGS_PER_BOX * count;
    for (; status == BB_OK && c.top < count; c.top++)
        c.list[c.top] = (uint32_t)c.top;
    if (status == BB_OK)
        status = cover_by_list(&c, r, 0, count, covered);
    for (int axis = 0; axis < 3; axis++)
        point[axis] = 0.5 * c.left.lo[axis] + 0.5 * c.left.hi[axis];
    bb_host_free(c.list);
    return status;
}

/* Lists the boxes of the leaves of each primitive. start[p] is the end of p's boxes before, their
 * start after. */
static void list_boxes(const bb_tree *tree, const bb_walk *walk, uint32_t *start, bb_box *boxes)
{
    for (uint32_t i = walk->info.node_count; i-- > 0;) {
        const bb_node *node = &tree->nodes[walk->order[i]];
        if (!bb_node_is_leaf(node))
            continue;
        const uint32_t *refs = tree->refs + (node->first & BB_INDEX_MASK);
        for (uint32_t k = 0; k < walk->width[i]; k++) {
            bb_box *box = &boxes[--start[refs[k] & BB_INDEX_MASK]];
            memcpy(box->lo, node->lo, sizeof box->lo);
            memcpy(box->hi, node->hi, sizeof box->hi);
        }
    }
}

bb_status bb_tree_check_cover(const bb_tree *tree, const bb_scene *scene, const bb_walk *walk,
                              const uint32_t *uses)
{
    uint32_t *start = NULL, prims = scene->prim_count, end = 0;
    bb_box *boxes = NULL;
    bb_status status = bb_host_alloc(NULL, prims * sizeof *start, "check of the tree", &start);
    if (status == BB_OK)
        status =
            bb_host_alloc(NULL, walk->info.ref_count * sizeof *boxes, "check of the tree", &boxes);
    if (status == BB_OK) {
        for (uint32_t prim = 0; prim < prims; prim++)
            start[prim] = end += uses[prim];
        list_boxes(tree, walk, start, boxes);
    }
    for (uint32_t prim = 0; prim < prims && status == BB_OK; prim++) {
        bool covered;
        double at[3];
        status = bb_cover_primitive(scene, prim, boxes + start[prim], uses[prim], &covered, at);
        if (status == BB_OK && !covered)
            status =
                bb_fail(BB_FAILED,
                        "primitive %u is not covered by its %u leaves: what is at (%.9g, %.9g, "
                        "%.9g) is outside of their boxes",
                        prim, uses[prim], at[0], at[1], at[2]);
    }
    bb_host_free(boxes);
    bb_host_free(start);
    return status;
}
