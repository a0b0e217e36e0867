/* Trees of sbvh: covers, budgets and memory, determinism, degenerate and extreme inputs, kinds;
 * what is refused, and what comes after. Cuts and searches: test_sbvh_split.c. Seed:
 * BVHBENCH_TEST_SEED. */
#include "builders/sbvh/sbvh_split.h"
#include "framework/builder/instance.h"
#include "tests/builder_fixture.h"
#include "tests/quality_inputs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 9 };

/* ---- trees ---- */

static bb_scene *load(const char *name)
{
    bb_scene *scene;
    ASSERT_OK(bb_scene_load(name, &scene));
    return scene;
}

/* Two builds: the same tree, valid, within the budget of references and memory. */
static void build_twice(made *m, const bb_scene *scene, double budget)
{
    build(m, scene);
    const uint64_t hash = hash_of(m), most = (uint64_t)(budget * scene->prim_count);
    build(m, scene);
    assert_true(hash_of(m) == hash);
    assert_true(m->tree.info.ref_count >= scene->prim_count && m->tree.info.ref_count <= most);
    assert_int_equal(m->tree.duplicated, m->tree.info.ref_count > scene->prim_count);
    const uint64_t nodes = 2 * most * sizeof(bb_node), refs = most * sizeof(uint32_t);
    const uint64_t own = (most + scene->prim_count) * sizeof(sb_ref);
    assert_true(m->account.peak <= nodes + refs + own + 1000000);
}

static void trees_are_covered_and_within_the_budget(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        "interior:n=3000", "hairball:n=300",          "slivers:aspect=40",
        "random:n=1000",   "spheres:n=1000",          "blocks:side=6,mixed=yes",
        "tets:side=4",     "awkward:kind=axis,n=500", "awkward:kind=zeros,n=500",
        "single"};
    static const double budgets[] = {1, 1.1, 2, 5};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        for (size_t i = 0; i < sizeof budgets / sizeof budgets[0]; i++) {
            char text[64];
            made m;
            snprintf(text, sizeof text, "sbvh:alpha=0,budget=%g,leaf=%d", budgets[i],
                     i % 2 == 0 ? 1 : 4);
            open_builder(text, &m);
            build_twice(&m, scene, budgets[i]);
            if (scene->kinds == BB_SPHERES)
                assert_int_equal(m.tree.info.ref_count, scene->prim_count);
            close_builder(&m);
        }
        bb_scene_free(scene);
    }
}

/* What forbids spatial splits gives the tree of object splits, whichever way; they lower the cost
 * of what lies askew. */
static void splits_pay_where_boxes_are_empty(void **state)
{
    (void)state;
    bb_scene *scene = load("slivers:aspect=40");
    made none, budget, split;
    open_builder("sbvh:alpha=1", &none);
    open_builder("sbvh:budget=1", &budget);
    open_builder("sbvh", &split);
    build(&none, scene);
    build(&budget, scene);
    build(&split, scene);
    assert_true(hash_of(&none) == hash_of(&budget));
    assert_int_equal(event(&none, "spatial"), 0);
    assert_true(event(&split, "spatial") > 10);
    assert_true(bb_tree_sah(&split.tree) < 0.7 * bb_tree_sah(&none.tree));
    close_builder(&none);
    close_builder(&budget);
    close_builder(&split);
    bb_scene_free(scene);
}

/* Triangles from corner to corner of boxes that are awkward. */
static void degenerate_inputs_end(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 50, 600};
    for (size_t k = 0; k < QUALITY_INPUTS; k++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            const uint32_t count = counts[c];
            bb_box *boxes = make_boxes(quality_inputs, k, count);
            float *corners = triangles_of_boxes(boxes, count);
            bb_scene *scene = make_scene(corners, count, NULL, 0);
            made m;
            open_builder("sbvh:alpha=0", &m);
            build_twice(&m, scene, 2);
            assert_true(m.tree.info.depth < 200);
            close_builder(&m);
            free_scene(scene);
            free(corners);
            free(boxes);
        }
}

/* Of triangles that lie on each other no split saves anything: a leaf takes as many as it may. */
static void leaves_are_as_large_as_they_may_be(void **state)
{
    (void)state;
    static const uint32_t leaves[] = {1, 2, 7, 255};
    for (size_t i = 0; i < sizeof leaves / sizeof leaves[0]; i++)
        for (uint32_t count = leaves[i]; count <= leaves[i] + 1; count++) {
            float *corners = malloc(CORNERS * (size_t)count * sizeof *corners);
            for (uint32_t c = 0; c < CORNERS * count; c++)
                corners[c] = (float)(c % CORNERS * (c % CORNERS));
            bb_scene *scene = make_scene(corners, count, NULL, 0);
            char text[32];
            made m;
            snprintf(text, sizeof text, "sbvh:alpha=1,leaf=%u", leaves[i]);
            open_builder(text, &m);
            build_twice(&m, scene, 2);
            assert_int_equal(m.tree.info.node_count, count == leaves[i] ? 1 : 3);
            close_builder(&m);
            free_scene(scene);
            free(corners);
        }
}

/* Node by node of the preorder: how deep it is. */
static uint32_t *depths_of(const bb_tree *tree)
{
    uint32_t *depths = calloc(tree->info.node_count, sizeof *depths);
    for (uint32_t i = 0; i < tree->info.node_count; i++)
        if (!bb_node_is_leaf(&tree->nodes[i]))
            for (uint32_t c = i + 1; c != tree->nodes[i].skip; c = tree->nodes[c].skip)
                depths[c] = depths[i] + 1;
    return depths;
}

/* Below the depth at which spatial splits end, no primitive is in two leaves of one node. Heaps of
 * slivers, each 16 times as large as the one before, make a deep tree with work at its end. */
static void splits_of_space_end_somewhere(void **state)
{
    (void)state;
    enum { COUNT = 360, HEAP = 6, DEEPEST = 48 };
    bb_random random = bb_random_make(seed, 6);
    float corners[CORNERS * COUNT];
    for (uint32_t i = 0; i < CORNERS * COUNT; i++) {
        const int octave = 4 * (int)(i / CORNERS / HEAP) - 2 * COUNT / HEAP;
        const double place = i % CORNERS < 6 ? bb_random_range(&random, 1, 2) : 0.01;
        corners[i] = ldexpf((float)place, octave) + (i % CORNERS < 6 ? 0 : corners[i - 6]);
    }
    bb_scene *scene = make_scene(corners, COUNT, NULL, 0);
    bb_tree tree;
    made m;
    open_builder("sbvh:alpha=0,budget=16", &m);
    build(&m, scene);
    bb_tree_init(&tree, NULL);
    ASSERT_OK(bb_tree_preorder(&m.tree, &tree));
    uint32_t *depths = depths_of(&tree), seen[COUNT] = {0}, deep = 0;
    for (uint32_t i = 0, top = 0; i < tree.info.node_count; i++) {
        top = depths[i] == DEEPEST ? i + 1 : top;
        if (depths[i] < DEEPEST || !bb_node_is_leaf(&tree.nodes[i]))
            continue;
        const uint32_t prim = tree.refs[tree.nodes[i].first & BB_INDEX_MASK] & BB_INDEX_MASK;
        if (seen[prim] == top)
            fail_msg("seed %llu: primitive %u is twice below node %u", (unsigned long long)seed,
                     prim, top - 1);
        seen[prim] = top;
        deep += depths[i] > DEEPEST;
    }
    free(depths);
    bb_tree_release(&tree);
    close_builder(&m);
    free_scene(scene);
    assert_true(deep > 20);
}

/* The sides of a node overlap by no more than its own area: below nodes of less than alpha of the
 * root's no primitive is in two leaves, if object splits are found everywhere. */
static void alpha_is_a_share_of_the_roots_area(void **state)
{
    (void)state;
    const double alpha = 0.02;
    bb_scene *scene = load("soup:n=1000,edge=6,aspect=100");
    bb_tree tree;
    made m;
    open_builder("sbvh:alpha=0.02,budget=4", &m);
    build(&m, scene);
    assert_true(event(&m, "spatial") > 10);
    bb_tree_init(&tree, NULL);
    ASSERT_OK(bb_tree_preorder(&m.tree, &tree));
    const bb_node *nodes = tree.nodes;
    const double least = alpha * bb_half_area(nodes[0].lo, nodes[0].hi);
    uint32_t *seen = calloc(scene->prim_count, sizeof *seen);
    for (uint32_t i = 0, end = 0, top = 0; i < tree.info.node_count; i++) {
        if (i >= end && bb_half_area(nodes[i].lo, nodes[i].hi) < least) {
            end = nodes[i].skip == BB_NONE ? tree.info.node_count : nodes[i].skip;
            top = i + 1;
        }
        if (i >= end || !bb_node_is_leaf(&nodes[i]))
            continue;
        const uint32_t prim = tree.refs[nodes[i].first & BB_INDEX_MASK] & BB_INDEX_MASK;
        if (seen[prim] == top)
            fail_msg("primitive %u is twice below node %u", prim, top - 1);
        seen[prim] = top;
    }
    free(seen);
    bb_tree_release(&tree);
    close_builder(&m);
    bb_scene_free(scene);
}

/* No plane lies between two floats that are neighbours. */
static void what_no_plane_divides_stays_whole(void **state)
{
    (void)state;
    float corners[8 * CORNERS];
    for (int i = 0; i < 8 * CORNERS; i++)
        corners[i] = i % 3 == 0 && i % 2 == 0 ? nextafterf(1e6f, INFINITY) : 1e6f;
    bb_scene *scene = make_scene(corners, 8, NULL, 0);
    made m;
    open_builder("sbvh:alpha=0", &m);
    build_twice(&m, scene, 2);
    assert_int_equal(m.tree.info.ref_count, 8);
    close_builder(&m);
    free_scene(scene);
}

/* ---- what is refused, and what comes after ---- */

static void bad_options_and_orders_are_refused(void **state)
{
    (void)state;
    static const char *const options[][2] = {
        {"sbvh:alpha=2", "must be a number from 0 to 1"},
        {"sbvh:budget=0.5", "must be a number from 1 to 16"},
        {"sbvh:slabs=1", "'slabs'"},
        {"sbvh:bins=257", "'bins'"},
        {"sbvh:leaf=0", "'leaf'"},
    };
    static const char *const orders[][2] = {
        {"presplit+sbvh", "reads the primitives' geometry"},
        {"lbvh+sbvh", "takes no tree"},
        {"sbvh+presplit", "can only come first"},
        {"rotate+sbvh", "takes another builder's tree"},
        {"sbvh+sbvh", "takes no tree"},
    };
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        made m;
        assert_int_equal(try_builder(options[i][0], &m), BB_INVALID);
        assert_non_null(strstr(bb_message(), options[i][1]));
        assert_null(m.self);
    }
    for (size_t i = 0; i < sizeof orders / sizeof orders[0]; i++) {
        assert_int_equal(bb_instance_check(orders[i][0]), BB_INVALID);
        if (strstr(bb_message(), orders[i][1]) == NULL || strchr(bb_message(), '\n') != NULL)
            fail_msg("'%s': expected '%s' in '%s'", orders[i][0], orders[i][1], bb_message());
    }
}

/* An optimiser takes its tree; a refit can't follow it, and the harness builds again. */
static void later_stages_take_duplicates(void **state)
{
    (void)state;
    static const char *const builders[] = {
        "sbvh",          "sbvh+rotate",        "sbvh+refit", "sbvh+trbvh", "sbvh+atrbvh+rotate",
        "sbvh+reinsert", "sbvh+reinsert+trbvh"};
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        bb_scene *scene = load("wave:n=800,strips=6,frames=3");
        bb_instance instance;
        bb_update_way way;
        uint32_t changed;
        ASSERT_OK(bb_scene_upload(scene, device));
        ASSERT_OK(bb_instance_create(device, builders[i], scene, 1, &instance));
        ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
        ASSERT_OK(bb_scene_set_frame(scene, 1, &changed));
        ASSERT_OK(bb_instance_update(&instance, scene, changed, false, &way, NULL));
        ASSERT_OK(bb_tree_download(&instance.tree, NULL));
        if (bb_tree_check(&instance.tree, scene) != BB_OK)
            fail_msg("%s: %s", builders[i], bb_message());
        assert_int_equal(way, BB_REBUILT);
        assert_true(instance.tree.duplicated);
        bb_instance_destroy(&instance);
        bb_scene_free(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_covered_and_within_the_budget),
        cmocka_unit_test(splits_pay_where_boxes_are_empty),
        cmocka_unit_test(degenerate_inputs_end),
        cmocka_unit_test(leaves_are_as_large_as_they_may_be),
        cmocka_unit_test(splits_of_space_end_somewhere),
        cmocka_unit_test(alpha_is_a_share_of_the_roots_area),
        cmocka_unit_test(what_no_plane_divides_stays_whole),
        cmocka_unit_test(bad_options_and_orders_are_refused),
        cmocka_unit_test(later_stages_take_duplicates),
    };
    return cmocka_run_group_tests_name("sbvh", tests, open_device, close_device);
}
