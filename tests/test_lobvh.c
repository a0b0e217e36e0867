/* LOBVH against a slow recursive construction from the definition, in both forms, at each level;
 * levels against brute-force fit tests; next pointers against a recursive walk. Bit for bit. Seed:
 * BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "tests/box_inputs.h"
#include "tests/device_forms.h"
#include "tests/lobvh_reference.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool small;

/* ---- the comparison ---- */

/* The skip of each node against the next of a recursive walk, which knows children only. */
static bool next_pointers_are_right(const bb_tree *tree, uint32_t n, uint32_t next)
{
    const bb_node *node = &tree->nodes[n];
    if (node->skip != next)
        return false;
    if (bb_node_is_leaf(node))
        return true;
    uint32_t children[9], count = 0;
    for (uint32_t c = node->first; c != next && count < 9; c = tree->nodes[c].skip)
        children[count++] = c;
    for (uint32_t i = 0; i < count; i++)
        if (!next_pointers_are_right(tree, children[i], i + 1 < count ? children[i + 1] : next))
            return false;
    return true;
}

static void compare(bb_device *device, const char *builder, const bb_box *boxes, uint32_t count,
                    const reference *r, const char *what)
{
    box_build b;
    open_box_build(&b, device, builder, boxes, count, what);
    const bb_tree_info *info = &b.instance.tree.info;
    if (info->depth != r->depth || info->node_count != r->node_count ||
        info->leaf_count != r->leaf_count || info->arity != r->arity ||
        memcmp(b.preorder.nodes, r->nodes, r->node_count * sizeof(bb_node)) != 0 ||
        memcmp(b.preorder.refs, r->refs, count * sizeof(uint32_t)) != 0)
        fail_msg("%s, %s, %u boxes, seed %llu: not the tree of the definition (%u nodes, not %u)",
                 builder, what, count, (unsigned long long)seed, info->node_count, r->node_count);
    if (!next_pointers_are_right(&b.instance.tree, info->root, BB_NONE))
        fail_msg("%s, %s, %u boxes, seed %llu: a next pointer is wrong", builder, what, count,
                 (unsigned long long)seed);
    close_box_build(&b);
}

static void compare_variant(const bb_box *boxes, uint32_t count, const variant *v, uint32_t levels,
                            const char *what)
{
    char builder[160];
    snprintf(builder, sizeof builder, "lobvh:levels=%u%s", levels, v->options);
    reference r;
    make_reference(&r, boxes, count, v, levels);
    for (int form = CPU_FORM; form <= GPU_FORM; form++)
        compare(devices[form], builder, boxes, count, &r, what);
    free(r.nodes);
    free(r.refs);
}

/* ---- inputs ---- */

static void fill_concentric(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double size = ldexp(1, -(int)bb_random_below(random, 20));
    set_box(box, (const double[]){3, -4, 5}, (const double[]){size, size, size});
}

/* 95 % of all are the same. */
static void fill_duplicates(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    if (bb_random_below(random, 20) == 0)
        fill_mixed(random, i, count, box);
    else
        set_box(box, (const double[]){0.3, 0.3, 0.3}, (const double[]){0.01, 0.02, 0.03});
}

static const box_input inputs[] = {
    {"mixed", fill_mixed},         {"points", fill_points}, {"concentric", fill_concentric},
    {"one point", fill_one_point}, {"flat", fill_flat},     {"walls", fill_walls},
    {"outlier", fill_outlier},     {"huge", fill_huge},     {"duplicates", fill_duplicates},
    {"tiny", fill_tiny},
};
enum { INPUTS = sizeof inputs / sizeof inputs[0] };

/* ---- tests ---- */

static const variant plain = {"", SMALLEST, true, false, 2, {0, 0, 0}};

static void trees_are_those_of_the_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 64, 65, 1000, 5000};
    for (size_t k = 0; k < INPUTS; k++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            if ((counts[c] > 1000 && k > 0) || (small && (counts[c] > 70 || c == 1 || c == 3)))
                continue;
            bb_box *boxes = make_boxes(inputs, k, counts[c]);
            for (uint32_t levels = 1; levels <= 6; levels++)
                if (!small || levels == 1 + (k + c) % 3) /* each with one of the counts */
                    compare_variant(boxes, counts[c], &plain, levels, inputs[k].name);
            free(boxes);
        }
}

static void options_mean_what_they_say(void **state)
{
    (void)state;
    static const variant variants[] = {
        {",side=largest", LARGEST, true, false, 2, {0, 0, 0}},
        {",side=mean", MEAN, true, false, 2, {0, 0, 0}},
        {",side=volume", VOLUME, true, false, 2, {0, 0, 0}},
        {",fit=no,chains=keep", SMALLEST, false, true, 2, {0, 0, 0}},
        {",side=largest,loose=1.25", LARGEST, true, false, 1.25, {0, 0, 0}},
        {",side=largest,loose=9", LARGEST, true, false, 9, {0, 0, 0}},
        {",view=1/2/3", SMALLEST, true, false, 2, {1, 2, 3}},
        {",view=-3/2/-1", SMALLEST, true, false, 2, {-3, 2, -1}},
        {",view=0/-1/0", SMALLEST, true, false, 2, {0, -1, 0}},
        {",view=2/-1/-3,side=largest", LARGEST, true, false, 2, {2, -1, -3}},
        {",chains=keep,octree=arrays", SMALLEST, true, true, 2, {0, 0, 0}},
        {",fit=no,side=largest,chains=keep,octree=arrays", LARGEST, false, true, 2, {0, 0, 0}},
        {",view=-3/2/-1,chains=keep,octree=arrays", SMALLEST, true, true, 2, {-3, 2, -1}},
    };
    for (size_t k = 0; k < INPUTS; k++) {
        uint32_t count = small ? 60 : 777;
        bb_box *boxes = make_boxes(inputs, k, count);
        for (size_t v = 0; v < sizeof variants / sizeof variants[0]; v++)
            if (!small || (k + v) % 10 == 0)
                compare_variant(boxes, count, &variants[v], small ? 3 : 4 + (v & 1),
                                inputs[k].name);
        free(boxes);
    }
}

/* Boxes on a grid of 2^-12 in the unit cube, sides of whole 2^-7: all arithmetic is exact, whatever
 * the order. */
static void fill_exact(bb_random *random, uint32_t i, bb_box *box)
{
    *box = (bb_box){0};
    for (int k = 0; k < 3; k++) {
        uint32_t side = bb_random_below(random, 2) == 0 ? bb_random_below(random, 129)
                                                        : bb_random_below(random, 6);
        double at = bb_random_below(random, 4096 - 32 * side + 1) / 4096.0;
        box->lo[k] = i == 0 ? 0 : (float)at;
        box->hi[k] = i == 0 ? 1 : (float)(at + side / 128.0); /* the first is the cube itself */
    }
}

static bool fits_exactly(const bb_box *box, double a, uint32_t level)
{
    double length = ldexp(1, -(int)level), margin = 0.5 * (a - 1) * length;
    for (int k = 0; k < 3; k++) {
        double centre = 0.5 * ((double)box->lo[k] + (double)box->hi[k]);
        double cell = fmin(floor(centre / length), 1 / length - 1) * length;
        if ((double)box->lo[k] < cell - margin || (double)box->hi[k] > cell + length + margin)
            return false;
    }
    return true;
}

/* Section 3.1: with the largest side as measure and a >= 2, equation 1 and one fit test find the
 * deepest level at which the box fits into the enlarged cell of its centroid. */
static void levels_are_those_of_brute_force(void **state)
{
    (void)state;
    const uint32_t count = small ? 100 : 4000, levels = small ? 3 : 6;
    static const struct {
        const char *options;
        double a;
    } cases[] = {{",side=largest", 2}, {",side=largest,loose=3", 3}};
    bb_random random = bb_random_make(seed, 7);
    bb_box *boxes = malloc(count * sizeof *boxes);
    item *items = malloc(count * sizeof *items);
    for (uint32_t i = 0; i < count; i++)
        fill_exact(&random, i, &boxes[i]);
    for (int n = 0; n < 2; n++) {
        variant v = {cases[n].options, LARGEST, true, false, cases[n].a, {0, 0, 0}};
        uint32_t deeper = 0;
        for (uint32_t i = 0; i < count; i++) {
            bb_box cube = {{0, 0, 0}, 0, {1, 1, 1}, 0};
            uint32_t deepest = levels;
            while (deepest > 0 && !fits_exactly(&boxes[i], v.a, deepest))
                deepest--;
            items[i] = item_of(&boxes[i], &cube, &v, levels);
            items[i].prim = i;
            if (items[i].level != deepest)
                fail_msg("box %u, seed %llu: level %u, brute force finds %u", i,
                         (unsigned long long)seed, items[i].level, deepest);
            v.fit = false;
            deeper += item_of(&boxes[i], &cube, &v, levels).level < deepest;
            v.fit = true;
        }
        assert_true(deeper > 0); /* the fit test mattered */
        compare_variant(boxes, count, &v, levels, "exact");
    }
    free(boxes);
    free(items);
}

static void what_does_not_fit_is_refused_beforehand(void **state)
{
    (void)state;
    bb_device *device = devices[0];
    bb_box boxes[2];
    bb_instance instance;
    set_box(&boxes[0], (const double[]){0, 0, 0}, (const double[]){1, 1, 1});
    set_box(&boxes[1], (const double[]){5, 5, 5}, (const double[]){1, 1, 1});
    bb_scene scene = scene_of(boxes, 2);
    assert_int_equal(upload_boxes(&scene, device), BB_OK);
    const uint64_t global = device->global_bytes, largest_allocation = device->largest_allocation;
    static const char *const words[] = {"levels=10", "1227133513 nodes", "249261508 bytes",
                                        "take levels=9 or less"};
    for (int limit = 0; limit < 2; limit++) {
        assert_int_equal(bb_instance_create(device, "lobvh:levels=10", &scene, 1, &instance),
                         BB_OK);
        if (limit == 0)
            device->global_bytes = device->bytes + 200000000;
        else
            device->largest_allocation = 100000000;
        const uint64_t before = device->bytes;
        assert_int_equal(bb_instance_build(&instance, &scene, false, NULL), BB_REFUSED);
        assert_true(device->bytes == before);
        for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
            if (strstr(bb_message(), words[i]) == NULL)
                fail_msg("not in the message: %s: %s", words[i], bb_message());
        bb_instance_destroy(&instance);
        device->global_bytes = global;
        device->largest_allocation = largest_allocation;
    }
    bb_buffer_release(&scene.on_device.boxes);
}

/* Four arrays of 40 bytes a node; in bits, a twentieth of that. */
static void the_papers_arrays_are_booked(void **state)
{
    (void)state;
    const uint64_t nodes = 299593; /* of levels 0 to 6 */
    const char *const builders[] = {"lobvh:levels=6,chains=keep,octree=arrays",
                                    "lobvh:levels=6,chains=keep"};
    uint64_t peaks[2];
    bb_box *boxes = make_boxes(inputs, 0, 100);
    for (int i = 0; i < 2; i++) {
        box_build b;
        open_box_build(&b, devices[0], builders[i], boxes, 100, "arrays");
        peaks[i] = b.instance.account.peak;
        close_box_build(&b);
    }
    assert_true(peaks[0] > 40 * nodes && peaks[0] < 44 * nodes);
    assert_true(peaks[1] < 2 * nodes);
    free(boxes);
    bb_instance instance = {0};
    bb_box box;
    set_box(&box, (const double[]){0, 0, 0}, (const double[]){1, 1, 1});
    bb_scene scene = scene_of(&box, 1);
    assert_int_equal(upload_boxes(&scene, devices[0]), BB_OK);
    const uint64_t global = devices[0]->global_bytes;
    devices[0]->global_bytes = devices[0]->bytes + 1000000000;
    assert_int_equal(bb_instance_create(devices[0], "lobvh:levels=10,chains=keep,octree=arrays",
                                        &scene, 1, &instance),
                     BB_OK);
    assert_int_equal(bb_instance_build(&instance, &scene, false, NULL), BB_REFUSED);
    devices[0]->global_bytes = global;
    assert_non_null(strstr(bb_message(), "1227133513 nodes"));
    bb_instance_destroy(&instance);
    bb_buffer_release(&scene.on_device.boxes);
}

/* auto takes no more levels than tell the centroids apart; the level and the order are said. */
static void the_level_is_chosen_and_said(void **state)
{
    (void)state;
    bb_device *device = devices[0];
    const uint32_t count = 1000;
    bb_box *boxes = make_boxes(inputs, 0, count);
    bb_scene scene = scene_of(boxes, count);
    char text[200];
    assert_int_equal(upload_boxes(&scene, device), BB_OK);
    uint32_t chosen[3] = {0};
    for (int n = 0; n < 3; n++) {
        bb_instance instance;
        const char *builder = n == 1 ? "lobvh:view=0/0/-1" : "lobvh";
        scene.profile.octree_depth = n == 2 ? 2 : 0;
        assert_int_equal(bb_instance_create(device, builder, &scene, 1, &instance), BB_OK);
        assert_int_equal(bb_instance_build(&instance, &scene, false, NULL), BB_OK);
        assert_int_equal(bb_instance_describe(&instance, &scene, text, sizeof text), BB_OK);
        assert_int_equal(sscanf(text, "octree of %u levels (auto)", &chosen[n]), 1);
        assert_int_equal(n == 1, strstr(text, "ordered along -z+x+y") != NULL);
        bb_instance_destroy(&instance);
    }
    assert_true(chosen[0] == chosen[1] && chosen[0] > 2 && chosen[0] <= 10);
    assert_int_equal(chosen[2], 2);
    bb_buffer_release(&scene.on_device.boxes);
    free(boxes);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "lobvh:levels=0",     "lobvh:levels=11",  "lobvh:side=longest", "lobvh:loose=1",
        "lobvh:loose=17",     "lobvh:loose=nan",  "lobvh:fit=maybe",    "lobvh:chains=cut",
        "lobvh:view=nowhere", "lobvh:view=0/0/0", "lobvh:octree=words", "lobvh:octree=arrays",
    };
    bb_box box;
    set_box(&box, (const double[]){0, 0, 0}, (const double[]){1, 1, 1});
    bb_scene scene = scene_of(&box, 1);
    assert_int_equal(upload_boxes(&scene, devices[0]), BB_OK);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        bb_instance instance = {0};
        bb_status status = bb_instance_create(devices[0], bad[i], &scene, 1, &instance);
        if (status == BB_OK)
            status = bb_instance_build(&instance, &scene, false, NULL);
        if (status != BB_INVALID)
            fail_msg("%s: status %d", bad[i], (int)status);
        bb_instance_destroy(&instance);
    }
    bb_buffer_release(&scene.on_device.boxes);
}

int main(void)
{
    seed = seed_or(20261121);
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_those_of_the_definition),
        cmocka_unit_test(options_mean_what_they_say),
        cmocka_unit_test(levels_are_those_of_brute_force),
        cmocka_unit_test(what_does_not_fit_is_refused_beforehand),
        cmocka_unit_test(the_papers_arrays_are_booked),
        cmocka_unit_test(the_level_is_chosen_and_said),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
