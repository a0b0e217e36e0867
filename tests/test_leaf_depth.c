/* The mean depth of leaves against cases solved by hand; the derivations are beside them. */
#include "framework/builder/metric.h"
#include "tests/tree_fixture.h"

static bb_status measure(const bb_tree *tree, bb_metric_value *out)
{
    return bb_metric_compute(bb_metrics[bb_metric_find("leaf_depth")], tree, NULL, 1, 1, out);
}

static void expect(const bb_tree *tree, double exact)
{
    bb_metric_value depth;
    ASSERT_OK(measure(tree, &depth));
    ASSERT_NEAR(depth.value, exact, 1e-14);
    assert_true(isnan(depth.half));
}

/* Root { A, N { B, C } }. A: [0,2] x [0,1]^2, half area 2 + 1 + 2 = 5, depth 1. B: [2,4] x [0,1]^2,
 * half area 5, and C: [4,5] x [0,1] x [0,0], half area 1, both at depth 2. (5 + 10 + 2) / 11. The
 * inner nodes' areas do not count, and it is not the mean of 1, 2 and 2. */
static void test_weighted_by_area(void **state)
{
    (void)state;
    const bb_node nodes[] = {
        make_node(V(0, 0, 0), V(5, 1, 1), 1, BB_NONE),
        make_node(V(0, 0, 0), V(2, 1, 1), BB_LEAF_BIT | 0, 2),
        make_node(V(2, 0, 0), V(5, 1, 1), 3, BB_NONE),
        make_node(V(2, 0, 0), V(4, 1, 1), BB_LEAF_BIT | 1, 4),
        make_node(V(4, 0, 0), V(5, 1, 0), BB_LEAF_BIT | 2, BB_NONE),
    };
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT, 2 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 5, refs, 3, 2, 2);
    expect(&tree, 17.0 / 11);
    /* nodes in another order are the same tree: N at 4, C at 2 */
    const bb_node moved[] = {
        nodes[0],
        make_node(V(0, 0, 0), V(2, 1, 1), BB_LEAF_BIT | 0, 4),
        nodes[4],
        make_node(V(2, 0, 0), V(4, 1, 1), BB_LEAF_BIT | 1, 2),
        make_node(V(2, 0, 0), V(5, 1, 1), 3, BB_NONE),
    };
    bb_tree_release(&tree);
    make_tree(&tree, moved, 5, refs, 3, 2, 2);
    expect(&tree, 17.0 / 11);
    bb_tree_release(&tree);
}

/* One leaf: depth 0; without area, nothing to weigh by. */
static void test_single_leaf(void **state)
{
    (void)state;
    const bb_node leaf = make_node(V(0, 0, 0), V(1, 0, 1), BB_LEAF_BIT | 0, BB_NONE);
    const uint32_t refs[] = {0, 1 | BB_LAST_BIT};
    bb_tree tree;
    bb_metric_value depth;
    make_tree(&tree, &leaf, 1, refs, 2, 0, 0);
    expect(&tree, 0);
    tree.nodes[0].hi[0] = 0;
    ASSERT_OK(measure(&tree, &depth));
    assert_true(isnan(depth.value));
    tree.nodes[0].skip = 0;
    assert_int_equal(measure(&tree, &depth), BB_FAILED);
    bb_tree_release(&tree);
}

/* Four leaves of one area below one node: all at depth 1, however wide the tree. */
static void test_wide(void **state)
{
    (void)state;
    bb_tree tree;
    make_row(&tree);
    expect(&tree, 1);
    bb_tree_release(&tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weighted_by_area),
        cmocka_unit_test(test_single_leaf),
        cmocka_unit_test(test_wide),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
