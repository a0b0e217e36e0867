/* Who drops out of a race, on made-up samples; the order of leastness. Seed of the simulation:
 * BVHBENCH_TEST_SEED. */
#include "framework/advise/advice.h"
#include "framework/base/random.h"
#include "tests/fixture.h"

#include <math.h>
#include <string.h>

/* ---- racing ---- */

enum { MANY = 12 };

typedef struct track {
    double cost[MANY];    /* of each, in truth */
    double noise, shared; /* of one measurement; of a round, on all */
    uint32_t rounds;
    bb_random random;
    uint32_t measured[MANY]; /* heats */
    uint32_t fails_in;       /* heat in which measuring fails; UINT32_MAX: none */
} track;

/* Heavy-tailed upwards, as times are. */
static double noisy(track *t, double spread)
{
    return exp(spread * pow(bb_random_unit(&t->random), 4) * 4);
}

static bb_status measure(void *user, uint32_t heat, bb_racer *racers, uint32_t count)
{
    track *t = user;
    if (heat == t->fails_in)
        return bb_fail(BB_FAILED, "the track is flooded");
    for (uint32_t i = 0; i < count; i++)
        racers[i].cost.count = racers[i].state == BB_RACING ? 0 : racers[i].cost.count;
    for (uint32_t round = 0; round <= t->rounds; round++) {
        double common = noisy(t, t->shared);
        for (uint32_t i = 0; i < count; i++)
            if (racers[i].state == BB_RACING)
                bb_samples_add(&racers[i].cost, t->cost[i] * common * noisy(t, t->noise));
    }
    for (uint32_t i = 0; i < count; i++)
        t->measured[i] += racers[i].state == BB_RACING;
    return BB_OK;
}

static track make_track(uint64_t seed, double noise, uint32_t rounds)
{
    return (track){.noise = noise,
                   .shared = 0.5,
                   .rounds = rounds,
                   .random = bb_random_make(seed, 0),
                   .fails_in = UINT32_MAX};
}

/* Twelve between 1 and 2, many of them close to the best. Returns how much slower than the winner
 * the best of those is that are left; counts who is dropped. */
static double race_of_many(track *t, uint32_t *dropped)
{
    bb_racer racers[MANY];
    double winner = 2, left = INFINITY;
    for (uint32_t i = 0; i < MANY; i++) {
        t->cost[i] = 1 + pow(bb_random_unit(&t->random), 3);
        winner = fmin(winner, t->cost[i]);
    }
    ASSERT_OK(bb_race_run(racers, MANY, 3, BB_ADVISE_SLACK, measure, t));
    for (uint32_t i = 0; i < MANY; i++) {
        *dropped += racers[i].state == BB_TOO_SLOW;
        if (racers[i].state == BB_RACING)
            left = fmin(left, t->cost[i]);
    }
    return left / winner;
}

/* Factors of noise up to 1.1, 1.5: luck drops the winner in less than 1 of 1000, for one that is as
 * good. */
static void the_winner_is_hardly_ever_dropped(void **state)
{
    (void)state;
    const uint64_t seed = seed_or(20261122);
    enum { TRIALS = 2000 };
    uint32_t dropped = 0, lost = 0;
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        track t = make_track(seed + trial, trial % 2 ? 0.025 : 0.1, 8);
        double left = race_of_many(&t, &dropped);
        lost += left != 1;
        if (left > BB_ADVISE_SLACK)
            fail_msg("seed %llu: all that are left are slower than the winner by %.3f",
                     (unsigned long long)(seed + trial), left);
    }
    assert_in_range(lost, 0, 4);
    assert_true(dropped > TRIALS * MANY / 3); /* it is a race all the same */
}

/* Factors up to 2.2: luck may drop the winner now and then, for one that is as good. */
static void noise_costs_little(void **state)
{
    (void)state;
    const uint64_t seed = seed_or(20261122);
    enum { TRIALS = 2000 };
    uint32_t dropped = 0, lost = 0;
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        track t = make_track(seed + trial, 0.2, 8);
        double left = race_of_many(&t, &dropped);
        lost += left != 1;
        if (left > BB_ADVISE_SLACK)
            fail_msg("seed %llu: all that are left are slower than the winner by %.3f",
                     (unsigned long long)(seed + trial), left);
    }
    assert_true(lost <= TRIALS / 100);
}

static void who_is_surely_slower_is_dropped(void **state)
{
    (void)state;
    track t = make_track(1, 0.001, 6);
    bb_racer racers[4];
    const double costs[] = {1.2, 1, 1.04, 3};
    memcpy(t.cost, costs, sizeof costs);
    ASSERT_OK(bb_race_run(racers, 4, 3, BB_ADVISE_SLACK, measure, &t));
    assert_int_equal(racers[0].state, BB_TOO_SLOW);
    assert_int_equal(racers[0].behind, 1);
    const bb_estimate ratio = bb_samples_estimate(&racers[0].ratio);
    assert_true(ratio.least > 1.05 && fabs(ratio.value - 1.2) < 0.05);
    assert_int_equal(racers[1].state, BB_RACING);
    assert_int_equal(racers[2].state, BB_RACING); /* within 5 % */
    assert_int_equal(racers[3].state, BB_TOO_SLOW);
    const uint32_t heats[] = {1, 3, 3, 1};
    for (int i = 0; i < 4; i++) { /* what is out is measured no more */
        assert_int_equal(t.measured[i], heats[i]);
        assert_int_equal(racers[i].heats, heats[i]);
    }
}

static void too_few_rounds_drop_nobody(void **state)
{
    (void)state;
    track t = make_track(1, 0.001, BB_INTERVAL_ROUNDS - 1);
    bb_racer racers[2];
    t.cost[0] = 1;
    t.cost[1] = 100;
    ASSERT_OK(bb_race_run(racers, 2, 3, BB_ADVISE_SLACK, measure, &t));
    assert_int_equal(racers[1].state, BB_RACING);
}

/* A machine that disturbs one round of four, by ten times: rounds of the best one that were
 * disturbed save the others from a rule that asks each round, not from one that asks the least. */
static void a_busy_machine_saves_nobody_from_scouts(void **state)
{
    (void)state;
    static const double costs[3] = {1, 2.05, 2.2};
    bb_racer racers[3], again[3];
    for (uint32_t i = 0; i < 3; i++) {
        racers[i] = (bb_racer){.behind = BB_NO_RACER};
        for (uint32_t round = 0; round <= 8; round++)
            bb_samples_add(&racers[i].cost, costs[i] * ((round + i) % 4 == 0 ? 10 : 1));
    }
    memcpy(again, racers, sizeof again);
    assert_int_equal(bb_race_drop(racers, 3, 2.1), 3);
    assert_int_equal(bb_race_drop_least(again, 3, 2.1), 2);
    assert_int_equal(again[1].state, BB_RACING);
    assert_int_equal(again[2].state, BB_TOO_SLOW);
    assert_int_equal(again[2].behind, 0);
}

static void ties_stay_in_order(void **state)
{
    (void)state;
    track t = make_track(1, 0, 6);
    bb_racer racers[3];
    t.cost[0] = t.cost[1] = t.cost[2] = 2;
    ASSERT_OK(bb_race_run(racers, 3, 2, BB_ADVISE_SLACK, measure, &t));
    assert_int_equal(bb_race_best(racers, 3), 0);
    for (int i = 0; i < 3; i++)
        assert_int_equal(racers[i].state, BB_RACING);
    t.cost[2] = 2 * BB_ADVISE_SLACK; /* exactly as much as is allowed */
    ASSERT_OK(bb_race_run(racers, 3, 2, BB_ADVISE_SLACK * (1 + 1e-12), measure, &t));
    assert_int_equal(racers[2].state, BB_RACING);
}

static bb_status lose_two(void *user, uint32_t heat, bb_racer *racers, uint32_t count)
{
    BB_TRY(measure(user, heat, racers, count));
    racers[0].state = BB_TOO_WRONG;
    racers[1].state = BB_NOT_RUN;
    return BB_OK;
}

static bb_status lose_all(void *user, uint32_t heat, bb_racer *racers, uint32_t count)
{
    BB_TRY(measure(user, heat, racers, count));
    for (uint32_t i = 0; i < count; i++)
        racers[i].state = BB_TOO_WRONG;
    return BB_OK;
}

/* However fast it is. */
static void what_is_wrong_does_not_win(void **state)
{
    (void)state;
    track t = make_track(1, 0.001, 6);
    bb_racer racers[4];
    const double costs[] = {0.1, 0.1, 1, 1.5};
    memcpy(t.cost, costs, sizeof costs);
    ASSERT_OK(bb_race_run(racers, 4, 3, BB_ADVISE_SLACK, lose_two, &t));
    assert_int_equal(bb_race_best(racers, 4), 2);
    assert_int_equal(racers[0].state, BB_TOO_WRONG);
    assert_int_equal(racers[1].state, BB_NOT_RUN);
    assert_int_equal(racers[3].behind, 2);
    ASSERT_OK(bb_race_run(racers, 4, 3, BB_ADVISE_SLACK, lose_all, &t));
    assert_int_equal(bb_race_best(racers, 4), BB_NO_RACER);
}

static void failures_are_passed_up(void **state)
{
    (void)state;
    track t = make_track(1, 0.001, 6);
    bb_racer racers[2];
    t.fails_in = 1;
    t.cost[0] = t.cost[1] = 1;
    assert_int_equal(bb_race_run(racers, 2, 3, BB_ADVISE_SLACK, measure, &t), BB_FAILED);
    assert_string_equal(bb_message(), "the track is flooded");
}

/* ---- leastness ---- */

static const bb_extent middle = {.bytes = 1e6,
                                 .code_bits = 30,
                                 .stack = 64,
                                 .kinds = 2,
                                 .width = 4,
                                 .doubt = 1,
                                 .ms = 10,
                                 .place = 5};

static void the_first_difference_decides(void **state)
{
    (void)state;
    bb_extent less[8], more = middle;
    const char *const reasons[] = {"memory",
                                   "bits of the code",
                                   "entries of the stack",
                                   "kinds of primitives",
                                   "children of a node",
                                   "a more careful intersector",
                                   "time",
                                   "its place in the list"};
    for (int i = 0; i < 8; i++)
        less[i] = middle;
    less[0].bytes = 0.9e6;
    less[1].code_bits = 29;
    less[2].stack = 32;
    less[3].kinds = 1;
    less[4].width = 2;
    less[5].doubt = 0;
    less[6].ms = 9;
    less[7].place = 4;
    for (int i = 0; i < 8; i++) {
        bb_extent one = less[i]; /* more of all that comes later */
        one.code_bits += i < 1 ? 9 : 0;
        one.stack += i < 2 ? 9 : 0;
        one.kinds += i < 3 ? 9 : 0;
        one.width += i < 4 ? 9 : 0;
        one.doubt += i < 5 ? 9 : 0;
        one.ms += i < 6 ? 9 : 0;
        one.place += i < 7 ? 9 : 0;
        assert_true(bb_extent_compare(&one, &more) < 0);
        assert_true(bb_extent_compare(&more, &one) > 0);
        assert_string_equal(bb_extent_reason(&one, &more), reasons[i]);
    }
    assert_int_equal(bb_extent_compare(&middle, &middle), 0);
}

/* What has no bytes that are known is no bargain. */
static void unknown_memory_is_the_most(void **state)
{
    (void)state;
    bb_extent unknown = middle, none = middle;
    unknown.bytes = NAN;
    none.bytes = 0;
    assert_true(bb_extent_compare(&unknown, &middle) > 0);
    assert_true(bb_extent_compare(&none, &middle) > 0);
}

static bb_extent random_extent(bb_random *random)
{
    return (bb_extent){.bytes = 1e6 * pow(1.1, bb_random_unit(random)),
                       .code_bits = (uint32_t)bb_random_below(random, 2),
                       .stack = (uint32_t)bb_random_below(random, 2),
                       .kinds = (uint32_t)bb_random_below(random, 2),
                       .width = (uint32_t)bb_random_below(random, 2),
                       .ms = (double)bb_random_below(random, 2),
                       .place = (uint32_t)bb_random_below(random, 3)};
}

static void it_is_an_order(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed_or(3), 0);
    for (int i = 0; i < 200000; i++) {
        bb_extent a = random_extent(&random), b = random_extent(&random),
                  c = random_extent(&random);
        int ab = bb_extent_compare(&a, &b), bc = bb_extent_compare(&b, &c);
        assert_true((ab < 0) == (bb_extent_compare(&b, &a) > 0));
        if (ab <= 0 && bc <= 0)
            assert_true(bb_extent_compare(&a, &c) <= 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_winner_is_hardly_ever_dropped),
        cmocka_unit_test(noise_costs_little),
        cmocka_unit_test(who_is_surely_slower_is_dropped),
        cmocka_unit_test(too_few_rounds_drop_nobody),
        cmocka_unit_test(a_busy_machine_saves_nobody_from_scouts),
        cmocka_unit_test(ties_stay_in_order),
        cmocka_unit_test(what_is_wrong_does_not_win),
        cmocka_unit_test(failures_are_passed_up),
        cmocka_unit_test(the_first_difference_decides),
        cmocka_unit_test(unknown_memory_is_the_most),
        cmocka_unit_test(it_is_an_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
