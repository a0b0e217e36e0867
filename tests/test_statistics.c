/* Statistics: median and bootstrap interval, rates, selection. Seed: BVHBENCH_TEST_SEED. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "framework/random.h"
#include "framework/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint64_t seed(void)
{
    const char *text = getenv("BVHBENCH_TEST_SEED");
    return text != NULL ? strtoull(text, NULL, 10) : 1986;
}

static void near(double value, double expected)
{
    if (!(fabs(value - expected) <= 1e-12 * fabs(expected)))
        fail_msg("%.17g, expected %.17g", value, expected);
}

static double normal(bb_random *random)
{
    double radius = sqrt(-2 * log(1 - bb_random_unit(random)));
    return radius * cos(6.283185307179586 * bb_random_unit(random));
}

static bb_samples samples_of(const double *values, uint32_t count)
{
    bb_samples samples = {0};
    for (uint32_t i = 0; i < count; i++)
        bb_samples_add(&samples, values[i]);
    return samples;
}

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

static void interval_of_few_samples_is_the_median(void **state)
{
    (void)state;
    const double values[] = {100, 3};
    double low, high;
    bb_samples two = samples_of(values, 2), none = {0};
    bb_samples_interval(&two, 1, &low, &high);
    assert_true(low == 3 && high == 3);
    bb_samples_interval(&none, 1, &low, &high);
    assert_true(isnan(low) && isnan(high));
}

/* Of 95 % intervals from normal samples, nearly as many cover the true median; the bootstrap is a
 * little short for few samples. */
static void interval_covers_the_median(void **state)
{
    (void)state;
    enum { TRIALS = 400, SAMPLES = 21 };
    bb_random random = bb_random_make(3, 0);
    int covered = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        bb_samples samples = {0};
        bb_samples_add(&samples, 1e6); /* the first round, left out */
        for (int i = 0; i < SAMPLES; i++) {
            double sum = 0;
            for (int k = 0; k < 12; k++)
                sum += bb_random_unit(&random) - 0.5;
            bb_samples_add(&samples, 10 + sum);
        }
        double low, high, median = bb_samples_median(&samples);
        bb_samples_interval(&samples, (uint64_t)trial, &low, &high);
        assert_true(low <= median && median <= high && high - low < 4);
        covered += low <= 10 && 10 <= high;
    }
    if (covered < TRIALS * 0.90 || covered > TRIALS * 0.99)
        fail_msg("%d of %d intervals cover the median (seed 3)", covered, TRIALS);
}

static void interval_is_reproducible(void **state)
{
    (void)state;
    const double values[] = {9, 1, 2, 3, 4, 5, 6, 7, 8};
    bb_samples samples = samples_of(values, 9);
    double low[2], high[2];
    for (int i = 0; i < 2; i++)
        bb_samples_interval(&samples, 42, &low[i], &high[i]);
    assert_true(low[0] == low[1] && high[0] == high[1]);
    assert_true(low[0] >= 1 && low[0] < 4.5 && high[0] > 4.5 && high[0] <= 8);
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
    bb_estimate ratio = bb_samples_ratio(&a, &b, 1);
    assert_true(ratio.value == 1.25 && ratio.low == 1.25 && ratio.high == 1.25);
    b = samples_of(more, 3);
    assert_true(isnan(bb_samples_ratio(&a, &b, 1).value));
    a = b = (bb_samples){0};
    assert_true(isnan(bb_samples_ratio(&a, &b, 1).high));
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
        cmocka_unit_test(interval_of_few_samples_is_the_median),
        cmocka_unit_test(interval_covers_the_median),
        cmocka_unit_test(interval_is_reproducible),
        cmocka_unit_test(ratio_pairs_the_rounds),
        cmocka_unit_test(none_found_is_at_most_three_of_n),
        cmocka_unit_test(rates_have_the_interval_of_a_poisson_count),
        cmocka_unit_test(selection_is_as_sorting),
        cmocka_unit_test(selection_takes_linear_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
