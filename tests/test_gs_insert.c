/* gs: what an insertion costs, against the whole tree's cost and all places there are; orders;
 * removals that restore. */
#include "tests/gs_fixture.h"

/* ---- inputs ---- */

/* Edges at a few places only in every third run: ties and flat boxes. */
static bb_gs_box random_box(bb_random *random, uint32_t run)
{
    bb_gs_box box;
    for (int k = 0; k < 3; k++) {
        double at = bb_random_unit(random), size = 0.2 * bb_random_unit(random);
        if (run % 3 == 0) {
            at = bb_random_below(random, 5);
            size = bb_random_below(random, 3);
        }
        box.lo[k] = (float)at;
        box.hi[k] = (float)(at + size);
    }
    return box;
}

static double cost_of(const bb_gs_tree *tree)
{
    double cost = 0;
    for (uint32_t n = 0; n < tree->count; n++)
        if ((tree->marks[n] & BB_GS_FREE) == 0)
            cost += tree->nodes[n].children * tree->nodes[n].area;
    return cost;
}

static const bb_gs_rules all_rules[] = {
    {.max_children = 0},
    {.max_children = 3},
    {.max_children = 16},
    {.binary = true},
    {.whole = true},
    {.whole = true, .max_children = 4},
    {.whole = true, .binary = true},
};

enum { RULES = sizeof all_rules / sizeof all_rules[0] };

/* ---- insertion ---- */

static bool may_have_another(const bb_gs_tree *tree, uint32_t n)
{
    const bb_gs_rules *rules = &tree->rules;
    uint32_t children = tree->nodes[n].children;
    return children > 0 && !rules->binary &&
           (rules->max_children == 0 || children < rules->max_children);
}

/* What all ancestors of n grow by. */
static double inherited_at(const bb_gs_tree *tree, uint32_t n, const bb_gs_box *x)
{
    double sum = 0;
    for (uint32_t up = tree->nodes[n].parent; up != BB_NONE; up = tree->nodes[up].parent)
        sum += tree->nodes[up].children *
               (bb_gs_area_with(&tree->nodes[up].box, x) - bb_gs_area(&tree->nodes[up].box));
    return sum;
}

/* Of all places that there are. */
static double least_cost(const bb_gs_tree *tree, uint32_t x)
{
    const bb_gs_box *box = &tree->nodes[x].box;
    double least = INFINITY;
    for (uint32_t n = 0; n < tree->count; n++) {
        const bb_gs_node *node = &tree->nodes[n];
        if (n == x)
            continue;
        double inherited = inherited_at(tree, n, box), with = bb_gs_area_with(&node->box, box);
        least = fmin(least, inherited + 2 * with);
        if (may_have_another(tree, n))
            least =
                fmin(least, inherited + (node->children + 1) * with - node->children * node->area);
    }
    return least;
}

/* The steps of the path as they are written, with no bound but that what is inherited costs more
 * than the best place so far. */
static double path_by_the_book(const bb_gs_tree *tree, const bb_gs_box *x)
{
    const bb_gs_node *nodes = tree->nodes;
    uint32_t n = tree->root;
    double best = 2 * bb_gs_area_with(&nodes[n].box, x);
    double inherited = nodes[n].children * (best / 2 - nodes[n].area);
    while (n != BB_NONE && inherited < best) {
        uint32_t to = BB_NONE;
        double least = INFINITY;
        if (may_have_another(tree, n))
            best = fmin(best, inherited + bb_gs_area_with(&nodes[n].box, x));
        for (uint32_t c = nodes[n].first; c != BB_NONE; c = nodes[c].next) {
            double with = bb_gs_area_with(&nodes[c].box, x);
            double growth = nodes[c].children * (with - nodes[c].area);
            best = fmin(best, inherited + 2 * with);
            if (bb_gs_is_leaf(&nodes[c]))
                continue;
            double of_to = to != BB_NONE ? bb_gs_area_with(&nodes[to].box, x) : INFINITY;
            bool smaller = growth != least ? growth < least
                           : with != of_to ? with < of_to
                                           : nodes[c].objects < nodes[to].objects;
            if (smaller) {
                least = growth;
                to = c;
            }
        }
        n = to;
        inherited += least;
    }
    return best;
}

static void insertions_cost_what_they_say(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 0);
    for (uint32_t run = 0; run < 12 * RULES; run++) {
        bb_gs_tree tree;
        uint32_t count = 1 + bb_random_below(&random, 200);
        open_tree(&tree, all_rules[run % RULES], count);
        for (uint32_t i = 0; i < count; i++) {
            bb_gs_box box = random_box(&random, run);
            if (i == 0) {
                bb_gs_add(&tree, i, &box);
                continue;
            }
            uint32_t x = bb_gs_make_leaf(&tree, i, &box);
            double before = cost_of(&tree), least = least_cost(&tree, x);
            bb_gs_choice choice = bb_gs_find(&tree, tree.root, x);
            double slack = 1e-12 * (before + 1);
            assert_true(choice.cost >= least - slack);
            if (tree.rules.whole)
                ASSERT_NEAR(choice.cost, least, slack);
            else if (!bb_gs_is_leaf(&tree.nodes[tree.root]))
                ASSERT_NEAR(choice.cost, path_by_the_book(&tree, &box), slack);
            bb_gs_attach(&tree, x, choice.node, choice.beside, BB_NONE);
            ASSERT_NEAR(cost_of(&tree) - before, choice.cost, slack);
            expect_sound(&tree, i + 1);
        }
        assert_true(!tree.rules.binary || tree.arity <= 2);
        assert_true(tree.rules.max_children == 0 || tree.arity <= tree.rules.max_children);
        bb_gs_release(&tree);
    }
}

/* From each node, against the places below it: what an update asks. */
static void paths_begin_where_they_are_told(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 1);
    bb_gs_tree tree;
    open_tree(&tree, (bb_gs_rules){.whole = true}, 101);
    for (uint32_t i = 0; i < 100; i++) {
        bb_gs_box box = random_box(&random, 1);
        bb_gs_add(&tree, i, &box);
    }
    bb_gs_box box = random_box(&random, 1);
    uint32_t x = bb_gs_make_leaf(&tree, 100, &box);
    for (uint32_t n = 0; n < x; n++) {
        if (bb_gs_is_leaf(&tree.nodes[n]) || n == tree.root)
            continue;
        bb_gs_choice choice = bb_gs_find(&tree, n, x);
        uint32_t up = choice.node;
        assert_false(choice.beside && choice.node == n);
        while (up != n && up != BB_NONE)
            up = tree.nodes[up].parent;
        assert_int_equal(up, n);
        tree.rules.whole = false;
        assert_true(bb_gs_find(&tree, n, x).cost >= choice.cost);
        tree.rules.whole = true;
    }
    bb_gs_release(&tree);
}

/* Two unit cubes 9 apart: half areas 3 each, 2 * (10 + 10 + 1) over both. A third in the place of
 * the first: a pair of the two, 2 * 3; as a child of the root it is 21 instead. */
static void by_hand(void **state)
{
    (void)state;
    bb_gs_tree tree;
    const float x[3] = {0, 9, 0};
    open_tree(&tree, (bb_gs_rules){0}, 3);
    for (uint32_t i = 0; i < 3; i++) {
        bb_gs_box box = {{x[i], 0, 0}, {x[i] + 1, 1, 1}};
        if (i == 2) {
            uint32_t leaf = bb_gs_make_leaf(&tree, i, &box);
            bb_gs_choice choice = bb_gs_find(&tree, tree.root, leaf);
            assert_true(choice.beside);
            assert_int_equal(choice.node, tree.leaf_of[0]);
            assert_true(choice.cost == 6);
            bb_gs_attach(&tree, leaf, choice.node, choice.beside, BB_NONE);
        } else {
            bb_gs_add(&tree, i, &box);
        }
    }
    assert_true(cost_of(&tree) == 2 * 21 + 2 * 3);
    bb_gs_release(&tree);
}

/* ---- order ---- */

/* Each object once; in rounds each ascends, and the last one has about half of them. */
static void orders_are_permutations(void **state)
{
    (void)state;
    enum { COUNT = 10000 };
    static const bb_gs_order orders[] = {BB_GS_AS_IN_FILE, BB_GS_SHUFFLED, BB_GS_ROUNDS};
    bb_gs_tree tree;
    open_tree(&tree, (bb_gs_rules){0}, COUNT);
    for (uint32_t o = 0; o < 3; o++)
        for (uint32_t count = 0; count <= COUNT; count += count < 20 ? 1 : COUNT - 20) {
            bool met[COUNT] = {false};
            uint32_t falls = 0, last_fall = 0;
            for (uint32_t i = 0; i < count; i++)
                tree.scratch[i] = i;
            bb_gs_put_in_order(&tree, orders[o], count, SEED, o);
            for (uint32_t i = 0; i < count; i++) {
                assert_true(tree.scratch[i] < count && !met[tree.scratch[i]]);
                met[tree.scratch[i]] = true;
                if (i > 0 && tree.scratch[i] < tree.scratch[i - 1]) {
                    falls++;
                    last_fall = i;
                }
            }
            if (orders[o] == BB_GS_AS_IN_FILE)
                assert_int_equal(falls, 0);
            if (orders[o] == BB_GS_SHUFFLED && count == COUNT)
                assert_true(falls > COUNT / 3);
            if (orders[o] == BB_GS_ROUNDS && count == COUNT)
                assert_true(falls < 32 && last_fall > 0.45 * COUNT && last_fall < 0.55 * COUNT);
        }
    bb_gs_release(&tree);
}

/* ---- removal ---- */

static void expect_equal_trees(const bb_gs_tree *a, const bb_gs_tree *b)
{
    uint32_t n = a->root, m = b->root;
    while (n != BB_NONE) {
        const bb_gs_node *p = &a->nodes[n], *q = &b->nodes[m];
        assert_memory_equal(&p->box, &q->box, sizeof p->box);
        assert_int_equal(p->objects, q->objects);
        assert_int_equal(p->children, q->children);
        if (!bb_gs_is_leaf(p)) {
            n = p->first;
            m = q->first;
            continue;
        }
        assert_int_equal(p->first, q->first);
        while (n != BB_NONE && a->nodes[n].next == BB_NONE) {
            assert_true(b->nodes[m].next == BB_NONE);
            n = a->nodes[n].parent;
            m = b->nodes[m].parent;
        }
        if (n != BB_NONE) {
            n = a->nodes[n].next;
            m = b->nodes[m].next;
        }
    }
    assert_int_equal(a->arity, b->arity);
}

static void what_is_taken_out_again_leaves_no_trace(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 2);
    for (uint32_t run = 0; run < 200; run++) {
        bb_gs_tree tree, other;
        uint32_t count = 1 + bb_random_below(&random, 100);
        open_tree(&tree, all_rules[run % RULES], count + 1);
        open_tree(&other, all_rules[run % RULES], count + 1);
        for (uint32_t i = 0; i < count; i++) {
            bb_gs_box box = random_box(&random, run);
            bb_gs_add(&tree, i, &box);
            bb_gs_add(&other, i, &box);
        }
        bb_gs_box box = random_box(&random, run);
        bb_gs_add(&tree, count, &box);
        uint32_t start = tree.root;
        bb_gs_detach(&tree, tree.leaf_of[count], &start);
        assert_int_equal(start, tree.root);
        bb_gs_free_node(&tree, tree.leaf_of[count]);
        expect_sound(&tree, count);
        expect_equal_trees(&tree, &other);
        bb_gs_release(&other);
        bb_gs_release(&tree);
    }
}

static void an_enclosing_ancestor_is_the_first(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 3);
    bb_gs_tree tree;
    open_tree(&tree, (bb_gs_rules){.max_children = 16}, 500);
    for (uint32_t i = 0; i < 500; i++) {
        bb_gs_box box = random_box(&random, 1);
        bb_gs_add(&tree, i, &box);
    }
    for (uint32_t i = 0; i < 500; i++) {
        uint32_t leaf = tree.leaf_of[i], at = tree.nodes[leaf].parent;
        bb_gs_box box = tree.nodes[leaf].box;
        for (int k = 0; k < 3; k++) {
            float by = (float)bb_random_range(&random, -0.2, 0.2);
            box.lo[k] += by;
            box.hi[k] += by;
        }
        uint32_t start = bb_gs_enclosing(&tree, leaf, &box);
        assert_true(start == tree.root || bb_gs_contains(&tree.nodes[start].box, &box));
        for (; at != start; at = tree.nodes[at].parent)
            assert_false(bb_gs_contains(&tree.nodes[at].box, &box));
    }
    bb_gs_release(&tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(insertions_cost_what_they_say),
        cmocka_unit_test(paths_begin_where_they_are_told),
        cmocka_unit_test(by_hand),
        cmocka_unit_test(orders_are_permutations),
        cmocka_unit_test(what_is_taken_out_again_leaves_no_trace),
        cmocka_unit_test(an_enclosing_ancestor_is_the_first),
    };
    return cmocka_run_group_tests_name("gs: insertion", tests, NULL, NULL);
}
