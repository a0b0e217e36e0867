/* How many rays a launch gets, and when a device has warmed up, on made-up devices. */
#include "framework/bench/launches.h"
#include "tests/fixture.h"

#include <math.h>

enum { SET = 1 << 22 };

/* Rays that take `ns` each, in a launch that takes 20 us more; the set in launches as the bench
 * makes them. Returns the longest of the launches from the first on. */
static double trace(double ns, uint32_t rounds, uint32_t *batch, uint32_t *launches)
{
    double longest = 0;
    for (uint32_t round = 0; round < rounds; round++) {
        *launches = 0;
        for (uint32_t from = 0, count; from < SET; from += count) {
            count = SET - from < *batch ? SET - from : *batch;
            const double ms = 0.02 + count * ns * 1e-6;
            longest = fmax(longest, ms);
            if (count == *batch || ms > BB_LAUNCH_MS)
                *batch = bb_launch_rays(count, ms, SET);
            ++*launches;
        }
    }
    return longest;
}

/* From 5 Grays/s to 50 krays/s: none is too long but, at less than 130 krays/s, the very first, and
 * none is shorter than it need be. */
static void launches_are_below_the_limit(void **state)
{
    (void)state;
    for (double ns = 0.2; ns < 20000; ns *= 1.7) {
        uint32_t batch = BB_LAUNCH_FIRST, launches = 0;
        const double first = BB_LAUNCH_FIRST * ns * 1e-6;
        const double longest = trace(ns, 3, &batch, &launches);
        if (longest > fmax(first + 1, BB_LAUNCH_MS))
            fail_msg("%g ns: a launch of %g ms", ns, longest);
        const double all = SET * ns * 1e-6;
        if (launches > 2 + all / (0.4 * BB_LAUNCH_MS))
            fail_msg("%g ns: %u launches for %g ms", ns, launches, all);
        assert_true(trace(ns, 1, &batch, &launches) < BB_LAUNCH_MS);
    }
    assert_int_equal(bb_launch_rays(1000, 1e9, SET), 1);
    assert_int_equal(bb_launch_rays(1000, 0, SET), 8000); /* a clock that sees nothing */
    assert_int_equal(bb_launch_rays(SET, 0.1, SET), SET);
}

static uint32_t rounds_of(double (*ms)(uint32_t round), bb_warming *warming)
{
    *warming = (bb_warming){.rounds = 0};
    for (uint32_t round = 0; round < 100; round++)
        if (bb_warmed(warming, ms(round)))
            return round + 1;
    return 100;
}

static double steady(uint32_t round)
{
    return 10 + 0.001 * round;
}
/* Clocks that rise to twice what they were. */
static double rising(uint32_t round)
{
    return 10 * (1 + exp2(-(double)round));
}
static double restless(uint32_t round)
{
    return round % 2 == 0 ? 10 : 11;
}
static double slow(uint32_t round)
{
    return round % 2 == 0 ? 1000 : 1100;
}

static void warm_when_two_rounds_are_alike(void **state)
{
    (void)state;
    bb_warming w;
    assert_int_equal(rounds_of(steady, &w), 2);
    assert_true(w.settled);
    assert_int_equal(rounds_of(rising, &w), 7); /* 1/64 after 1/32 */
    assert_true(w.settled);
    assert_int_equal(rounds_of(restless, &w), BB_WARM_ROUNDS);
    assert_false(w.settled);
    assert_int_equal(rounds_of(slow, &w), 3); /* 3.1 s */
    assert_false(w.settled);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(launches_are_below_the_limit),
        cmocka_unit_test(warm_when_two_rounds_are_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
