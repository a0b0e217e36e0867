/* Reinsertion: the search against all places there are, moves against taking out and putting in by
 * pointers, roots exhaustively, undoing, degenerate inputs and chains; one tree in all forms, never
 * a worse one. Seed: BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (oclgrind). */
#include "builders/reinsert/moves.h"
#include "builders/reinsert/search.h"
#include "framework/builder/registry.h"
#include "tests/device_forms.h"
#include "tests/quality_inputs.h"
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

/* ---- whole builds ---- */

static void expect_one_tree(const bb_box *boxes, uint32_t count, const char *before,
                            const char *builder, const char *what)
{
    box_build base, builds[FORMS];
    open_box_build(&base, devices[first_form()], before, boxes, count, what);
    const double was = bb_tree_sah(&base.preorder);
    for (int form = first_form(); form < FORMS; form++) {
        open_box_build(&builds[form], devices[form], builder, boxes, count, what);
        const bb_tree *tree = &builds[form].preorder, *first = &builds[first_form()].preorder;
        const double sah = bb_tree_sah(tree);
        if (!(sah <= was * (1 + 1e-6)) && !isnan(was))
            fail_msg("%s, %s, %u boxes: SAH %.9g, was %.9g", builder, what, count, sah, was);
        assert_memory_equal(&tree->info, &first->info, sizeof tree->info);
        if (memcmp(tree->nodes, first->nodes, tree->info.node_count * sizeof(bb_node)) != 0 ||
            memcmp(tree->refs, first->refs, tree->info.ref_count * sizeof(uint32_t)) != 0)
            fail_msg("%s, %s, %u boxes, seed %llu: form %d gives another tree", builder, what,
                     count, (unsigned long long)seed, form);
    }
    for (int form = first_form(); form < FORMS; form++)
        close_box_build(&builds[form]);
    close_box_build(&base);
}

static void all_forms_give_one_tree_and_no_worse(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 4, 33, 600}, few[] = {1, 3, 20};
    const uint32_t *sizes = small ? few : counts;
    for (size_t k = 0; k < (small ? 2 : QUALITY_INPUTS); k++)
        for (size_t c = 0; c < (small ? 3 : 6); c++) {
            bb_box *boxes = make_boxes(quality_inputs, k, sizes[c]);
            expect_one_tree(boxes, sizes[c], "lbvh", "lbvh+reinsert", quality_inputs[k].name);
            free(boxes);
        }
}

static void options_do_not_depend_on_the_form(void **state)
{
    (void)state;
    static const char *const builders[] = {
        "lbvh+reinsert:passes=20,stop=0,parts=1",
        "lbvh+reinsert:share=0.05,parts=64",
        "lbvh+reinsert:visits=8",
        "lbvh+reinsert:passes=1+reinsert:passes=1,share=0.3",
    };
    const uint32_t count = small ? 40 : 4000;
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++)
        expect_one_tree(boxes, count, "lbvh", builders[i], "options");
    free(boxes);
}

/* What a build says of itself. */
typedef struct account_of_passes {
    unsigned long long moved, searched;
    unsigned passes;
    uint64_t hash;
    double sah;
} account_of_passes;

static account_of_passes passes_of(const char *builder, const bb_box *boxes, uint32_t count)
{
    account_of_passes a;
    char text[512];
    box_build b;
    open_box_build(&b, devices[first_form()], builder, boxes, count, "passes");
    ASSERT_OK(bb_instance_describe(&b.instance, &b.scene, text, sizeof text));
    const char *own = strstr(text, "reinsert: ");
    assert_non_null(own);
    assert_int_equal(
        sscanf(own, "reinsert: %llu of %llu moved in %u passes", &a.moved, &a.searched, &a.passes),
        3);
    ASSERT_OK(bb_tree_hash(&b.preorder, &a.hash));
    a.sah = bb_tree_sah(&b.preorder);
    close_box_build(&b);
    return a;
}

/* A pass after which the tree is worse is as if it had not been; none is made after one that gains
 * less than it should. */
static void no_pass_raises_the_cost(void **state)
{
    (void)state;
    enum { PASSES = 20, TRIES = 8 };
    const uint32_t count = small ? 40 : 600;
    uint32_t taken_back = 0;
    for (uint32_t i = 0; i < (small ? 1 : TRIES) && taken_back < 2; i++) {
        bb_box *boxes = make_boxes(quality_inputs, 0, count + i);
        account_of_passes before = passes_of("lbvh+reinsert:stop=1", boxes, count + i);
        assert_int_equal(before.passes, 1);
        for (unsigned passes = 1; passes <= PASSES; passes++) {
            char text[64];
            snprintf(text, sizeof text, "lbvh+reinsert:stop=0,parts=2,passes=%u", passes);
            const account_of_passes now = passes_of(text, boxes, count + i);
            if (passes > 1 && now.sah > before.sah * (1 + 1e-7))
                fail_msg("%u boxes, pass %u, seed %llu: SAH %.9g, was %.9g", count + i, passes,
                         (unsigned long long)seed, now.sah, before.sah);
            if (passes > 1 && now.searched > before.searched && now.moved == before.moved) {
                assert_true(now.hash == before.hash);
                taken_back++;
            }
            before = now;
            if (now.passes < passes)
                break;
        }
        free(boxes);
    }
    assert_true(small || taken_back > 0);
}

/* No two boxes are of one size here, so that a share is a number of subtrees. */
static void a_share_is_that_of_all_subtrees(void **state)
{
    (void)state;
    static const double shares[] = {0.02, 0.25, 0.5, 0.9};
    const uint32_t count = small ? 40 : 600, places = 2 * (count - 1);
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        char text[64];
        snprintf(text, sizeof text, "lbvh+reinsert:passes=1,share=%g", shares[i]);
        const account_of_passes a = passes_of(text, boxes, count);
        assert_true(fabs((double)a.searched - shares[i] * places) <= 2);
    }
    free(boxes);
}

/* Leaves of several references, one leaf alone, and references that a splitter has made. */
static void leaves_stay_as_they_are(void **state)
{
    (void)state;
    static const char *const builders[] = {"sah:leaf=4", "null", "presplit:saves=-1+lbvh"};
    bb_scene *scene;
    bb_device *on = devices[first_form()];
    ASSERT_OK(bb_scene_load(small ? "interior:n=1000" : "interior:n=3000", &scene));
    ASSERT_OK(bb_scene_upload(scene, on));
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        bb_instance before = {0}, after = {0};
        char text[128];
        snprintf(text, sizeof text, "%s+reinsert", builders[i]);
        ASSERT_OK(bb_instance_create(on, builders[i], scene, 1, &before));
        ASSERT_OK(bb_instance_build(&before, scene, false, NULL));
        ASSERT_OK(bb_tree_download(&before.tree, NULL));
        ASSERT_OK(bb_instance_create(on, text, scene, 1, &after));
        ASSERT_OK(bb_instance_build(&after, scene, false, NULL));
        ASSERT_OK(bb_tree_download(&after.tree, NULL));
        ASSERT_OK(bb_tree_check(&after.tree, scene));
        assert_int_equal(before.tree.info.leaf_count, after.tree.info.leaf_count);
        assert_int_equal(before.tree.duplicated, after.tree.duplicated);
        assert_true(bb_tree_sah(&after.tree) <= bb_tree_sah(&before.tree) * (1 + 1e-6));
        if (i != 1 && !small)
            assert_true(bb_tree_sah(&after.tree) < 0.95 * bb_tree_sah(&before.tree));
        bb_instance_destroy(&before);
        bb_instance_destroy(&after);
    }
    bb_scene_free(scene);
}

/* Boxes around each other as a chain of so many levels: straight into the hook. */
static void make_chain(uint32_t levels, bb_scene **scene, bb_tree *chain)
{
    *scene = make_box_scene(levels + 1);
    bb_tree_init(chain, NULL);
    ASSERT_OK(bb_tree_reserve(chain, NULL, BB_ON_HOST, 2ul * levels + 1, levels + 1));
    for (uint32_t i = 0; i <= levels; i++) {
        const float half = 1.0f + (float)(levels - i);
        const bb_box box = {.lo = {-half, -half, -half}, .hi = {half, half, half}};
        (*scene)->boxes[i] = box;
        chain->refs[i] = i | BB_LAST_BIT;
        chain->nodes[2 * i] = make_node(box.lo, box.hi, 2 * i + 1, BB_NONE);
        if (i == levels)
            chain->nodes[2 * i].first = BB_LEAF_BIT | i;
        else
            chain->nodes[2 * i + 1] = make_node(box.lo, box.hi, BB_LEAF_BIT | i, 2 * i + 2);
    }
    chain->info = (bb_tree_info){0, 2 * levels + 1, levels + 1, levels + 1, 2, levels};
}

static void chains_end(void **state)
{
    (void)state;
    const uint32_t levels = small ? 50 : 20000;
    bb_device *on = devices[CPU_FORM];
    const bb_builder *reinsert = bb_builder_find("reinsert");
    bb_spec spec;
    bb_scene *scene;
    bb_tree chain, out;
    void *self = NULL;
    bb_account account = {0};
    bb_builder_context context = {
        .device = on, .account = &account, .spec = &spec, .options = reinsert->options};
    bb_phases phases = {.current = -1, .device = on};
    ASSERT_OK(bb_spec_parse("reinsert:passes=2", &spec));
    make_chain(levels, &scene, &chain);
    bb_tree_init(&out, &account);
    ASSERT_OK(bb_tree_check(&chain, scene));
    ASSERT_OK(bb_tree_upload(&chain, on, NULL));
    ASSERT_OK(reinsert->create(&context, &self));
    ASSERT_OK(reinsert->build(self, scene, &chain, &out, &phases));
    ASSERT_OK(bb_tree_fetch_info(&out));
    ASSERT_OK(bb_tree_download(&out, NULL));
    ASSERT_OK(bb_tree_check(&out, scene));
    assert_true(bb_tree_sah(&out) <= bb_tree_sah(&chain) * (1 + 1e-6));
    chain.info.arity = 3;
    assert_int_equal(reinsert->build(self, scene, &chain, &out, &phases), BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "binary trees"));
    reinsert->destroy(self);
    bb_tree_release(&chain);
    bb_tree_release(&out);
    free_scene(scene);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "lbvh+reinsert:passes=0", "lbvh+reinsert:share=0",   "lbvh+reinsert:share=1.1",
        "lbvh+reinsert:stop=2",   "lbvh+reinsert:visits=7",  "lbvh+reinsert:parts=0",
        "lbvh+reinsert:parts=65", "lbvh+reinsert:nothing=1", "reinsert+lbvh"};
    const bb_box box = {{0}, 0, {0}, 0};
    const bb_scene scene = scene_of(&box, 1);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        bb_instance instance = {0};
        assert_int_equal(bb_instance_create(devices[first_form()], bad[i], &scene, 1, &instance),
                         BB_INVALID);
        bb_instance_destroy(&instance);
    }
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
        cmocka_unit_test(all_forms_give_one_tree_and_no_worse),
        cmocka_unit_test(options_do_not_depend_on_the_form),
        cmocka_unit_test(no_pass_raises_the_cost),
        cmocka_unit_test(a_share_is_that_of_all_subtrees),
        cmocka_unit_test(leaves_stay_as_they_are),
        cmocka_unit_test(chains_end),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, open_all, close_devices);
}
