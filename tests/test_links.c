/* builders/common/links: skips, depth and counts from siblings alone, on the host and on the
 * device, are those of the tree that they were taken from. */
#include "builders/common/links.h"
#include "tests/tree_fixture.h"

#include "tests/device_forms.h"

enum { SEED = 977 };

/* Leaves of the last children's skips only that there is no sibling. */
static void forget_skips(bb_tree *tree)
{
    bb_node *nodes = tree->nodes;
    const bb_tree_info *info = &tree->info;
    uint32_t *ends = malloc(info->node_count * sizeof *ends);
    for (uint32_t i = 0; i < info->node_count; i++)
        ends[i] = nodes[i].skip;
    for (uint32_t i = 0; i < info->node_count; i++)
        if (!bb_node_is_leaf(&nodes[i])) {
            uint32_t child = nodes[i].first;
            while (ends[child] != ends[i])
                child = ends[child];
            nodes[child].skip = BB_NONE;
        }
    free(ends);
}

/* `device_too`: by the device as well, in both forms of its primitives. */
static void check_both(const bb_tree *tree, bool device_too)
{
    bb_tree_info known = {tree->info.root, tree->info.node_count, 0, tree->info.ref_count, 0, 0};
    size_t bytes = tree->info.node_count * sizeof(bb_node);
    bb_tree bare;
    copy_tree(tree, &bare);
    forget_skips(&bare);
    for (int form = CPU_FORM; form <= GPU_FORM && device_too; form++) {
        bb_links *links = NULL;
        bb_tree there;
        bb_tree_init(&there, NULL);
        ASSERT_OK(bb_tree_reserve(&there, devices[form], BB_ON_DEVICE, known.node_count,
                                  known.ref_count));
        ASSERT_OK(bb_buffer_write(&there.d_nodes, 0, bytes, bare.nodes));
        ASSERT_OK(bb_buffer_write(&there.d_refs, 0, known.ref_count * sizeof(uint32_t), bare.refs));
        ASSERT_OK(bb_links_create(devices[form], NULL, &links));
        ASSERT_OK(bb_links_finish_device(links, &known, &there));
        bb_tree_changed(&there);
        ASSERT_OK(bb_tree_download(&there, NULL));
        assert_memory_equal(there.nodes, tree->nodes, bytes);
        assert_memory_equal(&there.info, &tree->info, sizeof tree->info);
        bb_links_destroy(links);
        bb_tree_release(&there);
    }
    uint32_t *depths = malloc(known.node_count * sizeof *depths);
    bare.info = known;
    ASSERT_OK(bb_links_finish(&bare, depths));
    assert_memory_equal(bare.nodes, tree->nodes, bytes);
    assert_memory_equal(&bare.info, &tree->info, sizeof tree->info);
    free(depths);
    bb_tree_release(&bare);
}

static void random_trees_are_linked_as_they_were(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed_or(SEED), 0);
    for (uint32_t run = 0; run < 60; run++) {
        bb_scene *scene = make_random_scene(1 + bb_random_below(&random, 1000), &random);
        bb_tree tree;
        make_random_tree(scene, 2 + run % 8, 1 + run % 3, &random, &tree);
        check_both(&tree, run % 6 == 0);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

/* Leaves at each level of a chain, on either side of the rest. */
static void a_chain_of_a_million_levels(void **state)
{
    (void)state;
    enum { LEVELS = 1000000 };
    bb_tree tree;
    bb_tree_init(&tree, NULL);
    ASSERT_OK(bb_tree_reserve(&tree, NULL, BB_ON_HOST, 2 * LEVELS + 1, LEVELS + 1));
    uint32_t skip = BB_NONE;
    for (uint32_t i = 0; i <= LEVELS; i++) {
        /* nodes 2i: the chain; 2i + 1: the leaf beside 2i + 2, before or after it */
        bool first = i % 3 == 0;
        uint32_t leaf = 2 * i + 1, rest = 2 * i + 2, out = skip;
        tree.refs[i] = i | BB_LAST_BIT;
        if (i == LEVELS) {
            tree.nodes[2 * i] = (bb_node){.first = BB_LEAF_BIT | i, .skip = skip};
            break;
        }
        tree.nodes[2 * i] = (bb_node){.first = first ? leaf : rest, .skip = out};
        tree.nodes[leaf] = (bb_node){.first = BB_LEAF_BIT | i, .skip = first ? rest : out};
        skip = first ? out : leaf;
    }
    tree.info = (bb_tree_info){0, 2 * LEVELS + 1, LEVELS + 1, LEVELS + 1, 2, LEVELS};
    check_both(&tree, true);
    bb_tree_release(&tree);
}

static void what_is_no_tree_is_refused(void **state)
{
    (void)state;
    uint32_t depths[3];
    bb_node nodes[3] = {{.first = 1, .skip = BB_NONE},
                        {.first = BB_LEAF_BIT, .skip = 2},
                        {.first = 0, .skip = BB_NONE}}; /* back to the root */
    bb_tree tree;
    const uint32_t refs[1] = {BB_LAST_BIT};
    make_tree(&tree, nodes, 3, refs, 1, 2, 1);
    assert_int_equal(bb_links_finish(&tree, depths), BB_FAILED);
    tree.nodes[2].first = 7;
    assert_int_equal(bb_links_finish(&tree, depths), BB_FAILED);
    bb_tree_release(&tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_trees_are_linked_as_they_were),
        cmocka_unit_test(a_chain_of_a_million_levels),
        cmocka_unit_test(what_is_no_tree_is_refused),
    };
    return cmocka_run_group_tests_name("links", tests, open_devices, close_devices);
}
