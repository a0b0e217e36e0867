/* Statistics: medians, their intervals and how often these cover, paired ratios, rates, selection.
 * Seed: BVHBENCH_TEST_SEED. Simulates three million medians: some seconds. */
#include "framework/base/random.h"
#include "framework/base/statistics.h"
#include "tests/fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t seed(void)
{
    const char *text = getenv("BVHBENCH_TEST_SEED");
    return text != NULL ? strtoull(text, NULL, 10) : 1986;
}

static bb_samples samples_of(const double *values, uint32_t count)
{
    bb_samples samples = {0};
    for (uint32_t i = 0; i < count; i++)
        bb_samples_add(&samples, values[i]);
    return samples;
}

static void near(double value, double expected)
{
    if (!(fabs(value - expected) <= 1e-12 * fabs(expected)))
        fail_msg("%.17g, expected %.17g", value, expected);
}

/* ---- medians and ranges ---- */

static void median_leaves_the_first_out(void **state)
{
    (void)state;
    const double values[] = {100, 3, 1, 2, 8};
    bb_samples none = {0}, one = samples_of(values, 1), odd = samples_of(values, 4),
               even = samples_of(values, 5);
    assert_true(isnan(bb_samples_median(&none)));
    assert_true(bb_samples_median(&one) == 100);
    assert_true(bb_samples_median(&odd) == 2);
    assert_true(bb_samples_median(&even) == 2.5);
}

static void of_one_sample_nothing_is_pretended(void **state)
{
    (void)state;
    const double values[] = {100, 3};
    bb_samples none = {0};
    bb_estimate e = bb_samples_estimate(&none);
    assert_true(isnan(e.value) && isnan(e.low) && isnan(e.high));
    assert_true(isnan(e.least) && isnan(e.most));
    for (uint32_t count = 1; count <= 2;
         count++) { /* the first round alone, and the one after it */
        bb_samples one = samples_of(values, count);
        e = bb_samples_estimate(&one);
        assert_true(e.value == values[count - 1]);
        assert_true(isnan(e.low) && isnan(e.high) && isnan(e.least) && isnan(e.most));
    }
}

static void few_samples_have_a_range_and_no_interval(void **state)
{
    (void)state;
    const double values[] = {1000, 5, 1, 4, 2, 3, 6};
    for (uint32_t rounds = 2; rounds <= 6; rounds++) {
        bb_samples samples = samples_of(values, rounds + 1);
        bb_estimate e = bb_samples_estimate(&samples);
        assert_true(e.least == 1 && e.most == (rounds < 6 ? 5 : 6));
        assert_true(isnan(e.low) == (rounds < BB_INTERVAL_ROUNDS));
        assert_true(isnan(e.high) == (rounds < BB_INTERVAL_ROUNDS));
    }
}

static void what_is_no_number_is_not_measured(void **state)
{
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        const double values[] = {9, 1, 2, 3, 4, bad[i], 5, 6}, first[] = {bad[i], 1, 2};
        bb_samples samples = samples_of(values, 8), unused = samples_of(first, 3);
        bb_estimate e = bb_samples_estimate(&samples);
        assert_true(isnan(e.value) && isnan(e.low) && isnan(e.high) && isnan(e.least));
        assert_true(bb_samples_median(&unused) == 1.5); /* the first round counts for nothing */
    }
}

/* ---- intervals ---- */

/* By hand, with the names of framework/base/statistics.c.
 * n = 6: d = 1, g(1) = 31/32, g(2) = 25/32, i = 1/10, s = 5/14.
 * n = 9: d = 2, g(2) = 246/256, g(3) = 210/256, i = (246 - 243.2)/36 = 7/90,
 *        s = 7 (7/90) / (2 + 5 (7/90)) = 49/215.
 * n = 20: d = 6, 2 P(B < 6) = 43400 / 2^20, C(20, 6) = 38760. */
static void intervals_are_those_computed_by_hand(void **state)
{
    (void)state;
    const double at_20 = (0.05 * 1048576 - 43400) / (2 * 38760);
    const struct {
        uint32_t n, d;
        double s;
    } cases[] = {{6, 1, 5.0 / 14}, {9, 2, 49.0 / 215}, {20, 6, 14 * at_20 / (6 + 8 * at_20)}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        uint32_t n = cases[c].n, d = cases[c].d;
        bb_samples samples = {0};
        bb_samples_add(&samples, 1e9);
        for (uint32_t i = 0; i < n; i++) /* squares, in an order that is not theirs */
            bb_samples_add(&samples, pow((i * 7) % n + 1, 2));
        bb_estimate e = bb_samples_estimate(&samples);
        near(e.low, pow(d, 2) + cases[c].s * (pow(d + 1, 2) - pow(d, 2)));
        near(e.high, pow(n + 1 - d, 2) - cases[c].s * (pow(n + 1 - d, 2) - pow(n - d, 2)));
    }
}

static void ties_give_an_interval_without_width(void **state)
{
    (void)state;
    const double equal[] = {9, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
    const double mostly[] = {9, 0.1, 0.3, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
    bb_samples samples = samples_of(equal, 8);
    bb_estimate e = bb_samples_estimate(&samples);
    assert_true(e.value == 0.1 && e.low == 0.1 && e.high == 0.1 && e.least == 0.1 && e.most == 0.1);
    samples = samples_of(mostly, 11);
    e = bb_samples_estimate(&samples);
    assert_true(e.value == 0.1 && e.low == 0.1 && e.high == 0.1 && e.most == 0.3);
}

/* For every number of rounds that there can be, whatever the samples' size. */
static void intervals_lie_in_the_range_around_the_median(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed(), 0);
    for (uint32_t n = BB_INTERVAL_ROUNDS; n < BB_SAMPLES_MAX; n++) {
        bb_samples samples = {0};
        bb_samples_add(&samples, -1);
        for (uint32_t i = 0; i < n; i++)
            bb_samples_add(&samples, exp(bb_random_range(&random, -300, 300)));
        bb_estimate e = bb_samples_estimate(&samples);
        if (!(e.least <= e.low && e.low <= e.value && e.value <= e.high && e.high <= e.most))
            fail_msg("seed %llu, %u rounds: %g <= %g <= %g <= %g <= %g", (unsigned long long)seed(),
                     n, e.least, e.low, e.value, e.high, e.most);
    }
}

/* ---- coverage ---- */

static double normal(bb_random *random)
{
    double radius = sqrt(-2 * log(1 - bb_random_unit(random)));
    return radius * cos(6.283185307179586 * bb_random_unit(random));
}

static double log_normal(bb_random *random)
{
    return exp(normal(random)) - 1;
}

static double uniform(bb_random *random)
{
    return bb_random_unit(random) - 0.5;
}

static double cauchy(bb_random *random)
{
    return tan(3.141592653589793 * uniform(random));
}

/* The one whose coverage the formula makes exact. */
static double double_exponential(bb_random *random)
{
    double distance = -log(1 - bb_random_unit(random));
    return bb_random_unit(random) < 0.5 ? distance : -distance;
}

/* All have the median 0. */
static const struct {
    const char *name;
    double (*draw)(bb_random *random);
} distributions[] = {{"normal", normal},
                     {"log-normal", log_normal},
                     {"uniform", uniform},
                     {"Cauchy", cauchy},
                     {"double exponential", double_exponential}};

enum { TRIALS = 20000, N_MAX = 30 };

static double coverage(double (*draw)(bb_random *), uint32_t n, bb_random *random)
{
    uint32_t covered = 0;
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        bb_samples samples = {.count = 1, .values = {1e6}}; /* the first round, left out */
        for (uint32_t i = 0; i < n; i++)
            bb_samples_add(&samples, draw(random));
        bb_estimate e = bb_samples_estimate(&samples);
        covered += e.low <= 0 && 0 <= e.high;
    }
    return (double)covered / TRIALS;
}

static void intervals_cover_the_median(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed(), 1);
    for (size_t k = 0; k < sizeof distributions / sizeof distributions[0]; k++) {
        double least = 1, most = 0;
        uint32_t least_n = 0, most_n = 0;
        for (uint32_t n = BB_INTERVAL_ROUNDS; n <= N_MAX; n++) {
            double share = coverage(distributions[k].draw, n, &random);
            if (share < least) {
                least = share;
                least_n = n;
            }
            if (share > most) {
                most = share;
                most_n = n;
            }
        }
        printf("%s: covered from %.2f %% (n = %u) to %.2f %% (n = %u)\n", distributions[k].name,
               100 * least, least_n, 100 * most, most_n);
        if (least < 0.93 || most > 0.99)
            fail_msg("seed %llu, %s: covered from %.4f (n = %u) to %.4f (n = %u)",
                     (unsigned long long)seed(), distributions[k].name, least, least_n, most,
                     most_n);
        /* a standard deviation of the share is 0.0015; this is five of them */
        if (distributions[k].draw == double_exponential)
            assert_true(fabs(least - 0.95) < 0.008 && fabs(most - 0.95) < 0.008);
    }
}

/* ---- ratios ---- */

static bb_estimate ratio_of(const bb_samples *a, const bb_samples *b)
{
    bb_samples ratios = bb_samples_ratio(a, b);
    return bb_samples_estimate(&ratios);
}

/* Noise that both share in a round is not in their ratio. */
static void ratio_pairs_the_rounds(void **state)
{
    (void)state;
    const double noise[] = {100, 1, 7, 2, 30, 1, 5}, more[] = {1, 2, 3};
    bb_samples a = {0}, b = {0};
    for (int i = 0; i < 7; i++) {
        bb_samples_add(&a, (i == 0 ? 9 : 1.25) * noise[i]);
        bb_samples_add(&b, noise[i]);
    }
    bb_estimate ratio = ratio_of(&a, &b);
    assert_true(ratio.value == 1.25 && ratio.low == 1.25 && ratio.high == 1.25);
    b = samples_of(more, 3);
    assert_true(isnan(ratio_of(&a, &b).value));
    a = samples_of(noise, 3);
    ratio = ratio_of(&a, &b);
    assert_true(ratio.least == 0.5 && isnan(ratio.low)); /* too few rounds for an interval */
    a = b = (bb_samples){0};
    assert_true(isnan(ratio_of(&a, &b).high));
    a = b = samples_of((const double[]){1, 0, 0}, 3); /* 0/0 */
    assert_true(isnan(ratio_of(&a, &b).value));
}

/* The machine is up to twice as slow in some rounds than in others, for both alike. */
static double ratio_coverage(uint32_t n, bb_random *random, double *width)
{
    uint32_t covered = 0;
    *width = 0;
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        bb_samples a = {.count = 1, .values = {7}}, b = {.count = 1, .values = {1}};
        for (uint32_t i = 0; i < n; i++) {
            double slow = bb_random_range(random, 1, 2);
            bb_samples_add(&a, slow * 1.25 * exp(0.05 * normal(random)));
            bb_samples_add(&b, slow * exp(0.05 * normal(random)));
        }
        bb_estimate e = ratio_of(&a, &b);
        covered += e.low <= 1.25 && 1.25 <= e.high;
        *width += (e.high - e.low) / TRIALS;
    }
    return (double)covered / TRIALS;
}

static void ratios_cover_theirs(void **state)
{
    (void)state;
    static const uint32_t rounds[] = {6, 15};
    bb_random random = bb_random_make(seed(), 2);
    for (int i = 0; i < 2; i++) {
        double width, share = ratio_coverage(rounds[i], &random, &width);
        printf("paired ratio of %u rounds: covered %.2f %%, mean width %.3f\n", rounds[i],
               100 * share, width);
        if (share < 0.93 || share > 0.99 || width > 0.25)
            fail_msg("seed %llu, ratio of %u rounds: covered %.4f, width %.3f",
                     (unsigned long long)seed(), rounds[i], share, width);
    }
}

/* ---- rates ---- */

static void none_found_is_at_most_three_of_n(void **state)
{
    (void)state;
    bb_wrong_rate rate = bb_wrong_rate_of(0, 16384);
    near(rate.ppm, 3e6 / 16384);
    near(rate.high, 3e6 / 16384);
    assert_true(rate.low == 0);
    /* nothing checked, nothing known */
    assert_true(isnan(bb_wrong_rate_of(0, 0).ppm));
    assert_true(isnan(bb_wrong_rate_of(0, NAN).high));
    assert_true(isnan(bb_wrong_rate_of(NAN, 100).ppm));
}

/* Exact Poisson bounds (Garwood 1936), as tabled. */
static void rates_have_the_interval_of_a_poisson_count(void **state)
{
    (void)state;
    static const struct {
        double k, low, high;
    } table[] = {
        {1, 0.0253, 5.572},  {2, 0.2422, 7.225},   {5, 1.623, 11.668},
        {10, 4.795, 18.390}, {100, 81.36, 121.63},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        bb_wrong_rate rate = bb_wrong_rate_of(table[i].k, 1e6);
        near(rate.ppm, table[i].k);
        assert_true(fabs(rate.low - table[i].low) < 0.02 * table[i].k);
        assert_true(fabs(rate.high - table[i].high) < 0.02 * table[i].high);
    }
    /* more wrong rays never look better, none best of all */
    for (double k = 0; k < 50; k++)
        assert_true(bb_wrong_rate_of(k, 1000).high < bb_wrong_rate_of(k + 1, 1000).high);
}

/* ---- selection ---- */

static int compare(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Random, with many equal, sorted both ways, and rising then falling. */
static float value_at(int kind, uint32_t i, uint32_t count, bb_random *random)
{
    switch (kind) {
    case 0:
        return (float)normal(random);
    case 1:
        return (float)bb_random_below(random, 3);
    case 2:
        return (float)i;
    case 3:
        return -(float)i;
    default:
        return (float)(i < count / 2 ? i : count - i);
    }
}

static void selection_is_as_sorting(void **state)
{
    (void)state;
    enum { LONGEST = 300 };
    float values[LONGEST], sorted[LONGEST], work[LONGEST];
    bb_random random = bb_random_make(seed(), 3);
    for (int kind = 0; kind < 5; kind++)
        for (uint32_t count = 1; count <= LONGEST; count = count < 8 ? count + 1 : count * 3 / 2) {
            for (uint32_t i = 0; i < count; i++)
                values[i] = sorted[i] = value_at(kind, i, count, &random);
            qsort(sorted, count, sizeof *sorted, compare);
            for (uint32_t rank = 0; rank < count; rank++) {
                memcpy(work, values, count * sizeof *work);
                if (bb_select(work, count, rank) != sorted[rank])
                    fail_msg("seed %llu, kind %d: not value %u of %u", (unsigned long long)seed(),
                             kind, rank, count);
                qsort(work, count, sizeof *work, compare); /* none is lost */
                assert_memory_equal(work, sorted, count * sizeof *work);
            }
        }
}

/* No order makes it quadratic: that would take minutes here. */
static void selection_takes_linear_time(void **state)
{
    (void)state;
    enum { COUNT = 2000000 };
    float *values = malloc(COUNT * sizeof *values);
    assert_non_null(values);
    for (int kind = 1; kind < 5; kind++) {
        bb_random random = bb_random_make(seed(), 4);
        for (uint32_t i = 0; i < COUNT; i++)
            values[i] = value_at(kind, i, COUNT, &random);
        float median = bb_select(values, COUNT, COUNT / 2 - 1);
        if (kind == 2)
            assert_true(median == COUNT / 2 - 1);
    }
    free(values);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(median_leaves_the_first_out),
        cmocka_unit_test(of_one_sample_nothing_is_pretended),
        cmocka_unit_test(few_samples_have_a_range_and_no_interval),
        cmocka_unit_test(what_is_no_number_is_not_measured),
        cmocka_unit_test(intervals_are_those_computed_by_hand),
        cmocka_unit_test(ties_give_an_interval_without_width),
        cmocka_unit_test(intervals_lie_in_the_range_around_the_median),
        cmocka_unit_test(intervals_cover_the_median),
        cmocka_unit_test(ratio_pairs_the_rounds),
        cmocka_unit_test(ratios_cover_theirs),
        cmocka_unit_test(none_found_is_at_most_three_of_n),
        cmocka_unit_test(rates_have_the_interval_of_a_poisson_count),
        cmocka_unit_test(selection_is_as_sorting),
        cmocka_unit_test(selection_takes_linear_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
