/* Simulations of several sets of rays, summed up, and as columns of a table. */
#include "framework/simulate/simulated_sets.h"
#include "framework/simulate/simulated_table.h"
#include "tests/fixture.h"

#include <math.h>

static bb_simulation simulation(double mrays_s, double issue, double efficiency, double steps)
{
    bb_simulation s = {.binds = BB_BY_ISSUE};
#define SIMT(id, member, name, unit, better, heading, help) s.member = 1;
#include "framework/simulate/simt_figures.h"
    s.mrays_s = mrays_s;
    s.issue_mrays_s = issue;
    s.efficiency = efficiency;
    s.steps = steps;
    s.rays = 32;
    return s;
}

static bool is_near(double a, double b)
{
    return fabs(a / b - 1) < 1e-12;
}

static void one_set_is_as_it_is(void **state)
{
    (void)state;
    bb_simulated_sets sets = {.count = 0};
    bb_simulation s = simulation(3, 7, 0.3, 11);
    s.node_efficiency = 0.1;
    s.binds = BB_BY_SECOND;
    bb_simulated_add(&sets, 1000, &s);
    const bb_simulation sum = bb_simulated_sum(&sets);
    assert_memory_equal(&sum, &s, sizeof s);
}

static void sets_are_traced_one_after_the_other(void **state)
{
    (void)state;
    bb_simulated_sets sets = {.count = 0};
    bb_simulation slow = simulation(2, 4, 0.5, 10), fast = simulation(10, 20, 1, 40);
    slow.binds = BB_BY_MEMORY;
    bb_simulated_add(&sets, 100, &slow);
    bb_simulated_add(&sets, 300, &fast);
    const bb_simulation sum = bb_simulated_sum(&sets);
    assert_true(is_near(sum.mrays_s, 400.0 / (100.0 / 2 + 300.0 / 10)));
    assert_true(is_near(sum.issue_mrays_s, 400.0 / (100.0 / 4 + 300.0 / 20)));
    /* 25 of 40 us at a half, 15 at all of the lanes */
    assert_true(is_near(sum.efficiency, (25 * 0.5 + 15 * 1) / 40));
    assert_true(is_near(sum.steps, (100.0 * 10 + 300.0 * 40) / 400));
    assert_true(is_near(sum.rays, 64));
    assert_int_equal(sum.binds, BB_BY_MEMORY);
    assert_true(isnan(sum.node_efficiency) && isnan(sum.l1_hits));
}

static void what_a_set_lacks_is_not_summed(void **state)
{
    (void)state;
    bb_simulated_sets sets = {.count = 0};
    assert_true(isnan(bb_simulated_sum(&sets).mrays_s));
    bb_simulation s = simulation(2, 4, 0.5, 10);
    bb_simulated_add(&sets, 100, &s);
    s.mrays_s = NAN;
    bb_simulated_add(&sets, 100, &s);
    assert_true(isnan(bb_simulated_sum(&sets).mrays_s));
    assert_true(is_near(bb_simulated_sum(&sets).steps, 10));
}

static void a_table_gives_them_back(void **state)
{
    (void)state;
    bb_table *table;
    bb_simulation s = simulation(0.1, 4, 1.0 / 3, 10), back;
    s.node_efficiency = NAN;
    s.binds = BB_BY_FIRST;
    ASSERT_OK(bb_table_create("test", &table));
    const uint32_t row = bb_table_row(table, (bb_cell){{[BB_SCENE] = "a"}});
    const uint32_t other = bb_table_row(table, (bb_cell){{[BB_SCENE] = "b"}});
    bb_simulated_put(table, row, &s);
    ASSERT_OK(bb_table_status(table));
    assert_true(bb_simulated_get(table, row, &back));
    assert_true(back.mrays_s == s.mrays_s && back.efficiency == s.efficiency &&
                back.rays == s.rays && back.binds == BB_BY_FIRST);
    assert_true(isnan(back.node_efficiency));
    assert_false(bb_simulated_get(table, other, &back));
    assert_int_equal(back.binds, BB_BINDINGS);
    bb_table_free(table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_set_is_as_it_is),
        cmocka_unit_test(sets_are_traced_one_after_the_other),
        cmocka_unit_test(what_a_set_lacks_is_not_summed),
        cmocka_unit_test(a_table_gives_them_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
