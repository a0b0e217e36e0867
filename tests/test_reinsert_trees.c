/* Trees that reinsertion makes: one in all forms, never a worse one; leaves, degenerate inputs and
 * chains; what is refused. Search and moves by themselves: test_reinsert.c. Seed:
 * BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (oclgrind). */
#include "framework/builder/phases.h"
#include "framework/builder/registry.h"
#include "tests/device_forms.h"
#include "tests/quality_inputs.h"
#include "tests/tree_fixture.h"

static bool small;

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
    static const uint32_t counts[] = {1, 2, 3, 4, 33, 600}, few[] = {3, 20};
    const uint32_t *sizes = small ? few : counts;
    for (size_t k = 0; k < (small ? 1 : QUALITY_INPUTS); k++)
        for (size_t c = 0; c < (small ? 2 : 6); c++) {
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
    const uint32_t count = small ? 20 : 4000;
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i += small ? 3 : 1)
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
    ASSERT_OK(bb_scene_load(small ? "random:n=100" : "interior:n=3000", &scene));
    ASSERT_OK(bb_scene_upload(scene, on));
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i += small ? 2 : 1) {
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
