/* The `cwbvh` layout, read back and taken apart on the host: random trees of any arity, leaves of
 * any size, floats biased to extremes. What a kernel does with it: test_brute_force.c,
 * test_watertight.c (boxes), test_work.c. */
#include "tests/cwbvh_fixture.h"

#include <float.h>

/* What the kernel may be off by, in steps: kernels/ERROR_BUDGET.md. */
static const double KERNEL_MARGIN = 0x1p-14;

typedef struct walk {
    const compressed *c;
    const bb_scene *scene;
    uint32_t *seen; /* per primitive */
    uint32_t nodes; /* met */
    uint32_t prims; /* in the order of the records */
    uint32_t most_prims;
    uint32_t stack_need;
    bool loose; /* boxes may be larger than those of what is in them */
} walk;

static const bb_box nothing = {.lo = {INFINITY, INFINITY, INFINITY},
                               .hi = {-INFINITY, -INFINITY, -INFINITY}};

static void join(bb_box *box, const bb_box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = fminf(box->lo[k], other->lo[k]);
        box->hi[k] = fmaxf(box->hi[k], other->hi[k]);
    }
}

static bb_box see_prims(walk *w, uint32_t first, uint32_t count)
{
    bb_box box = nothing;
    w->most_prims = count > w->most_prims ? count : w->most_prims;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t prim = prim_of(w->c, w->scene, first + i);
        assert_true(prim < w->scene->prim_count);
        w->seen[prim]++;
        join(&box, &w->scene->boxes[prim]);
    }
    return box;
}

/* That the planes of a place are outside of a padded box by what the kernel needs; differences of
 * floats are rounded so that none passes by mistake. */
static void check_planes(const bb_cwbvh *node, uint32_t n, uint32_t place, const bb_box *padded)
{
    for (int k = 0; k < 3; k++) {
        const double step = step_of(node, k), origin = node->origin[k];
        const uint8_t *q = node->planes + 16 * k + place;
        fesetround(FE_DOWNWARD);
        volatile double below = (double)padded->lo[k] - origin;
        fesetround(FE_UPWARD);
        volatile double above = (double)padded->hi[k] - origin;
        fesetround(FE_TONEAREST);
        if (!(below >= (q[0] + KERNEL_MARGIN) * step && above <= (q[8] - KERNEL_MARGIN) * step))
            fail_msg("node %u place %u axis %d: steps %u to %u of %a from %a, padded %a to %a", n,
                     place, k, q[0], q[8], step, origin, padded->lo[k], padded->hi[k]);
    }
}

/* That steps are no longer than they must be: 255 half as long do not reach. */
static void check_steps(const bb_cwbvh *node, uint32_t n, const bb_box *padded)
{
    for (int k = 0; k < 3; k++) {
        const double half = step_of(node, k) / 2, low = padded->lo[k], high = padded->hi[k];
        const double place = nextafterf(padded->lo[k], -INFINITY); /* as near as origins are */
        if (half >= 0x1p-34 && high - fmin(place, low - 0x1p-12 * half) <= 254.99 * half)
            fail_msg("node %u axis %d: steps of %a from %a to %a", n, k, 2 * half, low, high);
    }
}

/* The box of the primitives below node n. */
static bb_box see_node(walk *w, uint32_t n, uint32_t above)
{
    assert_true(n < w->c->node_count);
    const bb_cwbvh *node = &w->c->nodes[n];
    bb_box box = nothing, padded_all = nothing;
    uint32_t inner = 0, children = 0, first = node->prims;
    w->nodes++;
    for (uint32_t place = 0; place < 8; place++)
        inner += node_at(node, place) != BB_NONE;
    const uint32_t need = above + (inner > 1);
    w->stack_need = need > w->stack_need ? need : w->stack_need;
    for (uint32_t place = 0; place < 8; place++) {
        const uint32_t child = node_at(node, place), prims = leaf_prims(node, place);
        bb_box below = nothing;
        if (child == BB_NONE && prims == 0) {
            assert_int_equal(node->meta[place], 0);
            continue;
        }
        children++;
        if (child != BB_NONE)
            below = see_node(w, child, need);
        else
            below = see_prims(w, first, prims);
        assert_true(child != BB_NONE || (node->meta[place] & 31u) == first - node->prims);
        first += prims;
        const bb_box padded = padded_box(&below);
        check_planes(node, n, place, &padded);
        join(&padded_all, &padded);
        join(&box, &below);
    }
    assert_true(children >= 2);
    w->prims += first - node->prims;
    if (!w->loose)
        check_steps(node, n, &padded_all);
    return box;
}

static void take_apart(const bb_scene *scene, bb_tree *tree, uint32_t leaf, bool greedy,
                       uint32_t most_prims, bool loose)
{
    compressed c = read_compressed(scene, tree, leaf, greedy);
    walk w = {.c = &c, .scene = scene, .seen = calloc(scene->prim_count, sizeof *w.seen)};
    /* of leaves that are divided the parts have the box of the whole */
    w.loose = loose || tree->info.leaf_count < tree->info.ref_count;
    if ((c.root & BB_LEAF_BIT) != 0) {
        assert_int_equal(c.root & BB_INDEX_MASK, scene->prim_count);
        see_prims(&w, 0, scene->prim_count);
        w.prims = scene->prim_count;
    } else {
        assert_int_equal(c.root, 0);
        see_node(&w, 0, 0);
        assert_int_equal(w.nodes, c.node_count);
    }
    for (uint32_t i = 0; i < scene->prim_count; i++)
        assert_int_equal(w.seen[i], 1);
    assert_int_equal(w.prims, c.record_count);
    assert_int_equal(w.stack_need, c.stack_need);
    assert_true(w.most_prims <= most_prims);
    free(w.seen);
    free_compressed(&c);
}

static bb_scene *make_extreme_scene(uint32_t run, bb_random *random)
{
    uint32_t triangles = bb_random_below(random, small() ? 30 : 300);
    uint32_t spheres = run % 3 == 0 ? bb_random_below(random, 50) : 0;
    if (run % 6 == 0)
        triangles = 0;
    if (triangles + spheres == 0)
        triangles = 1;
    float *v = malloc((9 * (size_t)triangles + 4 * (size_t)spheres) * sizeof *v);
    for (uint32_t i = 0; i < 9 * triangles; i++)
        v[i] = extreme(random, run % 5);
    for (uint32_t i = 0; i < 4 * spheres; i++)
        v[9 * triangles + i] = fabsf(extreme(random, 0));
    bb_scene *scene = make_scene(v, triangles, v + 9 * (size_t)triangles, spheres);
    free(v);
    ASSERT_OK(bb_scene_upload(scene, device));
    return scene;
}

/* All primitives once, in boxes that hold them by the margin; nodes and primitives lie together,
 * and the stack's need is no more than the walk's. */
static void nodes_hold_the_tree(void **state)
{
    (void)state;
    for (uint32_t run = 0; run < (small() ? 8u : 120u); run++) {
        bb_random random = bb_random_make(SEED + 6, run);
        bb_scene *scene = make_extreme_scene(run, &random);
        bb_tree tree;
        const uint32_t per_leaf = 1 + bb_random_below(&random, 12);
        make_random_tree(scene, 2 + bb_random_below(&random, 12), run % 2 == 0 ? 1 : per_leaf,
                         &random, &tree);
        ASSERT_OK(bb_tree_upload(&tree, device, NULL));
        for (uint32_t leaf = 1; leaf <= 3; leaf++)
            take_apart(scene, &tree, leaf, run / 2 % 2 == 0, run % 2 == 0 ? leaf : 3, false);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

/* Whatever a builder's boxes are, and however many of them, up to the largest floats: such a plane
 * is far beside what is there. */
static void boxes_may_be_of_any_size(void **state)
{
    (void)state;
    for (uint32_t run = 0; run < (small() ? 4u : 24u); run++) {
        bb_random random = bb_random_make(SEED + 10, run);
        bb_scene *scene = make_extreme_scene(run, &random);
        bb_tree tree;
        make_random_tree(scene, 2 + run % 3, 1, &random, &tree);
        for (uint32_t n = 0; n < tree.info.node_count; n++)
            for (int k = 0; k < 3; k++) {
                const float size = ldexpf(FLT_MAX, -(int)(run / 2 * bb_random_below(&random, 20)));
                if (bb_random_below(&random, 4) < 3)
                    tree.nodes[n].lo[k] = fminf(tree.nodes[n].lo[k], -size);
                if (bb_random_below(&random, 4) < 3)
                    tree.nodes[n].hi[k] = fmaxf(tree.nodes[n].hi[k], size);
            }
        ASSERT_OK(bb_tree_upload(&tree, device, NULL));
        take_apart(scene, &tree, 1 + run % 3, run % 2 == 0, 3, true);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

/* A tree that is one leaf of any size: nodes that all have its box. */
static void a_large_leaf_is_divided(void **state)
{
    (void)state;
    for (uint32_t count = 1; count < (small() ? 12u : 200u); count += 1 + count / 8) {
        bb_random random = bb_random_make(SEED + 7, count);
        float v[9 * 200];
        for (uint32_t i = 0; i < 9 * count; i++)
            v[i] = (float)bb_random_range(&random, -100, 100);
        bb_scene *scene = make_scene(v, count, NULL, 0);
        ASSERT_OK(bb_scene_upload(scene, device));
        uint32_t *refs = malloc(count * sizeof *refs);
        bb_box box = nothing;
        for (uint32_t i = 0; i < count; i++) {
            refs[i] = i | (i + 1 == count ? BB_LAST_BIT : 0);
            join(&box, &scene->boxes[i]);
        }
        const bb_node root = make_node(box.lo, box.hi, BB_LEAF_BIT, BB_NONE);
        bb_tree tree;
        make_tree(&tree, &root, 1, refs, count, 0, 0);
        ASSERT_OK(bb_tree_upload(&tree, device, NULL));
        take_apart(scene, &tree, 1, false, 3, false);
        free(refs);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

/* Eight boxes, one in each octant around the middle: each stands where its octant says. */
static void children_stand_in_their_octants(void **state)
{
    (void)state;
    float v[72];
    bb_random random = bb_random_make(SEED + 8, 0);
    uint32_t octants[8];
    for (uint32_t i = 0; i < 8; i++)
        octants[i] = i;
    shuffle(octants, 8, &random);
    for (uint32_t i = 0; i < 72; i++)
        v[i] = ((octants[i / 9] >> i % 3 & 1) != 0 ? 3.0f : 1.0f) +
               (float)bb_random_range(&random, -0.5, 0.5);
    bb_scene *scene = make_scene(v, 8, NULL, 0);
    ASSERT_OK(bb_scene_upload(scene, device));
    bb_tree tree;
    make_random_tree(scene, 2, 1, &random, &tree);
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    compressed c = read_compressed(scene, &tree, 1, false);
    assert_int_equal(c.node_count, 1);
    for (uint32_t place = 0; place < 8; place++)
        assert_int_equal(
            octants[prim_of(&c, scene, c.nodes[0].prims + (c.nodes[0].meta[place] & 31u))], place);
    free_compressed(&c);
    bb_tree_release(&tree);
    free_scene(scene);
}

static void leaves_have_a_limit(void **state)
{
    (void)state;
    bb_spec spec;
    const bb_kernel *kernel;
    ASSERT_OK(bb_kernel_parse("cwbvh:leaf=3", &spec, &kernel));
    assert_int_equal(bb_kernel_parse("cwbvh:leaf=4", &spec, &kernel), BB_INVALID);
    assert_non_null(strstr(bb_message(), "leaf=3 at most"));
    assert_null(strchr(bb_message(), '\n'));
}

/* With a fence, by levels, with primitives for GPUs and for CPUs: one layout, bit for bit. */
static void all_forms_make_one_layout(void **state)
{
    (void)state;
    for (uint32_t run = 0; run < (small() ? 2u : 12u); run++) {
        compressed first = {0};
        for (int form = CPU_FORM; form < FORMS; form++) {
            bb_random random = bb_random_make(SEED + 9, run);
            device = devices[form];
            bb_scene *scene = make_extreme_scene(run, &random);
            bb_tree tree;
            make_random_tree(scene, 2 + run % 3, 1 + run % 7, &random, &tree);
            ASSERT_OK(bb_tree_upload(&tree, device, NULL));
            compressed c = read_compressed(scene, &tree, 1 + run % 3, run % 2 == 0);
            if (form == CPU_FORM)
                first = c;
            assert_int_equal(c.root, first.root);
            assert_int_equal(c.stack_need, first.stack_need);
            assert_int_equal(c.node_count, first.node_count);
            if ((c.root & BB_LEAF_BIT) == 0)
                assert_memory_equal(c.nodes, first.nodes, c.node_count * sizeof *c.nodes);
            assert_memory_equal(c.records, first.records,
                                c.record_count * c.words * sizeof *c.records);
            if (form != CPU_FORM)
                free_compressed(&c);
            bb_tree_release(&tree);
            free_scene(scene);
        }
        free_compressed(&first);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_hold_the_tree),
        cmocka_unit_test(boxes_may_be_of_any_size),
        cmocka_unit_test(a_large_leaf_is_divided),
        cmocka_unit_test(children_stand_in_their_octants),
    };
    const struct CMUnitTest of_all[] = {
        cmocka_unit_test(leaves_have_a_limit),
        cmocka_unit_test(all_forms_make_one_layout),
    };
    int failed = open_devices(NULL);
    if (first_form() == CPU_FORM && failed == 0)
        failed = cmocka_run_group_tests(of_all, NULL, NULL);
    RUN_ON_EACH_DEVICE(tests, failed)
    close_devices(NULL);
    return failed;
}
