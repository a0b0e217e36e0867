/* The common tree: preorder, hash, stack need; memory and copies. */
#include "tests/device_fixture.h"
#include "tests/tree_fixture.h"

static const uint64_t SEED = 20240607;

/* ---- valid trees ---- */

static void test_random_trees_pass(void **state)
{
    (void)state;
    for (uint32_t run = 0; run < 200; run++) {
        bb_random random = bb_random_make(SEED, run);
        uint32_t count = 1 + bb_random_below(&random, run < 100 ? 12 : 600);
        uint32_t arity = 2 + bb_random_below(&random, 9), leaf = 1 + bb_random_below(&random, 5);
        bb_scene *scene = make_random_scene(count, &random);
        bb_tree tree, twice, preorder;
        make_random_tree(scene, arity, leaf, &random, &tree);
        if (bb_tree_check(&tree, scene) != BB_OK)
            fail_msg("seed %llu run %u: %s", (unsigned long long)SEED, run, bb_message());

        bb_tree_init(&preorder, NULL);
        bb_tree_init(&twice, NULL);
        ASSERT_OK(bb_tree_preorder(&tree, &preorder));
        ASSERT_OK(bb_tree_check(&preorder, scene));
        ASSERT_OK(bb_tree_preorder(&preorder, &twice));
        assert_memory_equal(&preorder.info, &twice.info, sizeof twice.info);
        assert_memory_equal(preorder.nodes, twice.nodes, twice.info.node_count * sizeof(bb_node));
        assert_memory_equal(preorder.refs, twice.refs, twice.info.ref_count * sizeof(uint32_t));
        uint64_t a, b;
        ASSERT_OK(bb_tree_hash(&tree, &a));
        ASSERT_OK(bb_tree_hash(&preorder, &b));
        assert_int_equal(a, b);
        preorder.nodes[0].lo[1] = nextafterf(preorder.nodes[0].lo[1], -INFINITY);
        ASSERT_OK(bb_tree_hash(&preorder, &b));
        assert_int_not_equal(a, b);
        bb_tree_release(&tree);
        bb_tree_release(&preorder);
        bb_tree_release(&twice);
        free_scene(scene);
    }
}

/* A chain: each inner node has a leaf and the rest of the chain; as deep as there are primitives.
 */
static void test_deep_chain(void **state)
{
    (void)state;
    const uint32_t count = 1000000;
    bb_scene *scene = make_box_scene(count);
    bb_tree tree;
    bb_tree_init(&tree, NULL);
    ASSERT_OK(bb_tree_reserve(&tree, NULL, BB_ON_HOST, 2 * count - 1, count));
    for (uint32_t i = 0; i < count; i++) {
        const float lo[3] = {0, 0, 0}, hi[3] = {1, 1, 1};
        bool last = i == count - 1;
        memcpy(scene->boxes[i].hi, hi, sizeof hi);
        if (!last)
            tree.nodes[2 * i] = make_node(lo, hi, 2 * i + 1, BB_NONE);
        tree.nodes[last ? 2 * i : 2 * i + 1] =
            make_node(lo, hi, BB_LEAF_BIT | i, last ? BB_NONE : 2 * i + 2);
        tree.refs[i] = i | BB_LAST_BIT;
    }
    tree.info = (bb_tree_info){0, 2 * count - 1, count, count, 2, count - 1};
    ASSERT_OK(bb_tree_check(&tree, scene));
    bb_tree_release(&tree);
    free_scene(scene);
}

/* ---- memory ---- */

static void test_reserve_refuses(void **state)
{
    (void)state;
    bb_account account = {0};
    bb_tree tree;
    bb_tree_init(&tree, &account);
    assert_int_equal(bb_tree_reserve(&tree, NULL, BB_ON_HOST, (size_t)1 << 31, 1), BB_REFUSED);
    assert_int_equal(bb_tree_reserve(&tree, NULL, BB_ON_HOST, 1, (size_t)1 << 31), BB_REFUSED);
    ASSERT_OK(bb_tree_reserve(&tree, NULL, BB_ON_HOST, 10, 20));
    assert_int_equal(account.bytes, 10 * sizeof(bb_node) + 20 * sizeof(uint32_t));
    const bb_node *nodes = tree.nodes;
    ASSERT_OK(bb_tree_reserve(&tree, NULL, BB_ON_HOST, 5, 5));
    assert_ptr_equal(tree.nodes, nodes);
    bb_tree_release(&tree);
    assert_int_equal(account.bytes, 0);
}

/* Host to device and back, the copies unbooked, and stale ones made anew. */
static void test_copies(void **state)
{
    (void)state;
    ASSERT_OK(open_test_device(BB_FORM_AUTO, NULL, &device));
    bb_random random = bb_random_make(SEED + 5, 0);
    bb_scene *scene = make_random_scene(1000, &random);
    bb_account account = {0};
    bb_tree host, there;
    uint64_t a, b;
    make_random_tree(scene, 4, 2, &random, &host);
    ASSERT_OK(bb_tree_hash(&host, &a));
    double ms;
    uint32_t flags[1000], back[1000]; /* a side array, one word per reference */
    bb_tree_array *array;
    ASSERT_OK(bb_tree_reserve_array(&host, NULL, "flags", true, sizeof *flags, &array));
    for (uint32_t i = 0; i < 1000; i++)
        flags[i] = (uint32_t)bb_random_u64(&random);
    memcpy(array->host, flags, sizeof flags);
    ASSERT_OK(bb_tree_upload(&host, device, &ms));
    assert_true(ms > 0);
    ASSERT_OK(bb_buffer_read(&array->buffer, 0, sizeof back, back));
    assert_memory_equal(flags, back, sizeof back);

    bb_tree_init(&there, &account);
    const bb_tree_info *info = &host.info;
    ASSERT_OK(bb_tree_reserve(&there, device, BB_ON_DEVICE, info->node_count, info->ref_count));
    uint64_t booked = account.bytes;
    assert_true(booked >= bb_tree_bytes(&host) - sizeof flags);
    ASSERT_OK(bb_buffer_write(&there.d_info, 0, sizeof *info, info));
    ASSERT_OK(bb_buffer_write(&there.d_nodes, 0, info->node_count * sizeof(bb_node), host.nodes));
    ASSERT_OK(bb_buffer_write(&there.d_refs, 0, info->ref_count * sizeof(uint32_t), host.refs));
    assert_int_equal(bb_tree_check(&there, scene), BB_FAILED); /* not on the host */
    ASSERT_OK(bb_tree_download(&there, &ms));
    assert_int_equal(account.bytes, booked);
    ASSERT_OK(bb_tree_check(&there, scene));
    ASSERT_OK(bb_tree_hash(&there, &b));
    assert_int_equal(a, b);

    bb_node root;
    ASSERT_OK(bb_buffer_read(&there.d_nodes, info->root * sizeof root, sizeof root, &root));
    root.lo[0] -= 1;
    ASSERT_OK(bb_buffer_write(&there.d_nodes, info->root * sizeof root, sizeof root, &root));
    bb_tree_changed(&there);
    ASSERT_OK(bb_tree_download(&there, NULL));
    ASSERT_OK(bb_tree_hash(&there, &b));
    assert_int_not_equal(a, b);

    /* An info that claims more than there is room for is refused before anything is copied. */
    bb_tree_info claim = *info;
    claim.node_count = 1u << 30;
    ASSERT_OK(bb_buffer_write(&there.d_info, 0, sizeof claim, &claim));
    bb_tree_changed(&there);
    assert_int_equal(bb_tree_download(&there, NULL), BB_FAILED);
    bb_tree_release(&host);
    bb_tree_release(&there);
    assert_int_equal(account.bytes, 0);
    free_scene(scene);
    bb_device_close(device);
}

/* What an optimiser hands on as it was: leaves of several references, the root anywhere, flags that
 * the other tree has otherwise. */
static void test_trees_are_copied_as_they_are(void **state)
{
    (void)state;
    ASSERT_OK(open_test_device(BB_FORM_AUTO, NULL, &device));
    for (uint32_t run = 0; run < 8; run++) {
        bb_random random = bb_random_make(SEED + 6, run);
        bb_scene *scene = make_random_scene(run == 0 ? 1 : 300 + run, &random);
        bb_tree host, from, to;
        uint64_t a, b;
        make_random_tree(scene, 4, 3, &random, &host);
        ASSERT_OK(bb_tree_hash(&host, &a));
        const bb_tree_info info = host.info;
        bb_tree_init(&from, NULL);
        bb_tree_init(&to, NULL);
        ASSERT_OK(bb_tree_reserve(&from, device, BB_ON_DEVICE, info.node_count, info.ref_count));
        ASSERT_OK(bb_tree_reserve(&to, device, BB_ON_DEVICE, info.node_count, info.ref_count));
        ASSERT_OK(bb_buffer_write(&from.d_nodes, 0, info.node_count * sizeof(bb_node), host.nodes));
        ASSERT_OK(bb_buffer_write(&from.d_refs, 0, info.ref_count * sizeof(uint32_t), host.refs));
        ASSERT_OK(bb_buffer_fill(&to.d_nodes, info.node_count * sizeof(bb_node), 0));
        ASSERT_OK(bb_buffer_fill(&to.d_refs, info.ref_count * sizeof(uint32_t), 0));
        from.info = info;
        from.duplicated = (run & 1) != 0;
        from.disjoint = (run & 2) != 0;
        from.keep_nodes = (run & 4) != 0;
        to.duplicated = !from.duplicated;
        to.disjoint = !from.disjoint;
        to.keep_nodes = !from.keep_nodes;
        ASSERT_OK(bb_tree_copy(&from, &to));
        ASSERT_OK(bb_tree_download(&to, NULL));
        assert_memory_equal(&to.info, &info, sizeof info);
        assert_memory_equal(to.nodes, host.nodes, info.node_count * sizeof(bb_node));
        assert_memory_equal(to.refs, host.refs, info.ref_count * sizeof(uint32_t));
        assert_int_equal(to.duplicated, from.duplicated);
        assert_int_equal(to.disjoint, from.disjoint);
        assert_int_equal(to.keep_nodes, from.keep_nodes);
        ASSERT_OK(bb_tree_hash(&to, &b));
        assert_int_equal(a, b);
        bb_tree_release(&host);
        bb_tree_release(&from);
        bb_tree_release(&to);
        free_scene(scene);
    }
    bb_device_close(device);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_trees_pass),
        cmocka_unit_test(test_deep_chain),
        cmocka_unit_test(test_reserve_refuses),
        cmocka_unit_test(test_copies),
        cmocka_unit_test(test_trees_are_copied_as_they_are),
    };
    return cmocka_run_group_tests_name("tree", tests, NULL, NULL);
}
