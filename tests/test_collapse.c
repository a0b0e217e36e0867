/* Leaf collapse: random trees of any arity, and trees whose costs are known. */
#include "tests/wide_fixture.h"
#include "traversal/collapse.h"

/* Collapses a copy on the device; `out` ends up on the host as well. */
static void collapse(bb_collapse *collapse, bb_tree *tree, uint32_t leaf, uint32_t width,
                     uint32_t block, bb_tree **out)
{
    ASSERT_OK(bb_tree_upload(tree, device, NULL));
    ASSERT_OK(bb_collapse_make(collapse, tree, 1.0f, leaf,
                               bb_collapse_traversal(bb_collapse_node_cost(width), width), block, 0,
                               out));
    ASSERT_OK(bb_tree_download(*out, NULL));
}

static void collapsed_trees_are_valid_and_cost_no_more(void **state)
{
    (void)state;
    bb_account account = {0};
    bb_collapse *self;
    ASSERT_OK(bb_collapse_create(device, &account, &self));
    for (uint32_t run = 0; run < (small() ? 5u : 100u); run++) {
        bb_random random = bb_random_make(SEED, run);
        bb_scene *scene =
            make_random_scene(1 + bb_random_below(&random, small() ? 40 : 400), &random);
        bb_tree tree, *out;
        make_random_tree(scene, 2 + bb_random_below(&random, 7), 1, &random, &tree);
        double before = bb_tree_sah(&tree);
        for (uint32_t leaf = 1; leaf <= BB_LEAF_MAX; leaf *= 2)
            for (uint32_t block = 1; block <= 4; block += 3) {
                collapse(self, &tree, leaf, block == 1 ? 2 : 8, block, &out);
                if (bb_tree_check(out, scene) != BB_OK)
                    fail_msg("seed %llu run %u leaf %u block %u: %s", (unsigned long long)SEED, run,
                             leaf, block, bb_message());
                double after = bb_tree_sah(out);
                if ((block == 1 && !(after <= before * (1 + 1e-5))) ||
                    (leaf == 1 && fabs(after - before) > 1e-9))
                    fail_msg("seed %llu run %u leaf %u: SAH %g became %g", (unsigned long long)SEED,
                             run, leaf, before, after);
                for (uint32_t i = 0, width = 1; i < out->info.ref_count; i++, width++) {
                    assert_true(width <= leaf);
                    width = out->refs[i] & BB_LAST_BIT ? 0 : width;
                }
            }
        bb_tree_release(&tree);
        free_scene(scene);
    }
    bb_collapse_destroy(self);
    assert_int_equal(account.bytes, 0);
}

/* Two leaves of equal boxes: a leaf of both costs 2 A, or A as a block, the inner node 1.2 A + 2 A.
 * Far apart, the inner node is kept. */
static void collapse_decides_by_cost(void **state)
{
    (void)state;
    const float lo[3] = {0, 0, 0}, hi[3] = {1, 1, 1}, far_lo[3] = {100, 0, 0},
                far_hi[3] = {101, 1, 1};
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT};
    const bb_node near[] = {make_node(lo, hi, 1, BB_NONE), make_node(lo, hi, BB_LEAF_BIT | 0, 2),
                            make_node(lo, hi, BB_LEAF_BIT | 1, BB_NONE)};
    const bb_node far[] = {make_node(lo, far_hi, 1, BB_NONE), near[1],
                           make_node(far_lo, far_hi, BB_LEAF_BIT | 1, BB_NONE)};
    bb_collapse *self;
    bb_tree tree, *out;
    ASSERT_OK(bb_collapse_create(device, NULL, &self));
    make_tree(&tree, near, 3, refs, 2, 2, 1);
    collapse(self, &tree, 1, 2, 1, &out);
    assert_int_equal(out->info.node_count, 3);
    collapse(self, &tree, 2, 2, 1, &out);
    assert_int_equal(out->info.node_count, 1);
    assert_int_equal(out->info.leaf_count, 1);
    assert_int_equal(out->info.ref_count, 2);
    assert_int_equal(out->info.arity, 0);
    assert_int_equal(out->info.depth, 0);
    bb_tree_release(&tree);

    make_tree(&tree, far, 3, refs, 2, 2, 1);
    collapse(self, &tree, 2, 2, 1, &out); /* 2 * 203 against 1.2 * 203 + 2 * 3 */
    assert_int_equal(out->info.node_count, 3);
    assert_int_equal(out->info.arity, 2);
    assert_int_equal(out->info.depth, 1);
    collapse(self, &tree, 2, 8, 4, &out); /* one block, 203, against 1.2 * 4 / 7 * 203 + 2 * 3 */
    assert_int_equal(out->info.node_count, 3);
    collapse(self, &tree, 2, 2, 4, &out); /* 203 against 1.2 * 203 + 2 * 3 */
    assert_int_equal(out->info.node_count, 1);
    /* the same where a node of 8 costs as much as 40 blocks: 40 / 7 * 203 + 2 * 3 */
    ASSERT_OK(bb_collapse_make(self, &tree, 1.0f, 2, bb_collapse_traversal(40, 8), 4, 0, &out));
    assert_int_equal(out->info.node_count, 1);
    bb_tree_release(&tree);

    /* Whichever the axis on which all is flat, and of whose faces nothing is seen: 2 * 101 against
     * 1.2 * 101 + 2. */
    for (uint32_t flat = 0; flat < 3; flat++) {
        float sizes[3] = {1, 1, 1}, from[3] = {0, 0, 0}, to[3];
        uint32_t along = (flat + 1) % 3;
        sizes[flat] = 0;
        memcpy(to, sizes, sizeof sizes);
        from[along] = 100;
        to[along] = 101;
        const bb_node row[] = {make_node(lo, to, 1, BB_NONE),
                               make_node(lo, sizes, BB_LEAF_BIT | 0, 2),
                               make_node(from, to, BB_LEAF_BIT | 1, BB_NONE)};
        make_tree(&tree, row, 3, refs, 2, 2, 1);
        collapse(self, &tree, 2, 2, 1, &out);
        assert_int_equal(out->info.node_count, 3);
        bb_tree_release(&tree);
    }

    /* Two unit squares side by side, with Ct = 1: 2 * 2 against 2 + 1 + 1, which is no more. */
    const float square[3] = {1, 1, 0}, twice[3] = {2, 1, 0}, beside[3] = {1, 0, 0};
    const bb_node tied[] = {make_node(lo, twice, 1, BB_NONE),
                            make_node(lo, square, BB_LEAF_BIT | 0, 2),
                            make_node(beside, twice, BB_LEAF_BIT | 1, BB_NONE)};
    make_tree(&tree, tied, 3, refs, 2, 2, 1);
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    for (int more = 0; more < 2; more++) {
        const float traversal = more ? 1.0f : 0.999f;
        ASSERT_OK(bb_collapse_make(self, &tree, 1.0f, 2, traversal, 1, 0, &out));
        assert_int_equal(out->info.node_count, more ? 1 : 3);
    }
    bb_tree_release(&tree);

    /* A primitive that both leaves reference is referenced once by the leaf of both. */
    make_tree(&tree, near, 3, refs, 2, 2, 1);
    tree.duplicated = true;
    tree.refs[1] = 0 | BB_LAST_BIT;
    collapse(self, &tree, 2, 2, 1, &out);
    assert_int_equal(out->info.ref_count, 1);
    bb_tree_release(&tree);
    bb_collapse_destroy(self);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(collapsed_trees_are_valid_and_cost_no_more),
        cmocka_unit_test(collapse_decides_by_cost),
    };
    int failed = open_devices(NULL);
    RUN_ON_EACH_DEVICE(tests, failed)
    close_devices(NULL);
    return failed;
}
