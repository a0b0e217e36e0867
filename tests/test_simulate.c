/* Figures and bounds of simulated traces (framework/simulate/simulate.h), on steps made by hand. */
#include "framework/judge/queries.h"
#include "framework/simulate/costs.h"
#include "framework/simulate/simulate.h"
#include "tests/made_steps.h"

#include <math.h>
#include <stdio.h>

static bb_simt h100(void)
{
    bb_simt simts[BB_SIMT_MAX];
    uint32_t count;
    ASSERT_OK(bb_simts_parse((char *[]){"simt:device=h100"}, 1, simts, &count));
    return simts[0];
}

static bb_simulation simulate_kinds(const bb_simt *simt, const char *kernel, uint32_t kinds)
{
    bb_spec spec;
    bb_simulation simulation;
    bb_traverser_request request = {
        .spec = &spec, .intersector = &bb_intersectors[0], .query = &bb_query_closest};
    const bb_layout_data layout = {.lanes = 1, .kinds = kinds};
    ASSERT_OK(bb_kernel_parse(kernel, &spec, &request.kernel));
    ASSERT_OK(bb_simulate(simt, &request, &layout, &made, &simulation));
    return simulation;
}

static bb_simulation simulate_kernel(const bb_simt *simt, const char *kernel)
{
    return simulate_kinds(simt, kernel, BB_TRIANGLES);
}

static bb_simulation simulate(const bb_simt *simt)
{
    return simulate_kernel(simt, "stack");
}

/* Returns the reads of the second cache by 8 groups of a set. All rays read the same node, which
 * each unit fetches once. */
static uint64_t fetched(uint32_t units, uint32_t set_rays)
{
    bb_simt simt = h100();
    simt.device.units = units;
    simt.device.groups = 1;
    no_rays();
    add_rays(8 * 32, "N7");
    made.set_rays = set_rays;
    return simulate(&simt).traffic.second;
}

/* A set fills as many units as get four groups each. */
static void a_sample_has_its_share_of_the_units(void **state)
{
    (void)state;
    const uint64_t one = fetched(1, 8 * 32), two = fetched(2, 8 * 32);
    assert_true(one < two);
    assert_true(fetched(4, 8 * 32) == two);  /* as many as are filled */
    assert_true(fetched(4, 16 * 32) == two); /* half of four */
    assert_true(fetched(4, 32 * 32) == one); /* a quarter of four */
    assert_true(fetched(4, 64 * 32) == one); /* an eighth */
}

/* Nobody knows the instructions and registers of a ray: there is no bound by these, nor a least
 * one. */
static void packets_are_bounded_by_traffic_alone(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    no_rays();
    add_rays(16, "J1-1N5B5B5+1-1P3");
    add_rays(16, "J1-0N5B5B5+1-1P3");
    const bb_simulation s = simulate_kernel(&simt, "packet8");
    assert_true(isnan(s.mrays_s) && isnan(s.issue_mrays_s) && isnan(s.efficiency));
    assert_true(s.memory_mrays_s > 0 && isfinite(s.memory_mrays_s));
    assert_true(s.l1_mrays_s > 0 && s.l2_mrays_s > 0);
    assert_true(s.node_efficiency == 0.5 && s.prim_efficiency == 1.0);
    assert_true(s.steps == 7); /* pop, node, two boxes, push, pop, primitive */
    assert_true(s.in_flight == simt.device.groups);
}

/* A search in a region has instructions of its own: a node more of them takes as much more time as
 * the table's row says, whichever the search. */
static void regions_have_costs_of_their_own(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    double us[2][2], more[2];
    bb_costs costs;
    bb_simulated_code code = {.program = "slice_tets/skip",
                              .kernel = "slice_tets",
                              .footing = {.control = BB_IF_ELSE,
                                          .group = 32,
                                          .node_bytes = 32,
                                          .prim_bytes = 52,
                                          .result_bytes = 12}};
    ASSERT_OK(bb_costs_find(code.program, code.kernel, simt.device.code, &costs));
    for (int in_region = 0; in_region < 2; in_region++) {
        code.footing.in_region = in_region;
        for (int nodes = 0; nodes < 2; nodes++) {
            bb_simulation s;
            no_rays();
            add_rays(64, nodes ? "N1N1P1" : "N1P1");
            ASSERT_OK(bb_simulate_code(&simt, &code, &made, &s));
            us[in_region][nodes] = 64 / s.issue_mrays_s;
            assert_true(s.efficiency == 1);
        }
        more[in_region] = us[in_region][1] - us[in_region][0];
    }
    assert_true(costs.in_regions[BB_STEP_EXACT] > costs.in_regions[BB_STEP_PRIMS]);
    assert_true(costs.in_regions[BB_STEP_FURTHER] > costs.in_regions[BB_STEP_PRIMS]);
    assert_true(costs.in_regions[BB_STEP_NODE] != costs.instructions[BB_STEP_NODE]);
    ASSERT_NEAR(more[0] / more[1],
                costs.instructions[BB_STEP_NODE] / costs.in_regions[BB_STEP_NODE], 1e-9);
}

/* An exact test is the same code, by whatever search it is reached; a search without the boundary
 * has code of its own. */
static void exact_tests_cost_the_same_in_all_searches(void **state)
{
    (void)state;
    static const char *const kernels[] = {"slice_tets", "overlap_tets"}, *const ways[] = {
                                                                             "skip",
                                                                             "all",
                                                                             "octree",
                                                                             "octree:boundary=no",
                                                                             "olbvh",
                                                                             "olbvh:boundary=no"};
    enum { WAYS = sizeof ways / sizeof ways[0] };
    for (int k = 0; k < 2; k++) {
        bb_costs costs[WAYS];
        for (int i = 0; i < WAYS; i++) {
            char program[64];
            snprintf(program, sizeof program, "%s/%s", kernels[k], ways[i]);
            ASSERT_OK(bb_costs_find(program, kernels[k], "gfx1030", &costs[i]));
            for (uint32_t kind = BB_STEP_EXACT; kind <= BB_STEP_FURTHER; kind++)
                assert_true(costs[i].in_regions[kind] == costs[0].in_regions[kind]);
        }
        assert_memory_not_equal(&costs[2], &costs[3], sizeof costs[2]);
        assert_memory_not_equal(&costs[4], &costs[5], sizeof costs[4]);
    }
}

/* Costs are those of the row that has most of a kernel's options, and no others. */
static void costs_are_those_of_the_options(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    no_rays();
    add_rays(64, "N1+N2P3-P4");
    const double octant = simulate_kernel(&simt, "stack8q:order=octant").issue_mrays_s;
    assert_true(octant > 0);
    assert_true(simulate_kernel(&simt, "stack8q:order=octant,stack=64").issue_mrays_s == octant);
    assert_true(simulate_kernel(&simt, "stack8q:stack=64").issue_mrays_s ==
                simulate_kernel(&simt, "stack8q").issue_mrays_s);
    assert_true(simulate_kernel(&simt, "stack8q").issue_mrays_s != octant);
    assert_true(simulate_kernel(&simt, "stack8q:order=octant,leaf=4").issue_mrays_s != octant);
}

/* Lanes without a ray are no steps of those that there are. */
static void steps_are_those_of_the_group(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    no_rays();
    add_ray("NNP");
    assert_true(simulate_kernel(&simt, "stack").steps == 3);
    add_ray("NN");
    assert_true(simulate_kernel(&simt, "stack:group=1").steps == 2.5);
}

/* Spheres have code of their own, whose exact test is longer. */
static void costs_are_those_of_the_primitives(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    no_rays();
    add_rays(64, "N1P1P2P3P4P5P6");
    const double spheres = simulate_kinds(&simt, "stackless", BB_SPHERES).issue_mrays_s;
    assert_true(spheres > 0 && isfinite(spheres));
    assert_true(spheres < simulate_kernel(&simt, "stackless").issue_mrays_s);
}

/* Nobody's code is taken for that of boxes; work-groups that tear runs of a sample apart, or are
 * larger than any GPU's, are refused. */
static void what_is_not_known_has_no_bound(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    const bb_layout_data boxes = {.lanes = 1, .kinds = BB_AABBS};
    bb_spec spec;
    bb_traverser_request request = {
        .spec = &spec, .intersector = &bb_intersectors[0], .query = &bb_query_closest};
    bb_simulation s;
    no_rays();
    add_rays(64, "N1P3");
    ASSERT_OK(bb_kernel_parse("stack", &spec, &request.kernel));
    ASSERT_OK(bb_simulate(&simt, &request, &boxes, &made, &s));
    assert_true(isnan(s.mrays_s) && isnan(s.issue_mrays_s) && s.l2_mrays_s > 0);
    static const char *const torn[] = {"stack:group=33", "stack:group=65536", "stack:group=96"};
    for (int i = 0; i < 3; i++) {
        ASSERT_OK(bb_kernel_parse(torn[i], &spec, &request.kernel));
        assert_int_equal(bb_simulate(&simt, &request, &boxes, &made, &s), BB_UNSUPPORTED);
    }
}

static void bounds_are_those_of_the_device(void **state)
{
    (void)state;
    char *const metrics[] = {"sah", "simt:device=h100"};
    bb_simt simts[BB_SIMT_MAX];
    uint32_t count;
    no_rays();
    for (uint32_t i = 0; i < 200; i++) {
        char steps[64];
        snprintf(steps, sizeof steps, "N%u+N%uP%u-P%u", 3 * i, 5 * i, i, 7 * i);
        add_ray(steps);
    }
    ASSERT_OK(bb_simts_parse(metrics, 2, simts, &count));
    assert_int_equal(count, 1);
    const bb_simt simt = simts[0];
    assert_string_equal(simt.name, "simt:device=h100,width=32");
    const bb_simulation s = simulate(&simt);
    const bb_traffic *t = &s.traffic;
    const double clock = simt.device.clock_ghz * 1e9;
    assert_true(fabs(s.memory_mrays_s * 1e6 * (double)(t->read + t->written) * 32 / 200 /
                         (simt.device.memory_gb_s * 1e9) -
                     1) < 1e-12);
    assert_true(fabs(s.l1_mrays_s * 1e6 * (double)t->first * 32 / 200 /
                         (simt.device.units * simt.device.first_bytes_per_clock * clock) -
                     1) < 1e-12);
    assert_true(fabs(s.l2_mrays_s * 1e6 * (double)(t->second + t->second_written) * 32 / 200 /
                         (simt.device.second_bytes_per_clock * clock) -
                     1) < 1e-12);
    assert_true(s.mrays_s <= s.issue_mrays_s && s.mrays_s <= s.l1_mrays_s &&
                s.mrays_s <= s.l2_mrays_s && s.mrays_s <= s.memory_mrays_s);
    assert_true(s.efficiency > 0 && s.efficiency <= 1);
    assert_true(fabs(s.memory_bytes - (double)(t->read + t->written) * 32 / 200) < 1e-9);

    /* half the units, issues, or clock: half the bound; groups of 64 lanes on 32 take two turns */
    bb_simt other = simt;
    other.device.units /= 2;
    assert_true(simulate(&other).issue_mrays_s * 2 == s.issue_mrays_s);
    assert_true(simulate(&other).l1_mrays_s * 2 == s.l1_mrays_s);
    assert_true(simulate(&other).memory_mrays_s == s.memory_mrays_s);
    other = simt;
    other.device.lanes = 16;
    assert_true(simulate(&other).issue_mrays_s * 2 == s.issue_mrays_s);
    other = simt;
    other.device.memory_gb_s = 1;
    assert_int_equal(simulate(&other).binds, BB_BY_MEMORY);
    assert_true(simulate(&other).mrays_s == simulate(&other).memory_mrays_s);

    /* where instructions are not known, what depends on them is left out */
    const bb_simulated_code unknown = {.program = "collapse.cl",
                                       .kernel = "collapse_decide",
                                       .footing = {.control = BB_WHILE_WHILE,
                                                   .group = 32,
                                                   .node_bytes = 64,
                                                   .prim_bytes = 48,
                                                   .item_bytes = sizeof(bb_ray),
                                                   .result_bytes = 8}};
    bb_simulation less;
    ASSERT_OK(bb_simulate_code(&simt, &unknown, &made, &less));
    assert_true(isnan(less.mrays_s) && isnan(less.issue_mrays_s) && isnan(less.efficiency));
    assert_true(less.l1_mrays_s > 0 && less.memory_mrays_s > 0 && less.node_efficiency > 0);

    /* steps have no bits for more nodes, or primitives */
    bb_simulated_code large = unknown;
    large.footing.nodes_bytes = (uint64_t)64 << 28;
    assert_int_equal(bb_simulate_code(&simt, &large, &made, &less), BB_UNSUPPORTED);
    large = unknown;
    large.footing.prims_bytes = (uint64_t)48 << 28;
    assert_int_equal(bb_simulate_code(&simt, &large, &made, &less), BB_UNSUPPORTED);

    /* registers, and the most groups, limit what is in flight */
    const bb_description d = {.groups = 64, .registers = 65536, .register_step = 8};
    assert_int_equal(bb_description_in_flight(&d, 32, 32), 64);
    assert_int_equal(bb_description_in_flight(&d, 33, 32), 65536 / (40 * 32));
    assert_int_equal(bb_description_in_flight(&d, 64, 64), 16);
    assert_int_equal(bb_description_in_flight(&d, 5000, 64), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(costs_are_those_of_the_options),
        cmocka_unit_test(costs_are_those_of_the_primitives),
        cmocka_unit_test(regions_have_costs_of_their_own),
        cmocka_unit_test(exact_tests_cost_the_same_in_all_searches),
        cmocka_unit_test(steps_are_those_of_the_group),
        cmocka_unit_test(a_sample_has_its_share_of_the_units),
        cmocka_unit_test(what_is_not_known_has_no_bound),
        cmocka_unit_test(bounds_are_those_of_the_device),
        cmocka_unit_test(packets_are_bounded_by_traffic_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
