/* gs: what an insertion costs, against the whole tree's cost and all places there are; removals
 * that restore; updates, thinning and the common tree that follows them. */
#include "builders/gs/gs.h"
#include "framework/builder/registry.h"
#include "tests/tree_fixture.h"

enum { SEED = 1987 };

/* ---- trees by hand ---- */

static void open_tree(bb_gs_tree *tree, bb_gs_rules rules, uint32_t objects)
{
    *tree = (bb_gs_tree){.rules = rules};
    ASSERT_OK(bb_gs_reserve(tree, NULL, objects));
    bb_gs_clear(tree, objects);
}

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

static void expect_union(const bb_gs_tree *tree, uint32_t n)
{
    const bb_gs_node *nodes = tree->nodes, *node = &nodes[n];
    bb_gs_box box = nodes[node->first].box;
    uint32_t children = 0, objects = 0, last = BB_NONE;
    for (uint32_t c = node->first; c != BB_NONE; c = nodes[c].next, children++) {
        assert_int_equal(nodes[c].parent, n);
        if (last != BB_NONE)
            assert_int_equal(nodes[c].prev, last);
        box = bb_gs_unite(&box, &nodes[c].box);
        objects += nodes[c].objects;
        last = c;
    }
    assert_int_equal(nodes[node->first].prev, last);
    assert_int_equal(node->children, children);
    assert_int_equal(node->objects, objects);
    assert_true(children >= 2);
    assert_true(bb_gs_contains(&node->box, &box) && bb_gs_contains(&box, &node->box));
}

/* What holds at all times, found anew. `attached`: objects in the tree. */
static void expect_sound(const bb_gs_tree *tree, uint32_t attached)
{
    uint32_t leaves = 0, met = 0, arity = 0, slots = 0, n = tree->root;
    while (n != BB_NONE) {
        const bb_gs_node *node = &tree->nodes[n];
        met++;
        assert_true(n < tree->count && met <= tree->count);
        assert_true((tree->marks[n] & BB_GS_FREE) == 0);
        assert_true(node->area == bb_gs_area(&node->box));
        arity = node->children > arity ? node->children : arity;
        if (!bb_gs_is_leaf(node)) {
            expect_union(tree, n);
            n = node->first;
            continue;
        }
        assert_int_equal(tree->leaf_of[node->first & BB_INDEX_MASK], n);
        assert_int_equal(node->objects, 1);
        leaves++;
        while (n != BB_NONE && tree->nodes[n].next == BB_NONE)
            n = tree->nodes[n].parent;
        n = n != BB_NONE ? tree->nodes[n].next : BB_NONE;
    }
    for (uint32_t i = 0; i < tree->count; i++)
        slots += (tree->marks[i] & BB_GS_FREE) == 0;
    assert_int_equal(leaves, attached);
    assert_int_equal(met, slots);
    assert_int_equal(arity, tree->arity);
    assert_int_equal(tree->nodes[tree->root].parent, BB_NONE);
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

/* ---- the builder ---- */

typedef struct made {
    bb_account account;
    bb_spec spec;
    const bb_builder *builder;
    void *self;
    bb_tree tree;
    bb_phases phases;
} made;

static bb_status create(const char *text, made *m)
{
    memset(m, 0, sizeof *m);
    ASSERT_OK(bb_spec_parse(text, &m->spec));
    m->builder = bb_builder_find(m->spec.name);
    assert_non_null(m->builder);
    ASSERT_OK(bb_spec_validate(&m->spec, m->builder->options, "builder"));
    ASSERT_OK(bb_builder_validate(m->builder));
    bb_builder_context context = {.account = &m->account,
                                  .spec = &m->spec,
                                  .options = m->builder->options,
                                  .seed = 1,
                                  .threads = 1};
    bb_tree_init(&m->tree, &m->account);
    return m->builder->create(&context, &m->self);
}

static void expect_tree(const made *m, const bb_scene *scene)
{
    if (bb_tree_check(&m->tree, scene) != BB_OK)
        fail_msg("%s: %s", m->spec.text, bb_message());
}

static void build(made *m, const bb_scene *scene)
{
    m->phases = (bb_phases){.current = -1};
    ASSERT_OK(m->builder->prepare(m->self, scene, &m->tree));
    ASSERT_OK(m->builder->build(m->self, scene, NULL, &m->tree, &m->phases));
    expect_tree(m, scene);
}

static void update(made *m, const bb_scene *scene)
{
    m->phases = (bb_phases){.current = -1};
    m->tree.refitted = false;
    ASSERT_OK(m->builder->update(m->self, scene, BB_CHANGED_POSITIONS, &m->tree, &m->phases));
    expect_tree(m, scene);
}

static void destroy(made *m)
{
    bb_tree_release(&m->tree);
    m->builder->destroy(m->self);
    assert_int_equal(m->account.bytes, 0);
}

static uint64_t hash_of(const made *m)
{
    uint64_t hash;
    ASSERT_OK(bb_tree_hash(&m->tree, &hash));
    return hash;
}

static uint64_t event(const made *m, const char *name)
{
    for (uint32_t i = 0; i < m->phases.event_count; i++)
        if (strcmp(m->phases.event_names[i], name) == 0)
            return m->phases.events[i];
    return 0;
}

static bb_scene *scene_of_boxes(uint32_t count, bb_random *random)
{
    bb_scene *scene = make_box_scene(count);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            scene->boxes[i].lo[k] = (float)(100 * bb_random_unit(random));
            scene->boxes[i].hi[k] = scene->boxes[i].lo[k] + (float)(3 * bb_random_unit(random));
        }
    return scene;
}

/* One of `one_of` objects, by up to `far` on each axis; returns how many. */
static uint32_t move(bb_scene *scene, uint32_t one_of, float far, bb_random *random)
{
    uint32_t moved = 0;
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        if (bb_random_below(random, one_of) != 0)
            continue;
        moved++;
        for (int k = 0; k < 3; k++) {
            float by = far * (float)bb_random_range(random, -1, 1);
            scene->boxes[i].lo[k] += by;
            scene->boxes[i].hi[k] += by;
        }
    }
    return moved;
}

static const char *const specs[] = {
    "gs",
    "gs:tau=0",
    "gs:arity=2,order=shuffled",
    "gs:max_children=0,tau=1.1,q=min",
    "gs:max_children=3,start=root,order=file",
    "gs:search=bb,thin_budget=2",
    "gs:search=bb,arity=2,start=root,tau=1",
};

enum { SPECS = sizeof specs / sizeof specs[0] };

/* Of all and of few, near and far: patched trees and such as were written anew. */
static void trees_stay_valid_over_many_frames(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < SPECS; s++) {
        bb_random random = bb_random_make(SEED, 100 + s);
        bb_scene *scene = scene_of_boxes(700, &random);
        made m;
        ASSERT_OK(create(specs[s], &m));
        build(&m, scene);
        for (uint32_t frame = 0; frame < 60; frame++) {
            uint32_t moved = move(scene, frame % 4 == 0 ? 1 : 40, frame % 3 == 0 ? 50 : 2, &random);
            update(&m, scene);
            assert_int_equal(event(&m, "moved"), moved);
            assert_true(event(&m, "reinserted") >= moved + 2 * event(&m, "thinned"));
            if (strstr(specs[s], "budget=2") != NULL)
                assert_true(event(&m, "thinned") <= 2);
            if (strstr(specs[s], "tau=0") != NULL)
                assert_int_equal(event(&m, "thinned"), 0);
        }
        destroy(&m);
        free_scene(scene);
    }
}

/* The pool itself, and that the common tree is that pool, node by node. */
static void the_common_tree_follows_the_pool(void **state)
{
    (void)state;
    enum { COUNT = 600 };
    bb_random random = bb_random_make(SEED, 4);
    bb_scene *scene = scene_of_boxes(COUNT, &random);
    bb_gs_tree tree;
    bb_tree out;
    open_tree(&tree, (bb_gs_rules){.max_children = 16, .tau = 1.05}, COUNT);
    bb_tree_init(&out, NULL);
    ASSERT_OK(bb_tree_reserve(&out, NULL, BB_ON_HOST, 2 * COUNT - 1, COUNT));
    for (uint32_t i = 0; i < COUNT; i++) {
        bb_gs_box box = bb_gs_box_of(&scene->boxes[i]);
        bb_gs_add(&tree, i, &box);
        out.refs[i] = i | BB_LAST_BIT;
    }
    bb_gs_start_q(&tree);
    bb_gs_emit(&tree, true, &out);
    uint32_t thinned = 0;
    for (uint32_t frame = 0; frame < 200; frame++) {
        move(scene, 1 + frame % 100, 5, &random);
        bb_gs_move(&tree, scene->boxes, bb_gs_detect(&tree, scene->boxes));
        expect_sound(&tree, COUNT);
        tree.thinned = 0;
        bb_gs_thin(&tree);
        thinned += tree.thinned;
        expect_sound(&tree, COUNT);
        assert_int_equal(tree.nodes[tree.root].objects, COUNT);
        bb_gs_emit(&tree, false, &out);
        expect_sound(&tree, COUNT);
        assert_int_equal(tree.free, BB_NONE);
        ASSERT_OK(bb_tree_check(&out, scene));
        for (uint32_t n = 0; n < tree.count; n++) {
            assert_memory_equal(out.nodes[n].lo, tree.nodes[n].box.lo, sizeof out.nodes[n].lo);
            assert_memory_equal(out.nodes[n].hi, tree.nodes[n].box.hi, sizeof out.nodes[n].hi);
            assert_int_equal(out.nodes[n].first, tree.nodes[n].first);
        }
    }
    assert_true(thinned > 0);
    bb_tree_release(&out);
    bb_gs_release(&tree);
    free_scene(scene);
}

/* Nodes that go and are not made again elsewhere, which leaves slots free all over. */
static void free_slots_are_filled(void **state)
{
    (void)state;
    enum { COUNT = 400 };
    bb_random random = bb_random_make(SEED, 13);
    for (uint32_t run = 0; run < 100; run++) {
        bb_scene *scene = scene_of_boxes(COUNT, &random);
        bb_gs_tree tree;
        bb_tree out;
        open_tree(&tree, (bb_gs_rules){0}, COUNT);
        bb_tree_init(&out, NULL);
        ASSERT_OK(bb_tree_reserve(&out, NULL, BB_ON_HOST, 2 * COUNT - 1, COUNT));
        for (uint32_t i = 0; i < COUNT; i++) {
            bb_gs_box box = bb_gs_box_of(&scene->boxes[i]);
            bb_gs_add(&tree, i, &box);
            out.refs[i] = i | BB_LAST_BIT;
        }
        bb_gs_emit(&tree, true, &out);
        uint32_t before = tree.count;
        for (uint32_t i = 0; i < 15; i++) {
            uint32_t start = tree.root, leaf = tree.leaf_of[bb_random_below(&random, COUNT)];
            bb_gs_detach(&tree, leaf, &start);
            bb_gs_attach(&tree, leaf, tree.root, false, BB_NONE);
        }
        assert_true(tree.free != BB_NONE);
        bb_gs_emit(&tree, false, &out);
        assert_true(tree.count < before);
        expect_sound(&tree, COUNT);
        ASSERT_OK(bb_tree_check(&out, scene));
        bb_tree_release(&out);
        bb_gs_release(&tree);
        free_scene(scene);
    }
}

/* Nodes stay where they are when three of four thousand objects move. */
static void few_movers_write_few_nodes(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 5);
    bb_scene *scene = scene_of_boxes(4000, &random);
    made m;
    ASSERT_OK(create("gs", &m));
    build(&m, scene);
    bb_tree before;
    copy_tree(&m.tree, &before);
    for (uint32_t i = 0; i < 3; i++)
        scene->boxes[1000 * i].hi[0] += 1;
    update(&m, scene);
    uint32_t differ = 0;
    for (uint32_t n = 0; n < before.info.node_count; n++)
        differ += memcmp(&before.nodes[n], &m.tree.nodes[n], sizeof *before.nodes) != 0;
    assert_true(differ > 0 && differ < 200);
    bb_tree_release(&before);
    destroy(&m);
    free_scene(scene);
}

static void what_stays_still_is_not_touched(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 6);
    bb_scene *scene = scene_of_boxes(500, &random);
    for (uint32_t s = 0; s < SPECS; s++) {
        made m;
        bb_tree before;
        ASSERT_OK(create(specs[s], &m));
        build(&m, scene);
        move(scene, 1, 3, &random);
        update(&m, scene);
        copy_tree(&m.tree, &before);
        uint64_t links = m.tree.links;
        for (uint32_t i = 0; i < 3; i++) {
            update(&m, scene);
            assert_true(m.tree.refitted && m.tree.links == links);
            assert_memory_equal(&m.tree.info, &before.info, sizeof before.info);
            assert_memory_equal(m.tree.nodes, before.nodes,
                                before.info.node_count * sizeof *before.nodes);
            assert_memory_equal(m.tree.refs, before.refs, 500 * sizeof *before.refs);
        }
        bb_tree_release(&before);
        destroy(&m);
    }
    free_scene(scene);
}

/* Two objects of the same scene and seed; then there and back; then a build. */
static void replays_are_the_same(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < SPECS; s++) {
        bb_random random = bb_random_make(SEED, 7);
        bb_scene *scene = scene_of_boxes(400, &random);
        bb_box *first = malloc(400 * sizeof *first);
        memcpy(first, scene->boxes, 400 * sizeof *first);
        made m, again;
        ASSERT_OK(create(specs[s], &m));
        ASSERT_OK(create(specs[s], &again));
        build(&m, scene);
        uint64_t fresh = hash_of(&m);
        build(&again, scene);
        build(&again, scene);
        for (uint32_t frame = 0; frame < 20; frame++) {
            assert_true(hash_of(&m) == hash_of(&again));
            move(scene, 1 + 30 * (frame % 2), 10, &random);
            update(&m, scene);
            update(&again, scene);
        }
        memcpy(scene->boxes, first, 400 * sizeof *first);
        update(&m, scene);
        build(&m, scene);
        assert_true(hash_of(&m) == fresh);
        destroy(&again); /* from here on against one that never moved before */
        ASSERT_OK(create(specs[s], &again));
        build(&again, scene);
        move(scene, 1, 10, &random);
        update(&m, scene);
        update(&again, scene);
        assert_true(hash_of(&m) == hash_of(&again));
        free(first);
        destroy(&again);
        destroy(&m);
        free_scene(scene);
    }
}

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
        ASSERT_OK(create(texts[t], &m));
        build(&m, scene);
        for (uint32_t frame = 0; frame < 10; frame++) {
            move(scene, 2, 5, &random);
            update(&m, scene);
            thinned += event(&m, "thinned");
        }
        hashes[t] = hash_of(&m);
        assert_true(t < 2 ? thinned == 0 : thinned > 0);
        destroy(&m);
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
    ASSERT_OK(create("gs:tau=1.05,thin_budget=7", &m));
    build(&m, scene);
    move(scene, 1, 10, &random);
    update(&m, scene);
    for (uint32_t i = 0; i < 5; i++) {
        assert_true(event(&m, "thinned") > 0 && event(&m, "thinned") <= 7);
        scene->boxes[0].hi[0] += 0.01f;
        update(&m, scene);
    }
    destroy(&m);
    free_scene(scene);
}

/* ---- awkward scenes ---- */

static void few_objects(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < SPECS; s++)
        for (uint32_t count = 1; count <= 5; count++) {
            bb_random random = bb_random_make(SEED, 10);
            bb_scene *scene = scene_of_boxes(count, &random);
            made m;
            ASSERT_OK(create(specs[s], &m));
            build(&m, scene);
            for (uint32_t frame = 0; frame < 50; frame++) {
                move(scene, 1 + frame % 3, 60, &random);
                update(&m, scene);
            }
            destroy(&m);
            free_scene(scene);
        }
}

/* All equal, or all at the origin: about as deep as a tree of that width has to be; then they
 * part. */
static void equal_boxes_make_no_chains(void **state)
{
    (void)state;
    const char *const texts[] = {"gs", "gs:arity=2", "gs:search=bb"};
    for (uint32_t t = 0; t < 3; t++)
        for (int points = 0; points < 2; points++) {
            uint32_t count = t == 0 ? 10000 : 2000;
            bb_random random = bb_random_make(SEED, 11);
            bb_scene *scene = make_box_scene(count);
            for (uint32_t i = 0; i < count && !points; i++)
                for (int k = 0; k < 3; k++)
                    scene->boxes[i].hi[k] = 1;
            made m;
            ASSERT_OK(create(texts[t], &m));
            build(&m, scene);
            if (m.tree.info.depth > 30)
                fail_msg("%s, %s: depth %u", texts[t], points ? "points" : "cubes",
                         m.tree.info.depth);
            assert_true(m.tree.info.arity <= 16);
            move(scene, 1, 1, &random);
            update(&m, scene);
            move(scene, 1, 1, &random);
            update(&m, scene);
            destroy(&m);
            free_scene(scene);
        }
}

/* Deeper than any stack: no search makes this, so it is made by hand. */
static void a_long_chain(void **state)
{
    (void)state;
    enum { COUNT = 100000 };
    bb_scene *scene = make_box_scene(COUNT);
    bb_gs_tree tree;
    bb_tree out;
    open_tree(&tree, (bb_gs_rules){.max_children = 16, .tau = 1.3}, COUNT);
    bb_tree_init(&out, NULL);
    ASSERT_OK(bb_tree_reserve(&out, NULL, BB_ON_HOST, 2 * COUNT - 1, COUNT));
    for (uint32_t i = 0; i < COUNT; i++) {
        scene->boxes[i].lo[0] = (float)i;
        scene->boxes[i].hi[0] = (float)i + 1;
        scene->boxes[i].hi[1] = scene->boxes[i].hi[2] = 1;
        bb_gs_box box = bb_gs_box_of(&scene->boxes[i]);
        if (i == 0) {
            bb_gs_add(&tree, i, &box);
        } else {
            tree.boxes[i] = box;
            bb_gs_attach(&tree, bb_gs_make_leaf(&tree, i, &box), tree.root, true, BB_NONE);
        }
        out.refs[i] = i | BB_LAST_BIT;
    }
    bb_gs_start_q(&tree);
    bb_gs_emit(&tree, true, &out);
    assert_int_equal(out.info.depth, COUNT - 1);
    ASSERT_OK(bb_tree_check(&out, scene));
    for (uint32_t i = 0; i < 20; i++)
        scene->boxes[i * 5000].hi[0] += 5;
    bb_gs_move(&tree, scene->boxes, bb_gs_detect(&tree, scene->boxes));
    bb_gs_thin(&tree);
    bb_gs_emit(&tree, false, &out);
    ASSERT_OK(bb_tree_check(&out, scene));
    expect_sound(&tree, COUNT);
    bb_tree_release(&out);
    bb_gs_release(&tree);
    free_scene(scene);
}

/* ---- what is refused ---- */

static void bad_options_are_refused(void **state)
{
    (void)state;
    const char *const bad[] = {"gs:max_children=1", "gs:max_children=2", "gs:tau=0.5", "gs:tau=-1",
                               "gs:thin_budget=x"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        made m;
        assert_int_equal(create(bad[i], &m), BB_INVALID);
        m.builder->destroy(m.self);
        assert_int_equal(m.account.bytes, 0);
    }
}

static void expect_unsupported(made *m, const bb_scene *scene, uint32_t changed)
{
    bb_phases phases = {.current = -1};
    uint64_t before = hash_of(m);
    assert_int_equal(m->builder->update(m->self, scene, changed, &m->tree, &phases),
                     BB_UNSUPPORTED);
    assert_int_equal(phases.count, 0);
    assert_true(hash_of(m) == before);
}

static void other_changes_ask_for_a_build(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 12);
    bb_scene *scene = scene_of_boxes(50, &random);
    made m;
    ASSERT_OK(create("gs", &m));
    build(&m, scene);
    expect_unsupported(&m, scene, BB_CHANGED_POSITIONS | BB_CHANGED_TOPOLOGY);
    scene->prim_count--;
    expect_unsupported(&m, scene, BB_CHANGED_POSITIONS);
    scene->prim_count++;
    destroy(&m);
    ASSERT_OK(create("gs:update=rebuild", &m));
    build(&m, scene);
    expect_unsupported(&m, scene, BB_CHANGED_POSITIONS);
    destroy(&m);
    free_scene(scene);
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
        cmocka_unit_test(trees_stay_valid_over_many_frames),
        cmocka_unit_test(the_common_tree_follows_the_pool),
        cmocka_unit_test(free_slots_are_filled),
        cmocka_unit_test(few_movers_write_few_nodes),
        cmocka_unit_test(what_stays_still_is_not_touched),
        cmocka_unit_test(replays_are_the_same),
        cmocka_unit_test(the_threshold_is_a_ratio),
        cmocka_unit_test(a_high_threshold_thins_nothing),
        cmocka_unit_test(a_budget_delays),
        cmocka_unit_test(few_objects),
        cmocka_unit_test(equal_boxes_make_no_chains),
        cmocka_unit_test(a_long_chain),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(other_changes_ask_for_a_build),
    };
    return cmocka_run_group_tests_name("gs", tests, NULL, NULL);
}
