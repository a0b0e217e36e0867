/* builders/common/refit: the boxes of a plain reference, on the host and on the device, in each
 * form; of trees of any shape, with links and references left alone; and what it refuses. */
#include "builders/common/refit.h"
#include "tests/device_forms.h"
#include "tests/tree_fixture.h"

enum { SEED = 3301 };

/* Whose boxes a node's subtree holds, all of them again for each node: by its references alone. */
static void enclose_subtree(const bb_tree *tree, const bb_box *boxes, uint32_t n, bb_node *out)
{
    const bb_node *nodes = tree->nodes;
    uint32_t end = nodes[n].skip;
    *out = (bb_node){.lo = {INFINITY, INFINITY, INFINITY},
                     .hi = {-INFINITY, -INFINITY, -INFINITY},
                     .first = nodes[n].first,
                     .skip = end};
    for (uint32_t c = n; c != end;
         c = bb_node_is_leaf(&nodes[c]) ? nodes[c].skip : nodes[c].first) {
        if (!bb_node_is_leaf(&nodes[c]))
            continue;
        for (uint32_t r = nodes[c].first & BB_INDEX_MASK;; r++) {
            const bb_box *box = &boxes[tree->refs[r] & BB_INDEX_MASK];
            for (int axis = 0; axis < 3; axis++) {
                out->lo[axis] = fminf(out->lo[axis], box->lo[axis]);
                out->hi[axis] = fmaxf(out->hi[axis], box->hi[axis]);
            }
            if ((tree->refs[r] & BB_LAST_BIT) != 0)
                break;
        }
    }
}

static void refit_on_host(bb_tree *tree, const bb_scene *scene)
{
    uint32_t *order = malloc(tree->info.node_count * sizeof *order);
    ASSERT_OK(bb_refit(tree, scene->boxes, scene->prim_count, order));
    free(order);
}

static void put(bb_device *device, const char *what, const void *bytes, size_t size, bb_buffer *out)
{
    ASSERT_OK(bb_buffer_reserve(device, NULL, size, what, out));
    ASSERT_OK(bb_buffer_write(out, 0, size, bytes));
}

/* `before` is the tree with its old boxes, `after` what the host made of it. */
static void check_device(bb_device *device, const bb_tree *before, const bb_tree *after,
                         const bb_scene *scene)
{
    size_t bytes = before->info.node_count * sizeof(bb_node);
    size_t ref_bytes = before->info.ref_count * sizeof(uint32_t);
    bb_refitter *refitter = NULL;
    bb_buffer boxes = {0};
    bb_tree there;
    bb_tree_init(&there, NULL);
    ASSERT_OK(bb_tree_reserve(&there, device, BB_ON_DEVICE, before->info.node_count,
                              before->info.ref_count));
    ASSERT_OK(bb_buffer_write(&there.d_nodes, 0, bytes, before->nodes));
    ASSERT_OK(bb_buffer_write(&there.d_refs, 0, ref_bytes, before->refs));
    ASSERT_OK(bb_buffer_write(&there.d_info, 0, sizeof before->info, &before->info));
    there.info = before->info;
    put(device, "boxes", scene->boxes, scene->prim_count * sizeof(bb_box), &boxes);
    ASSERT_OK(bb_refitter_create(device, NULL, &refitter));
    for (int again = 0; again < 2; again++)
        ASSERT_OK(bb_refit_device(refitter, &boxes, &there));
    ASSERT_OK(bb_tree_download(&there, NULL));
    assert_memory_equal(there.nodes, after->nodes, bytes);
    assert_memory_equal(there.refs, before->refs, ref_bytes);
    bb_refitter_destroy(refitter);
    bb_buffer_release(&boxes);
    bb_tree_release(&there);
}

static void move(bb_scene *scene, bb_random *random)
{
    for (uint32_t i = 0; i < scene->prim_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float by = (float)bb_random_range(random, -50, 50);
            scene->boxes[i].lo[axis] += by;
            scene->boxes[i].hi[axis] += by;
        }
}

static void boxes_are_those_of_a_plain_reference(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed_or(SEED), 0);
    for (uint32_t run = 0; run < 60; run++) {
        bb_scene *scene = make_random_scene(1 + bb_random_below(&random, 700), &random);
        bb_tree tree, before;
        make_random_tree(scene, 2 + run % 9, 1 + run % 4, &random, &tree);
        tree.disjoint = true;
        move(scene, &random);
        copy_tree(&tree, &before);
        refit_on_host(&tree, scene);
        assert_false(tree.disjoint);
        for (uint32_t n = 0; n < tree.info.node_count; n++) {
            bb_node expected;
            enclose_subtree(&before, scene->boxes, n, &expected);
            assert_memory_equal(&tree.nodes[n], &expected, sizeof expected);
        }
        assert_memory_equal(tree.refs, before.refs, tree.info.ref_count * sizeof *tree.refs);
        for (int form = first_form(); form < FORMS && run % 6 == 0; form++)
            check_device(devices[form], &before, &tree, scene);
        bb_tree_release(&before);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

/* Leaves at each level, before or after the rest; a box for each, ever farther along x. */
static void make_chain(uint32_t levels, bb_tree *tree, bb_scene *scene)
{
    bb_tree_init(tree, NULL);
    ASSERT_OK(bb_tree_reserve(tree, NULL, BB_ON_HOST, 2 * (size_t)levels + 1, levels + 1));
    memset(tree->nodes, 0, (2 * (size_t)levels + 1) * sizeof *tree->nodes);
    uint32_t skip = BB_NONE;
    for (uint32_t i = 0; i <= levels; i++) {
        bool first = i % 3 == 0;
        uint32_t leaf = 2 * i + 1, rest = 2 * i + 2;
        scene->boxes[i].lo[0] = scene->boxes[i].hi[0] = (float)i;
        tree->refs[i] = i | BB_LAST_BIT;
        if (i == levels) {
            tree->nodes[2 * i] = (bb_node){.first = BB_LEAF_BIT | i, .skip = skip};
            break;
        }
        tree->nodes[2 * i] = (bb_node){.first = first ? leaf : rest, .skip = skip};
        tree->nodes[leaf] = (bb_node){.first = BB_LEAF_BIT | i, .skip = first ? rest : skip};
        skip = first ? skip : leaf;
    }
    tree->info = (bb_tree_info){0, 2 * levels + 1, levels + 1, levels + 1, 2, levels};
}

/* Where a launch is made for each level, of fewer; BVHBENCH_TEST_SMALL: of fewer everywhere. */
static void a_chain_of_a_million_levels(void **state)
{
    (void)state;
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (int form = first_form(); form < FORMS; form++) {
        uint32_t levels = form == LEVELS_FORM ? (small ? 300 : 3000) : (small ? 20000 : 1000000);
        bb_scene *scene = make_box_scene(levels + 1);
        bb_tree tree, before;
        make_chain(levels, &tree, scene);
        copy_tree(&tree, &before);
        refit_on_host(&tree, scene);
        for (uint32_t i = 0; i <= levels; i++) {
            assert_true(tree.nodes[2 * i].lo[0] == (float)i);
            assert_true(tree.nodes[2 * i].hi[0] == (float)levels);
        }
        check_device(devices[form], &before, &tree, scene);
        bb_tree_release(&before);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

static void expect_refusal(bb_tree *tree, const bb_scene *scene, bb_status status,
                           const char *words)
{
    uint32_t order[8];
    bb_node before[3];
    memcpy(before, tree->nodes, sizeof before);
    assert_int_equal(bb_refit(tree, scene->boxes, scene->prim_count, order), status);
    if (strstr(bb_message(), words) == NULL)
        fail_msg("expected '%s' in '%s'", words, bb_message());
    assert_memory_equal(tree->nodes, before, sizeof before); /* nothing was written */
}

static void what_cannot_be_refitted_is_refused(void **state)
{
    (void)state;
    bb_scene *scene = make_box_scene(2);
    const bb_node nodes[3] = {{.first = 1, .skip = BB_NONE},
                              {.first = BB_LEAF_BIT, .skip = 2},
                              {.first = BB_LEAF_BIT | 1, .skip = BB_NONE}};
    const uint32_t refs[2] = {BB_LAST_BIT, 1 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 3, refs, 2, 2, 1);
    tree.duplicated = true;
    expect_refusal(&tree, scene, BB_UNSUPPORTED, "duplicated references");
    if (devices[LEVELS_FORM] != NULL) {
        bb_refitter *refitter = NULL;
        bb_buffer none = {0};
        ASSERT_OK(bb_refitter_create(devices[LEVELS_FORM], NULL, &refitter));
        assert_int_equal(bb_refit_device(refitter, &none, &tree), BB_UNSUPPORTED);
        bb_refitter_destroy(refitter);
    }
    tree.duplicated = false;
    tree.nodes[2].skip = 0;
    expect_refusal(&tree, scene, BB_FAILED, "a cycle, or two parents");
    tree.nodes[2].skip = 3;
    expect_refusal(&tree, scene, BB_FAILED, "a link leads to node 3 of 3");
    tree.nodes[2].skip = BB_NONE;
    tree.refs[1] = 2 | BB_LAST_BIT;
    expect_refusal(&tree, scene, BB_FAILED, "leaf 2 refers to primitive 2 of 2");
    tree.refs[1] = 1;
    expect_refusal(&tree, scene, BB_FAILED, "leaf 2 has references beyond the last");
    bb_tree_release(&tree);
    free_scene(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_those_of_a_plain_reference),
        cmocka_unit_test(a_chain_of_a_million_levels),
        cmocka_unit_test(what_cannot_be_refitted_is_refused),
    };
    return cmocka_run_group_tests_name("refit", tests, open_devices, close_devices);
}
