/* What rotate promises: cheaper trees of the same leaves, whatever the builder; chains. */
#include "framework/builder/phases.h"
#include "framework/builder/registry.h"
#include "tests/pipeline_fixture.h"

static void rotations_never_raise_the_cost(void **state)
{
    (void)state;
    static const char *const scenes[] = {"single",
                                         "cube",
                                         "interior:n=3000",
                                         "spheres:n=2000",
                                         "hairball:n=1000",
                                         "awkward:kind=flat,n=1000",
                                         "awkward:kind=axis,n=1000",
                                         "awkward:kind=duplicates,n=1000",
                                         "awkward:kind=zeros,n=1000"};
    static const char *const builders[] = {
        "lbvh", "sah", "sah:leaf=4", "embree:quality=high", "null", "presplit:saves=-1+lbvh"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
            char text[128];
            built before, after, other;
            build(scene, builders[i], &before);
            snprintf(text, sizeof text, "%s+rotate:passes=100", builders[i]);
            build(scene, text, &after);
            snprintf(text, sizeof text, "%s+rotate:passes=100,order=random", builders[i]);
            build(scene, text, &other);
            const bb_tree_info *a = &before.instance.tree.info, *b = &after.instance.tree.info;
            if (!(after.sah <= before.sah * (1 + 1e-12) || isnan(before.sah)) ||
                !(other.sah <= before.sah * (1 + 1e-12) || isnan(before.sah)))
                fail_msg("%s of %s: SAH %.17g, was %.17g", text, scenes[s], after.sah, before.sah);
            assert_int_equal(a->leaf_count, b->leaf_count);
            assert_int_equal(a->ref_count, b->ref_count);
            assert_int_equal(before.instance.tree.duplicated, after.instance.tree.duplicated);
            bb_instance_destroy(&before.instance);
            bb_instance_destroy(&after.instance);
            bb_instance_destroy(&other.instance);
        }
        bb_scene_free(scene);
    }
}

/* It does something: a tree that is bad on purpose becomes better, and another seed's another
 * one. */
static void rotations_lower_the_cost(void **state)
{
    (void)state;
    bb_scene *scene = load("interior:n=3000");
    built before, after, other;
    build(scene, "lbvh", &before);
    build(scene, "lbvh+rotate", &after);
    build(scene, "lbvh+rotate:order=random", &other);
    assert_true(after.sah < 0.95 * before.sah);
    bb_instance reseeded;
    uint64_t hash;
    ASSERT_OK(bb_instance_create(device, "lbvh+rotate:order=random", scene, SEED + 1, &reseeded));
    ASSERT_OK(bb_instance_build(&reseeded, scene, false, NULL));
    ASSERT_OK(bb_tree_hash(&reseeded.tree, &hash));
    assert_true(hash != other.hash);
    char text[512];
    ASSERT_OK(bb_instance_describe(&after.instance, scene, text, sizeof text));
    assert_non_null(strstr(text, "lbvh: code of"));
    assert_non_null(strstr(text, "; rotate: "));
    bb_instance_destroy(&before.instance);
    bb_instance_destroy(&after.instance);
    bb_instance_destroy(&other.instance);
    bb_instance_destroy(&reseeded);
    bb_scene_free(scene);
}

/* A chain of a million levels, and the wide nodes that it does not take, straight into the hook. */
static void rotate_takes_chains_and_refuses_wide_nodes(void **state)
{
    (void)state;
    enum { LEVELS = 1000000 };
    const bb_builder *rotate = bb_builder_find("rotate");
    bb_spec spec;
    ASSERT_OK(bb_spec_parse("rotate:passes=1", &spec));
    bb_account account = {0};
    bb_builder_context context = {
        .device = device, .account = &account, .spec = &spec, .options = rotate->options};
    bb_scene *scene = make_box_scene(LEVELS + 1);
    void *self = NULL;
    bb_tree chain, out;
    bb_tree_init(&chain, NULL);
    bb_tree_init(&out, &account);
    ASSERT_OK(bb_tree_reserve(&chain, NULL, BB_ON_HOST, 2 * LEVELS + 1, LEVELS + 1));
    for (uint32_t i = 0; i <= LEVELS; i++) {
        float at = (float)i;
        bb_box box = {.lo = {at, 0, 0}, .hi = {at + 0.5f, 1, 1}};
        scene->boxes[i] = box;
        bb_node leaf = make_node(box.lo, box.hi, BB_LEAF_BIT | i, 2 * i + 2);
        const float far[3] = {LEVELS + 0.5f, 1, 1};
        chain.refs[i] = i | BB_LAST_BIT;
        chain.nodes[2 * i] = make_node(box.lo, far, 2 * i + 1, BB_NONE);
        if (i == LEVELS)
            chain.nodes[2 * i].first = BB_LEAF_BIT | i;
        else
            chain.nodes[2 * i + 1] = leaf;
    }
    chain.info = (bb_tree_info){0, 2 * LEVELS + 1, LEVELS + 1, LEVELS + 1, 2, LEVELS};
    bb_phases phases = {.current = -1};
    ASSERT_OK(bb_tree_check(&chain, scene));
    ASSERT_OK(rotate->create(&context, &self));
    ASSERT_OK(rotate->build(self, scene, &chain, &out, &phases));
    ASSERT_OK(bb_tree_check(&out, scene));
    assert_true(bb_tree_sah(&out) < bb_tree_sah(&chain));
    chain.info.arity = 3;
    assert_int_equal(rotate->build(self, scene, &chain, &out, &phases), BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "binary trees"));
    rotate->destroy(self);
    bb_tree_release(&chain);
    bb_tree_release(&out);
    assert_int_equal(account.bytes, 0);
    free_scene(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotations_never_raise_the_cost),
        cmocka_unit_test(rotations_lower_the_cost),
        cmocka_unit_test(rotate_takes_chains_and_refuses_wide_nodes),
    };
    return cmocka_run_group_tests_name("rotate", tests, open_device, close_device);
}
