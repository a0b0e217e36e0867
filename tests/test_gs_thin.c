/* gs: which nodes are thinned: the threshold, and the budget of an update. */
#include "tests/gs_fixture.h"

/* One inner node below the root, whose initial area per object is made up. */
static void the_threshold_is_a_ratio(void **state)
{
    (void)state;
    static const struct {
        double ratio;
        bool least_q;
        uint32_t thinned;
    } cases[] = {{1.29, false, 0}, {1.31, false, 1}, {0.5, false, 0}, {0.5, true, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_gs_tree tree;
        const float x[3] = {0, 9, 0};
        open_tree(&tree, (bb_gs_rules){.tau = 1.3, .least_q = cases[i].least_q}, 3);
        for (uint32_t k = 0; k < 3; k++) {
            bb_gs_box box = {{x[k], 0, 0}, {x[k] + 1, 1, 1}};
            bb_gs_add(&tree, k, &box);
        }
        uint32_t pair = tree.nodes[tree.leaf_of[0]].parent;
        assert_true(pair != tree.root && tree.nodes[pair].children == 2);
        double q = tree.nodes[pair].area / 2, init = q / cases[i].ratio;
        bb_gs_start_q(&tree);
        assert_true(tree.nodes[pair].q_init == q);
        bb_gs_thin(&tree); /* it is not touched */
        assert_int_equal(tree.thinned, 0);
        tree.nodes[pair].q_init = init;
        tree.marks[pair] |= BB_GS_TOUCHED;
        bb_gs_thin(&tree);
        assert_int_equal(tree.thinned, cases[i].thinned);
        assert_int_equal(tree.reinserted, 2 * cases[i].thinned);
        if (cases[i].thinned == 0)
            assert_true(tree.nodes[pair].q_init == (cases[i].least_q ? q : init));
        expect_sound(&tree, 3);
        bb_gs_release(&tree);
    }
}

static void a_high_threshold_thins_nothing(void **state)
{
    (void)state;
    const char *const texts[] = {"gs:tau=0", "gs:tau=1e9", "gs:tau=1.01"};
    uint64_t hashes[3];
    for (uint32_t t = 0; t < 3; t++) {
        bb_random random = bb_random_make(SEED, 8);
        bb_scene *scene = scene_of_boxes(1000, &random);
        made m;
        uint64_t thinned = 0;
        open_builder(texts[t], &m);
        build(&m, scene);
        for (uint32_t frame = 0; frame < 10; frame++) {
            move(scene, 2, 5, &random);
            update(&m, scene);
            thinned += event(&m, "thinned");
        }
        hashes[t] = hash_of(&m);
        assert_true(t < 2 ? thinned == 0 : thinned > 0);
        close_builder(&m);
        free_scene(scene);
    }
    assert_true(hashes[0] == hashes[1] && hashes[0] != hashes[2]);
}

/* What is left over for want of a budget comes in the next updates. */
static void a_budget_delays(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 9);
    bb_scene *scene = scene_of_boxes(1000, &random);
    made m;
    open_builder("gs:tau=1.05,thin_budget=7", &m);
    build(&m, scene);
    move(scene, 1, 10, &random);
    update(&m, scene);
    for (uint32_t i = 0; i < 5; i++) {
        assert_true(event(&m, "thinned") > 0 && event(&m, "thinned") <= 7);
        scene->boxes[0].hi[0] += 0.01f;
        update(&m, scene);
    }
    close_builder(&m);
    free_scene(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_threshold_is_a_ratio),
        cmocka_unit_test(a_high_threshold_thins_nothing),
        cmocka_unit_test(a_budget_delays),
    };
    return cmocka_run_group_tests_name("gs: thinning", tests, NULL, NULL);
}
