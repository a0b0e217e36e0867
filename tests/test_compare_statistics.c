/* The comparison's statistics, by simulation: how often the interval of a ratio of medians covers
 * the true one; how often equals raise an alarm; what planted changes are found. */
#include "tests/fixture.h"

#include "framework/base/random.h"
#include "framework/compare/compare.h"
#include "framework/compare/family.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double normal(bb_random *random)
{
    double u = 1 - bb_random_unit(random), v = bb_random_unit(random);
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

/* ---- times of a program whose true median is 1 ---- */

typedef double draw_fn(bb_random *random);

static double draw_normal(bb_random *random)
{
    return exp(0.02 * normal(random));
}

/* Nothing is faster than the machine; what disturbs it makes it slower. */
static double draw_skewed(bb_random *random)
{
    return 1 + 0.03 * (-log(1 - bb_random_unit(random)) - 0.6931471805599453);
}

/* Student's t of 2 degrees of freedom. */
static double draw_heavy(bb_random *random)
{
    double chi = -2 * log(1 - bb_random_unit(random));
    return exp(0.01 * normal(random) / sqrt(chi / 2));
}

/* Mostly quiet, now and then somebody else has the processor. */
static double draw_spikes(bb_random *random)
{
    double wait = bb_random_unit(random) < 0.1 ? 0.5 * bb_random_unit(random) : 0;
    return exp(0.01 * normal(random)) + wait;
}

static double draw_uniform(bb_random *random)
{
    return bb_random_range(random, 0.9, 1.1);
}

static double median_of(draw_fn *draw)
{
    if (draw != draw_spikes)
        return 1;
    static double found; /* by simulation: a tenth of the values is larger */
    bb_random random = bb_random_make(99, 0);
    enum { MANY = 200000 };
    static float values[MANY];
    if (found == 0) {
        for (int i = 0; i < MANY; i++)
            values[i] = (float)draw(&random);
        found = (double)bb_select(values, MANY, MANY / 2);
    }
    return found;
}

static bb_samples draw_rounds(draw_fn *draw, double factor, uint32_t rounds, bb_random *random)
{
    bb_samples ms = {0};
    bb_samples_add(&ms, 9); /* does not count */
    for (uint32_t i = 0; i < rounds; i++)
        bb_samples_add(&ms, factor * draw(random));
    return ms;
}

static void intervals_of_ratios_cover(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        draw_fn *before, *after;
    } cases[] = {
        {"normal", draw_normal, draw_normal},
        {"skewed", draw_skewed, draw_skewed},
        {"heavy", draw_heavy, draw_heavy},
        {"spikes", draw_spikes, draw_spikes},
        {"uniform", draw_uniform, draw_uniform},
        {"normal, skewed", draw_normal, draw_skewed},
        {"heavy, uniform", draw_heavy, draw_uniform},
    };
    static const uint32_t rounds[][2] = {{6, 6}, {7, 7}, {10, 10}, {20, 20}, {30, 30}, {6, 20}};
    enum { TRIALS = 20000 };
    const uint64_t seed = seed_or(7);
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
        for (size_t r = 0; r < sizeof rounds / sizeof rounds[0]; r++) {
            bb_random random = bb_random_make(seed, c * 100 + r);
            const double factor = 1.37;
            double truth = factor * median_of(cases[c].after) / median_of(cases[c].before);
            uint32_t covered = 0, one = 0;
            for (int i = 0; i < TRIALS; i++) {
                bb_samples a = draw_rounds(cases[c].before, 1, rounds[r][0], &random);
                bb_samples b = draw_rounds(cases[c].after, factor, rounds[r][1], &random);
                bb_effect e = bb_effect_of_runs(&a, &b);
                covered += e.low <= truth && truth <= e.high;
                one += bb_effect_excludes_one(&e);
                assert_true(e.low <= e.ratio && e.ratio <= e.high);
            }
            double share = (double)covered / TRIALS;
            if (share < 0.945 || share > 0.99)
                fail_msg("%s, %u and %u rounds: %.2f %% of the intervals cover (seed %llu)",
                         cases[c].name, rounds[r][0], rounds[r][1], 100 * share,
                         (unsigned long long)seed);
            print_message("%-15s %2u %2u rounds: %.2f %%\n", cases[c].name, rounds[r][0],
                          rounds[r][1], 100 * share);
            assert_true(one > TRIALS / 2); /* and are no wider than they need to be */
        }
}

/* Of pairs: what both share in a pair is in neither ratio. */
static void intervals_of_pairs_cover(void **state)
{
    (void)state;
    static draw_fn *const draws[] = {draw_normal, draw_skewed, draw_heavy, draw_spikes};
    static const uint32_t pairs[] = {7, 10, 20, 30};
    enum { TRIALS = 20000 };
    for (size_t d = 0; d < sizeof draws / sizeof draws[0]; d++)
        for (size_t r = 0; r < sizeof pairs / sizeof pairs[0]; r++) {
            bb_random random = bb_random_make(seed_or(11), d * 10 + r);
            uint32_t covered = 0;
            for (int i = 0; i < TRIALS; i++) {
                bb_samples ratios = {0};
                bb_samples_add(&ratios, 5);
                for (uint32_t k = 0; k < pairs[r]; k++)
                    bb_samples_add(&ratios, 1.05 * draws[d](&random) / draws[d](&random));
                bb_effect e = bb_effect_of_pairs(&ratios);
                covered += e.low <= 1.05 && 1.05 <= e.high;
            }
            if (covered < 0.94 * TRIALS || covered > 0.965 * TRIALS)
                fail_msg("%zu, %u pairs: %.2f %%", d, pairs[r], 100.0 * covered / TRIALS);
        }
}

static void too_few_rounds_have_no_interval(void **state)
{
    (void)state;
    bb_random random = bb_random_make(1, 0);
    bb_samples five = draw_rounds(draw_normal, 1, 5, &random), six = five, none = {0};
    bb_samples_add(&six, 1);
    bb_effect e = bb_effect_of_runs(&five, &six);
    assert_true(isfinite(e.ratio) && isnan(e.low) && isnan(e.high) && !bb_effect_excludes_one(&e));
    e = bb_effect_of_runs(&none, &six);
    assert_true(isnan(e.ratio));
    six.values[3] = 0;
    e = bb_effect_of_runs(&six, &six);
    assert_true(isnan(e.ratio));
    assert_int_equal(bb_family_pairs_needed(0.002), 9);
    assert_int_equal(bb_family_pairs_needed(BB_COMPARE_LEVEL), 7);
}

/* ---- whole comparisons on made-up runs ---- */

enum { CELLS = 100, ROUNDS = 6 };

typedef struct noise {
    double round, shared, run; /* of each time, of all cells in a round, of a cell in a run */
    bool heavy;
    double burst; /* how often another takes some of a run's rounds, most of their time */
} noise;

/* A machine on which rounds have heavy tails and share some of them, and a cell is a bit faster or
 * slower all through one run. Cells differ in how noisy they are. */
static const noise usual = {0.012, 0.01, 0.004, true, 0};
/* One on which others work, too: in half of the runs, some rounds are up to twice as long. */
static const noise busy = {0.012, 0.01, 0.004, true, 0.5};

static void make_run(bb_cell_set *set, const noise *n, double slow, uint32_t slow_cells, double sah,
                     bb_random *random)
{
    double shared[ROUNDS + 1];
    memset(set, 0, sizeof *set);
    snprintf(set->origin.what, sizeof set->origin.what, "made up");
    for (uint32_t k = 0; k <= ROUNDS; k++)
        shared[k] = n->shared * fabs(log(draw_heavy(random)) * 100);
    if (bb_random_unit(random) < n->burst) {
        uint32_t from = bb_random_below(random, ROUNDS), to = from + bb_random_below(random, 5);
        for (uint32_t k = from; k <= to && k <= ROUNDS; k++)
            shared[k] += bb_random_range(random, 0.1, 0.7);
    }
    for (uint32_t i = 0; i < CELLS; i++) {
        char key[64];
        bb_measured *cell;
        snprintf(key, sizeof key, "scene=s%u/builder=b%u/kernel=k%u", i / 20, i % 20, i);
        ASSERT_OK(bb_cell_set_add(set, key, &cell));
        strcpy(cell->time, "trace ms");
        strcpy(cell->status, "ok");
        strcpy(cell->rays_hash, "1");
        double own = exp(n->run * normal(random)) * (i < slow_cells ? slow : 1);
        double loud = 0.5 + 1.5 * (i % 10) / 9.0;
        for (uint32_t k = 0; k <= ROUNDS; k++) {
            double tail = n->heavy ? log(draw_heavy(random)) * 100 : normal(random);
            bb_samples_add(&cell->ms,
                           (1 + i) * own * exp(shared[k] + loud * n->round * fabs(tail)));
        }
        ASSERT_OK(bb_measured_add_figure(cell, "sah", BB_BETTER_LESS, 50 * (i == 7 ? sah : 1)));
    }
    bb_cell_set_sort(set);
}

typedef struct found {
    uint32_t slower, right, sah;
} found;

/* Pairs of runs, the first of which does not count; or, with one, two runs and a floor. */
static found compare_made_up(const noise *n, uint32_t pairs, double slow, uint32_t slow_cells,
                             double sah, const bb_floor *floor, bb_random *random)
{
    static bb_cell_set sets[2][40];
    found f = {0, 0, 0};
    for (uint32_t i = 0; i < pairs; i++) {
        make_run(&sets[0][i], n, 1, 0, 1, random);
        make_run(&sets[1][i], n, slow, slow_cells, sah, random);
    }
    bb_comparison_result result;
    ASSERT_OK(
        bb_compare(&(bb_side){sets[0], pairs}, &(bb_side){sets[1], pairs}, NAN, floor, &result));
    assert_int_equal(result.common, CELLS);
    assert_int_equal(result.timed, CELLS);
    for (uint32_t i = 0; i < result.move_count; i++) {
        const bb_change *m = &result.moves[i];
        f.slower += m->timed && m->verdict == BB_WORSE;
        f.right += m->timed && m->verdict == BB_WORSE &&
                   strtoul(strstr(m->after->key, "kernel=k") + 8, NULL, 10) < slow_cells;
        f.sah += strcmp(m->what, "sah") == 0 && m->verdict == BB_WORSE;
    }
    bb_compare_free(&result);
    for (uint32_t i = 0; i < pairs; i++) {
        bb_cell_set_free(&sets[0][i]);
        bb_cell_set_free(&sets[1][i]);
    }
    return f;
}

/* What is known of a machine from runs of one program: the floor for comparing two runs. */
static bb_floor made_up_floor(bb_random *random)
{
    bb_cell_set sets[11];
    bb_floor floor = BB_NO_FLOOR;
    for (uint32_t i = 0; i < 11; i++)
        make_run(&sets[i], &usual, 1, 0, 1, random);
    ASSERT_OK(bb_floor_take_runs(&floor, &(bb_side){sets, 11}, 1));
    bb_floor_finish_runs(&floor);
    for (uint32_t i = 0; i < 11; i++)
        bb_cell_set_free(&sets[i]);
    return floor;
}

/* A hundred comparisons of equals, of a hundred cells each: in at most 1 % of them anything is
 * called slower, but for chance (more than 5 would be one such test in 2000). So in ten of them at
 * most one cell in a hundred is. */
static void equals_raise_no_alarms(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        const noise *noise;
        uint32_t pairs;
    } cases[] = {{"pairs", &usual, 11}, {"busy, pairs", &busy, 11}, {"runs", &usual, 1}};
    for (uint32_t way = 0; way < sizeof cases / sizeof cases[0]; way++) {
        bb_random random = bb_random_make(seed_or(3), way);
        bb_floor floor = made_up_floor(&random);
        uint32_t comparisons = 0;
        for (uint32_t ten = 0; ten < 10; ten++) {
            uint32_t alarms = 0;
            for (uint32_t i = 0; i < 10; i++) {
                uint32_t slower =
                    compare_made_up(cases[way].noise, cases[way].pairs, 1, 0, 1, &floor, &random)
                        .slower;
                comparisons += slower > 0;
                alarms += slower;
            }
            assert_true(alarms <= 10 * CELLS / 100);
        }
        print_message("%s: an alarm in %u of 100 comparisons; floor of runs %.2f %%\n",
                      cases[way].name, comparisons, 100 * floor.share);
        assert_true(comparisons <= 5);
        bb_floor_free(&floor);
    }
}

static double noise_of_two(bb_random *random)
{
    double first = log(draw_heavy(random));
    return first - log(draw_heavy(random));
}

/* p-values by themselves: any of a hundred cells is below a level as often as the level says. */
static void adjusted_p_values_hold(void **state)
{
    (void)state;
    enum { TRIALS = 400, PAIRS = 9 };
    const double level = 0.05;
    static bb_family_row rows[CELLS];
    bb_random random = bb_random_make(seed_or(21), 0);
    for (int way = 0; way < 2; way++) {
        uint32_t alarms = 0;
        for (int t = 0; t < TRIALS; t++) {
            double shared[2 * PAIRS];
            memset(rows, 0, sizeof rows);
            for (int k = 0; k < 2 * PAIRS; k++)
                shared[k] = noise_of_two(&random);
            bool any = false;
            for (int i = 0; i < CELLS; i++)
                for (int k = 0; k < PAIRS; k++) {
                    bb_samples_add(&rows[i].before, noise_of_two(&random) + shared[k]);
                    if (way == 1)
                        bb_samples_add(&rows[i].after, noise_of_two(&random) + shared[PAIRS + k]);
                }
            ASSERT_OK(way == 0 ? bb_family_of_pairs(rows, CELLS) : bb_family_of_runs(rows, CELLS));
            for (int i = 0; i < CELLS; i++)
                any = any || rows[i].p_up <= level;
            alarms += any;
        }
        print_message("%s: any of %d cells at 5 %%: %.1f %%\n", way == 0 ? "pairs" : "runs", CELLS,
                      100.0 * alarms / TRIALS);
        assert_true(alarms <= TRIALS * (level + 0.05) && alarms >= TRIALS * 0.01);
    }
}

/* A coarse clock: more than half of the values are one and the same, and the others count. */
static void times_that_tie_are_told_apart(void **state)
{
    (void)state;
    bb_family_row rows[2];
    memset(rows, 0, sizeof rows);
    for (int k = 0; k < 20; k++) {
        bb_samples_add(&rows[0].before, log(10));
        bb_samples_add(&rows[1].before, log(10));
        if (k < 8) {
            bb_samples_add(&rows[0].after, log(20));
            bb_samples_add(&rows[1].after, log(10));
        }
    }
    ASSERT_OK(bb_family_of_runs(rows, 2));
    assert_true(rows[0].p_up <= BB_COMPARE_LEVEL && rows[0].p_down > 0.5);
    assert_true(rows[1].p_up == 1 && rows[1].p_down == 1);
}

/* What the tests above rely on: without control, equals would raise alarms. */
static void intervals_alone_would(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed_or(5), 0);
    uint32_t excluded = 0;
    for (int t = 0; t < 10; t++) {
        bb_cell_set sets[2];
        make_run(&sets[0], &usual, 1, 0, 1, &random);
        make_run(&sets[1], &usual, 1, 0, 1, &random);
        for (uint32_t i = 0; i < CELLS; i++) {
            bb_effect e = bb_effect_of_runs(&sets[0].cells[i].ms, &sets[1].cells[i].ms);
            excluded += bb_effect_excludes_one(&e);
        }
        bb_cell_set_free(&sets[0]);
        bb_cell_set_free(&sets[1]);
    }
    assert_true(excluded > 5);
}

/* A slowdown of 5 % in one kernel of several, and one SAH that is 2 % worse. */
static void planted_changes_are_found(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        const noise *noise;
        uint32_t pairs, slow_cells;
    } cases[] = {{"usual", &usual, 11, 1},
                 {"usual", &usual, 11, 30},
                 {"busy", &busy, 21, 1},
                 {"busy", &busy, 21, 30}};
    bb_random random = bb_random_make(seed_or(13), 0);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        uint32_t found_any = 0, right = 0, wrong = 0;
        enum { TRIALS = 20 };
        for (int i = 0; i < TRIALS; i++) {
            found f = compare_made_up(cases[k].noise, cases[k].pairs, 1.05, cases[k].slow_cells,
                                      1.02, NULL, &random);
            found_any += f.right > 0;
            right += f.right;
            wrong += f.slower - f.right;
            assert_int_equal(f.sah, 1);
        }
        print_message("%s: 5 %% in %u cells: found in %u of %d, %.1f cells each, %u others\n",
                      cases[k].name, cases[k].slow_cells, found_any, TRIALS, (double)right / TRIALS,
                      wrong);
        /* at BB_COMPARE_LEVEL, 4 or more false ones in 20 are 4 in 100,000 */
        assert_true(found_any >= TRIALS - 1 && wrong <= 3);
    }
    /* of two runs by themselves, exact figures just as well */
    bb_floor floor = made_up_floor(&random);
    assert_int_equal(compare_made_up(&usual, 1, 1, 0, 1.02, &floor, &random).sah, 1);
    assert_int_equal(compare_made_up(&usual, 1, 1, 0, 1, &floor, &random).sah, 0);
    /* and a slowdown that is well above the floor */
    uint32_t many = compare_made_up(&usual, 1, 1.3, 30, 1, &floor, &random).right;
    print_message("30 %% in 30 cells of two runs: %u found\n", many);
    assert_true(many >= 20);
    bb_floor_free(&floor);
}

/* What is found among the others is the same with times of too few rounds, however wild they are,
 * as without. */
static void times_of_few_rounds_hide_nothing(void **state)
{
    (void)state;
    uint32_t slower[2] = {0, 0}, seen[2] = {0, 0};
    double least[2] = {0, 0};
    for (int few = 0; few < 2; few++) {
        bb_random random = bb_random_make(23, 0);
        bb_cell_set sets[2];
        bb_comparison_result result;
        for (int k = 0; k < 2; k++) {
            make_run(&sets[k], &usual, k == 0 ? 1 : 1.3, 30, 1, &random);
            for (uint32_t i = 0; i < CELLS; i += 2) {
                bb_samples *ms = &sets[k].cells[i].ms;
                ms->count = few * ROUNDS; /* one of them does not count */
                for (uint32_t r = 0; r < ms->count; r++)
                    ms->values[r] *= r % 2 == 0 ? 1 : 3;
            }
        }
        ASSERT_OK(bb_compare(&(bb_side){&sets[0], 1}, &(bb_side){&sets[1], 1}, 0.1, NULL, &result));
        for (uint32_t i = 0; i < result.move_count; i++)
            slower[few] += result.moves[i].timed && result.moves[i].verdict == BB_WORSE;
        for (uint32_t i = 0; i < result.sight_count; i++)
            if (isfinite(result.sights[i].least)) {
                seen[few]++;
                least[few] += result.sights[i].least;
            }
        bb_compare_free(&result);
        bb_cell_set_free(&sets[0]);
        bb_cell_set_free(&sets[1]);
    }
    assert_true(slower[0] > 5 && seen[0] > CELLS / 3);
    assert_int_equal(slower[0], slower[1]);
    assert_int_equal(seen[0], seen[1]);
    assert_float_equal(least[0], least[1], 1e-12);
}

/* One cell that doubles from run to run, and a reference that does: the others' floor stays. */
static void one_cell_sets_no_floor(void **state)
{
    (void)state;
    bb_random random = bb_random_make(17, 0);
    bb_cell_set sets[2];
    bb_floor floor = BB_NO_FLOOR;
    make_run(&sets[0], &usual, 1, 0, 1, &random);
    make_run(&sets[1], &usual, 2, 1, 1, &random);
    const char *slow = "scene=s0/builder=b0/kernel=k0",
               *reference = "scene=s0/builder=b1/kernel=k1";
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < CELLS; i++) {
            bb_measured *cell = &sets[k].cells[i];
            cell->reference = strcmp(cell->key, reference) == 0;
            for (uint32_t r = 0; r < cell->ms.count && cell->reference; r++)
                cell->ms.values[r] *= k == 0 ? 1 : 3;
        }
    ASSERT_OK(bb_floor_take_runs(&floor, &(bb_side){sets, 2}, 0));
    bb_floor_finish_runs(&floor);
    assert_int_equal(floor.cells, CELLS - 1);
    assert_true(floor.share >= BB_COMPARE_FLOOR_LEAST && floor.share < 0.1);
    assert_true(bb_floor_own(&floor, slow) > 0.8);
    assert_true(isnan(bb_floor_own(&floor, reference)));
    /* with that floor, the same once more is nothing new */
    bb_comparison_result result;
    ASSERT_OK(bb_compare(&(bb_side){&sets[0], 1}, &(bb_side){&sets[1], 1}, NAN, &floor, &result));
    for (uint32_t i = 0; i < result.move_count; i++)
        assert_false(result.moves[i].timed && result.moves[i].counts);
    bb_compare_free(&result);
    bb_floor_free(&floor);
    bb_cell_set_free(&sets[0]);
    bb_cell_set_free(&sets[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intervals_of_ratios_cover),
        cmocka_unit_test(intervals_of_pairs_cover),
        cmocka_unit_test(too_few_rounds_have_no_interval),
        cmocka_unit_test(equals_raise_no_alarms),
        cmocka_unit_test(adjusted_p_values_hold),
        cmocka_unit_test(times_that_tie_are_told_apart),
        cmocka_unit_test(intervals_alone_would),
        cmocka_unit_test(planted_changes_are_found),
        cmocka_unit_test(times_of_few_rounds_hide_nothing),
        cmocka_unit_test(one_cell_sets_no_floor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
