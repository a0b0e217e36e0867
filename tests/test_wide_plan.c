/* Which nodes wide layouts have: greedy ones against the definition, planned ones against these,
 * and what kernels ask for. */
#include "tests/wide_fixture.h"

/* Half the area of a box of small whole numbers: without error. */
static float half_area(const float lo[3], const float hi[3])
{
    float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    return x * y + y * z + z * x;
}

/* By the definition: the largest of `out`, of equals the first, makes way for its children, as long
 * as there is room. */
static uint32_t children_by_greed(const bb_tree *tree, uint32_t n, uint32_t width, uint32_t out[8])
{
    uint32_t count = 1;
    out[0] = n;
    while (count < width) {
        uint32_t largest = count;
        float area = -1;
        for (uint32_t c = 0; c < count; c++) {
            const bb_node *node = &tree->nodes[out[c]];
            if ((node->first & BB_LEAF_BIT) == 0 && half_area(node->lo, node->hi) > area) {
                area = half_area(node->lo, node->hi);
                largest = c;
            }
        }
        if (largest == count)
            break;
        memmove(out + largest + 2, out + largest + 1, (count - largest - 1) * sizeof *out);
        out[largest] = tree->nodes[out[largest]].first;
        out[largest + 1] = tree->nodes[out[largest]].skip;
        count++;
    }
    return count;
}

/* That what `link` leads to is what greed makes of node n of the tree. */
static void compare_by_greed(const wide *w, const bb_tree *tree, uint32_t link, uint32_t n)
{
    assert_int_equal(link & BB_LEAF_BIT, tree->nodes[n].first & BB_LEAF_BIT);
    if ((link & BB_LEAF_BIT) != 0)
        return;
    uint32_t wanted[8], count;
    const uint32_t *links = links_of(w, link, &count);
    assert_int_equal(count, children_by_greed(tree, n, w->width, wanted));
    for (uint32_t c = 0; c < count; c++) {
        bb_box box, said = box_of(w, link, c);
        memcpy(box.lo, tree->nodes[wanted[c]].lo, sizeof box.lo);
        memcpy(box.hi, tree->nodes[wanted[c]].hi, sizeof box.hi);
        box = padded_box(&box);
        for (int k = 0; k < 3; k++)
            assert_true(said.lo[k] == box.lo[k] && said.hi[k] == box.hi[k]);
        compare_by_greed(w, tree, links[c], wanted[c]);
    }
}

/* Areas of the nodes below a node, children that are leaves left out. */
static double area_below(const wide *w, uint32_t link)
{
    uint32_t count;
    const uint32_t *links = links_of(w, link, &count);
    double sum = 0;
    for (uint32_t c = 0; c < count; c++) {
        const bb_box box = box_of(w, link, c);
        if ((links[c] & BB_LEAF_BIT) == 0)
            sum += half_area(box.lo, box.hi) + area_below(w, links[c]);
    }
    return sum;
}

/* Who asks for it by name gets it; who has no use for it is told. */
static void a_kernel_asks_for_its_nodes(void **state)
{
    (void)state;
    bb_spec spec;
    const bb_kernel *kernel;
    ASSERT_OK(bb_kernel_parse("stack8i:leaf=8,plan=greedy", &spec, &kernel));
    assert_int_equal(bb_kernel_wish(&spec).plan, BB_PLAN_GREEDY);
    ASSERT_OK(bb_kernel_parse("short4:plan=optimal", &spec, &kernel));
    assert_int_equal(bb_kernel_wish(&spec).plan, BB_PLAN_OPTIMAL);
    ASSERT_OK(bb_kernel_parse("short4", &spec, &kernel));
    assert_int_equal(bb_kernel_wish(&spec).plan, BB_PLAN_BY_TREE);
    ASSERT_OK(bb_kernel_parse("stack8q:plan=native", &spec, &kernel));
    assert_int_equal(bb_kernel_wish(&spec).plan, BB_PLAN_NATIVE);
    assert_int_equal(bb_kernel_parse("cwbvh:plan=native", &spec, &kernel), BB_INVALID);
    assert_non_null(strstr(bb_message(), "leave out plan=native"));
    assert_int_equal(bb_kernel_parse("stack4:plan=best", &spec, &kernel), BB_INVALID);
    assert_int_equal(bb_kernel_parse("stack:plan=optimal", &spec, &kernel), BB_INVALID);
    assert_non_null(strstr(bb_message(), "drop plan="));
    ASSERT_OK(bb_kernel_parse("stack8i:leaf=8,node=0.25", &spec, &kernel));
    assert_true(bb_kernel_wish(&spec).node_cost == 0.25);
    ASSERT_OK(bb_kernel_parse("stack:leaf=8", &spec, &kernel));
    assert_true(bb_kernel_wish(&spec).node_cost == 0);
    assert_int_equal(bb_kernel_parse("stack8i:leaf=8,node=0", &spec, &kernel), BB_INVALID);
    assert_int_equal(bb_kernel_parse("stack8i:leaf=8,node=half", &spec, &kernel), BB_INVALID);
    assert_int_equal(bb_kernel_parse("stack8i:node=0.25", &spec, &kernel), BB_INVALID);
    assert_non_null(strstr(bb_message(), "give leaf=N"));
}

/* Triangles with corners of small whole numbers, so that areas have no error and many are equal. */
static bb_scene *make_lattice_scene(uint32_t count, bb_random *random)
{
    float v[9 * 64];
    assert_true(count <= 64);
    for (uint32_t i = 0; i < 9 * count; i++)
        v[i] = (float)bb_random_below(random, 12);
    bb_scene *scene = make_scene(v, count, NULL, 0);
    assert_true(scene->scale == 1.0f); /* what padded_box() is for */
    ASSERT_OK(bb_scene_upload(scene, device));
    return scene;
}

/* The cheaper a node, the fewer leaves become one: and the layout's name says what it was taken to
 * cost. */
static void cheap_nodes_keep_leaves_apart(void **state)
{
    (void)state;
    static const double costs[] = {100, 0.01};
    bb_random random = bb_random_make(SEED + 5, 0);
    bb_tree tree;
    size_t before = 0;
    device = devices[CPU_FORM];
    bb_scene *scene = make_lattice_scene(64, &random);
    make_random_tree(scene, 2, 1, &random, &tree);
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    for (size_t i = 0; i < sizeof costs / sizeof costs[0]; i++) {
        bb_layout_maker maker;
        bb_layout_data data = {0};
        char node[24];
        ASSERT_OK(bb_layout_maker_create(bb_layout_find("wide8"), device, &maker));
        maker.wish.node_cost = costs[i];
        ASSERT_OK(bb_layout_maker_make(&maker, scene, &tree, 8, BB_FORMAT_VERTICES, &data));
        snprintf(node, sizeof node, "node=%g", costs[i]);
        assert_non_null(strstr(data.name, node));
        assert_true(data.buffers[0].bytes > before);
        before = data.buffers[0].bytes;
        bb_layout_data_release(&data);
        bb_layout_maker_destroy(&maker);
    }
    bb_tree_release(&tree);
    free_scene(scene);
}

/* Greedy nodes are those of the definition, and the plan's have no more area: less on some tree. */
static void nodes_are_those_of_the_plan(void **state)
{
    (void)state;
    const bb_layout_wish greedy = {.plan = BB_PLAN_GREEDY}, optimal = {.plan = BB_PLAN_OPTIMAL};
    uint32_t better = 0;
    for (uint32_t run = 0; run < (small() ? 6u : 60u); run++) {
        bb_random random = bb_random_make(SEED + 4, run);
        bb_scene *scene = make_lattice_scene(2 + bb_random_below(&random, 63), &random);
        const char *name = run % 2 == 0 ? "wide8" : "wide4";
        bb_tree tree;
        uint32_t root;
        make_random_tree(scene, 2, 1, &random, &tree);
        ASSERT_OK(bb_tree_upload(&tree, device, NULL));
        wide w = read_wide(name, scene, &tree, 1, &greedy, &root);
        compare_by_greed(&w, &tree, root, tree.info.root);
        double most = area_below(&w, root);
        free_wide(&w);
        w = read_wide(name, scene, &tree, 1, &optimal, &root);
        double least = area_below(&w, root);
        free_wide(&w);
        if (!(least <= most * (1 + 1e-6)))
            fail_msg("run %u %s: nodes of %g planned, of %g by greed", run, name, least, most);
        better += least < most * 0.99;
        bb_tree_release(&tree);
        free_scene(scene);
    }
    assert_true(better > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_are_those_of_the_plan),
    };
    const struct CMUnitTest of_all[] = {
        cmocka_unit_test(a_kernel_asks_for_its_nodes),
        cmocka_unit_test(cheap_nodes_keep_leaves_apart),
    };
    int failed = open_devices(NULL);
    if (first_form() == CPU_FORM && failed == 0)
        failed = cmocka_run_group_tests(of_all, NULL, NULL);
    RUN_ON_EACH_DEVICE(tests, failed)
    close_devices(NULL);
    return failed;
}
