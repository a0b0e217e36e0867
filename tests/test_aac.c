/* AAC against a slow construction from its definition, in all forms, over several codes; against
 * agglomeration of all pairs; degenerate inputs. Bit for bit. Seed: BVHBENCH_TEST_SEED.
 * BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "builders/aac/aac_goal.h"
#include "tests/aac_reference.h"
#include "tests/box_inputs.h"
#include "tests/device_forms.h"
#include "tests/quality_inputs.h"

#include <stdio.h>
#include <string.h>

static bool small;

/* ---- the comparison ---- */

typedef struct variant {
    const char *options;
    uint32_t delta;
    double epsilon;
} variant;

static const variant hq = {"variant=hq", 20, 0.1}, fast = {"variant=fast", 4, 0.2};

static void compare(bb_device *device, const char *builder, const bb_box *boxes, uint32_t count,
                    const aac_reference *r, const char *what)
{
    box_build b;
    open_box_build(&b, device, builder, boxes, count, what);
    if (b.preorder.info.depth != r->depth || b.preorder.info.node_count != 2 * count - 1 ||
        memcmp(b.preorder.nodes, r->nodes, r->node_count * sizeof(bb_node)) != 0 ||
        memcmp(b.preorder.refs, r->refs, count * sizeof(uint32_t)) != 0)
        fail_msg("%s, %s, %u boxes, seed %llu: not the tree of the definition", builder, what,
                 count, (unsigned long long)seed);
    close_box_build(&b);
}

/* The radix tree of the definition is emc's, which its own tests hold to its definition. */
static void compare_all(const bb_box *boxes, uint32_t count, const char *code, const variant *v,
                        const char *what)
{
    char builder[120];
    box_build radix;
    aac_reference r;
    snprintf(builder, sizeof builder, "emc:code=%s", code);
    open_box_build(&radix, devices[first_form()], builder, boxes, count, what);
    make_aac_reference(&r, &radix.preorder, v->delta, v->epsilon);
    snprintf(builder, sizeof builder, "aac:code=%s,%s", code, v->options);
    for (int form = first_form(); form < FORMS; form++)
        compare(devices[form], builder, boxes, count, &r, what);
    free_aac_reference(&r);
    close_box_build(&radix);
}

/* ---- trees ---- */

static void few_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 4, 5, 19, 20, 21, 41, 64};
    enum { COUNTS = sizeof counts / sizeof counts[0] };
    for (size_t k = 0; k < QUALITY_INPUTS; k++)
        for (size_t c = 0; c < COUNTS; c++) {
            if (small && (k % 3 != 0 || c != 2 + k / 3))
                continue;
            bb_box *boxes = make_boxes(quality_inputs, k, counts[c]);
            if (!small || k % 2 == 0)
                compare_all(boxes, counts[c], "mc32", &hq, quality_inputs[k].name);
            if (!small || k % 2 == 1)
                compare_all(boxes, counts[c], "mc32", &fast, quality_inputs[k].name);
            free(boxes);
        }
}

/* More than one work-group, and on GPUs large nodes. */
static void many_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {600, 1500, 4000};
    for (size_t k = 0; k < QUALITY_INPUTS && !small; k++) {
        uint32_t count = counts[k % 3];
        bb_box *boxes = make_boxes(quality_inputs, k, count);
        compare_all(boxes, count, "mc32", k % 2 == 0 ? &hq : &fast, quality_inputs[k].name);
        free(boxes);
    }
}

static void any_code_will_do(void **state)
{
    (void)state;
    static const char *const codes[] = {"mc64", "emc64-var"};
    const uint32_t count = small ? 30 : 1200;
    for (size_t k = 0; k < 2; k++) {
        if (small && k > 0)
            continue;
        bb_box *boxes = make_boxes(quality_inputs, 0, count);
        compare_all(boxes, count, codes[k], k % 2 == 0 ? &hq : &fast, codes[k]);
        free(boxes);
    }
}

static void options_mean_what_they_say(void **state)
{
    (void)state;
    static const variant variants[] = {
        {"delta=2,epsilon=0.5", 2, 0.5},          {"delta=2", 2, 0.1},
        {"delta=7,epsilon=0,variant=fast", 7, 0}, {"epsilon=0.3", 20, 0.3},
        {"delta=256,epsilon=0.05", 256, 0.05},
    };
    const uint32_t count = small ? 25 : 900;
    for (size_t v = 0; v < sizeof variants / sizeof variants[0]; v++) {
        if (small && v > 0)
            continue;
        bb_box *boxes = make_boxes(quality_inputs, v, count);
        compare_all(boxes, count, "mc32", &variants[v], variants[v].options);
        free(boxes);
    }
}

/* ---- with delta above the number of boxes: plain agglomeration ---- */

typedef struct lump {
    bb_box box;
    uint64_t members;
} lump;

static float union_area(const bb_box *a, const bb_box *b)
{
    float side[3];
    for (int k = 0; k < 3; k++)
        side[k] = fmaxf(a->hi[k], b->hi[k]) - fminf(a->lo[k], b->lo[k]);
    return (side[0] * side[1] + side[1] * side[2]) + side[2] * side[0];
}

static int compare_members(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* What nodes hold when of all pairs the closest is joined, until one is left; sorted. */
static void agglomerate(const bb_box *boxes, uint32_t count, uint64_t *inner)
{
    lump lumps[64];
    for (uint32_t i = 0; i < count; i++)
        lumps[i] = (lump){boxes[i], UINT64_C(1) << i};
    uint32_t found = 0;
    for (uint32_t left = count; left > 1; left--) {
        uint32_t a = 0, b = 1;
        for (uint32_t i = 0; i < left; i++)
            for (uint32_t j = i + 1; j < left; j++)
                if (union_area(&lumps[i].box, &lumps[j].box) <
                    union_area(&lumps[a].box, &lumps[b].box)) {
                    a = i;
                    b = j;
                }
        for (int k = 0; k < 3; k++) {
            lumps[a].box.lo[k] = fminf(lumps[a].box.lo[k], lumps[b].box.lo[k]);
            lumps[a].box.hi[k] = fmaxf(lumps[a].box.hi[k], lumps[b].box.hi[k]);
        }
        lumps[a].members |= lumps[b].members;
        inner[found++] = lumps[a].members;
        lumps[b] = lumps[left - 1];
    }
    qsort(inner, found, sizeof *inner, compare_members);
}

static uint64_t members_of(const bb_tree *tree, uint32_t n, uint64_t *inner, uint32_t *found)
{
    const bb_node *node = &tree->nodes[n];
    if (bb_node_is_leaf(node))
        return UINT64_C(1) << (tree->refs[node->first & ~BB_LEAF_BIT] & ~BB_LAST_BIT);
    uint64_t members = members_of(tree, node->first, inner, found);
    members |= members_of(tree, tree->nodes[node->first].skip, inner, found);
    inner[(*found)++] = members;
    return members;
}

static void a_large_delta_agglomerates_all_pairs(void **state)
{
    (void)state;
    const uint32_t count = small ? 20 : 64;
    for (uint32_t n = 0; n < (small ? 1 : 5); n++) {
        bb_random random = bb_random_make(seed, 77 + n);
        bb_box boxes[64];
        for (uint32_t i = 0; i < count; i++)
            fill_mixed(&random, i, count, &boxes[i]);
        uint64_t right[64], inner[64];
        uint32_t found = 0;
        box_build b;
        agglomerate(boxes, count, right);
        open_box_build(&b, devices[first_form()], "aac:delta=65", boxes, count, "all pairs");
        members_of(&b.preorder, 0, inner, &found);
        qsort(inner, found, sizeof *inner, compare_members);
        if (found != count - 1 || memcmp(inner, right, found * sizeof *inner) != 0)
            fail_msg("round %u, seed %llu: not what joining the closest pairs makes", n,
                     (unsigned long long)seed);
        close_box_build(&b);
    }
}

/* ---- how many clusters a node keeps ---- */

static void expect_goals(double epsilon, uint32_t delta)
{
    const aac_law law = {delta, epsilon};
    const double c = 0.5 * pow(delta, 0.5 + epsilon);
    uint32_t before = 1;
    for (uint32_t size = 1; size < 100000000; size += 1 + size / 50) {
        double right = c * pow(size, 0.5 - epsilon);
        uint32_t goal = aac_goal(&law, size), least;
        assert_true(goal >= before);
        before = goal;
        if (fabs((double)goal - right) > 0.500001 && !(goal == 1 && right < 1))
            fail_msg("f(%u) = %u, not %g (delta %u, epsilon %g)", size, goal, right, delta,
                     epsilon);
        least = aac_goal_size(&law, goal, size);
        assert_true(least >= 1 && least <= size && aac_goal(&law, least) == goal);
        assert_true(least == 1 || aac_goal(&law, least - 1) < goal);
        assert_int_equal(aac_goal_size(&law, goal + 1, size), 0);
    }
}

static void nodes_keep_as_many_as_the_paper_says(void **state)
{
    (void)state;
    static const double epsilons[] = {0, 0.05, 0.1, 0.2, 0.3, 0.5};
    for (size_t i = 0; i < sizeof epsilons / sizeof epsilons[0]; i++) {
        expect_goals(epsilons[i], 2);
        expect_goals(epsilons[i], 4);
        expect_goals(epsilons[i], 20);
        expect_goals(epsilons[i], 256);
    }
    const aac_law laws[] = {{20, 0.1}, {4, 0.2}};
    assert_int_equal(aac_goal(&laws[0], 20), 10);
    assert_int_equal(aac_goal(&laws[0], 1000000), 758);
    assert_int_equal(aac_goal(&laws[1], 4), 2);
    assert_int_equal(aac_goal(&laws[1], 1000000), 83);
}

/* ---- inputs that are hard on builders ---- */

/* Equal codes are halved by index, so that the radix tree stays shallow; that of the clusters may
 * be deep, but all ends. */
static void many_equal_boxes_end(void **state)
{
    (void)state;
    const uint32_t count = small ? 50 : 100000;
    bb_box *boxes = malloc(count * sizeof *boxes);
    for (uint32_t i = 0; i < count; i++)
        set_box(&boxes[i], (const double[]){1, 2, 3}, (const double[]){0.5, 0.25, 1});
    for (int form = first_form(); form < FORMS; form++) {
        box_build b;
        open_box_build(&b, devices[form], "aac:variant=fast", boxes, count, "equal boxes");
        assert_int_equal(b.preorder.info.leaf_count, count);
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
    expect_refusals_for_room(devices[first_form()], "aac", boxes, count, 200);
    free(boxes);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "aac:delta=1",      "aac:delta=257",    "aac:delta=few",
        "aac:epsilon=-0.1", "aac:epsilon=0.51", "aac:epsilon=nan",
        "aac:variant=lq",   "aac:code=mc16",    "aac:radius=4",
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
        cmocka_unit_test(any_code_will_do),
        cmocka_unit_test(options_mean_what_they_say),
        cmocka_unit_test(a_large_delta_agglomerates_all_pairs),
        cmocka_unit_test(nodes_keep_as_many_as_the_paper_says),
        cmocka_unit_test(many_equal_boxes_end),
        cmocka_unit_test(what_does_not_fit_is_refused_beforehand),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
