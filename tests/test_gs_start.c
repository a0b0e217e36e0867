/* gs: where what moved starts from, and what a thinned node leaves: updates against the rule as it
 * is written, step by step, on a tree of the test's own. */
#include "tests/gs_fixture.h"

enum { COUNT = 400, FRAMES = 12 };

/* What each case must come upon: else it shows nothing. */
typedef struct met {
    uint32_t moved, inside; /* of those, that started below the root */
    uint32_t thinned, children, below, spared;
} met;

/* ---- by the book ---- */

static void insert_from(bb_gs_tree *tree, uint32_t *start, uint32_t x, met *met)
{
    met->inside += *start != tree->root;
    bb_gs_insert(tree, start, x);
}

/* All that moved, in the order of the file. */
static void move_by_the_book(bb_gs_tree *tree, const bb_scene *scene, met *met)
{
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        bb_gs_box box = bb_gs_box_of(&scene->boxes[i]);
        uint32_t leaf = tree->leaf_of[i], start = tree->nodes[leaf].parent;
        if (memcmp(&box, &tree->nodes[leaf].box, sizeof box) == 0)
            continue;
        while (start != tree->root && !bb_gs_contains(&tree->nodes[start].box, &box))
            start = tree->nodes[start].parent;
        if (tree->rules.from_root)
            start = tree->root;
        bb_gs_detach(tree, leaf, &start);
        bb_gs_set_box(tree, leaf, &box);
        insert_from(tree, &start, leaf, met);
        met->moved++;
    }
}

static double q_of(const bb_gs_node *node)
{
    return node->area / node->objects;
}

/* Looks at every node that there is. */
static bool is_too_large(const bb_gs_tree *tree, uint32_t n)
{
    const bb_gs_node *node = &tree->nodes[n];
    return (tree->marks[n] & BB_GS_FREE) == 0 && node->children > 0 && n != tree->root &&
           q_of(node) > tree->rules.tau * node->q_init;
}

/* Its children start from its parent, which held them; a parent that is left with one child goes
 * with it, and is no candidate any more. */
static void delete_node(bb_gs_tree *tree, uint32_t n, bool *candidates, met *met)
{
    uint32_t children[COUNT], count = 0, parent = tree->nodes[n].parent;
    uint32_t start = tree->rules.from_root ? tree->root : parent;
    for (uint32_t c = tree->nodes[n].first; c != BB_NONE; c = tree->nodes[c].next)
        children[count++] = c;
    met->thinned++;
    met->children += count;
    met->below += parent != tree->root;
    if (tree->nodes[parent].children == 2)
        candidates[parent] = false;
    bb_gs_detach(tree, n, &start);
    bb_gs_free_node(tree, n);
    for (uint32_t i = 0; i < count; i++) {
        bb_gs_node *child = &tree->nodes[children[i]];
        child->parent = child->next = BB_NONE;
        child->prev = children[i];
        insert_from(tree, &start, children[i], met);
    }
}

/* Candidates are all that are too large before the first goes; each goes if it still is when its
 * turn comes. */
static void thin_by_the_book(bb_gs_tree *tree, met *met)
{
    bool candidates[2 * COUNT] = {false};
    uint32_t slots = tree->count;
    for (uint32_t n = 0; n < slots && tree->rules.tau > 0; n++) {
        bb_gs_node *node = &tree->nodes[n];
        candidates[n] = is_too_large(tree, n);
        if (tree->rules.least_q && node->children > 0 && q_of(node) < node->q_init)
            node->q_init = q_of(node);
    }
    for (uint32_t n = 0; n < slots; n++)
        if (candidates[n] && is_too_large(tree, n))
            delete_node(tree, n, candidates, met);
        else
            met->spared += candidates[n];
}

/* ---- the builder beside it ---- */

static const struct {
    const char *builder;
    bb_gs_rules rules;
} cases[] = {
    {"gs:order=file,tau=0", {.max_children = 16}},
    {"gs:order=file,tau=0,start=root", {.max_children = 16, .from_root = true}},
    {"gs:order=file,tau=1.05", {.max_children = 16, .tau = 1.05}},
    {"gs:order=file,tau=1.05,start=root", {.max_children = 16, .tau = 1.05, .from_root = true}},
    {"gs:order=file,tau=1.1,q=min,max_children=4",
     {.max_children = 4, .tau = 1.1, .least_q = true}},
    {"gs:order=file,tau=1.02,arity=2", {.max_children = 16, .tau = 1.02, .binary = true}},
};

enum { CASES = sizeof cases / sizeof cases[0] };

static uint64_t hash_of_tree(const bb_tree *tree)
{
    uint64_t hash;
    ASSERT_OK(bb_tree_hash(tree, &hash));
    return hash;
}

static void expect_figures(uint32_t i, const met *met)
{
    const bb_gs_rules *rules = &cases[i].rules;
    print_message("%s: %u moved, %u started below the root; %u thinned, %u of them lower down, %u "
                  "spared\n",
                  cases[i].builder, met->moved, met->inside, met->thinned, met->below, met->spared);
    assert_true(met->moved > FRAMES);
    assert_true((met->inside > 0) == !rules->from_root);
    assert_true((met->below > 0 && met->spared > 0) == (rules->tau > 0));
}

static void updates_go_by_the_book(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < CASES; i++) {
        bb_random random = bb_random_make(SEED, 200);
        bb_scene *scene = scene_of_boxes(COUNT, &random);
        bb_gs_tree tree;
        bb_tree out;
        made m;
        met all = {0};
        open_builder(cases[i].builder, &m);
        build(&m, scene);
        open_pair(&tree, &out, cases[i].rules, scene);
        assert_true(hash_of(&m) == hash_of_tree(&out));
        for (uint32_t frame = 0; frame < FRAMES; frame++) {
            move(scene, 1 + frame % 4, 8, &random);
            met before = all;
            move_by_the_book(&tree, scene, &all);
            thin_by_the_book(&tree, &all);
            bb_gs_emit(&tree, false, &out);
            update(&m, scene);
            assert_int_equal(event(&m, "moved"), all.moved - before.moved);
            assert_int_equal(event(&m, "thinned"), all.thinned - before.thinned);
            assert_int_equal(event(&m, "reinserted"),
                             all.moved - before.moved + all.children - before.children);
            if (hash_of(&m) != hash_of_tree(&out))
                fail_msg("%s: frame %u has another tree", cases[i].builder, frame);
        }
        expect_figures(i, &all);
        close_pair(&tree, &out);
        close_builder(&m);
        free_scene(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(updates_go_by_the_book)};
    return cmocka_run_group_tests_name("gs: where insertions start", tests, NULL, NULL);
}
