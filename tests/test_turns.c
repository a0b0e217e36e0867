/* Turns: each round all take theirs once, in an order that favours nobody; failures end a round;
 * GPUs are warmed up until two rounds took the same time. */
#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/bench/launches.h"
#include "framework/bench/turns.h"
#include "tests/fixture.h"

#include <math.h>
#include <string.h>

enum { COUNT = 5, ROUNDS = 1200 };

typedef struct sheet {
    uint32_t at, round, taken[COUNT]; /* of the current round */
    uint32_t follows[COUNT][COUNT], warming, fails_at;
    uint32_t last;
    const double *warm_ms; /* of each turn of a round of warming up */
} sheet;

static bb_status note(void *self, uint32_t who, uint32_t round, double *ms)
{
    sheet *s = self;
    assert_true(who < COUNT);
    if (round == BB_WARMING_UP) {
        *ms += s->warm_ms != NULL ? s->warm_ms[s->warming / COUNT] : 0;
        s->warming++;
        return BB_OK;
    }
    assert_int_equal(round, s->round);
    s->taken[who]++;
    if (s->at > 0)
        s->follows[who][s->last]++;
    s->last = who;
    return ++s->at == s->fails_at ? bb_fail(BB_FAILED, "planted") : BB_OK;
}

static void all_follow_each_other_alike(void **state)
{
    (void)state;
    bb_device device = {.is_cpu = true};
    bb_random random = bb_random_make(seed_or(20261126), 0);
    sheet s = {.at = 0};
    bb_turns turns = {&device, &random, COUNT, &s, note};
    ASSERT_OK(bb_turns_warm_up(&turns, NULL, "scene", "turns"));
    assert_int_equal(s.warming, 0);
    for (s.round = 0; s.round < ROUNDS; s.round++) {
        ASSERT_OK(bb_turns_round(&turns, s.round));
        for (int i = 0; i < COUNT; i++)
            assert_int_equal(s.taken[i], 1);
        memset(s.taken, 0, sizeof s.taken);
        s.at = 0;
    }
    /* each pair is adjacent in 1 of COUNT rounds; six standard deviations */
    const double mean = (double)ROUNDS / COUNT, slack = 6 * sqrt(mean * (1 - 1.0 / COUNT));
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < COUNT; k++)
            if (i != k)
                ASSERT_NEAR(s.follows[i][k], mean, slack);
}

static void a_failure_ends_the_round(void **state)
{
    (void)state;
    bb_device device = {.is_cpu = true};
    bb_random random = {1};
    sheet s = {.fails_at = 3};
    bb_turns turns = {&device, &random, COUNT, &s, note};
    assert_int_equal(bb_turns_round(&turns, 0), BB_FAILED);
    assert_int_equal(s.at, 3);
}

static void a_gpu_is_warmed_up_until_it_settles(void **state)
{
    (void)state;
    static const double settles[BB_WARM_ROUNDS] = {9, 7, 5, 4, 4, 1};
    static const double never[BB_WARM_ROUNDS] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    bb_device device = {.is_cpu = false};
    bb_progress progress;
    bb_progress_start(&progress, true);
    bb_random random = {1};
    sheet s = {.warm_ms = settles};
    bb_turns turns = {&device, &random, COUNT, &s, note};
    ASSERT_OK(bb_turns_warm_up(&turns, &progress, "scene", "turns"));
    assert_int_equal(s.warming, 5 * COUNT);
    assert_int_equal(s.at, 0);
    s = (sheet){.warm_ms = never};
    ASSERT_OK(bb_turns_warm_up(&turns, &progress, "scene", "turns"));
    assert_int_equal(s.warming, BB_WARM_ROUNDS * COUNT);
    bb_progress_end(&progress);
}

/* As many rounds as fit into the time, but one in any case. */
static void rounds_fit_into_the_time(void **state)
{
    (void)state;
    bb_progress progress;
    bb_progress_start(&progress, true);
    assert_int_equal(bb_turns_foretell(&progress, "it", 1e3, 50, 0), 50);
    assert_int_equal(bb_turns_foretell(&progress, "it", 1e3, 50, bb_wall_ms() + 1e6), 50);
    assert_int_equal(bb_turns_foretell(&progress, "it", 1e3, 50, bb_wall_ms() - 1), 1);
    const uint32_t some = bb_turns_foretell(&progress, "it", 1e3, 50, bb_wall_ms() + 10900);
    assert_true(some == 10 || some == 9); /* nearly a second may pass in between */
    bb_progress_end(&progress);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_follow_each_other_alike),
        cmocka_unit_test(a_failure_ends_the_round),
        cmocka_unit_test(a_gpu_is_warmed_up_until_it_settles),
        cmocka_unit_test(rounds_fit_into_the_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
