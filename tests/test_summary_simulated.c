/* What is said of simulations in a result document (framework/compare/simulated.c). */
#include "tests/summary_fixture.h"

static const char *const simulated_names[] = {"simt:device=d,width=32",
                                              "simt:device=d,width=32,cache=2"};

static void put_simulated(bb_results *d, bb_entry *trace, size_t name, double bound,
                          const char *binds)
{
    bb_entry *part = bb_results_part(d, trace, simulated_names[name]);
    bb_put_number(part, BB_F_SIMT_RATE, bound);
    bb_put_text(part, BB_F_SIMT_BINDS, binds);
}

/* Three builders, from the fastest to the slowest, with two kernels on two ray sets. By the first
 * simulation they have the same ranks with their better kernels; by the second the last two change
 * places. */
static bb_results *simulated_builders(void)
{
    static const struct {
        const char *builder;
        double ms, bounds[2][2];
    } builders[] = {{"x", 100, {{10, 40}, {40, 10}}},
                    {"y", 200, {{30, 5}, {20, 5}}},
                    {"z", 300, {{20, 8}, {30, 8}}}};
    static const char *const rays[] = {"random", "ao"};
    bb_results *d = empty_document();
    add_scene(d, "a", 1e6);
    for (int b = 0; b < 3; b++) {
        add_build(d, "a", builders[b].builder, 10, false);
        for (int set = 0; set < 2; set++)
            for (int k = 0; k < 2; k++) {
                const traced t = {.scene = "a",
                                  .builder = builders[b].builder,
                                  .rays = rays[set],
                                  .kernel = k == 0 ? "stack" : "short",
                                  .intersector = "exact",
                                  .ms = builders[b].ms * (1 + k),
                                  .spread = 0.001};
                bb_entry *trace = add_trace(d, &t);
                put_simulated(d, trace, 0, builders[b].bounds[0][k] * (set == 0 ? 4 : 1), "issue");
                put_simulated(d, trace, 1, builders[b].bounds[1][k], b == 2 ? "L2" : "memory");
            }
    }
    return d;
}

static void simulations_are_said_beside_what_was_measured(void **state)
{
    (void)state;
    bb_summary s;
    bb_results *d = simulated_builders();
    assert_int_equal(bb_summary_make(d, &(bb_summary_choice){NULL, NULL}, &s), BB_OK);
    assert_int_equal(s.simulation_count, 2);
    const bb_summary_simulation *first = &s.simulations[0], *second = &s.simulations[1];
    const size_t x = (size_t)(row_of(&s, "x") - s.rows), y = (size_t)(row_of(&s, "y") - s.rows);
    assert_int_equal(first->sets, 2);
    assert_near(first->mrays_s[x], 80); /* the mean of 160 and 40, by the better kernel */
    assert_near(first->mrays_s[y], 60);
    assert_near(second->mrays_s[x], 40);
    assert_near(first->correlation, 1);
    assert_near(first->stability, 1);
    assert_near(second->correlation, 1.0 / 3);
    assert_near(second->stability, 1.0 / 3);
    const size_t z = (size_t)(row_of(&s, "z") - s.rows);
    assert_int_equal(first->binds[x], BB_BY_ISSUE);
    assert_int_equal(second->binds[x], BB_BY_MEMORY);
    assert_int_equal(second->binds[z], BB_BY_SECOND);
    /* ranks are of what was measured */
    assert_int_equal(x, 0);
    assert_int_equal(row_of(&s, "y")->group, 1);
    expect_words(&s, "Simulated",
                 "neither measured nor validated, device=d,width=32: x 80.0 Mrays/s, bound by "
                 "issue most often");
    expect_words(&s, "Simulated", "y 0.75x");
    const char *last = s.sentences[s.sentence_count - 1].text;
    assert_non_null(strstr(last, "agree with those of device=d,width=32 by 0.33"));
    assert_non_null(strstr(last, "y (memory) behind z (L2)"));
    bb_summary_free(&s);

    /* of one kind of rays, only these */
    assert_int_equal(bb_summary_make(d, &(bb_summary_choice){NULL, "ao"}, &s), BB_OK);
    assert_int_equal(s.simulations[0].sets, 1);
    assert_near(s.simulations[0].mrays_s[x], 40);
    bb_summary_free(&s);
    bb_results_destroy(d);
}

/* Who lacks a ray set has no figure; nothing is said where nothing was simulated. */
static void simulations_that_lack_sets_have_no_mean(void **state)
{
    (void)state;
    bb_summary s;
    bb_results *d = simulated_builders();
    add_build(d, "a", "w", 10, false);
    for (int set = 0; set < 2; set++) {
        const traced t = {.scene = "a",
                          .builder = "w",
                          .rays = set == 0 ? "random" : "ao",
                          .kernel = "stack",
                          .intersector = "exact",
                          .ms = 50,
                          .spread = 0.001};
        bb_entry *trace = add_trace(d, &t);
        if (set == 0)
            put_simulated(d, trace, 0, 1e6, "issue");
    }
    assert_int_equal(bb_summary_make(d, &(bb_summary_choice){NULL, NULL}, &s), BB_OK);
    const size_t w = (size_t)(row_of(&s, "w") - s.rows);
    assert_true(isnan(s.simulations[0].mrays_s[w]) && isnan(s.simulations[1].mrays_s[w]));
    expect_words(&s, "Simulated", "x 80.0 Mrays/s, bound by issue most often");
    bb_summary_free(&s);
    bb_results_destroy(d);
    d = three_builders();
    assert_int_equal(bb_summary_make(d, &(bb_summary_choice){NULL, NULL}, &s), BB_OK);
    assert_int_equal(s.simulation_count, 0);
    assert_string_equal(sentence_of(&s, "Simulated"), "");
    bb_summary_free(&s);
    bb_results_destroy(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(simulations_are_said_beside_what_was_measured),
        cmocka_unit_test(simulations_that_lack_sets_have_no_mean),
    };
    return cmocka_run_group_tests_name("summary_simulated", tests, NULL, NULL);
}
