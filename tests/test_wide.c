/* The wide layouts, read back and taken apart on the host: random trees of any arity, floats biased
 * to extremes; and made in all ways that there are. */
#include "framework/builder/instance.h"
#include "tests/wide_fixture.h"

static void join(bb_box *box, const bb_box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = fminf(box->lo[k], other->lo[k]);
        box->hi[k] = fmaxf(box->hi[k], other->hi[k]);
    }
}

/* Box of the primitives in the leaf, which are marked as seen; false if it has none. */
static bool read_leaf(wide *w, uint32_t block, bb_box *box)
{
    bool any = false, last = false;
    for (; !last; block++) {
        const uint32_t *words = w->blocks + (size_t)block * w->words;
        const uint32_t *prims = words + bb_leaf_prim_payload(w->scene->kinds, 0) * w->lanes;
        last = (prims[0] & BB_LAST_BIT) != 0;
        for (uint32_t lane = 0; lane < w->lanes; lane++) {
            if (prims[lane] == BB_NONE) {
                assert_true(lane == 0 || prims[w->lanes - 1] == BB_NONE);
                continue;
            }
            uint32_t prim = lane == 0 ? prims[0] & BB_INDEX_MASK : prims[lane];
            assert_true(prim < w->scene->prim_count);
            assert_int_equal(prim < w->scene->prims[BB_TRIANGLE].count,
                             (prims[0] & BB_INDEX_MASK) < w->scene->prims[BB_TRIANGLE].count);
            bool triangle = prim < w->scene->prims[BB_TRIANGLE].count;
            const float *from = triangle
                                    ? w->scene->vertices + 9 * (size_t)prim
                                    : bb_scene_floats(w->scene, BB_SPHERE) +
                                          4 * (size_t)(prim - w->scene->prims[BB_TRIANGLE].count);
            for (uint32_t k = 0; k < (triangle ? 9u : 4u); k++)
                assert_memory_equal(&words[k * w->lanes + lane], &from[k], sizeof *from);
            w->seen[prim]++;
            join(box, &w->scene->boxes[prim]);
            any = true;
        }
    }
    return any;
}

/* How well a box fits a place, whose bit a says that it shall lie high on axis a. */
static float fit_of(const bb_box *box, uint32_t place)
{
    float fit = 0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        float middle = 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
        fit += (place >> axis & 1u) != 0 ? middle : -middle;
    }
    return fit;
}

/* Without octants children take the first places. With them, the pair of child and place that fits
 * best comes first: a place that a child fits better than its own has one that fits it as well. */
static void check_places(const wide *w, uint32_t node, uint32_t count)
{
    for (uint32_t c = 0; c < w->width; c++) {
        if (!w->octants)
            assert_int_equal(is_place(w, node, c), c < count);
        if (!w->octants || !is_place(w, node, c))
            continue;
        const bb_box box = box_of(w, node, c);
        for (uint32_t place = 0; place < w->width; place++) {
            const bb_box there = box_of(w, node, place);
            if (fit_of(&box, place) > fit_of(&box, c) &&
                !(is_place(w, node, place) && fit_of(&there, place) >= fit_of(&box, place)))
                fail_msg("node %u: child %u fits place %u better", node, c, place);
        }
    }
}

/* Box of the primitives below `link`. Recursion: trees of the tests are shallow. */
static bool read_link(wide *w, uint32_t link, uint32_t above, bb_box *box)
{
    if ((link & BB_LEAF_BIT) != 0)
        return read_leaf(w, link & BB_INDEX_MASK, box);
    uint32_t count, children = 0;
    const uint32_t *links = links_of(w, link, &count);
    w->inner++;
    uint32_t need = above + count - 1;
    w->stack_need = need > w->stack_need ? need : w->stack_need;
    for (uint32_t c = 0; c < w->width; c++) {
        bb_box below = {.lo = {INFINITY, INFINITY, INFINITY},
                        .hi = {-INFINITY, -INFINITY, -INFINITY}};
        bb_box said = box_of(w, link, c);
        if (!read_link(w, links[c], need, &below)) {
            for (int k = 0; k < 3; k++) /* boxes of flat nodes can't be empty: a bit says it */
                assert_true(w->quantised || said.lo[k] > said.hi[k]);
            assert_false(is_place(w, link, c));
            continue;
        }
        assert_true(is_place(w, link, c));
        children++;
        bb_box padded = padded_box(&below);
        for (int k = 0; k < 3; k++) {
            bool right = w->quantised ? said.lo[k] <= padded.lo[k] && said.hi[k] >= padded.hi[k]
                                      : said.lo[k] == padded.lo[k] && said.hi[k] == padded.hi[k];
            if (!right)
                fail_msg("node %u child %u axis %d: %a to %a, its primitives, padded, %a to %a",
                         link, c, k, said.lo[k], said.hi[k], padded.lo[k], padded.hi[k]);
        }
        join(box, &below);
    }
    assert_int_equal(children, count);
    assert_true(count >= 2);
    if (w->width == 8 && !w->quantised) /* whose planes are those that places were given by */
        check_places(w, link, count);
    return true;
}

static void take_apart(const char *name, const bb_scene *scene, bb_tree *tree, uint32_t leaf,
                       const bb_layout_wish *wish)
{
    uint32_t root;
    wide w = read_wide(name, scene, tree, leaf, wish, &root);
    /* records of one lane where no leaf needs more */
    assert_int_equal(
        w.lanes, leaf == 1 && tree->info.leaf_count == tree->info.ref_count ? 1 : BB_BLOCK_LANES);
    bb_box box = {.lo = {INFINITY, INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY, -INFINITY}};
    assert_true(read_link(&w, root, 0, &box));
    if (wish->plan == BB_PLAN_NATIVE) { /* an upper bound */
        assert_true(w.stack_need <= w.said_need);
        if (leaf == 1)
            assert_int_equal(w.inner, tree->info.node_count - tree->info.leaf_count);
    } else
        assert_int_equal(w.stack_need, w.said_need);
    for (uint32_t i = 0; i < scene->prim_count; i++)
        assert_int_equal(w.seen[i], 1);
    free_wide(&w);
}

static void refuse_native(const char *name, const bb_scene *scene, bb_tree *tree)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    ASSERT_OK(bb_layout_maker_create(bb_layout_find(name), device, &maker));
    maker.wish.plan = BB_PLAN_NATIVE;
    assert_int_equal(bb_layout_maker_make(&maker, scene, tree, 1, BB_FORMAT_VERTICES, &data),
                     BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "leave out plan=native"));
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
}

static void wide_layouts_hold_the_tree(void **state)
{
    (void)state;
    static const char *const names[] = {"wide4", "wide8", "quant8"};
    for (uint32_t run = 0; run < (small() ? 10u : 200u); run++) {
        bb_random random = bb_random_make(SEED + 1, run);
        uint32_t triangles = bb_random_below(&random, small() ? 30 : 300);
        uint32_t spheres = run % 3 == 0 ? bb_random_below(&random, 50) : 0;
        if (run % 6 == 0)
            triangles = 0;
        if (triangles + spheres == 0)
            triangles = 1;
        float *v = malloc((9 * (size_t)triangles + 4 * (size_t)spheres) * sizeof *v);
        for (uint32_t i = 0; i < 9 * triangles; i++)
            v[i] = extreme(&random, run % 5);
        for (uint32_t i = 0; i < 4 * spheres; i++)
            v[9 * triangles + i] = fabsf(extreme(&random, 0));
        bb_scene *scene = make_scene(v, triangles, v + 9 * (size_t)triangles, spheres);
        free(v);
        ASSERT_OK(bb_scene_upload(scene, device));
        bb_tree tree;
        make_random_tree(scene, 2 + bb_random_below(&random, 12), 1 + bb_random_below(&random, 9),
                         &random, &tree);
        ASSERT_OK(bb_tree_upload(&tree, device, NULL));
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
            for (uint32_t leaf = 1; leaf <= 8; leaf += 7) {
                bb_layout_wish wish = {.octants = run % 2 == 0,
                                       .plan = run / 2 % 2 == 0 ? BB_PLAN_GREEDY : BB_PLAN_OPTIMAL};
                take_apart(names[i], scene, &tree, leaf, &wish);
                wish.plan = BB_PLAN_NATIVE;
                if (tree.info.arity <= bb_layout_find(names[i])->width)
                    take_apart(names[i], scene, &tree, leaf, &wish);
                else
                    refuse_native(names[i], scene, &tree);
            }
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

/* A chain down the first children, each with two leaves beside it: from level to level a node's
 * work-item has seven more pairs to open later on than there is room for. Pair i is at x = i; the
 * chain's nodes are 0 .. PAIRS - 2, then come three nodes of each pair. */
static void make_comb(const bb_scene *scene, uint32_t pairs, bb_tree *tree)
{
    const uint32_t chain = pairs - 1, count = chain + 3 * pairs;
    bb_node *nodes = malloc(count * sizeof *nodes);
    uint32_t *refs = malloc(2 * pairs * sizeof *refs);
    bb_box below = {.lo = {INFINITY, INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = pairs; i-- > 0;) {
        const uint32_t up = i < chain ? i : i - 1, pair = chain + 3 * i;
        /* of the chain's node: the pair of the one above */
        const uint32_t skip = up == 0 ? BB_NONE : chain + 3 * (up - 1);
        const bb_box *boxes = &scene->boxes[2 * i];
        bb_box both = boxes[0];
        join(&both, &boxes[1]);
        join(&below, &both);
        for (uint32_t k = 0; k < 2; k++)
            refs[2 * i + k] = (2 * i + k) | BB_LAST_BIT;
        const uint32_t after =
            i < chain ? skip : chain + 3 * up; /* the last pair is a first child */
        nodes[pair] = make_node(both.lo, both.hi, pair + 1, after);
        nodes[pair + 1] = make_node(boxes[0].lo, boxes[0].hi, BB_LEAF_BIT | 2 * i, pair + 2);
        nodes[pair + 2] = make_node(boxes[1].lo, boxes[1].hi, BB_LEAF_BIT | (2 * i + 1), after);
        if (i < chain)
            nodes[i] =
                make_node(below.lo, below.hi, i + 1 < chain ? i + 1 : chain + 3 * chain, skip);
    }
    make_tree(tree, nodes, count, refs, 2 * pairs, 2, pairs);
    free(nodes);
    free(refs);
}

static void pairs_wait_where_there_is_no_room(void **state)
{
    (void)state;
    enum { PAIRS = 200 };
    float *v = calloc(18 * PAIRS, sizeof *v);
    for (uint32_t i = 0; i < 2 * PAIRS; i++)
        for (uint32_t corner = 0; corner < 3; corner++) {
            v[9 * i + 3 * corner] = (float)(i / 2) + 0.1f * (float)corner;
            v[9 * i + 3 * corner + 1] = (float)(i % 2) + (corner == 1 ? 0.1f : 0);
        }
    bb_scene *scene = make_scene(v, 2 * PAIRS, NULL, 0);
    free(v);
    ASSERT_OK(bb_scene_upload(scene, device));
    bb_tree tree;
    make_comb(scene, PAIRS, &tree);
    ASSERT_OK(bb_tree_check(&tree, scene));
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    for (bb_plan plan = BB_PLAN_OPTIMAL; plan <= BB_PLAN_GREEDY; plan++) {
        const bb_layout_wish wish = {.plan = plan};
        take_apart("wide8", scene, &tree, 1, &wish);
        take_apart("wide4", scene, &tree, 1, &wish);
    }
    bb_tree_release(&tree);
    free_scene(scene);
}

/* Where nobody names a plan, a tree says whether its nodes are kept: if there are places for them.
 * Its leaves are kept with them. */
static void expect_name(const char *layout, const bb_scene *scene, bb_tree *tree, bb_plan plan,
                        const char *expected)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    bool in_place;
    ASSERT_OK(bb_layout_maker_create(bb_layout_find(layout), device, &maker));
    maker.wish.plan = plan;
    ASSERT_OK(bb_layout_maker_make(&maker, scene, tree, 3, BB_FORMAT_VERTICES, &data));
    assert_string_equal(data.name, expected);
    assert_int_equal(data.keeps_shape, strcmp(expected, "wide8:plan=native") == 0);
    bb_tree_boxes_changed(tree);
    ASSERT_OK(bb_layout_maker_follow(&maker, scene, tree, 3, BB_FORMAT_VERTICES, &data, &in_place));
    assert_true(in_place);
    assert_string_equal(data.name, expected);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
}

static void a_tree_says_whether_its_nodes_are_kept(void **state)
{
    (void)state;
    bb_scene *scene;
    bb_instance instance;
    ASSERT_OK(bb_scene_load("soup:n=300", &scene));
    ASSERT_OK(bb_scene_upload(scene, device));
    ASSERT_OK(bb_instance_create(device, "lbvh:arity=8", scene, 1, &instance));
    ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
    bb_tree *tree = &instance.tree;
    assert_int_equal(tree->info.arity, 8);
    expect_name("wide8", scene, tree, BB_PLAN_BY_TREE, "wide8:plan=native");
    expect_name("wide4", scene, tree, BB_PLAN_BY_TREE, "wide4:leaf=3");
    expect_name("cwbvh", scene, tree, BB_PLAN_BY_TREE, "cwbvh:leaf=3");
    expect_name("pair", scene, tree, BB_PLAN_BY_TREE, "pair:leaf=3");
    expect_name("wide8", scene, tree, BB_PLAN_OPTIMAL, "wide8:leaf=3");
    expect_name("wide8", scene, tree, BB_PLAN_NATIVE, "wide8:leaf=3,plan=native");
    tree->keep_nodes = false;
    expect_name("wide8", scene, tree, BB_PLAN_BY_TREE, "wide8:leaf=3");
    bb_instance_destroy(&instance);
    bb_scene_free(scene);
}

/* ---- the ways to the same layout ---- */

typedef struct made {
    uint32_t root, stack_need, lanes;
    size_t sizes[2];
    void *data[2];
} made;

static made make_on(int form, bb_scene *scene, const char *name, uint32_t arity, uint32_t per_leaf,
                    uint64_t run, uint32_t leaf)
{
    bb_random random = bb_random_make(SEED + 3, run);
    bb_layout_maker maker;
    bb_layout_data data = {0};
    bb_tree tree;
    device = devices[form];
    ASSERT_OK(bb_scene_upload(scene, device));
    make_random_tree(scene, arity, per_leaf, &random, &tree);
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    ASSERT_OK(bb_layout_maker_create(bb_layout_find(name), device, &maker));
    maker.wish =
        (bb_layout_wish){.octants = run % 2 == 1,
                         .plan = run / 2 % 2 == 1 ? BB_PLAN_GREEDY : BB_PLAN_OPTIMAL,
                         .node_cost = run % 3 == 1 ? 0.5 : 0,
                         .kinds = run % 5 == 4 ? 1u << BB_TETRAHEDRON
                                               : 0}; /* blocks larger than the scene asks for */
    ASSERT_OK(bb_layout_maker_make(&maker, scene, &tree, leaf, BB_FORMAT_VERTICES, &data));
    made made = {data.root, data.stack_need, data.lanes, {0}, {NULL}};
    for (uint32_t i = 0; i < 2; i++) {
        made.sizes[i] = data.buffers[i].bytes;
        made.data[i] = download(&data.buffers[i]);
    }
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    bb_tree_release(&tree);
    bb_scene_device *geometry = &scene->on_device;
    bb_buffer_release(&geometry->boxes);
    bb_buffer_release(&geometry->vertices);
    bb_buffer_release(&geometry->prims);
    return made;
}

/* Straight from a binary tree, or by way of pairs, with a fence or by levels: one layout, bit for
 * bit. Scenes of one kind of primitives and of two, extreme coordinates, and sizes with and without
 * nodes above the subtrees of the cut. */
static void all_ways_make_one_layout(void **state)
{
    (void)state;
    static const char *const names[] = {"wide8", "wide4", "quant8"};
    static const uint32_t leaves[] = {1, 2, 8, 64};
    for (uint32_t run = 0; run < (small() ? 4u : 40u); run++) {
        bb_random random = bb_random_make(SEED + 2, run);
        uint32_t triangles = 1 + bb_random_below(&random, small() ? 60 : run % 8 == 0 ? 6000 : 300);
        uint32_t spheres = run % 3 == 0 ? bb_random_below(&random, 50) : 0;
        float *v = malloc((9 * (size_t)triangles + 4 * (size_t)spheres) * sizeof *v);
        for (uint32_t i = 0; i < 9 * triangles; i++)
            v[i] = extreme(&random, run % 5);
        for (uint32_t i = 0; i < 4 * spheres; i++)
            v[9 * triangles + i] = fabsf(extreme(&random, 0));
        bb_scene *scene = make_scene(v, triangles, v + 9 * (size_t)triangles, spheres);
        free(v);
        for (uint32_t k = 0; k < 4; k++) {
            const char *name = names[(run + k) % 3];
            const uint32_t per_leaf = run % 4 == 3 ? 3 : 1; /* else straight */
            made first = {0};
            for (int form = CPU_FORM; form < FORMS; form++) {
                made made = make_on(form, scene, name, 2, per_leaf, run, leaves[k]);
                if (form == CPU_FORM) {
                    first = made;
                    continue;
                }
                assert_int_equal(first.root, made.root);
                assert_int_equal(first.stack_need, made.stack_need);
                assert_int_equal(first.lanes, made.lanes);
                for (uint32_t i = 0; i < 2; i++) {
                    assert_int_equal(first.sizes[i], made.sizes[i]);
                    bool is_written = i == 1 || (made.root & BB_LEAF_BIT) == 0;
                    if (is_written && memcmp(first.data[i], made.data[i], made.sizes[i]) != 0)
                        fail_msg("run %u %s leaf %u: buffer %u of form %d differs", run, name,
                                 leaves[k], i, form);
                    free(made.data[i]);
                }
            }
            free(first.data[0]);
            free(first.data[1]);
        }
        free_scene(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wide_layouts_hold_the_tree),
        cmocka_unit_test(pairs_wait_where_there_is_no_room),
        cmocka_unit_test(a_tree_says_whether_its_nodes_are_kept),
    };
    const struct CMUnitTest of_all[] = {
        cmocka_unit_test(all_ways_make_one_layout),
    };
    int failed = open_devices(NULL);
    if (first_form() == CPU_FORM && failed == 0)
        failed = cmocka_run_group_tests(of_all, NULL, NULL);
    RUN_ON_EACH_DEVICE(tests, failed)
    close_devices(NULL);
    return failed;
}
