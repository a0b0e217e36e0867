/* Trees and layouts on a device that gets too small for them: who makes room, who stays, and what
 * is known of what could not be made. */
#include "framework/bench/resident.h"
#include "tests/device_fixture.h"

enum { COUNT = 3 };

static const char *const builders[COUNT] = {"hlbvh", "ploc", "lbvh"};
static bb_scene *scene;
static uint64_t global;
static bb_residency all;
static bb_resident residents[COUNT];
static uint32_t layout;

/* Leaves `room` bytes beside what is on the device. */
static void leave_room(uint64_t room)
{
    device->global_bytes = device->bytes + room;
}

static bool has_tree(uint32_t i)
{
    assert_true(residents[i].built == (residents[i].instance.pipeline.count > 0));
    return residents[i].built;
}

/* Gives back memory of a tree, which its next build needs, and leaves no room for it. */
static void rob(uint32_t i)
{
    bb_buffer_release(&residents[i].instance.tree.d_nodes);
    device->global_bytes = device->bytes;
}

static void failed_builds_warm_nothing_up(void **state)
{
    (void)state;
    leave_room(0);
    assert_int_equal(bb_resident_tree(&all, &residents[0]), BB_REFUSED);
    assert_false(has_tree(0));
    assert_false(residents[0].compiled);
    device->global_bytes = global;
    ASSERT_OK(bb_resident_tree(&all, &residents[0]));
    assert_true(has_tree(0) && residents[0].compiled && residents[0].cold_ms > 0);
}

static void builds_are_tried_again_in_the_room_of_others(void **state)
{
    (void)state;
    bb_build_timing timing;
    for (uint32_t i = 0; i < 2; i++)
        ASSERT_OK(bb_resident_layout(&all, &residents[i], layout));
    rob(0);
    ASSERT_OK(bb_resident_build(&all, &residents[0], false, &timing));
    assert_true(has_tree(0) && !has_tree(1) && timing.timing.ms > 0);
    assert_false(residents[0].has_layout[layout]);
    leave_room(0); /* now there is no other */
    rob(0);
    assert_int_equal(bb_resident_build(&all, &residents[0], false, &timing), BB_REFUSED);
    assert_false(has_tree(0));
}

static void what_is_pinned_stays(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < COUNT; i++)
        ASSERT_OK(bb_resident_layout(&all, &residents[i], layout));
    bb_residency_pin(&all, residents, 2);
    const uint64_t bytes = residents[0].layouts[layout].bytes;
    bb_layout_data_release(&residents[0].layouts[layout]);
    residents[0].has_layout[layout] = false;
    leave_room(bytes / 2); /* less than the layout needs */
    ASSERT_OK(bb_resident_layout(&all, &residents[0], layout));
    assert_true(has_tree(0) && has_tree(1) && !has_tree(2));
    assert_true(residents[0].has_layout[layout] && residents[1].has_layout[layout]);
    leave_room(0);
    ASSERT_OK(bb_resident_tree(&all, &residents[2])); /* in the room of layouts */
    assert_true(has_tree(0) && has_tree(1));
    assert_false(residents[0].has_layout[layout] || residents[1].has_layout[layout]);
    bb_resident_evict(&residents[2]);
    leave_room(0);
    assert_int_equal(bb_resident_tree(&all, &residents[2]), BB_REFUSED);
    assert_true(has_tree(0) && has_tree(1) && !has_tree(2));
    bb_residency_pin(&all, &residents[1], 1);
    leave_room(0);
    ASSERT_OK(bb_resident_tree(&all, &residents[2]));
    assert_true(!has_tree(0) && has_tree(1) && has_tree(2));
}

/* A tree that is freed leaves its layouts, and is built again for another. */
static void layouts_outlive_their_tree(void **state)
{
    (void)state;
    ASSERT_OK(bb_resident_layout(&all, &residents[0], layout));
    const uint64_t bytes = device->bytes;
    assert_true(bb_resident_free_tree(&residents[0]));
    assert_true(!has_tree(0) && residents[0].has_layout[layout] && device->bytes < bytes);
    assert_false(bb_resident_free_tree(&residents[0]));
    ASSERT_OK(bb_resident_layout(&all, &residents[0], layout)); /* which is there */
    assert_false(has_tree(0));
    ASSERT_OK(bb_resident_layout_again(&all, &residents[0], layout));
    assert_true(has_tree(0));
    (void)bb_resident_free_tree(&residents[0]); /* a layout alone is something to evict */
    assert_true(bb_resident_evict(&residents[0]));
    assert_false(residents[0].has_layout[layout] || bb_resident_evict(&residents[0]));
}

static uint32_t asked;

static bool give_up(void *whom)
{
    asked++;
    device->global_bytes = global;
    return *(bool *)whom;
}

/* Others are asked for room when nothing is left to evict, and only then. */
static void others_give_up_last(void **state)
{
    (void)state;
    bool gives = true;
    all.give_up = give_up;
    all.whom = &gives;
    asked = 0;
    ASSERT_OK(bb_resident_tree(&all, &residents[0]));
    ASSERT_OK(bb_resident_tree(&all, &residents[2]));
    leave_room(0);
    ASSERT_OK(bb_resident_tree(&all, &residents[1])); /* in the room of both */
    assert_int_equal(asked, 0);
    assert_true(!has_tree(0) && has_tree(1) && !has_tree(2));
    bb_resident_evict(&residents[1]);
    leave_room(0);
    ASSERT_OK(bb_resident_tree(&all, &residents[1]));
    assert_int_equal(asked, 1);
    bb_resident_evict(&residents[1]);
    leave_room(0);
    gives = false;
    assert_int_equal(bb_resident_tree(&all, &residents[1]), BB_REFUSED);
    assert_int_equal(asked, 2);
}

/* What makes a layout is given back with it, and made again. */
static void makers_are_created_again(void **state)
{
    (void)state;
    uint32_t other;
    const bb_layout_wish wish = {.octants = true};
    ASSERT_OK(
        bb_residency_layout(&all, bb_layout_find("wide8"), &wish, 1, BB_FORMAT_VERTICES, &other));
    ASSERT_OK(bb_resident_layout(&all, &residents[0], other));
    assert_true(all.layouts[other].maker.wish.octants);
    rob(0);
    ASSERT_OK(bb_resident_build(&all, &residents[0], false, NULL));
    assert_null(all.layouts[other].maker.layout);
    device->global_bytes = global;
    ASSERT_OK(bb_resident_layout(&all, &residents[0], other));
    assert_true(all.layouts[other].maker.wish.octants);
}

static int start(void **state)
{
    (void)state;
    const bb_layout_wish wish = {0};
    all = (bb_residency){.device = device, .seed = seed, .items = residents, .count = COUNT};
    for (uint32_t i = 0; i < COUNT; i++)
        residents[i] = (bb_resident){.text = builders[i], .scene = scene};
    return bb_residency_layout(&all, bb_layout_find("skip"), &wish, 1, BB_FORMAT_VERTICES,
                               &layout) == BB_OK
               ? 0
               : -1;
}

static int end(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < COUNT; i++)
        bb_resident_evict(&residents[i]);
    bb_residency_end(&all);
    device->global_bytes = global;
    return 0;
}

static int open(void **state)
{
    if (open_device(state) != 0)
        return -1;
    ASSERT_OK(bb_scene_load("spheres:n=5000", &scene));
    ASSERT_OK(bb_scene_upload(scene, device));
    global = device->global_bytes;
    return 0;
}

static int close(void **state)
{
    bb_scene_free(scene);
    return close_device(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(failed_builds_warm_nothing_up, start, end),
        cmocka_unit_test_setup_teardown(builds_are_tried_again_in_the_room_of_others, start, end),
        cmocka_unit_test_setup_teardown(what_is_pinned_stays, start, end),
        cmocka_unit_test_setup_teardown(makers_are_created_again, start, end),
        cmocka_unit_test_setup_teardown(layouts_outlive_their_tree, start, end),
        cmocka_unit_test_setup_teardown(others_give_up_last, start, end),
    };
    return cmocka_run_group_tests(tests, open, close);
}
