/* Bonsai against a slow construction from its definition, in all forms; degenerate inputs; what is
 * refused. Seed: BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "tests/bonsai_reference.h"
#include "tests/box_inputs.h"
#include "tests/device_forms.h"
#include "tests/quality_inputs.h"

#include <stdio.h>
#include <string.h>

static bool small;

/* ---- the comparison ---- */

static void expect_counts(box_build *b, const bonsai_reference *r)
{
    char text[400];
    unsigned groups = 0, prims = 0, items = 0;
    ASSERT_OK(bb_instance_describe(&b->instance, &b->scene, text, sizeof text));
    assert_int_equal(sscanf(text, "%u mini-trees of %u primitives, a top tree over %u subtrees",
                            &groups, &prims, &items),
                     3);
    assert_int_equal(groups, r->groups);
    assert_int_equal(prims, r->ref_count);
    assert_int_equal(items, r->items);
}

/* Boxes as numbers: of a zero and its negative, the union may be either. */
static bool same_node(const bb_node *a, const bb_node *b)
{
    bool same = a->first == b->first && a->skip == b->skip;
    for (int k = 0; k < 3; k++)
        same = same && a->lo[k] == b->lo[k] && a->hi[k] == b->hi[k];
    return same;
}

/* Returns the tree's hash. */
static uint64_t compare(bb_device *device, const char *builder, const bb_box *boxes, uint32_t count,
                        const bonsai_reference *r, const char *what)
{
    box_build b;
    uint64_t hash;
    open_box_build(&b, device, builder, boxes, count, what);
    expect_counts(&b, r);
    bool same = b.preorder.info.depth == r->depth && b.preorder.info.node_count == r->node_count &&
                memcmp(b.preorder.refs, r->refs, count * sizeof(uint32_t)) == 0;
    for (uint32_t n = 0; same && n < r->node_count; n++)
        same = same_node(&b.preorder.nodes[n], &r->nodes[n]);
    if (!same)
        fail_msg("%s, %s, %u boxes, seed %llu: not the tree of the definition", builder, what,
                 count, (unsigned long long)seed);
    ASSERT_OK(bb_tree_hash(&b.instance.tree, &hash));
    close_box_build(&b);
    return hash;
}

/* The groups are subtrees of lbvh's tree, which its own test holds to its definition. */
static void compare_all(const bb_box *boxes, uint32_t count, const char *options,
                        const bonsai_choice *choice, const char *what)
{
    char builder[120];
    box_build radix;
    bonsai_reference r;
    uint64_t first = 0;
    const bool its_own_code = strstr(options, "code=") == NULL;
    open_box_build(&radix, devices[first_form()], its_own_code ? "lbvh:code=emc32-var" : "lbvh",
                   boxes, count, what);
    make_bonsai_reference(&r, &radix.preorder, choice);
    snprintf(builder, sizeof builder, "bonsai%s%s", options[0] != '\0' ? ":" : "", options);
    for (int form = first_form(); form < FORMS; form++) {
        uint64_t hash = compare(devices[form], builder, boxes, count, &r, what);
        first = form == first_form() ? hash : first;
        if (hash != first)
            fail_msg("%s, %s, %u boxes, seed %llu: two forms, two trees", builder, what, count,
                     (unsigned long long)seed);
    }
    free_bonsai_reference(&r);
    close_box_build(&radix);
}

/* ---- trees ---- */

typedef struct variant {
    const char *options;
    bonsai_choice choice;
} variant;

static const variant variants[] = {
    {"code=mc32,group=256,prune=0.1,weight=items", {256, 0.1, false}},
    {"code=mc32,group=7,prune=0.5,weight=prims", {7, 0.5, true}},
    {"code=mc32,group=2,prune=1000", {2, 1000, false}},
    {"code=mc32,group=64,prune=0.001,weight=prims", {64, 0.001, true}},
    {"code=mc32,group=512,prune=0.1,weight=items", {512, 0.1, false}},
    {"code=mc32,group=30,prune=0.3,weight=items", {30, 0.3, false}},
    {"", {256, 0.1, false}}, /* with its own code */
};
enum { VARIANTS = sizeof variants / sizeof variants[0] };

static void few_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 4, 5, 9, 33, 64};
    enum { COUNTS = sizeof counts / sizeof counts[0] };
    for (size_t k = 0; k < QUALITY_INPUTS; k++)
        for (size_t c = 0; c < COUNTS; c++) {
            if (small && (k % 6 != 0 || c != 2 + k / 3))
                continue;
            bb_box *boxes = make_boxes(quality_inputs, k, counts[c]);
            for (size_t v = 0; v < 3; v++)
                if (!small || v == k / 6 % 3)
                    compare_all(boxes, counts[c], variants[v].options, &variants[v].choice,
                                quality_inputs[k].name);
            free(boxes);
        }
}

/* Several chunks of keys in the CPU form; top trees that take two launches. */
static void many_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    for (size_t k = 0; k < QUALITY_INPUTS && !small; k++) {
        uint32_t count = k == 0 ? 9000 : k % 3 == 0 ? 3000 : 700;
        bb_box *boxes = make_boxes(quality_inputs, k, count);
        for (size_t v = 0; v < VARIANTS; v++)
            if (k == 0 || v == k % VARIANTS)
                compare_all(boxes, count, variants[v].options, &variants[v].choice,
                            quality_inputs[k].name);
        free(boxes);
    }
}

/* Whatever the boxes are: halves from BN_LEVELS on, in the mini-tree and in the top tree. */
static void no_input_makes_a_chain(void **state)
{
    (void)state;
    const uint32_t count = small ? 32 : 4096;
    for (size_t k = 0; k < QUALITY_INPUTS; k++) {
        if (small && k % 6 != 1)
            continue;
        box_build b;
        bb_box *boxes = make_boxes(quality_inputs, k, count);
        const char *what = quality_inputs[k].name;
        open_box_build(&b, devices[first_form()], "bonsai", boxes, count, what);
        bool same = strcmp(what, "same") == 0 || strcmp(what, "one point") == 0;
        if (b.preorder.info.depth > (same ? 13u : 2 * CHAIN_MOST + 20u))
            fail_msg("%s: depth %u", what, b.preorder.info.depth);
        close_box_build(&b);
        free(boxes);
    }
}

/* ---- what is said beforehand ---- */

static void what_does_not_fit_is_refused_beforehand(void **state)
{
    (void)state;
    const uint32_t count = small ? 30 : 1000;
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    expect_refusals_for_room(devices[first_form()], "bonsai", boxes, count, 100);
    free(boxes);
}

static void mini_trees_fit_into_local_memory(void **state)
{
    (void)state;
    bb_device *device = devices[first_form()];
    const uint64_t local = device->local_bytes;
    bb_box box;
    set_box(&box, (const double[]){0, 0, 0}, (const double[]){1, 1, 1});
    bb_scene scene = scene_of(&box, 1);
    bb_instance instance = {0};
    device->local_bytes = 48 * 1024;
    bb_status status = bb_instance_create(device, "bonsai:group=1024", &scene, 1, &instance);
    device->local_bytes = local;
    assert_int_equal(status, BB_REFUSED);
    assert_non_null(strstr(bb_message(), "smaller `group`"));
    bb_instance_destroy(&instance);
    device->local_bytes = 48 * 1024;
    status = bb_instance_create(device, "bonsai", &scene, 1, &instance);
    device->local_bytes = local;
    assert_int_equal(status, BB_OK);
    bb_instance_destroy(&instance);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "bonsai:group=1",    "bonsai:group=1025", "bonsai:group=few",  "bonsai:prune=0",
        "bonsai:prune=1001", "bonsai:prune=much", "bonsai:weight=one", "bonsai:code=mc16",
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
        cmocka_unit_test(no_input_makes_a_chain),
        cmocka_unit_test(what_does_not_fit_is_refused_beforehand),
        cmocka_unit_test(mini_trees_fit_into_local_memory),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
