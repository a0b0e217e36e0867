/* Samples: median and bootstrap interval. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "framework/random.h"
#include "framework/record.h"

#include <math.h>

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(median_leaves_the_first_out),
        cmocka_unit_test(interval_of_few_samples_is_the_median),
        cmocka_unit_test(interval_covers_the_median),
        cmocka_unit_test(interval_is_reproducible),
        cmocka_unit_test(ratio_pairs_the_rounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
