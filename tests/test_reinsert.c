/* Reinsertion: the search against all places there are, moves against taking out and putting in by
 * pointers, each of them in every small tree; undoing. Whole builds: test_reinsert_trees.c. Seed:
 * BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (oclgrind). */
#include "builders/reinsert/moves.h"
#include "builders/reinsert/search.h"
#include "tests/device_forms.h"
#include "tests/tree_fixture.h"

static bool small;

enum { LEAVES_MAX = 32, PLACES_MAX = 2 * LEAVES_MAX, MOST = 100000 };

/* ---- the definition: nodes by pointers, named after the place where they are at first ---- */

typedef struct model_node {
    bool leaf;
    bb_box box; /* of a leaf */
    uint32_t parent, children[2];
} model_node;

typedef struct model {
    uint32_t root, count; /* of inner nodes */
    float unit;
    model_node nodes[PLACES_MAX];
} model;

static void make_model(const bb_family *families, uint32_t count, float unit, model *m)
{
    *m = (model){.root = 2 * count, .count = count, .unit = unit};
    for (uint32_t place = 0; place <= 2 * count; place++) {
        const bb_family *family = &families[place >> 1];
        model_node *node = &m->nodes[place];
        uint32_t side = place & 1, link = family->links[side];
        node->leaf = (link & BB_LEAF_BIT) != 0;
        node->parent = place < 2 * count ? family->place : BB_NONE;
        for (int k = 0; k < 3; k++) {
            node->box.lo[k] = -family->planes[4 * k + side];
            node->box.hi[k] = family->planes[4 * k + 2 + side];
        }
        if (!node->leaf) {
            node->children[0] = 2 * link;
            node->children[1] = 2 * link + 1;
        }
    }
}

static bb_box model_box(const model *m, uint32_t n)
{
    if (m->nodes[n].leaf)
        return m->nodes[n].box;
    bb_box a = model_box(m, m->nodes[n].children[0]), b = model_box(m, m->nodes[n].children[1]);
    for (int k = 0; k < 3; k++) {
        a.lo[k] = fminf(a.lo[k], b.lo[k]);
        a.hi[k] = fmaxf(a.hi[k], b.hi[k]);
    }
    return a;
}

static double model_area(const model *m, uint32_t n)
{
    const bb_box box = model_box(m, n);
    double x = (double)box.hi[0] - box.lo[0], y = (double)box.hi[1] - box.lo[1],
           z = (double)box.hi[2] - box.lo[2];
    return (x * y + y * z + z * x) * m->unit * m->unit;
}

static double model_cost(const model *m, uint32_t n)
{
    if (m->nodes[n].leaf)
        return 0;
    return model_area(m, n) + model_cost(m, m->nodes[n].children[0]) +
           model_cost(m, m->nodes[n].children[1]);
}

static bool is_below(const model *m, uint32_t n, uint32_t top)
{
    while (n != BB_NONE && n != top)
        n = m->nodes[n].parent;
    return n == top;
}

static uint32_t *slot_of(model *m, uint32_t n)
{
    uint32_t parent = m->nodes[n].parent;
    return parent == BB_NONE ? &m->root
                             : &m->nodes[parent].children[m->nodes[parent].children[1] == n];
}

static uint32_t sibling_of(const model *m, uint32_t n)
{
    const uint32_t *children = m->nodes[m->nodes[n].parent].children;
    return children[children[0] == n];
}

static bool may_move(const model *m, uint32_t x, uint32_t to)
{
    return x != m->root && !is_below(m, to, x) && to != m->nodes[x].parent &&
           to != sibling_of(m, x);
}

static void model_move(model *m, uint32_t x, uint32_t to)
{
    uint32_t p = m->nodes[x].parent, s = sibling_of(m, x);
    *slot_of(m, p) = s;
    m->nodes[s].parent = m->nodes[p].parent;
    *slot_of(m, to) = p;
    m->nodes[p].parent = m->nodes[to].parent;
    m->nodes[to].parent = p;
    m->nodes[p].children[0] = x;
    m->nodes[p].children[1] = to;
}

static double gain_of(const model *m, uint32_t x, uint32_t to)
{
    model moved = *m;
    model_move(&moved, x, to);
    return model_cost(m, m->root) - model_cost(&moved, moved.root);
}

/* ---- one tree on a device ---- */

typedef struct bench {
    bb_family_tree tree;
    bb_reinsert_search search;
    bb_mover mover;
} bench;

static void open_bench(bench *b, bb_device *on, uint32_t most)
{
    *b = (bench){0};
    ASSERT_OK(bb_family_tree_create(on, NULL, &b->tree));
    ASSERT_OK(bb_reinsert_search_create(on, NULL, b->tree.primitives, most, &b->search));
    ASSERT_OK(bb_mover_create(on, NULL, &b->mover));
}

static void close_bench(bench *b)
{
    bb_mover_release(&b->mover);
    bb_reinsert_search_release(&b->search);
    bb_family_tree_release(&b->tree);
}

static void put_tree(bench *b, bb_tree *tree)
{
    ASSERT_OK(bb_tree_upload(tree, b->tree.device, NULL));
    ASSERT_OK(bb_family_tree_gather(&b->tree, tree));
    ASSERT_OK(bb_reinsert_search_reserve(&b->search, b->tree.count));
    ASSERT_OK(bb_mover_reserve(&b->mover, b->tree.count));
}

static void get_families(const bench *b, bb_family *families)
{
    ASSERT_OK(
        bb_buffer_read(&b->tree.families, 0, (b->tree.count + 1) * sizeof *families, families));
}

static void get_model(const bench *b, model *m)
{
    bb_family families[LEAVES_MAX];
    get_families(b, families);
    make_model(families, b->tree.count, b->tree.unit, m);
}

/* Moves of all subtrees, by place. */
static void find_all(bench *b, bb_move *moves)
{
    uint32_t end;
    ASSERT_OK(bb_reinsert_choose(&b->search, &b->tree, 1));
    assert_int_equal(b->search.count, 2 * b->tree.count);
    ASSERT_OK(bb_reinsert_find(&b->search, &b->tree, 0, 1, 0, &end));
    assert_int_equal(end, b->search.count);
    ASSERT_OK(bb_buffer_read(&b->search.moves, 0, end * sizeof *moves, moves));
}

static double cost_of(bench *b)
{
    double cost;
    ASSERT_OK(bb_family_tree_cost(&b->tree, &cost));
    return cost;
}

static void random_scene_tree(bb_random *random, uint32_t count, uint32_t max_leaf,
                              bb_scene **scene, bb_tree *tree)
{
    *scene = make_random_scene(count, random);
    do
        make_random_tree(*scene, 2, max_leaf, random, tree);
    while (tree->info.leaf_count < 2 && (bb_tree_release(tree), true));
}

/* ---- the search ---- */

static void check_move(const model *m, const bb_move *move, double slack)
{
    double best = 0, found = 0;
    for (uint32_t to = 0; to <= 2 * m->count; to++)
        if (may_move(m, move->from, to))
            best = fmax(best, gain_of(m, move->from, to));
    if (move->to != BB_NONE) {
        assert_true(may_move(m, move->from, move->to));
        found = gain_of(m, move->from, move->to);
        assert_true(move->gain > 0);
        ASSERT_NEAR(move->gain, found, slack);
        /* what rules out rings */
        uint32_t parent = m->nodes[move->to].parent;
        assert_true(parent == BB_NONE || is_below(m, move->from, parent) ||
                    model_area(m, move->from) < model_area(m, parent) * (1 + 1e-6));
    }
    ASSERT_NEAR(found, best, slack);
    if (move->from < 2 * m->count && move->to != BB_NONE)
        assert_int_equal(move->above, m->nodes[m->nodes[move->from].parent].parent == BB_NONE
                                          ? 2 * m->count
                                          : m->nodes[move->from].parent);
}

static void the_search_finds_the_best_place(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 1);
    bench b;
    open_bench(&b, devices[first_form()], MOST);
    for (uint32_t round = 0; round < (small ? 3u : 60u); round++) {
        bb_scene *scene;
        bb_tree tree;
        bb_move moves[PLACES_MAX];
        model m;
        random_scene_tree(&random, 2 + bb_random_below(&random, LEAVES_MAX - 1), 1 + round % 3,
                          &scene, &tree);
        put_tree(&b, &tree);
        get_model(&b, &m);
        find_all(&b, moves);
        const double cost = model_cost(&m, m.root);
        ASSERT_NEAR(cost_of(&b), cost, 1e-6 * cost);
        for (uint32_t i = 0; i < 2 * m.count; i++)
            check_move(&m, &moves[i], 2e-6 * cost);
        bb_tree_release(&tree);
        free_scene(scene);
    }
    close_bench(&b);
}

/* ---- moves ---- */

/* Makes the one move, whatever it gains, and takes it back. */
static void try_move(bench *b, const bb_scene *scene, const model *m, uint32_t x, uint32_t to,
                     bb_tree *out)
{
    bb_family before[LEAVES_MAX], after[LEAVES_MAX];
    const bb_moves one = {&b->search.moves, 0, 1};
    uint32_t p = x >> 1, made;
    get_families(b, before);
    const bb_move move = {x, to, before[p].place, 1};
    ASSERT_OK(bb_buffer_write(&b->search.moves, 0, sizeof move, &move));
    ASSERT_OK(bb_mover_choose(&b->mover, one, &made));
    assert_int_equal(made, 1);
    ASSERT_OK(bb_mover_make(&b->mover, &b->tree, one));
    const double cost = model_cost(m, m->root), now = cost_of(b);
    ASSERT_NEAR(cost - now, gain_of(m, x, to), 1e-6 * cost);
    ASSERT_OK(
        bb_tree_reserve(out, b->tree.device, BB_ON_DEVICE, 2 * m->count + 1, scene->prim_count));
    uint32_t refs[LEAVES_MAX];
    for (uint32_t i = 0; i < scene->prim_count; i++)
        refs[i] = i | BB_LAST_BIT;
    ASSERT_OK(bb_buffer_write(&out->d_refs, 0, scene->prim_count * sizeof *refs, refs));
    ASSERT_OK(bb_family_tree_write(&b->tree, scene->prim_count, out));
    ASSERT_OK(bb_tree_fetch_info(out));
    ASSERT_OK(bb_tree_download(out, NULL));
    ASSERT_OK(bb_tree_check(out, scene));
    ASSERT_OK(bb_mover_undo(&b->mover, &b->tree, one));
    get_families(b, after);
    assert_memory_equal(before, after, (m->count + 1) * sizeof *before);
}

/* Leaves `order`[0 .. n) under the shape-th of all binary trees; returns how many shapes there
 * are. Nodes in preorder. */
static uint32_t shapes_of(uint32_t leaves)
{
    uint32_t sum = leaves == 1;
    for (uint32_t left = 1; left < leaves; left++)
        sum += shapes_of(left) * shapes_of(leaves - left);
    return sum;
}

static void add_shape(const bb_scene *scene, const uint32_t *order, uint32_t leaves, uint32_t shape,
                      uint32_t skip, uint32_t depth, bb_tree *tree)
{
    uint32_t n = tree->info.node_count++;
    bb_node *node = &tree->nodes[n];
    *node = (bb_node){.skip = skip};
    for (int k = 0; k < 3; k++) {
        node->lo[k] = INFINITY;
        node->hi[k] = -INFINITY;
        for (uint32_t i = 0; i < leaves; i++) {
            node->lo[k] = fminf(node->lo[k], scene->boxes[order[i]].lo[k]);
            node->hi[k] = fmaxf(node->hi[k], scene->boxes[order[i]].hi[k]);
        }
    }
    tree->info.depth = depth > tree->info.depth ? depth : tree->info.depth;
    if (leaves == 1) {
        node->first = BB_LEAF_BIT | order[0];
        return;
    }
    uint32_t left = 1;
    for (; shape >= shapes_of(left) * shapes_of(leaves - left); left++)
        shape -= shapes_of(left) * shapes_of(leaves - left);
    uint32_t rest = shapes_of(leaves - left);
    node->first = n + 1;
    add_shape(scene, order, left, shape / rest, n + 2 * left, depth + 1, tree);
    add_shape(scene, order + left, leaves - left, shape % rest, skip, depth + 1, tree);
}

static void try_all_moves(bench *b, bb_scene *scene, const uint32_t *order, uint32_t shape)
{
    uint32_t n = scene->prim_count;
    bb_tree tree, out;
    bb_tree_init(&tree, NULL);
    bb_tree_init(&out, NULL);
    ASSERT_OK(bb_tree_reserve(&tree, NULL, BB_ON_HOST, 2 * n - 1, n));
    for (uint32_t i = 0; i < n; i++)
        tree.refs[i] = i | BB_LAST_BIT;
    tree.info = (bb_tree_info){.leaf_count = n, .ref_count = n, .arity = 2};
    add_shape(scene, order, n, shape, BB_NONE, 0, &tree);
    ASSERT_OK(bb_tree_check(&tree, scene));
    put_tree(b, &tree);
    model m;
    get_model(b, &m);
    for (uint32_t x = 0; x < 2 * m.count; x++)
        for (uint32_t to = 0; to <= 2 * m.count; to++)
            if (may_move(&m, x, to))
                try_move(b, scene, &m, x, to, &out);
    bb_tree_release(&out);
    bb_tree_release(&tree);
}

/* Every tree of up to four leaves, every move in it, in all forms. */
static void any_move_can_be_made_and_undone(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 2);
    for (int form = first_form(); form < (small ? first_form() + 1 : FORMS); form++) {
        bench b;
        open_bench(&b, devices[form], MOST);
        for (uint32_t n = 2; n <= (small ? 3u : 4u); n++) {
            bb_scene *scene = make_random_scene(n, &random);
            for (uint32_t shape = 0; shape < shapes_of(n); shape++) {
                /* rotations of the order put each leaf everywhere */
                for (uint32_t turn = 0; turn < n; turn++) {
                    uint32_t order[4];
                    for (uint32_t i = 0; i < n; i++)
                        order[i] = (i + turn) % n;
                    try_all_moves(&b, scene, order, shape);
                }
            }
            free_scene(scene);
        }
        close_bench(&b);
    }
}

/* Moves that are made together: the same ones in whatever order they are listed, and all that they
 * have rewritten comes back. */
static void moves_do_not_depend_on_their_order(void **state)
{
    (void)state;
    const uint32_t count = small ? 60 : 3000;
    bb_random random = bb_random_make(seed, 3);
    bb_scene *scene;
    bb_tree tree;
    random_scene_tree(&random, count, 1, &scene, &tree);
    bb_move *moves = malloc(2 * count * sizeof *moves);
    uint32_t *order = malloc(2 * count * sizeof *order);
    bb_family *before = malloc(count * sizeof *before), *first = malloc(count * sizeof *first),
              *after = malloc(count * sizeof *after);
    for (int form = first_form(); form < FORMS; form++) {
        bench b;
        uint32_t made;
        open_bench(&b, devices[form], MOST);
        put_tree(&b, &tree);
        get_families(&b, before);
        find_all(&b, moves);
        const bb_moves all = {&b.search.moves, 0, b.search.count};
        const double cost = cost_of(&b);
        ASSERT_OK(bb_mover_choose(&b.mover, all, &made));
        assert_true(made > 1);
        ASSERT_OK(bb_mover_make(&b.mover, &b.tree, all));
        get_families(&b, after);
        if (form == first_form())
            memcpy(first, after, count * sizeof *first);
        assert_memory_equal(first, after, count * sizeof *first);
        assert_true(cost_of(&b) < cost);
        ASSERT_OK(bb_mover_undo(&b.mover, &b.tree, all));
        get_families(&b, after);
        assert_memory_equal(before, after, count * sizeof *before);

        for (uint32_t i = 0; i < all.end; i++)
            order[i] = i;
        shuffle(order, all.end, &random);
        for (uint32_t i = 0; i < all.end; i++)
            ASSERT_OK(bb_buffer_write(&b.search.moves, i * sizeof *moves, sizeof *moves,
                                      &moves[order[i]]));
        ASSERT_OK(bb_mover_choose(&b.mover, all, &made));
        ASSERT_OK(bb_mover_make(&b.mover, &b.tree, all));
        get_families(&b, after);
        assert_memory_equal(first, after, count * sizeof *first);
        close_bench(&b);
    }
    free(moves);
    free(order);
    free(before);
    free(first);
    free(after);
    bb_tree_release(&tree);
    free_scene(scene);
}

static int open_all(void **state)
{
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    return open_devices(state);
}

int main(void)
{
    seed = seed_or(seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_search_finds_the_best_place),
        cmocka_unit_test(any_move_can_be_made_and_undone),
        cmocka_unit_test(moves_do_not_depend_on_their_order),
    };
    return cmocka_run_group_tests(tests, open_all, close_devices);
}
