/* Contests on a device that is too small for all trees and layouts at once: as long as each way
 * fits alone, all are measured, since trees and layouts make room for each other. */
#include "framework/tasks/overlap_contest.h"
#include "framework/tasks/slice_contest.h"
#include "tests/device_fixture.h"

#include <string.h>

enum { BUILDERS = 3 };

static const char *const builders[BUILDERS] = {"lbvh", "ploc", "sah"};
static const char *const searches[] = {"skip"};
static bb_scene *scene;
static uint64_t global;
static bool pairs; /* each way needs two trees at a time */

/* Slices by `count` builders, or lets the mesh meet itself, with `room` bytes beside the scene.
 * NULL: no way fits. */
static bb_table *contest(const char *const *which, uint32_t count, uint64_t room)
{
    bb_scene *const twice[2] = {scene, scene};
    bb_slice_request request = {
        .contest = {.device = device,
                    .name = "tets",
                    .builders = which,
                    .builder_count = count,
                    .searches = searches,
                    .search_count = 1,
                    .repeats = 2,
                    .seed = seed,
                    .quiet = true},
        .plan = {.axis = 2, .width = 16, .height = 16, .count = 2},
    };
    bb_table *table;
    ASSERT_OK(bb_slice_plan_check(scene, &request.plan));
    ASSERT_OK(bb_table_create("slice", &table));
    const uint64_t before = device->bytes;
    device->global_bytes = before + room;
    const bb_status status = pairs ? bb_overlap_run(&request.contest, twice, NULL, table)
                                   : bb_slice_run(&request, scene, table);
    device->global_bytes = global;
    assert_true(device->bytes == before);
    if (status == BB_OK)
        return table;
    bb_table_free(table);
    if (status != BB_UNSUPPORTED) /* "no way" */
        fail_msg("with room for %llu bytes: %s", (unsigned long long)room, bb_message());
    return NULL;
}

static uint32_t measured(const bb_table *table)
{
    uint32_t count = 0;
    for (uint32_t r = 0; r < bb_table_row_count(table); r++) {
        const bb_samples *rounds = bb_table_get_rounds(table, r, "answer_ms");
        if (rounds == NULL)
            continue;
        assert_int_equal(rounds->count, 3);
        assert_true(bb_table_get_number(table, r, "differ") == 0);
        count++;
    }
    return count;
}

/* The least room in which the builder is measured, to 1 in 256. */
static uint64_t least_room(const char *builder)
{
    uint64_t low = 0, high = (uint64_t)1 << 32;
    while (high - low > high / 256) {
        const uint64_t middle = low + (high - low) / 2;
        bb_table *table = contest(&builder, 1, middle);
        if (table != NULL)
            high = middle;
        else
            low = middle;
        bb_table_free(table);
    }
    return high;
}

static void expect_room_for_each_other(void)
{
    uint64_t most = 0;
    for (uint32_t i = 0; i < BUILDERS; i++) {
        const uint64_t room = least_room(builders[i]);
        most = room > most ? room : most;
    }
    assert_true(most < (uint64_t)1 << 31);
    for (uint64_t quarter = 4; quarter <= 16; quarter++) {
        bb_table *table = contest(builders, BUILDERS, most * quarter / 4);
        assert_non_null(table);
        assert_int_equal(measured(table), BUILDERS);
        bb_table_free(table);
    }
}

static void ways_make_room_for_each_other(void **state)
{
    (void)state;
    pairs = false;
    expect_room_for_each_other();
}

static void trees_that_are_used_together_stay(void **state)
{
    (void)state;
    pairs = true;
    expect_room_for_each_other();
}

static int open(void **state)
{
    if (open_device(state) != 0)
        return -1;
    ASSERT_OK(bb_scene_load("tets:side=8", &scene));
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
    const struct CMUnitTest tests[] = {cmocka_unit_test(ways_make_room_for_each_other),
                                       cmocka_unit_test(trees_that_are_used_together_stay)};
    return cmocka_run_group_tests(tests, open, close);
}
