/* ATRBVH against its definition, treelet by treelet, in all forms, bit for bit; a whole tree as one
 * treelet against agglomeration of all pairs; degenerate inputs; what is refused. Seed:
 * BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "tests/quality_inputs.h"
#include "tests/treelet_reference.h"

static bool small;

/* ---- the definition: distances anew for each merge ---- */

static item *choose_nearest(treelet_reference *r, item *const *leaves, uint32_t count, float *area)
{
    item *places[TREELET_MOST];
    memcpy(places, leaves, count * sizeof *places);
    *area = 0;
    for (uint32_t left = count; left > 1; left--) {
        uint32_t near_i = 0, near_j = 0;
        float least = INFINITY;
        for (uint32_t i = 1; i < count; i++)
            for (uint32_t j = 0; j < i && places[i] != NULL; j++) {
                if (places[j] == NULL)
                    continue;
                bb_box box = join_boxes(&places[i]->box, &places[j]->box);
                if (area_in(r, &box) < least) {
                    least = area_in(r, &box);
                    near_i = i;
                    near_j = j;
                }
            }
        if (left > 2)
            *area += least;
        places[near_j] = join_items(r, places[near_j], places[near_i]);
        places[near_i] = NULL;
    }
    return places[0];
}

static const treelet_reference usual = {
    .choose = choose_nearest, .treelet = 9, .gamma = 9, .rounds = 2};

static void few_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 8, 9, 10, 64};
    enum { COUNTS = sizeof counts / sizeof counts[0] };
    for (size_t k = 0; k < QUALITY_INPUTS; k++)
        for (size_t c = 0; c < COUNTS; c++) {
            if (small && (k > 1 || c != 3 + 2 * k))
                continue;
            bb_box *boxes = make_boxes(quality_inputs, k, counts[c]);
            compare_with(usual, "lbvh:code=mc64", "atrbvh", boxes, counts[c],
                         quality_inputs[k].name, FORMS);
            free(boxes);
        }
}

/* More than one chunk and work-item to a level. */
static void many_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    for (size_t k = 0; k < QUALITY_INPUTS && !small; k += 2) {
        bb_box *boxes = make_boxes(quality_inputs, k, 5000);
        compare_with(usual, k % 4 == 0 ? "lbvh" : "emc", "atrbvh", boxes, 5000,
                     quality_inputs[k].name, FORMS);
        free(boxes);
    }
}

/* Several references in a leaf; deep trees; the nodes in any order. */
static void any_binary_tree_will_do(void **state)
{
    (void)state;
    static const char *const builders[] = {"sah:leaf=4", "sah", "hploc", "lbvh+rotate",
                                           "lbvh+trbvh"};
    const uint32_t count = small ? 30 : 2000;
    for (size_t b = 0; b < (small ? 1 : 5); b++)
        for (size_t k = 0; k < 7; k += 6) {
            bb_box *boxes = make_boxes(quality_inputs, k, count);
            compare_with(usual, builders[b], "atrbvh", boxes, count, quality_inputs[k].name, FORMS);
            free(boxes);
        }
}

static void options_mean_what_they_say(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t treelet, gamma, rounds;
    } variants[] = {
        {"atrbvh:treelet=3,rounds=5", 3, 3, 5},
        {"atrbvh:treelet=4,gamma=9", 4, 9, 2},
        {"atrbvh:treelet=13,rounds=3", 13, 13, 3},
        {"atrbvh:treelet=20,rounds=1", 20, 20, 1},
    };
    const uint32_t count = small ? 25 : 1500;
    for (size_t v = 0; v < (small ? 1 : sizeof variants / sizeof variants[0]); v++) {
        treelet_reference r = {.choose = choose_nearest,
                               .treelet = variants[v].treelet,
                               .gamma = variants[v].gamma,
                               .rounds = variants[v].rounds};
        bb_box *boxes = make_boxes(quality_inputs, 0, count);
        compare_with(r, "lbvh", variants[v].text, boxes, count, "mixed", FORMS);
        free(boxes);
    }
}

/* More leaves than all have: the treelet never gets as large, and the tree stays. */
static void a_small_tree_stays_as_it_is(void **state)
{
    (void)state;
    bb_box *boxes = make_boxes(quality_inputs, 0, 50);
    treelet_reference r = usual;
    r.rounds = 0;
    compare_with(r, "lbvh", "atrbvh:gamma=51", boxes, 50, "mixed", FORMS);
    free(boxes);
}

/* Far more levels than are launched at a time. */
static void deep_trees_end(void **state)
{
    (void)state;
    const uint32_t count = small ? 40 : 20000;
    bb_box *boxes = make_boxes(quality_inputs, 4, count);
    for (int form = first_form(); form < FORMS; form++) {
        box_build b;
        open_box_build(&b, devices[form], "sah+atrbvh:rounds=3", boxes, count, "nest");
        assert_int_equal(b.preorder.info.leaf_count, count);
        close_box_build(&b);
    }
    free(boxes);
}

static void bad_options_and_wide_trees_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"atrbvh:rounds=0", "atrbvh:treelet=2", "atrbvh:treelet=21",
                                      "atrbvh:gamma=8", "atrbvh:gamma=x"};
    bb_box *boxes = make_boxes(quality_inputs, 0, 100);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[64];
        snprintf(text, sizeof text, "lbvh+%s", bad[i]);
        expect_refusal(text, boxes, 100, BB_INVALID, "atrbvh");
    }
    expect_refusal("lobvh+atrbvh", boxes, 100, BB_UNSUPPORTED, "binary trees");
    free(boxes);
}

int main(void)
{
    seed = seed_or(seed);
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(few_boxes_make_the_tree_of_the_definition),
        cmocka_unit_test(many_boxes_make_the_tree_of_the_definition),
        cmocka_unit_test(any_binary_tree_will_do),
        cmocka_unit_test(options_mean_what_they_say),
        cmocka_unit_test(a_small_tree_stays_as_it_is),
        cmocka_unit_test(deep_trees_end),
        cmocka_unit_test(bad_options_and_wide_trees_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
