/* What the tests of gs share: its tree by itself, and what holds of it at all times. */
#ifndef BB_TEST_GS_FIXTURE_H
#define BB_TEST_GS_FIXTURE_H

#include "builders/gs/gs.h"
#include "tests/builder_fixture.h"

enum { SEED = 1987 };

/* ---- its tree ---- */

static inline void open_tree(bb_gs_tree *tree, bb_gs_rules rules, uint32_t objects)
{
    *tree = (bb_gs_tree){.rules = rules};
    ASSERT_OK(bb_gs_reserve(tree, NULL, objects));
    bb_gs_clear(tree, objects);
}

static inline void expect_union(const bb_gs_tree *tree, uint32_t n)
{
    const bb_gs_node *nodes = tree->nodes, *node = &nodes[n];
    bb_gs_box box = nodes[node->first].box;
    uint32_t children = 0, objects = 0, last = BB_NONE;
    for (uint32_t c = node->first; c != BB_NONE; c = nodes[c].next, children++) {
        assert_int_equal(nodes[c].parent, n);
        if (last != BB_NONE)
            assert_int_equal(nodes[c].prev, last);
        box = bb_gs_unite(&box, &nodes[c].box);
        objects += nodes[c].objects;
        last = c;
    }
    assert_int_equal(nodes[node->first].prev, last);
    assert_int_equal(node->children, children);
    assert_int_equal(node->objects, objects);
    assert_true(children >= 2);
    assert_true(bb_gs_contains(&node->box, &box) && bb_gs_contains(&box, &node->box));
}

/* What holds at all times, found anew. `attached`: objects in the tree. */
static inline void expect_sound(const bb_gs_tree *tree, uint32_t attached)
{
    uint32_t leaves = 0, met = 0, arity = 0, slots = 0, n = tree->root;
    while (n != BB_NONE) {
        const bb_gs_node *node = &tree->nodes[n];
        met++;
        assert_true(n < tree->count && met <= tree->count);
        assert_true((tree->marks[n] & BB_GS_FREE) == 0);
        assert_true(node->area == bb_gs_area(&node->box));
        arity = node->children > arity ? node->children : arity;
        if (!bb_gs_is_leaf(node)) {
            expect_union(tree, n);
            n = node->first;
            continue;
        }
        assert_int_equal(tree->leaf_of[node->first & BB_INDEX_MASK], n);
        assert_int_equal(node->objects, 1);
        leaves++;
        while (n != BB_NONE && tree->nodes[n].next == BB_NONE)
            n = tree->nodes[n].parent;
        n = n != BB_NONE ? tree->nodes[n].next : BB_NONE;
    }
    for (uint32_t i = 0; i < tree->count; i++)
        slots += (tree->marks[i] & BB_GS_FREE) == 0;
    assert_int_equal(leaves, attached);
    assert_int_equal(met, slots);
    assert_int_equal(arity, tree->arity);
    assert_int_equal(tree->nodes[tree->root].parent, BB_NONE);
}

/* ---- scenes that move ---- */

static inline bb_scene *scene_of_boxes(uint32_t count, bb_random *random)
{
    bb_scene *scene = make_box_scene(count);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            scene->boxes[i].lo[k] = (float)(100 * bb_random_unit(random));
            scene->boxes[i].hi[k] = scene->boxes[i].lo[k] + (float)(3 * bb_random_unit(random));
        }
    return scene;
}

/* One of `one_of` objects, by up to `far` on each axis; returns how many. */
static inline uint32_t move(bb_scene *scene, uint32_t one_of, float far, bb_random *random)
{
    uint32_t moved = 0;
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        if (bb_random_below(random, one_of) != 0)
            continue;
        moved++;
        for (int k = 0; k < 3; k++) {
            float by = far * (float)bb_random_range(random, -1, 1);
            scene->boxes[i].lo[k] += by;
            scene->boxes[i].hi[k] += by;
        }
    }
    return moved;
}

#endif
