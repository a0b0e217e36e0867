/* How many rays a sample has (framework/simulate/sample.h); which ones: test_lockstep. */
#include "framework/simulate/sample.h"
#include "tests/fixture.h"

#include <string.h>

enum { RUNS = 16, COUNT = RUNS * BB_STEPS_RUN, EACH = 10 };

static uint32_t steps[COUNT + 1];
static bool taken[COUNT + 1];

/* A sample of `most` rays, of EACH steps each, of which `room` can be kept. */
static bb_status sample(uint32_t count, uint32_t least, uint32_t most, uint64_t room,
                        uint32_t *rays)
{
    for (uint32_t i = 0; i < count; i++) {
        steps[i] = EACH;
        taken[i] = true;
    }
    return bb_sample_take(steps, count, (bb_sample_size){least, most}, room, taken, rays);
}

static void expect_taken(uint32_t count, uint32_t expected, uint32_t rays)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += taken[i];
    assert_int_equal(sum, expected);
    assert_int_equal(rays, expected);
}

static void small_sets_are_whole(void **state)
{
    (void)state;
    uint32_t rays;
    ASSERT_OK(sample(COUNT, COUNT, COUNT, COUNT * EACH, &rays));
    expect_taken(COUNT, COUNT, rays);
    ASSERT_OK(sample(5, COUNT, COUNT, COUNT * EACH, &rays));
    expect_taken(5, 5, rays);
    ASSERT_OK(bb_sample_take(steps, COUNT, BB_SAMPLE_ALL, COUNT * EACH, taken, &rays));
    expect_taken(COUNT, COUNT, rays);
    ASSERT_OK(sample(0, COUNT, COUNT, 0, &rays));
    assert_int_equal(rays, 0);
}

/* Rays that make no whole run are of no sample. */
static void large_sets_are_sampled(void **state)
{
    (void)state;
    uint32_t rays;
    for (uint32_t part = COUNT / 2; part >= BB_STEPS_RUN; part /= 2) {
        ASSERT_OK(sample(COUNT + 1, part, part, COUNT * EACH, &rays));
        expect_taken(COUNT + 1, part, rays);
        assert_false(taken[COUNT]);
    }
}

static void a_sample_has_as_much_as_there_is_room_for(void **state)
{
    (void)state;
    uint32_t rays;
    ASSERT_OK(sample(COUNT, BB_STEPS_RUN, COUNT, COUNT * EACH - 1, &rays));
    expect_taken(COUNT, COUNT / 2, rays);
    ASSERT_OK(sample(COUNT, BB_STEPS_RUN, COUNT, COUNT / 2 * EACH - 1, &rays));
    expect_taken(COUNT, COUNT / 4, rays);
    ASSERT_OK(sample(COUNT / 2, COUNT / 4, COUNT, COUNT / 4 * EACH, &rays));
    expect_taken(COUNT / 2, COUNT / 4, rays);
}

static void the_least_sample_has_room_or_there_is_none(void **state)
{
    (void)state;
    uint32_t rays;
    assert_int_equal(sample(COUNT, COUNT / 2, COUNT, COUNT / 2 * EACH - 1, &rays), BB_REFUSED);
    assert_non_null(strstr(bb_message(), "steps of 512 items"));
    assert_int_equal(bb_sample_take(steps, COUNT, BB_SAMPLE_ALL, COUNT * EACH - 1, taken, &rays),
                     BB_REFUSED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_sets_are_whole),
        cmocka_unit_test(large_sets_are_sampled),
        cmocka_unit_test(a_sample_has_as_much_as_there_is_room_for),
        cmocka_unit_test(the_least_sample_has_room_or_there_is_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
