/* The least slowing that a comparison would have found: just above it is found, just below it is
 * not, whatever the noise, the rounds and the other cells. */
#include "tests/fixture.h"

#include "framework/base/random.h"
#include "framework/compare/compare.h"
#include "framework/compare/family.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CELLS = 12 };

static double normal(bb_random *random)
{
    double u = 1 - bb_random_unit(random), v = bb_random_unit(random);
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Logarithms whose median is 0. */
static bb_samples quiet(bb_random *random, uint32_t count, double spread)
{
    bb_samples samples = {0};
    double sorted[BB_SAMPLES_MAX];
    for (uint32_t i = 0; i < count; i++)
        bb_samples_add(&samples, spread * normal(random));
    memcpy(sorted, samples.values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, rising);
    const double middle =
        count % 2 ? sorted[count / 2] : 0.5 * (sorted[count / 2 - 1] + sorted[count / 2]);
    for (uint32_t i = 0; i < count; i++)
        samples.values[i] -= middle;
    return samples;
}

static void make_rows(bb_family_row *rows, bool pairs, uint32_t count, uint64_t seed)
{
    bb_random random = bb_random_make(seed, 0);
    for (uint32_t i = 0; i < CELLS; i++) {
        const double spread = 0.002 * (1 + i % 5);
        rows[i] = (bb_family_row){.before = quiet(&random, count, spread)};
        if (!pairs)
            rows[i].after = quiet(&random, count + i % 3, spread);
    }
}

static double p_of(const bb_family_row *from, bool pairs, uint32_t cell, double shift)
{
    bb_family_row rows[CELLS];
    memcpy(rows, from, sizeof rows);
    bb_samples *moved = pairs ? &rows[cell].before : &rows[cell].after;
    for (uint32_t k = 0; k < moved->count; k++)
        moved->values[k] += shift;
    ASSERT_OK(pairs ? bb_family_of_pairs(rows, CELLS) : bb_family_of_runs(rows, CELLS));
    return rows[cell].p_up;
}

/* A cell's own shift hardly changes the median spread of all. */
static void what_is_said_is_the_border(void **state)
{
    (void)state;
    static const struct {
        bool pairs;
        uint32_t rounds;
    } cases[] = {{true, 7}, {true, 10}, {true, 20}, {false, 6}, {false, 10}, {false, 30}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
        for (uint64_t seed = 1; seed <= 3; seed++) {
            bb_family_row rows[CELLS];
            double least[CELLS];
            make_rows(rows, cases[c].pairs, cases[c].rounds, seed);
            ASSERT_OK(bb_family_found(rows, CELLS, cases[c].pairs, BB_COMPARE_LEVEL, least));
            for (uint32_t i = 0; i < CELLS; i++) {
                const double above = p_of(rows, cases[c].pairs, i, 1.1 * least[i]);
                const double below = p_of(rows, cases[c].pairs, i, 0.8 * least[i]);
                if (!(least[i] > 1e-3 && least[i] < 0.2) || above > BB_COMPARE_LEVEL ||
                    below <= BB_COMPARE_LEVEL)
                    fail_msg("case %zu, seed %d, cell %u: %g, p %g above, %g below", c, (int)seed,
                             i, least[i], above, below);
            }
        }
}

static void a_change_that_is_there_hides_nothing(void **state)
{
    (void)state;
    bb_family_row rows[CELLS], moved[CELLS];
    double least[2][CELLS];
    make_rows(rows, true, 10, 5);
    memcpy(moved, rows, sizeof rows);
    for (uint32_t k = 0; k < moved[3].before.count; k++)
        moved[3].before.values[k] += 0.7;
    ASSERT_OK(bb_family_found(rows, CELLS, true, BB_COMPARE_LEVEL, least[0]));
    ASSERT_OK(bb_family_found(moved, CELLS, true, BB_COMPARE_LEVEL, least[1]));
    for (uint32_t i = 0; i < CELLS; i++)
        assert_true(fabs(log(least[0][i] / least[1][i])) < 0.02);
}

static void too_few_pairs_find_nothing(void **state)
{
    (void)state;
    bb_family_row rows[CELLS];
    double least[CELLS];
    make_rows(rows, true, bb_family_pairs_needed(BB_COMPARE_LEVEL) - 1, 1);
    ASSERT_OK(bb_family_found(rows, CELLS, true, BB_COMPARE_LEVEL, least));
    for (uint32_t i = 0; i < CELLS; i++)
        assert_true(isinf(least[i]));
    ASSERT_OK(bb_family_found(rows, 0, true, BB_COMPARE_LEVEL, least));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_said_is_the_border),
        cmocka_unit_test(a_change_that_is_there_hides_nothing),
        cmocka_unit_test(too_few_pairs_find_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
