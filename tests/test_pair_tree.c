/* Trees of pairs: chains, whose subtrees are small and many, in every form. */
#include "builders/common/pair_tree.h"
#include "tests/device_forms.h"
#include "tests/fixture.h"

#include <stdlib.h>
#include <string.h>

/* So many that the top, at most 4,096 tasks, leaves most of the chain to one walk. */
enum { TWIGS = 6000, PRIMS = 2 * TWIGS };

static bb_pair_side side(uint32_t link, uint32_t count)
{
    return (bb_pair_side){.link = link, .hi = {1, 1, 1}, .count = count};
}

/* Pair t < TWIGS is a twig: primitives 2t and 2t + 1. Pair TWIGS + t joins the chain of twigs 0 to
 * t and twig t + 1, the chain on the left, on the right or by turns. */
static bb_pair_side make_chain(bb_cluster_pair *pairs, int manner)
{
    bb_pair_side chain = side(0, 2);
    for (uint32_t t = 0; t < TWIGS; t++)
        pairs[t] =
            (bb_cluster_pair){{side(BB_LEAF_BIT | (2 * t), 1), side(BB_LEAF_BIT | (2 * t + 1), 1)}};
    for (uint32_t t = 0; t + 1 < TWIGS; t++) {
        bool right = manner == 1 || (manner == 2 && t % 2 == 1);
        bb_pair_side twig = side(t + 1, 2);
        pairs[TWIGS + t] =
            right ? (bb_cluster_pair){{twig, chain}} : (bb_cluster_pair){{chain, twig}};
        chain = side(TWIGS + t, chain.count + 2);
    }
    return chain;
}

/* Every primitive is in one leaf, every node is reached once, the depth is the chain's. */
static void check_chain(bb_tree *tree)
{
    static unsigned char seen[PRIMS];
    uint32_t nodes = 0, leaves = 0;
    memset(seen, 0, sizeof seen);
    ASSERT_OK(bb_tree_fetch_info(tree));
    ASSERT_OK(bb_tree_download(tree, NULL));
    assert_int_equal(tree->info.node_count, 2 * PRIMS - 1);
    assert_int_equal(tree->info.depth, TWIGS);
    for (uint32_t n = tree->info.root; n != BB_NONE && nodes < 2 * PRIMS; nodes++) {
        assert_true(n < 2 * PRIMS - 1);
        const bb_node *node = &tree->nodes[n];
        if ((node->first & BB_LEAF_BIT) == 0) {
            n = node->first;
            continue;
        }
        const uint32_t ref = tree->refs[node->first & BB_INDEX_MASK];
        assert_true((ref & BB_LAST_BIT) != 0 && (ref & BB_INDEX_MASK) < PRIMS);
        assert_false(seen[ref & BB_INDEX_MASK]++);
        leaves++;
        n = node->skip;
    }
    assert_int_equal(nodes, 2 * PRIMS - 1);
    assert_int_equal(leaves, PRIMS);
}

static void chains_of_twigs(void **state)
{
    (void)state;
    static bb_cluster_pair pairs[PRIMS];
    for (int form = first_form(); form < FORMS; form++)
        for (int manner = 0; manner < 3; manner++) {
            bb_account account = {0};
            bb_tree tree;
            bb_tree_init(&tree, &account);
            bb_pair_tree *made;
            const bb_pair_side root = make_chain(pairs, manner);
            ASSERT_OK(bb_pair_tree_create(devices[form], &account, &made));
            ASSERT_OK(bb_pair_tree_reserve(made, PRIMS, &tree));
            bb_buffer to_pairs = *bb_pair_tree_pairs(made), to_root = *bb_pair_tree_root(made);
            ASSERT_OK(bb_buffer_write(&to_pairs, 0, sizeof pairs, pairs));
            ASSERT_OK(bb_buffer_write(&to_root, 0, sizeof root, &root));
            ASSERT_OK(bb_pair_tree_finish(made, PRIMS, &tree));
            check_chain(&tree);
            bb_tree_release(&tree);
            bb_pair_tree_destroy(made);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(chains_of_twigs)};
    return cmocka_run_group_tests_name("pair_tree", tests, open_devices, close_devices);
}
