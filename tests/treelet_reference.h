/* Optimisers of treelets (Karras and Aila 2013; Domingues and Pedrini 2015) as builders/trbvh and
 * builders/atrbvh define them, by slow recursion over a binary tree that is given. How a treelet's
 * leaves become a tree is the caller's. */
#ifndef BB_TEST_TREELET_REFERENCE_H
#define BB_TEST_TREELET_REFERENCE_H

#include "framework/builder/tree.h"
#include "tests/box_fixture.h"
#include "tests/device_forms.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { TREELET_MOST = 20 };

typedef struct item {
    bb_box box;
    uint32_t leaves;       /* of the tree, below */
    struct item *sides[2]; /* NULL: a leaf of the tree */
    const uint32_t *refs;  /* of a leaf */
} item;

typedef struct treelet_reference treelet_reference;

/* Makes a tree over `count` leaves and returns its root; *area: the sum of the areas of its inner
 * nodes but the root. New inner nodes are new_item()s. */
typedef item *(*choose_function)(treelet_reference *r, item *const *leaves, uint32_t count,
                                 float *area);

struct treelet_reference {
    choose_function choose;
    uint32_t treelet, gamma, rounds;
    float unit;
    item **items; /* all that were made */
    uint32_t made, room;
    uint32_t seen, rebuilt;
    bb_node *nodes; /* the tree, in preorder */
    uint32_t *refs;
    uint32_t node_count, ref_count, depth;
};

static inline item *new_item(treelet_reference *r)
{
    if (r->made == r->room) {
        r->room = 2 * r->room + 64;
        r->items = realloc(r->items, r->room * sizeof *r->items);
    }
    return r->items[r->made++] = calloc(1, sizeof(item));
}

static inline bb_box join_boxes(const bb_box *a, const bb_box *b)
{
    bb_box box = *a;
    for (int k = 0; k < 3; k++) {
        box.lo[k] = b->lo[k] < a->lo[k] ? b->lo[k] : a->lo[k];
        box.hi[k] = b->hi[k] > a->hi[k] ? b->hi[k] : a->hi[k];
    }
    return box;
}

static inline item *join_items(treelet_reference *r, item *a, item *b)
{
    item *both = new_item(r);
    *both = (item){join_boxes(&a->box, &b->box), a->leaves + b->leaves, {a, b}, NULL};
    return both;
}

/* In the unit of the scene; what is next to nothing is nothing. */
static inline float area_in(const treelet_reference *r, const bb_box *box)
{
    float x = box->hi[0] * r->unit - box->lo[0] * r->unit;
    float y = box->hi[1] * r->unit - box->lo[1] * r->unit;
    float z = box->hi[2] * r->unit - box->lo[2] * r->unit;
    float area = x * y + y * z + z * x;
    return area < ldexpf(1, -100) ? 0 : area;
}

/* ---- the definition ---- */

static inline void optimise_treelet(treelet_reference *r, item *root)
{
    item *leaves[TREELET_MOST] = {root->sides[0], root->sides[1]};
    float before = 0, after;
    for (uint32_t count = 2; count < r->treelet; count++) {
        uint32_t open = count;
        float largest = -1;
        for (uint32_t i = 0; i < count; i++)
            if (leaves[i]->sides[0] != NULL && area_in(r, &leaves[i]->box) > largest) {
                open = i;
                largest = area_in(r, &leaves[i]->box);
            }
        item *opened = leaves[open];
        before += largest;
        leaves[open] = opened->sides[0];
        leaves[count] = opened->sides[1];
    }
    item *best = r->choose(r, leaves, r->treelet, &after);
    r->seen++;
    if (!(after < before * (1 - ldexpf(1, -20))))
        return;
    r->rebuilt++;
    root->sides[0] = best->sides[0];
    root->sides[1] = best->sides[1];
}

static inline void optimise_below(treelet_reference *r, item *root, uint32_t gamma)
{
    if (root->leaves < gamma || root->sides[0] == NULL)
        return;
    optimise_below(r, root->sides[0], gamma);
    optimise_below(r, root->sides[1], gamma);
    optimise_treelet(r, root);
}

/* ---- from the common tree and back ---- */

/* Of a tree in preorder. */
static inline item *read_item(treelet_reference *r, const bb_tree *tree, uint32_t n)
{
    const bb_node *node = &tree->nodes[n];
    item *it;
    if (bb_node_is_leaf(node)) {
        it = new_item(r);
        it->leaves = 1;
        it->refs = &tree->refs[node->first & BB_INDEX_MASK];
    } else {
        item *left = read_item(r, tree, node->first);
        it = join_items(r, left, read_item(r, tree, tree->nodes[node->first].skip));
    }
    memcpy(it->box.lo, node->lo, sizeof node->lo);
    memcpy(it->box.hi, node->hi, sizeof node->hi);
    return it;
}

static inline void write_item(treelet_reference *r, const item *it, uint32_t skip, uint32_t depth)
{
    bb_node *node = &r->nodes[r->node_count++];
    memcpy(node->lo, it->box.lo, sizeof node->lo);
    memcpy(node->hi, it->box.hi, sizeof node->hi);
    node->skip = skip;
    r->depth = depth > r->depth ? depth : r->depth;
    if (it->sides[0] == NULL) {
        node->first = BB_LEAF_BIT | r->ref_count;
        for (const uint32_t *ref = it->refs;; ref++) {
            r->refs[r->ref_count++] = *ref;
            if ((*ref & BB_LAST_BIT) != 0)
                return;
        }
    }
    node->first = r->node_count;
    write_item(r, it->sides[0], r->node_count + 2 * it->sides[0]->leaves - 1, depth + 1);
    write_item(r, it->sides[1], skip, depth + 1);
}

static inline float unit_of(const bb_node *root)
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)root->hi[k] - root->lo[k]);
    int exponent = longest > 0 ? ilogb(longest) + 1 : 0;
    return (float)ldexp(1, exponent > 126 ? -126 : exponent < -126 ? 126 : -exponent);
}

/* `r` has choose and the parameters, and is zero otherwise; free_reference() follows. */
static inline void make_reference(treelet_reference *r, const bb_tree *input)
{
    r->nodes = calloc(input->info.node_count, sizeof *r->nodes);
    r->refs = calloc(input->info.ref_count, sizeof *r->refs);
    r->unit = unit_of(&input->nodes[0]);
    item *root = read_item(r, input, 0);
    for (uint32_t round = 0; round < r->rounds; round++)
        optimise_below(r, root, r->gamma << round);
    write_item(r, root, BB_NONE, 0);
}

static inline void free_reference(treelet_reference *r)
{
    for (uint32_t i = 0; i < r->made; i++)
        free(r->items[i]);
    free(r->items);
    free(r->nodes);
    free(r->refs);
}

/* ---- the comparison ---- */

static inline uint64_t event_of(const bb_build_step *step, const char *name)
{
    for (uint32_t i = 0; i < step->phases.event_count; i++)
        if (strcmp(step->phases.event_names[i], name) == 0)
            return step->phases.events[i];
    fail_msg("no event %s", name);
    return 0;
}

/* `optimiser` behind `builder` in all forms before `last`, against the definition in `r`. */
static inline void compare_with(treelet_reference r, const char *builder, const char *optimiser,
                                const bb_box *boxes, uint32_t count, const char *what, int last)
{
    char text[200];
    box_build input, b;
    open_box_build(&input, devices[first_form()], builder, boxes, count, what);
    make_reference(&r, &input.preorder);
    snprintf(text, sizeof text, "%s+%s", builder, optimiser);
    for (int form = first_form(); form < last; form++) {
        open_box_build(&b, devices[form], text, boxes, count, what);
        const bb_tree *tree = &b.preorder;
        const bb_build_step *step = &b.instance.steps[b.instance.step_count - 1];
        if (tree->info.depth != r.depth || tree->info.node_count != r.node_count ||
            tree->info.ref_count != r.ref_count ||
            memcmp(tree->nodes, r.nodes, r.node_count * sizeof(bb_node)) != 0 ||
            memcmp(tree->refs, r.refs, r.ref_count * sizeof(uint32_t)) != 0)
            fail_msg("%s, form %d, %s, %u boxes, seed %llu: not the tree of the definition", text,
                     form, what, count, (unsigned long long)seed);
        assert_int_equal(event_of(step, "treelets"), r.seen);
        assert_int_equal(event_of(step, "improved"), r.rebuilt);
        close_box_build(&b);
    }
    free_reference(&r);
    close_box_build(&input);
}

/* That building such a chain over `boxes` says `status`, and why. */
static inline void expect_refusal(const char *text, const bb_box *boxes, uint32_t count,
                                  bb_status status, const char *why)
{
    bb_instance instance = {0};
    bb_scene scene = scene_of(boxes, count);
    bb_status got = upload_boxes(&scene, devices[first_form()]);
    if (got == BB_OK)
        got = bb_instance_create(devices[first_form()], text, &scene, 1, &instance);
    if (got == BB_OK)
        got = bb_instance_build(&instance, &scene, false, NULL);
    if (got != status || strstr(bb_message(), why) == NULL)
        fail_msg("%s: status %d, '%s'", text, got, bb_message());
    bb_instance_destroy(&instance);
    bb_buffer_release(&scene.on_device.boxes);
}

#endif
