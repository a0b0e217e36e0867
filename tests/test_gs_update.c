/* gs: updates, and the common tree that follows them; awkward scenes; what is refused. */
#include "tests/gs_fixture.h"

static const char *const specs[] = {
    "gs",
    "gs:tau=0",
    "gs:arity=2,order=shuffled",
    "gs:max_children=0,tau=1.1,q=min",
    "gs:max_children=3,start=root,order=file",
    "gs:search=bb,thin_budget=2",
    "gs:search=bb,arity=2,start=root,tau=1",
};

enum { SPECS = sizeof specs / sizeof specs[0] };

/* ---- updates ---- */

/* Of all and of few, near and far: patched trees and such as were written anew. */
static void trees_stay_valid_over_many_frames(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < SPECS; s++) {
        bb_random random = bb_random_make(SEED, 100 + s);
        bb_scene *scene = scene_of_boxes(700, &random);
        made m;
        open_builder(specs[s], &m);
        build(&m, scene);
        for (uint32_t frame = 0; frame < 60; frame++) {
            uint32_t moved = move(scene, frame % 4 == 0 ? 1 : 40, frame % 3 == 0 ? 50 : 2, &random);
            update(&m, scene);
            assert_int_equal(event(&m, "moved"), moved);
            assert_true(event(&m, "reinserted") >= moved + 2 * event(&m, "thinned"));
            if (strstr(specs[s], "budget=2") != NULL)
                assert_true(event(&m, "thinned") <= 2);
            if (strstr(specs[s], "tau=0") != NULL)
                assert_int_equal(event(&m, "thinned"), 0);
        }
        close_builder(&m);
        free_scene(scene);
    }
}

/* Room for what bb_gs_emit() writes. */
static void open_common(bb_tree *out, uint32_t count)
{
    bb_tree_init(out, NULL);
    ASSERT_OK(bb_tree_reserve(out, NULL, BB_ON_HOST, 2 * (size_t)count - 1, count));
    for (uint32_t i = 0; i < count; i++)
        out->refs[i] = i | BB_LAST_BIT;
}

/* A tree over the scene's boxes and the common tree that was written of it. */
static void open_pair(bb_gs_tree *tree, bb_tree *out, bb_gs_rules rules, const bb_scene *scene)
{
    uint32_t count = scene->prim_count;
    open_tree(tree, rules, count);
    open_common(out, count);
    for (uint32_t i = 0; i < count; i++) {
        bb_gs_box box = bb_gs_box_of(&scene->boxes[i]);
        bb_gs_add(tree, i, &box);
    }
    bb_gs_start_q(tree);
    bb_gs_emit(tree, true, out);
}

static void close_pair(bb_gs_tree *tree, bb_tree *out)
{
    bb_tree_release(out);
    bb_gs_release(tree);
}

/* The pool itself, and that the common tree is that pool, node by node. */
static void the_common_tree_follows_the_pool(void **state)
{
    (void)state;
    enum { COUNT = 600 };
    bb_random random = bb_random_make(SEED, 4);
    bb_scene *scene = scene_of_boxes(COUNT, &random);
    bb_gs_tree tree;
    bb_tree out;
    open_pair(&tree, &out, (bb_gs_rules){.max_children = 16, .tau = 1.05}, scene);
    uint32_t thinned = 0;
    for (uint32_t frame = 0; frame < 200; frame++) {
        move(scene, 1 + frame % 100, 5, &random);
        bb_gs_move(&tree, scene->boxes, bb_gs_detect(&tree, scene->boxes));
        expect_sound(&tree, COUNT);
        tree.thinned = 0;
        bb_gs_thin(&tree);
        thinned += tree.thinned;
        expect_sound(&tree, COUNT);
        assert_int_equal(tree.nodes[tree.root].objects, COUNT);
        bb_gs_emit(&tree, false, &out);
        expect_sound(&tree, COUNT);
        assert_int_equal(tree.free, BB_NONE);
        ASSERT_OK(bb_tree_check(&out, scene));
        for (uint32_t n = 0; n < tree.count; n++) {
            assert_memory_equal(out.nodes[n].lo, tree.nodes[n].box.lo, sizeof out.nodes[n].lo);
            assert_memory_equal(out.nodes[n].hi, tree.nodes[n].box.hi, sizeof out.nodes[n].hi);
            assert_int_equal(out.nodes[n].first, tree.nodes[n].first);
        }
    }
    assert_true(thinned > 0);
    close_pair(&tree, &out);
    free_scene(scene);
}

/* Nodes that go and are not made again elsewhere, which leaves slots free all over. */
static void free_slots_are_filled(void **state)
{
    (void)state;
    enum { COUNT = 400 };
    bb_random random = bb_random_make(SEED, 13);
    for (uint32_t run = 0; run < 100; run++) {
        bb_scene *scene = scene_of_boxes(COUNT, &random);
        bb_gs_tree tree;
        bb_tree out;
        open_pair(&tree, &out, (bb_gs_rules){0}, scene);
        uint32_t before = tree.count;
        for (uint32_t i = 0; i < 15; i++) {
            uint32_t start = tree.root, leaf = tree.leaf_of[bb_random_below(&random, COUNT)];
            bb_gs_detach(&tree, leaf, &start);
            bb_gs_attach(&tree, leaf, tree.root, false, BB_NONE);
        }
        assert_true(tree.free != BB_NONE);
        bb_gs_emit(&tree, false, &out);
        assert_true(tree.count < before);
        expect_sound(&tree, COUNT);
        ASSERT_OK(bb_tree_check(&out, scene));
        close_pair(&tree, &out);
        free_scene(scene);
    }
}

/* Nodes stay where they are when three of four thousand objects move. */
static void few_movers_write_few_nodes(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 5);
    bb_scene *scene = scene_of_boxes(4000, &random);
    made m;
    open_builder("gs", &m);
    build(&m, scene);
    bb_tree before;
    copy_tree(&m.tree, &before);
    for (uint32_t i = 0; i < 3; i++)
        scene->boxes[1000 * i].hi[0] += 1;
    update(&m, scene);
    uint32_t differ = 0;
    for (uint32_t n = 0; n < before.info.node_count; n++)
        differ += memcmp(&before.nodes[n], &m.tree.nodes[n], sizeof *before.nodes) != 0;
    assert_true(differ > 0 && differ < 200);
    bb_tree_release(&before);
    close_builder(&m);
    free_scene(scene);
}

static void what_stays_still_is_not_touched(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 6);
    bb_scene *scene = scene_of_boxes(500, &random);
    for (uint32_t s = 0; s < SPECS; s++) {
        made m;
        bb_tree before;
        open_builder(specs[s], &m);
        build(&m, scene);
        move(scene, 1, 3, &random);
        update(&m, scene);
        copy_tree(&m.tree, &before);
        uint64_t links = m.tree.links;
        for (uint32_t i = 0; i < 3; i++) {
            update(&m, scene);
            assert_true(m.tree.refitted && m.tree.links == links);
            assert_memory_equal(&m.tree.info, &before.info, sizeof before.info);
            assert_memory_equal(m.tree.nodes, before.nodes,
                                before.info.node_count * sizeof *before.nodes);
            assert_memory_equal(m.tree.refs, before.refs, 500 * sizeof *before.refs);
        }
        bb_tree_release(&before);
        close_builder(&m);
    }
    free_scene(scene);
}

/* Two objects of the same scene and seed; then there and back; then a build. */
static void replays_are_the_same(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < SPECS; s++) {
        bb_random random = bb_random_make(SEED, 7);
        bb_scene *scene = scene_of_boxes(400, &random);
        bb_box *first = malloc(400 * sizeof *first);
        memcpy(first, scene->boxes, 400 * sizeof *first);
        made m, again;
        open_builder(specs[s], &m);
        open_builder(specs[s], &again);
        build(&m, scene);
        uint64_t fresh = hash_of(&m);
        build(&again, scene);
        build(&again, scene);
        for (uint32_t frame = 0; frame < 20; frame++) {
            assert_true(hash_of(&m) == hash_of(&again));
            move(scene, 1 + 30 * (frame % 2), 10, &random);
            update(&m, scene);
            update(&again, scene);
        }
        memcpy(scene->boxes, first, 400 * sizeof *first);
        update(&m, scene);
        build(&m, scene);
        assert_true(hash_of(&m) == fresh);
        close_builder(&again); /* from here on against one that never moved before */
        open_builder(specs[s], &again);
        build(&again, scene);
        move(scene, 1, 10, &random);
        update(&m, scene);
        update(&again, scene);
        assert_true(hash_of(&m) == hash_of(&again));
        free(first);
        close_builder(&again);
        close_builder(&m);
        free_scene(scene);
    }
}

/* ---- awkward scenes ---- */

static void few_objects(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < SPECS; s++)
        for (uint32_t count = 1; count <= 5; count++) {
            bb_random random = bb_random_make(SEED, 10);
            bb_scene *scene = scene_of_boxes(count, &random);
            made m;
            open_builder(specs[s], &m);
            build(&m, scene);
            for (uint32_t frame = 0; frame < 50; frame++) {
                move(scene, 1 + frame % 3, 60, &random);
                update(&m, scene);
            }
            close_builder(&m);
            free_scene(scene);
        }
}

/* All equal, or all at the origin: about as deep as a tree of that width has to be; then they
 * part. */
static void equal_boxes_make_no_chains(void **state)
{
    (void)state;
    const char *const texts[] = {"gs", "gs:arity=2", "gs:search=bb"};
    for (uint32_t t = 0; t < 3; t++)
        for (int points = 0; points < 2; points++) {
            uint32_t count = t == 0 ? 10000 : 2000;
            bb_random random = bb_random_make(SEED, 11);
            bb_scene *scene = make_box_scene(count);
            for (uint32_t i = 0; i < count && !points; i++)
                for (int k = 0; k < 3; k++)
                    scene->boxes[i].hi[k] = 1;
            made m;
            open_builder(texts[t], &m);
            build(&m, scene);
            if (m.tree.info.depth > 30)
                fail_msg("%s, %s: depth %u", texts[t], points ? "points" : "cubes",
                         m.tree.info.depth);
            assert_true(m.tree.info.arity <= 16);
            move(scene, 1, 1, &random);
            update(&m, scene);
            move(scene, 1, 1, &random);
            update(&m, scene);
            close_builder(&m);
            free_scene(scene);
        }
}

/* Deeper than any stack: no search makes this, so it is made by hand. */
static void a_long_chain(void **state)
{
    (void)state;
    enum { COUNT = 100000 };
    bb_scene *scene = make_box_scene(COUNT);
    bb_gs_tree tree;
    bb_tree out;
    open_tree(&tree, (bb_gs_rules){.max_children = 16, .tau = 1.3}, COUNT);
    open_common(&out, COUNT);
    for (uint32_t i = 0; i < COUNT; i++) {
        scene->boxes[i].lo[0] = (float)i;
        scene->boxes[i].hi[0] = (float)i + 1;
        scene->boxes[i].hi[1] = scene->boxes[i].hi[2] = 1;
        bb_gs_box box = bb_gs_box_of(&scene->boxes[i]);
        if (i == 0) {
            bb_gs_add(&tree, i, &box);
        } else {
            tree.boxes[i] = box;
            bb_gs_attach(&tree, bb_gs_make_leaf(&tree, i, &box), tree.root, true, BB_NONE);
        }
    }
    bb_gs_start_q(&tree);
    bb_gs_emit(&tree, true, &out);
    assert_int_equal(out.info.depth, COUNT - 1);
    ASSERT_OK(bb_tree_check(&out, scene));
    for (uint32_t i = 0; i < 20; i++)
        scene->boxes[i * 5000].hi[0] += 5;
    bb_gs_move(&tree, scene->boxes, bb_gs_detect(&tree, scene->boxes));
    bb_gs_thin(&tree);
    bb_gs_emit(&tree, false, &out);
    ASSERT_OK(bb_tree_check(&out, scene));
    expect_sound(&tree, COUNT);
    close_pair(&tree, &out);
    free_scene(scene);
}

/* ---- what is refused ---- */

static void bad_options_are_refused(void **state)
{
    (void)state;
    const char *const bad[] = {"gs:max_children=1", "gs:max_children=2", "gs:tau=0.5", "gs:tau=-1",
                               "gs:thin_budget=x"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        made m;
        assert_int_equal(try_builder(bad[i], &m), BB_INVALID);
        close_builder(&m);
    }
}

static void expect_unsupported(made *m, const bb_scene *scene, uint32_t changed)
{
    bb_phases phases = {.current = -1};
    uint64_t before = hash_of(m);
    assert_int_equal(m->builder->update(m->self, scene, changed, &m->tree, &phases),
                     BB_UNSUPPORTED);
    assert_int_equal(phases.count, 0);
    assert_true(hash_of(m) == before);
}

static void other_changes_ask_for_a_build(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 12);
    bb_scene *scene = scene_of_boxes(50, &random);
    made m;
    open_builder("gs", &m);
    build(&m, scene);
    expect_unsupported(&m, scene, BB_CHANGED_POSITIONS | BB_CHANGED_TOPOLOGY);
    scene->prim_count--;
    expect_unsupported(&m, scene, BB_CHANGED_POSITIONS);
    scene->prim_count++;
    close_builder(&m);
    open_builder("gs:update=rebuild", &m);
    build(&m, scene);
    expect_unsupported(&m, scene, BB_CHANGED_POSITIONS);
    close_builder(&m);
    free_scene(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_stay_valid_over_many_frames),
        cmocka_unit_test(the_common_tree_follows_the_pool),
        cmocka_unit_test(free_slots_are_filled),
        cmocka_unit_test(few_movers_write_few_nodes),
        cmocka_unit_test(what_stays_still_is_not_touched),
        cmocka_unit_test(replays_are_the_same),
        cmocka_unit_test(few_objects),
        cmocka_unit_test(equal_boxes_make_no_chains),
        cmocka_unit_test(a_long_chain),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(other_changes_ask_for_a_build),
    };
    return cmocka_run_group_tests_name("gs: updates", tests, NULL, NULL);
}
