/* HLBVH against a slow construction from its definition, in all forms; against the LBVH where it is
 * one; degenerate inputs. Bit for bit. Seed: BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the
 * inputs small (for oclgrind). */
#include "tests/box_inputs.h"
#include "tests/decision_fixture.h"
#include "tests/device_forms.h"
#include "tests/hlbvh_reference.h"
#include "tests/quality_inputs.h"

#include <stdio.h>
#include <string.h>

static bool small;

/* ---- the comparison ---- */

static void expect_clusters(box_build *b, uint32_t clusters)
{
    char text[400];
    unsigned said = 0;
    ASSERT_OK(bb_instance_describe(&b->instance, &b->scene, text, sizeof text));
    assert_int_equal(sscanf(text, "%u clusters", &said), 1);
    assert_int_equal(said, clusters);
    assert_int_equal(clusters == 1, strstr(text, "this is the LBVH") != NULL);
}

static void compare(bb_device *device, const char *builder, const bb_box *boxes, uint32_t count,
                    const hlbvh_reference *r, const char *what)
{
    box_build b;
    open_box_build(&b, device, builder, boxes, count, what);
    expect_clusters(&b, r->clusters);
    if (b.preorder.info.depth != r->depth || b.preorder.info.node_count != 2 * count - 1 ||
        memcmp(b.preorder.nodes, r->nodes, r->node_count * sizeof(bb_node)) != 0 ||
        memcmp(b.preorder.refs, r->refs, count * sizeof(uint32_t)) != 0)
        fail_msg("%s, %s, %u boxes, seed %llu: not the tree of the definition", builder, what,
                 count, (unsigned long long)seed);
    close_box_build(&b);
}

/* The radix tree of the definition is lbvh's, which its own test holds to its definition. */
static void compare_all(const bb_box *boxes, uint32_t count, const char *options,
                        const hlbvh_choice *choice, const char *what)
{
    char builder[120];
    box_build radix;
    hlbvh_reference r;
    open_box_build(&radix, devices[first_form()], "lbvh", boxes, count, what);
    make_hlbvh_reference(&r, &radix.preorder, choice);
    snprintf(builder, sizeof builder, "hlbvh:%s", options);
    for (int form = first_form(); form < FORMS; form++)
        compare(devices[form], builder, boxes, count, &r, what);
    free_hlbvh_reference(&r);
    close_box_build(&radix);
}

/* ---- trees ---- */

typedef struct variant {
    const char *options;
    hlbvh_choice choice;
} variant;

static const variant variants[] = {
    {"bins=32", {15, 8, 32, false}}, /* the defaults */
    {"top-bits=auto", {AUTO_BITS, 8, 32, false}},
    {"top-bits=all", {64, 8, 32, false}},
    {"top-bits=auto,each=2", {AUTO_BITS, 2, 32, false}},
    {"top-bits=12,weight=prims", {12, 8, 32, true}},
    {"top-bits=9,weight=prims,bins=5", {9, 8, 5, true}},
    {"top-bits=all,bins=2", {64, 8, 2, false}},
    {"top-bits=auto,each=1000000", {AUTO_BITS, 1000000, 32, false}},
};
enum { VARIANTS = sizeof variants / sizeof variants[0] };

static void few_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 4, 5, 9, 33, 64};
    enum { COUNTS = sizeof counts / sizeof counts[0] };
    for (size_t k = 0; k < QUALITY_INPUTS; k++)
        for (size_t c = 0; c < COUNTS; c++) {
            if (small && (k % 3 != 0 || c != 2 + k / 3))
                continue;
            bb_box *boxes = make_boxes(quality_inputs, k, counts[c]);
            for (size_t v = 0; v < 3; v++)
                if (!small || v == k / 3 % 3)
                    compare_all(boxes, counts[c], variants[v].options, &variants[v].choice,
                                quality_inputs[k].name);
            free(boxes);
        }
}

/* Enough clusters for tasks that many work-items split, and for several chunks in the CPU form;
 * under oclgrind for a chunk of several groups of them in the form for GPUs. */
static void many_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    for (size_t k = 0; k < QUALITY_INPUTS; k++) {
        uint32_t count = k == 0 ? 6000 : k % 3 == 0 ? 3000 : 700;
        if (small && (k > 0 || first_form() != LEVELS_FORM))
            break;
        if (small)
            count = 130;
        bb_box *boxes = make_boxes(quality_inputs, k, count);
        for (size_t v = 0; v < VARIANTS; v++)
            if (small ? v == 2 : k == 0 || v == 1 || v == k % VARIANTS)
                compare_all(boxes, count, variants[v].options, &variants[v].choice,
                            quality_inputs[k].name);
        free(boxes);
    }
}

/* ---- where it is another's tree ---- */

static uint64_t hash_of_build(bb_device *device, const char *builder, const bb_box *boxes,
                              uint32_t count)
{
    box_build b;
    uint64_t hash;
    open_box_build(&b, device, builder, boxes, count, "hash");
    ASSERT_OK(bb_tree_hash(&b.instance.tree, &hash));
    close_box_build(&b);
    return hash;
}

static void expect_equal(const char *one, const char *other, const bb_box *boxes, uint32_t count)
{
    for (int form = first_form(); form < FORMS; form++)
        if (hash_of_build(devices[form], one, boxes, count) !=
            hash_of_build(devices[first_form()], other, boxes, count))
            fail_msg("%s and %s, %u boxes, seed %llu: two trees", one, other, count,
                     (unsigned long long)seed);
}

/* Without top bits it is the radix tree of its code; with clusters of one primitive each, the two
 * weights are one. Any code will do. */
static void the_limits_are_known_trees(void **state)
{
    (void)state;
    const uint32_t count = small ? 60 : 3000;
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    expect_equal("hlbvh:top-bits=0", "lbvh", boxes, count);
    if (!small) {
        expect_equal("hlbvh:code=emc64-var,top-bits=0", "emc:code=emc64-var", boxes, count);
        expect_equal("hlbvh:code=mc64,top-bits=all,weight=prims", "hlbvh:code=mc64,top-bits=all",
                     boxes, count);
    }
    free(boxes);
}

/* Which tasks are small enough for one work-item depends on the cores, no node does. */
static void any_number_of_cores_makes_the_same_tree(void **state)
{
    (void)state;
    static const uint32_t cores[] = {1, 3, 64, 1000};
    const uint32_t count = small ? 60 : 20000;
    const char *builder = "hlbvh:code=emc64-var,top-bits=auto,each=3";
    bb_device *device = devices[first_form()];
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    const uint32_t own = device->compute_units;
    const uint64_t hash = hash_of_build(device, builder, boxes, count);
    for (size_t i = 0; i < sizeof cores / sizeof cores[0]; i++) {
        device->compute_units = cores[i];
        const uint64_t other = hash_of_build(device, builder, boxes, count);
        device->compute_units = own;
        if (other != hash)
            fail_msg("%u cores, %u boxes, seed %llu: another tree", cores[i], count,
                     (unsigned long long)seed);
    }
    free(boxes);
}

static void a_decision_names_who_made_it(void **state)
{
    (void)state;
    static const struct {
        const char *builder;
        bb_decider by;
    } cases[] = {
        {"hlbvh", BB_BY_DEFAULT},
        {"hlbvh:top-bits=15", BB_GIVEN},
        {"hlbvh:top-bits=all", BB_GIVEN},
        {"hlbvh:top-bits=auto,each=3", BB_BY_SCENE},
    };
    bb_box *boxes = make_boxes(quality_inputs, 0, 20);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        box_build b;
        bb_decisions decisions = {0};
        open_box_build(&b, devices[first_form()], cases[i].builder, boxes, 20, "decisions");
        ASSERT_OK(bb_instance_decisions(&b.instance, &b.scene, &decisions));
        const bb_decision *decision = find_decision(&decisions, "top bits");
        assert_non_null(decision);
        assert_int_equal(decision->by, cases[i].by);
        close_box_build(&b);
    }
    free(boxes);
}

/* ---- what is said beforehand ---- */

static void what_does_not_fit_is_refused_beforehand(void **state)
{
    (void)state;
    const uint32_t count = small ? 30 : 1000;
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    expect_refusals_for_room(devices[first_form()], "hlbvh:top-bits=auto,each=1", boxes, count,
                             100);
    free(boxes);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "hlbvh:top-bits=65",
        "hlbvh:top-bits=some",
        "hlbvh:top-bits=auto,each=0",
        "hlbvh:top-bits=auto,each=1000001",
        "hlbvh:each=8",
        "hlbvh:top-bits=15,each=8",
        "hlbvh:bins=1",
        "hlbvh:bins=65",
        "hlbvh:bins=few",
        "hlbvh:weight=area",
        "hlbvh:code=mc16",
    };
    bb_box box;
    set_box(&box, (const double[]){0, 0, 0}, (const double[]){1, 1, 1});
    bb_scene scene = scene_of(&box, 1);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        bb_instance instance = {0};
        bb_status status = bb_instance_create(devices[first_form()], bad[i], &scene, 1, &instance);
        if (status != BB_INVALID)
            fail_msg("%s: status %d", bad[i], (int)status);
        bb_instance_destroy(&instance);
    }
}

int main(void)
{
    seed = seed_or(seed);
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(few_boxes_make_the_tree_of_the_definition),
        cmocka_unit_test(many_boxes_make_the_tree_of_the_definition),
        cmocka_unit_test(the_limits_are_known_trees),
        cmocka_unit_test(any_number_of_cores_makes_the_same_tree),
        cmocka_unit_test(a_decision_names_who_made_it),
        cmocka_unit_test(what_does_not_fit_is_refused_beforehand),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
