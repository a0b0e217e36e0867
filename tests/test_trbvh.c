/* TRBVH against its definition, treelet by treelet, in all forms, bit for bit; against all 10,395
 * trees of seven leaves; costs that never rise; degenerate inputs and deep trees; what is refused.
 * Seed: BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "tests/quality_inputs.h"
#include "tests/treelet_reference.h"

static bool small;

/* ---- the definition, by recursion without a table ---- */

static bb_box box_of(item *const *leaves, uint32_t set)
{
    bb_box box = leaves[__builtin_ctz(set)]->box;
    for (uint32_t rest = set & (set - 1); rest != 0; rest &= rest - 1)
        box = join_boxes(&box, &leaves[__builtin_ctz(rest)]->box);
    return box;
}

/* The least sum of areas of inner nodes of trees over `set`, but the root's; *part is the first of
 * several equal ones: a side of the root without the first leaf. */
static float least_below(treelet_reference *r, item *const *leaves, uint32_t set, uint32_t *part);

static float least_area(treelet_reference *r, item *const *leaves, uint32_t set)
{
    uint32_t part;
    if ((set & (set - 1)) == 0)
        return 0;
    bb_box box = box_of(leaves, set);
    return area_in(r, &box) + least_below(r, leaves, set, &part);
}

static float least_below(treelet_reference *r, item *const *leaves, uint32_t set, uint32_t *part)
{
    float least = INFINITY;
    *part = 0;
    for (uint32_t p = 1; p < set; p++) {
        if ((p & ~set) != 0 || (p & set & -set) != 0)
            continue;
        float sum = least_area(r, leaves, p) + least_area(r, leaves, set ^ p);
        if (sum < least) {
            least = sum;
            *part = p;
        }
    }
    return least;
}

static item *best_item(treelet_reference *r, item *const *leaves, uint32_t set)
{
    uint32_t part;
    if ((set & (set - 1)) == 0)
        return leaves[__builtin_ctz(set)];
    least_below(r, leaves, set, &part);
    item *left = best_item(r, leaves, part);
    return join_items(r, left, best_item(r, leaves, set ^ part));
}

static item *choose_best(treelet_reference *r, item *const *leaves, uint32_t count, float *area)
{
    uint32_t part, all = (1u << count) - 1;
    *area = least_below(r, leaves, all, &part);
    return best_item(r, leaves, all);
}

static const treelet_reference usual = {
    .choose = choose_best, .treelet = 7, .gamma = 7, .rounds = 3};

static void few_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 6, 7, 8, 64};
    enum { COUNTS = sizeof counts / sizeof counts[0] };
    for (size_t k = 0; k < QUALITY_INPUTS; k++)
        for (size_t c = 0; c < COUNTS; c++) {
            if (small && (k > 1 || c != 3 + 2 * k))
                continue;
            bb_box *boxes = make_boxes(quality_inputs, k, counts[c]);
            compare_with(usual, "lbvh:code=mc64", "trbvh", boxes, counts[c], quality_inputs[k].name,
                         FORMS);
            free(boxes);
        }
}

/* More than one chunk and work-item to a level. */
static void many_boxes_make_the_tree_of_the_definition(void **state)
{
    (void)state;
    static const size_t kinds[] = {0, 3, 6};
    for (size_t k = 0; k < 3 && !small; k++) {
        bb_box *boxes = make_boxes(quality_inputs, kinds[k], 2500);
        treelet_reference r = usual;
        r.rounds = 2;
        compare_with(r, "lbvh", "trbvh:rounds=2", boxes, 2500, quality_inputs[kinds[k]].name,
                     FORMS);
        free(boxes);
    }
}

/* Trees as others leave them: in preorder, with several references in a leaf, deep. */
static void any_binary_tree_will_do(void **state)
{
    (void)state;
    static const char *const builders[] = {"sah:leaf=4", "sah", "ploc", "lbvh+rotate"};
    const uint32_t count = small ? 30 : 400;
    for (size_t b = 0; b < 4; b++) {
        if (small && b > 0)
            continue;
        for (size_t k = 0; k < 7; k += 6) {
            bb_box *boxes = make_boxes(quality_inputs, k, count);
            compare_with(usual, builders[b], "trbvh", boxes, count, quality_inputs[k].name, FORMS);
            free(boxes);
        }
    }
}

static void options_mean_what_they_say(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t treelet, gamma, rounds;
    } variants[] = {
        {"trbvh:treelet=3,rounds=5", 3, 3, 5},  {"trbvh:treelet=4", 4, 4, 3},
        {"trbvh:treelet=5,gamma=11", 5, 11, 3}, {"trbvh:treelet=6,rounds=1", 6, 6, 1},
        {"trbvh:treelet=8,rounds=1", 8, 8, 1},
    };
    const uint32_t count = small ? 12 : 100;
    for (size_t v = 0; v < (small ? 1 : sizeof variants / sizeof variants[0]); v++) {
        treelet_reference r = {.choose = choose_best,
                               .treelet = variants[v].treelet,
                               .gamma = variants[v].gamma,
                               .rounds = variants[v].rounds};
        bb_box *boxes = make_boxes(quality_inputs, 0, count);
        compare_with(r, "lbvh", variants[v].text, boxes, count, "mixed", FORMS);
        free(boxes);
    }
}

/* ---- all trees of seven leaves ---- */

typedef struct all_trees {
    const bb_box *boxes;
    uint32_t parents[13], sets[13]; /* nodes 0 to 6 are the leaves */
    uint32_t trees;
    double least;
} all_trees;

static double area_of_set(const bb_box *boxes, uint32_t set)
{
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < 7; i++)
        for (int k = 0; k < 3 && (set >> i & 1) != 0; k++) {
            lo[k] = fmin(lo[k], boxes[i].lo[k]);
            hi[k] = fmax(hi[k], boxes[i].hi[k]);
        }
    double x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    return x * y + y * z + z * x;
}

/* Leaf `next` goes beside each node that is there, the root too; each tree is met once. */
static void add_leaf(all_trees *t, uint32_t next)
{
    if (next == 7) {
        double area = 0;
        for (uint32_t n = 7; n < 13; n++)
            area += area_of_set(t->boxes, t->sets[n]);
        t->trees++;
        t->least = fmin(t->least, area);
        return;
    }
    const all_trees before = *t;
    const uint32_t made = 6 + next; /* the inner node that comes with this leaf */
    for (uint32_t n = 0; n < made; n++) {
        if (n >= next && n < 7)
            continue;
        t->sets[made] = t->sets[n];
        t->parents[made] = t->parents[n];
        t->parents[n] = t->parents[next] = made;
        for (uint32_t p = made; p != BB_NONE; p = t->parents[p])
            t->sets[p] |= 1u << next;
        add_leaf(t, next + 1);
        const uint32_t trees = t->trees;
        const double least = t->least;
        *t = before;
        t->trees = trees;
        t->least = least;
    }
}

static double area_of_inner(const bb_tree *tree)
{
    double area = 0;
    for (uint32_t n = 0; n < tree->info.node_count; n++)
        if (!bb_node_is_leaf(&tree->nodes[n]))
            area += bb_half_area(tree->nodes[n].lo, tree->nodes[n].hi);
    return area;
}

static void seven_leaves_become_the_best_of_all_trees(void **state)
{
    (void)state;
    uint64_t improved = 0;
    for (size_t k = 0; k < (small ? 1 : 40); k++) {
        bb_random random = bb_random_make(seed, 900 + k);
        bb_box boxes[7];
        box_build b;
        for (uint32_t i = 0; i < 7; i++)
            quality_inputs[k % 4 == 3 ? 8 : 0].fill(&random, i, 7, &boxes[i]);
        all_trees t = {.boxes = boxes, .least = INFINITY};
        for (uint32_t i = 0; i < 7; i++) {
            t.sets[i] = 1u << i;
            t.parents[i] = BB_NONE;
        }
        add_leaf(&t, 1);
        assert_int_equal(t.trees, 10395);
        open_box_build(&b, devices[first_form()], "lbvh+trbvh:rounds=1", boxes, 7, "seven");
        improved += event_of(&b.instance.steps[1], "improved");
        double area = area_of_inner(&b.preorder);
        if (area > t.least * (1 + 2e-6) || area < t.least * (1 - 1e-12))
            fail_msg("round %zu, seed %llu: %.9g, the least of all is %.9g", k,
                     (unsigned long long)seed, area, t.least);
        close_box_build(&b);
    }
    assert_true(small || improved > 10);
}

/* ---- rounds ---- */

static double cost_after(const char *builder, const bb_box *boxes, uint32_t count,
                         uint64_t *improved)
{
    box_build b;
    open_box_build(&b, devices[first_form()], builder, boxes, count, builder);
    double area = area_of_inner(&b.preorder);
    if (improved != NULL)
        *improved = event_of(&b.instance.steps[b.instance.step_count - 1], "improved");
    close_box_build(&b);
    return area;
}

/* A single treelet that is the best there is stays. */
static void costs_never_rise_and_rest(void **state)
{
    (void)state;
    const uint32_t count = small ? 40 : 2000;
    uint64_t improved;
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    double last = cost_after("lbvh", boxes, count, NULL);
    for (uint32_t rounds = 1; rounds < (small ? 3 : 7); rounds++) {
        char text[64];
        snprintf(text, sizeof text, "lbvh+trbvh:rounds=%u", rounds);
        double cost = cost_after(text, boxes, count, NULL);
        assert_true(cost < last || (rounds > 1 && cost == last));
        last = cost;
    }
    cost_after("lbvh+trbvh:rounds=1+trbvh:rounds=1", boxes, 7, &improved);
    assert_int_equal(improved, 0);
    free(boxes);
}

static void chains_of_optimisers_are_built(void **state)
{
    (void)state;
    const uint32_t count = small ? 20 : 1000;
    bb_box *boxes = make_boxes(quality_inputs, 0, count);
    double cost = cost_after("lbvh", boxes, count, NULL);
    assert_true(cost_after("lbvh+rotate+trbvh+rotate", boxes, count, NULL) < cost);
    assert_true(cost_after("lbvh+atrbvh+trbvh+trbvh", boxes, count, NULL) < cost);
    free(boxes);
}

/* ---- what is refused ---- */

static void bad_options_and_wide_trees_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "trbvh:rounds=0", "trbvh:rounds=31", "trbvh:treelet=2",        "trbvh:treelet=9",
        "trbvh:gamma=6",  "trbvh:gamma=2",   "trbvh:treelet=4,gamma=3"};
    bb_box *boxes = make_boxes(quality_inputs, 0, 100);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[64];
        snprintf(text, sizeof text, "lbvh+%s", bad[i]);
        expect_refusal(text, boxes, 100, BB_INVALID, "trbvh");
    }
    expect_refusal("trbvh+lbvh", boxes, 100, BB_INVALID, "trbvh");
    expect_refusal("lobvh+trbvh", boxes, 100, BB_UNSUPPORTED, "binary trees");
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
        cmocka_unit_test(seven_leaves_become_the_best_of_all_trees),
        cmocka_unit_test(costs_never_rise_and_rest),
        cmocka_unit_test(chains_of_optimisers_are_built),
        cmocka_unit_test(bad_options_and_wide_trees_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
