/* The Loose BVH against the paper's own: all nodes of the complete tree in an array, primitives
 * inserted by a slow descent, refitted backwards, chains skipped; in all forms, for both roots, at
 * each N. Bit for bit. Seed: BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (for
 * oclgrind). */
#include "tests/box_inputs.h"
#include "tests/device_forms.h"
#include "tests/loose_bvh_reference.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS_MAX = 10, DENSE_MAX = 8 };

static bool small;
static int forms = FORMS; /* how many of them: by levels it is the form for GPUs once more */

/* ---- the comparison ---- */

static void compare(bb_device *on, const char *builder, const bb_box *boxes, uint32_t count,
                    const reference *r, const char *what)
{
    box_build b;
    open_box_build(&b, on, builder, boxes, count, what);
    const bb_tree_info *info = &b.instance.tree.info;
    if (info->depth != r->depth || info->node_count != r->node_count ||
        info->leaf_count != r->leaf_count || info->arity != r->arity ||
        memcmp(b.preorder.nodes, r->nodes, r->node_count * sizeof(bb_node)) != 0 ||
        memcmp(b.preorder.refs, r->refs, count * sizeof(uint32_t)) != 0)
        fail_msg("%s, %s, %u boxes, seed %llu: not the paper's tree: %u nodes of %u, %u leaves of "
                 "%u, depth %u of %u",
                 builder, what, count, (unsigned long long)seed, info->node_count, r->node_count,
                 info->leaf_count, r->leaf_count, info->depth, r->depth);
    close_box_build(&b);
}

/* As published, all nodes in an array, on the host, where scenes have no -0. */
static void compare_array(const bb_box *boxes, uint32_t count, const reference *r, way w,
                          const char *what)
{
    char builder[64];
    bb_box *plain = malloc(count * sizeof *plain);
    assert_non_null(plain);
    for (uint32_t i = 0; i < count; i++) {
        plain[i] = boxes[i];
        for (int k = 0; k < 3; k++) {
            plain[i].lo[k] += 0.0f;
            plain[i].hi[k] += 0.0f;
        }
    }
    snprintf(builder, sizeof builder, "loose-bvh-array:levels=%u,root=%s", w.levels,
             root_names[w.root]);
    compare(devices[first_form()], builder, plain, count, r, what);
    free(plain);
}

static void compare_forms(const bb_box *boxes, uint32_t count, way w, const char *what)
{
    char builder[64];
    reference r;
    snprintf(builder, sizeof builder, "loose-bvh:levels=%u,root=%s,deeper=%u", w.levels,
             root_names[w.root], w.deeper);
    make_reference(&r, boxes, count, &w);
    for (int form = first_form(); form < forms; form++)
        compare(devices[form], builder, boxes, count, &r, what);
    if (w.deeper == 0 && w.levels <= 6)
        compare_array(boxes, count, &r, w, what);
    release_reference(&r);
}

/* ---- inputs ---- */

/* All levels at few places: most nodes with primitives have children, on one side or on both. */
static void fill_dense(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)count;
    double c[3], size = ldexp(0.5, -(int)bb_random_below(random, 7));
    for (int k = 0; k < 3; k++)
        c[k] = i < 2 ? (double)i * 2 - 1 : bb_random_range(random, -1, 1) / (1 + (i & 8));
    set_box(box, c, (const double[]){size, size, size});
}

static void fill_small(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double c[3], half = 0.001 * bb_random_unit(random);
    random_centre(random, c);
    set_box(box, c, (const double[]){half, half, half});
}

static void fill_identical(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    (void)i;
    (void)count;
    set_box(box, (const double[]){3, -4, 5}, (const double[]){0.5, 1, 0.25});
}

/* What the paper's root makes one list of. */
static void fill_nearly_flat(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_small(random, i, count, box);
    box->lo[1] = (float)(0.001 * bb_random_unit(random));
    box->hi[1] = 0.002f;
}

/* Most are the same: their list goes across chunks. Zeros of either sign. */
static void fill_duplicates(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    if (bb_random_below(random, 20) == 0) {
        fill_mixed(random, i, count, box);
        return;
    }
    set_box(box, (const double[]){0.005, 0.005, 0.005}, (const double[]){0.005, 0.005, 0.005});
    for (int k = 0; k < 3; k++)
        box->lo[k] = i % 3 == (uint32_t)k ? -0.0f : 0.0f;
}

/* Half of them begin where the scene does, and are a power of two of it, or a bit more or less. */
static void fill_powers(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)count;
    *box = (bb_box){0};
    for (int k = 0; k < 3; k++) {
        float side = ldexpf(1024, -(int)bb_random_below(random, 11));
        uint32_t nudge = i == 0 ? 0 : bb_random_below(random, 3);
        side = i == 0 ? 1024 : side;
        side = nudge == 1 ? nextafterf(side, 0) : side;
        side = nudge == 2 && side < 1024 ? nextafterf(side, 2048) : side;
        box->hi[k] = side;
    }
    if (i > 0 && i % 2 == 0) /* whole numbers, so that the sides stay */
        for (int k = 0; k < 3; k++) {
            float side = ldexpf(1024, -(int)bb_random_below(random, 11));
            box->lo[k] = (float)bb_random_below(random, 1025 - (uint32_t)side);
            box->hi[k] = box->lo[k] + side;
        }
}

static const box_input inputs[] = {
    {"mixed", fill_mixed},
    {"dense", fill_dense},
    {"small", fill_small},
    {"points", fill_points},
    {"one point", fill_one_point},
    {"identical", fill_identical},
    {"flat", fill_flat},
    {"nearly flat", fill_nearly_flat},
    {"walls", fill_walls},
    {"outlier", fill_outlier},
    {"duplicates", fill_duplicates},
    {"huge", fill_huge},
    {"tiny", fill_tiny},
    {"powers", fill_powers},
};
enum { INPUTS = sizeof inputs / sizeof inputs[0], DENSE = 1, SMALL = 2, POWERS = INPUTS - 1 };

/* ---- tests ---- */

static void trees_are_the_papers(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 64, 65, 1000};
    for (size_t k = 0; k < INPUTS; k++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            if (small && (counts[c] != 65 || k % 9 != 1))
                continue;
            bb_box *boxes = make_boxes(inputs, k, counts[c]);
            for (uint32_t levels = 1; levels <= 5; levels++)
                if (small ? levels == 2 + k % 2 : levels != 4)
                    compare_forms(
                        boxes, counts[c],
                        (way){levels, (root)((levels + c + k) % 2), (levels + k) % 3, false},
                        inputs[k].name);
            free(boxes);
        }
}

/* Many chunks of cells, lists across chunks, and the array at its full size. */
static void large_trees_are_the_papers(void **state)
{
    (void)state;
    static const struct {
        size_t input;
        uint32_t count, levels;
    } cases[] = {{DENSE, 20000, 6}, {SMALL, 20000, 6},  {SMALL, 30000, 7},
                 {0, 9000, 7},      {POWERS, 20000, 8}, {10, 20000, 4}};
    for (size_t n = 0; n < sizeof cases / sizeof cases[0] && !small; n++) {
        bb_box *boxes = make_boxes(inputs, cases[n].input, cases[n].count);
        compare_forms(boxes, cases[n].count,
                      (way){cases[n].levels, (root)(n % 2), (uint32_t)n / 2 % 2, false},
                      inputs[cases[n].input].name);
        free(boxes);
    }
}

/* Whole numbers in a box of 1024: the descent in double rounds nothing, nor may the builder. */
static void keys_are_exact(void **state)
{
    (void)state;
    const uint32_t count = small ? 60 : 3000;
    bb_box *boxes = malloc(count * sizeof *boxes);
    bb_random random = bb_random_make(seed, 7);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t top = 1u << bb_random_below(&random, 11);
        boxes[i] = (bb_box){0};
        for (int k = 0; k < 3; k++) {
            uint32_t side = bb_random_below(&random, top + 1);
            uint32_t low = bb_random_below(&random, 1025 - side);
            boxes[i].lo[k] = i == 0 ? 0 : (float)low;
            boxes[i].hi[k] = i == 0 ? 1024 : (float)(low + side);
        }
    }
    for (uint32_t levels = small ? 2 : 1; levels <= (small ? 2 : DENSE_MAX - 1); levels++)
        compare_forms(boxes, count, (way){levels, (root)(levels % 2), 0, true}, "whole numbers");
    free(boxes);
}

/* A box of the scene's size and one of `side`, in a low corner: how many nodes. */
static uint32_t nodes_of_two(const float side[3], uint32_t levels)
{
    char builder[64];
    box_build b;
    const bb_box boxes[2] = {{{0, 0, 0}, 0, {1024, 1024, 1024}, 0},
                             {{0, 0, 0}, 0, {side[0], side[1], side[2]}, 0}};
    snprintf(builder, sizeof builder, "loose-bvh:deeper=0,levels=%u", levels);
    open_box_build(&b, devices[first_form()], builder, boxes, 2, "two boxes");
    uint32_t nodes = b.preorder.info.node_count;
    close_box_build(&b);
    return nodes;
}

/* Half the scene is a level deeper, the next float above is not, on whichever axis. */
static void levels_change_at_powers_of_two(void **state)
{
    (void)state;
    for (int axis = 0; axis < (small ? 1 : 3); axis++) {
        float side[3] = {512, 512, 512};
        assert_int_equal(nodes_of_two(side, 3), 3);
        side[axis] = nextafterf(512, 1024);
        assert_int_equal(nodes_of_two(side, 3), 1);
        side[axis] = 0; /* sets no limit */
        assert_int_equal(nodes_of_two(side, 3), 3);
    }
    assert_int_equal(nodes_of_two((const float[]){0, 0, 0}, 1), 3);
    assert_int_equal(nodes_of_two((const float[]){0, 1024, 0}, 8), 1);
}

/* A scene that is a cube: both roots are the same. */
static void both_roots_of_a_cube_are_one(void **state)
{
    (void)state;
    const uint32_t count = small ? 50 : 2000;
    bb_box *boxes = make_boxes(inputs, 0, count);
    boxes[count / 2] = (bb_box){{-4, -4, -4}, 0, {4, 4, 4}, 0};
    for (int form = first_form(); form < (small ? first_form() + 1 : forms); form++) {
        box_build b[2];
        open_box_build(&b[0], devices[form], "loose-bvh:root=cube,levels=5", boxes, count, "cube");
        open_box_build(&b[1], devices[form], "loose-bvh:root=box,levels=5", boxes, count, "cube");
        uint32_t nodes = b[0].preorder.info.node_count;
        assert_int_equal(nodes, b[1].preorder.info.node_count);
        assert_memory_equal(b[0].preorder.nodes, b[1].preorder.nodes, nodes * sizeof(bb_node));
        assert_memory_equal(b[0].preorder.refs, b[1].preorder.refs, count * sizeof(uint32_t));
        close_box_build(&b[0]);
        close_box_build(&b[1]);
    }
    free(boxes);
}

/* As they lie in memory, and in each form. */
static void the_same_tree_again(void **state)
{
    (void)state;
    const uint32_t count = small ? 50 : 10000;
    bb_box *boxes = make_boxes(inputs, DENSE, count);
    uint64_t hashes[FORMS] = {0};
    for (int form = first_form(); form < forms; form++) {
        box_build b;
        open_box_build(&b, devices[form], "loose-bvh", boxes, count, "again");
        const bb_tree *tree = &b.instance.tree;
        const size_t bytes = tree->info.node_count * sizeof(bb_node);
        bb_node *nodes = malloc(bytes);
        memcpy(nodes, tree->nodes, bytes);
        ASSERT_OK(bb_instance_build(&b.instance, &b.scene, false, NULL));
        ASSERT_OK(bb_tree_download(&b.instance.tree, NULL));
        assert_memory_equal(nodes, tree->nodes, bytes);
        ASSERT_OK(bb_tree_hash(tree, &hashes[form]));
        assert_true(hashes[form] == hashes[first_form()]);
        free(nodes);
        close_box_build(&b);
    }
    free(boxes);
}

/* All at the origin, but one: one list, whose box is joined by many. */
static void a_pile_is_one_leaf(void **state)
{
    (void)state;
    const uint32_t count = small ? 50 : 100001;
    bb_box *boxes = malloc(count * sizeof *boxes);
    for (uint32_t i = 0; i < count; i++) {
        double half = 0.001 * (i % 7);
        set_box(&boxes[i], (const double[]){0, 0, 0}, (const double[]){half, half, half});
    }
    set_box(&boxes[count / 2], (const double[]){5, 5, 5}, (const double[]){0, 0, 0});
    set_box(&boxes[0], (const double[]){-5, -5, -5}, (const double[]){0, 0, 0});
    compare_forms(boxes, count, (way){6, CUBE, 1, false}, "pile");
    free(boxes);
}

/* Deeper than the paper's array could be here: valid, and no shallower. */
static void deeper_trees_are_valid(void **state)
{
    (void)state;
    const uint32_t count = small ? 60 : 5000;
    bb_box *boxes = make_boxes(inputs, DENSE, count);
    for (uint32_t levels = small ? LEVELS_MAX : DENSE_MAX + 1; levels <= LEVELS_MAX; levels++)
        for (int form = small ? forms - 1 : first_form(); form < forms; form++) {
            char builder[64];
            box_build b;
            snprintf(builder, sizeof builder, "loose-bvh:levels=%u", levels);
            open_box_build(&b, devices[form], builder, boxes, count, "deep");
            close_box_build(&b);
        }
    free(boxes);
}

static void what_does_not_fit_is_refused_beforehand(void **state)
{
    (void)state;
    bb_device *on = devices[0];
    const uint32_t count = 1000;
    bb_box *boxes = make_boxes(inputs, 0, count);
    bb_scene scene = scene_of(boxes, count);
    ASSERT_OK(upload_boxes(&scene, on));
    const uint64_t global = on->global_bytes, largest_allocation = on->largest_allocation;
    static const char *const words[] = {"levels=8", "1000 primitives", "bytes"};
    for (int limit = 0; limit < 2; limit++) {
        bb_instance instance;
        ASSERT_OK(bb_instance_create(on, "loose-bvh:levels=8", &scene, 1, &instance));
        if (limit == 0)
            on->global_bytes = on->bytes + 64 * count;
        else
            on->largest_allocation = 60 * count;
        const uint64_t before = on->bytes;
        assert_int_equal(bb_instance_build(&instance, &scene, false, NULL), BB_REFUSED);
        assert_true(on->bytes == before);
        assert_null(strchr(bb_message(), '\n'));
        for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
            if (strstr(bb_message(), words[i]) == NULL)
                fail_msg("not in the message: %s: %s", words[i], bb_message());
        bb_instance_destroy(&instance);
        on->global_bytes = global;
        on->largest_allocation = largest_allocation;
    }
    bb_buffer_release(&scene.on_device.boxes);
    free(boxes);
}

static void the_level_is_chosen_and_said(void **state)
{
    (void)state;
    static const struct {
        const char *builder, *start;
    } cases[] = {{"loose-bvh", "N = 6 (auto): "}, {"loose-bvh:levels=3", "N = 3: "}};
    const uint32_t count = 1000;
    bb_box *boxes = make_boxes(inputs, 0, count);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        box_build b;
        char text[200];
        open_box_build(&b, devices[first_form()], cases[i].builder, boxes, count, "levels");
        ASSERT_OK(bb_instance_describe(&b.instance, &b.scene, text, sizeof text));
        if (strncmp(text, cases[i].start, strlen(cases[i].start)) != 0)
            fail_msg("%s: %s", cases[i].builder, text);
        close_box_build(&b);
    }
    free(boxes);
}

static void other_options_are_refused(void **state)
{
    (void)state;
    static const char *const builders[] = {"loose-bvh:levels=0", "loose-bvh:levels=11",
                                           "loose-bvh:levels=x", "loose-bvh:root=sphere",
                                           "loose-bvh:deeper=11"};
    bb_box box = {{0}, 0, {1, 1, 1}, 0};
    bb_scene scene = scene_of(&box, 1);
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        bb_instance instance;
        assert_int_equal(bb_instance_create(devices[0], builders[i], &scene, 1, &instance),
                         BB_INVALID);
    }
}

/* Sides of the least denormal, whose halves are 0: no cell is before the first. */
static void the_least_sides_have_cells(void **state)
{
    (void)state;
    bb_box boxes[2];
    const float least = 0x1p-149f;
    for (int i = 0; i < 2; i++) {
        set_box(&boxes[i], (const double[]){0.5, 0.5, 0}, (const double[]){0.5, 0.5, 0});
        boxes[i].lo[2] = boxes[i].hi[2] = (float)(i + 1) * least;
    }
    box_build b;
    open_box_build(&b, devices[first_form()], "loose-bvh-array", boxes, 2, "least");
    close_box_build(&b);
}

int main(void)
{
    seed = seed_or(20070312);
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    if (small && first_form() == CPU_FORM)
        forms = LEVELS_FORM;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_least_sides_have_cells),
        cmocka_unit_test(trees_are_the_papers),
        cmocka_unit_test(large_trees_are_the_papers),
        cmocka_unit_test(keys_are_exact),
        cmocka_unit_test(levels_change_at_powers_of_two),
        cmocka_unit_test(both_roots_of_a_cube_are_one),
        cmocka_unit_test(the_same_tree_again),
        cmocka_unit_test(a_pile_is_one_leaf),
        cmocka_unit_test(deeper_trees_are_valid),
        cmocka_unit_test(what_does_not_fit_is_refused_beforehand),
        cmocka_unit_test(the_level_is_chosen_and_said),
        cmocka_unit_test(other_options_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
