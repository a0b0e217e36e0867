/* Extended Morton codes inside other builders: tables and claims on made-up results whose answers
 * are known, and builders that are not there. */
#include "framework/papers/emc.h"
#include "tests/paper_fixture.h"

#include <math.h>

/* With EMC-64-var, of one method: costs and times as ratios to those with MC-64, and boxes per ray,
 * where MC-64 has 40. */
typedef struct made_up {
    double cost[2], centred[2], build, time[EMC_KINDS], boxes;
} made_up;

/* The builder of a method, with the code and box for its '$'; till four calls later. */
static const char *spec_of(int id, const char *fill)
{
    static const bb_figure any = {.what = "sah"};
    static char names[4][256];
    static int at;
    char chosen[32];
    const bb_paper_place place = {.row = &bb_emc_methods[id], .view = -1};
    at = (at + 1) % 4;
    bb_figure_builder(&place, &any, fill, NULL, names[at], chosen);
    return names[at];
}

/* Both codes of a method on both scenes. */
static void add_method(bb_results *results, int id, const made_up *m)
{
    for (int s = 0; s < 2; s++) {
        uint32_t plain = add_build(results, scenes[s], spec_of(id, "$" EMC_PLAIN), 100, 10);
        uint32_t var = add_build(results, scenes[s], spec_of(id, "$" EMC_VAR), 100 * m->cost[s],
                                 10 * m->build);
        for (int k = 0; k < EMC_KINDS; k++) {
            add_trace_of(results, plain, "stack", "", bb_emc_rays[k], 6, 40);
            add_trace_of(results, var, "stack", "", bb_emc_rays[k], 6 * m->time[k], m->boxes);
        }
    }
}

/* The same in the box of the centroids, where MC-64 costs 90. */
static void add_centred(bb_results *results, int id, const made_up *m)
{
    for (int s = 0; s < 2; s++) {
        add_build(results, scenes[s], spec_of(id, "$" EMC_PLAIN_CENTRED), 90, 10);
        add_build(results, scenes[s], spec_of(id, "$" EMC_VAR_CENTRED), 90 * m->centred[s], 10);
    }
}

/* All methods, and in the box of the centroids a sweep that costs 80 everywhere, and PLOC with
 * wider radii, which costs 89 and 85. */
static const cJSON *reproduce_with(bb_results *results, const made_up methods[EMC_METHODS])
{
    bb_findings all[BB_EXPERIMENTS_MAX];
    for (int e = 0; e < BB_EXPERIMENTS_MAX; e++)
        all[e] = findings_of(results, 0);
    for (int i = 0; i < EMC_METHODS; i++)
        add_method(results, i, &methods[i]);
    for (int s = 0; s < 2; s++)
        add_build(results, scenes[s], EMC_ATRBVH_OF("emc64-sort"), 95, 10.2);
    all[EMC_INSIDE] = findings_of(results, 0);
    uint32_t first = bb_results_begin_run(results);
    for (int i = 0; i < EMC_METHODS; i++)
        add_centred(results, i, &methods[i]);
    for (int s = 0; s < 2; s++) {
        add_build(results, scenes[s], EMC_SWEEP, 80, 100);
        add_build(results, scenes[s], bb_emc_radii[0].builder, 89, 10);
        add_build(results, scenes[s], bb_emc_radii[1].builder, 85, 10);
    }
    all[EMC_CENTRED] = findings_of(results, first);
    return reproduce("emc", all, results);
}

static void all_better(made_up methods[EMC_METHODS])
{
    for (int i = 0; i < EMC_METHODS; i++)
        methods[i] = (made_up){{.7, .9}, {.9, .9}, 1.01, {.8, .9, .9, .9}, 30};
}

static double number(const cJSON *table, const char *row, int column)
{
    return cell_of(table, row, column)->valuedouble;
}

static void better_everywhere_is_held(void **state)
{
    (void)state;
    made_up methods[EMC_METHODS];
    bb_results *results = new_results();
    all_better(methods);
    const cJSON *r = reproduce_with(results, methods);
    static const char *const held[] = {
        "lowers the cost of HLBVH",
        "lowers the cost of AAC-HQ",
        "lowers the cost of PLOC",
        "lowers the cost of H-PLOC",
        "faster with HLBVH",
        "faster with AAC-Fast",
        "faster with PLOC",
        "faster with H-PLOC",
        "HLBVH with EMC-64-var costs",
        "AAC-HQ with EMC-64-var costs",
        "bridges the gap",
        "it lowers the counted work",
        "build time of other",
    };
    for (size_t i = 0; i < sizeof held / sizeof held[0]; i++)
        if (!cJSON_IsTrue(claim_with(r, held[i])))
            fail_msg("%s: %s", held[i], verdict_with(r, held[i]));
    assert_string_equal(text_after(claim_with(r, "faster with PLOC"), "paper"), "not published");

    /* work: 1.2 * 40 / 2 + 1 = 25 against 1.2 * 30 / 2 + 1 = 19 */
    const cJSON *table = table_with(r, "EMC-64-var inside builders, as a ratio");
    assert_true(number(table, "PLOC", 1) == 0.8);
    for (int column = 2; column <= 5; column++)
        assert_true(number(table, "PLOC", column) == 0.76);
    assert_true(number(table, "PLOC", 6) == 0.8 && number(table, "PLOC", 7) == 0.9);
    assert_true(number(table, "PLOC", 10) == 1.01);
    table = table_with(r, "time per primary ray");
    assert_true(number(table, "H-PLOC", 1) == 0.8 && number(table, "H-PLOC", 2) == 0.8);
    assert_true(number(table, "H-PLOC", 4) == 0.8 && number(table, "H-PLOC", 5) == 0.8);
    assert_string_equal(cJSON_GetStringValue(cell_of(table, "H-PLOC", 6)),
                        "lower (2 of 2 scenes lower, 0 higher)");
    table = table_with(r, "that choice alone");
    assert_true(number(table, "PLOC", 1) == 0.8 && number(table, "PLOC", 2) == 0.9);
    assert_true(number(table, "PLOC", 3) == 0.9 && number(table, "PLOC", 5) == 0.9);
    table = table_with(r, "section 5.4");
    assert_true(number(table, "HLBVH", 1) == 0.84 && number(table, "HLBVH", 2) == 0.8);
    assert_true(number(table, "HLBVH", 4) == 1.25 && number(table, "HLBVH", 6) == 1);
    assert_true(cJSON_IsNull(cell_of(table, "PLOC", 1)));
    bb_results_destroy(results);
}

static void what_is_worse_is_not_held(void **state)
{
    (void)state;
    made_up methods[EMC_METHODS];
    bb_results *results = new_results();
    all_better(methods);
    methods[EMC_HPLOC].cost[1] = 1.4;
    methods[EMC_PLOC].centred[1] = 1.2; /* in the other box alone */
    methods[EMC_HLBVH].time[2] = 1.1;
    methods[EMC_AAC_FAST].boxes = 45;
    methods[EMC_AAC_HQ].cost[0] = methods[EMC_AAC_HQ].cost[1] = 0.95;
    methods[EMC_PLOC].build = 1.2;
    const cJSON *r = reproduce_with(results, methods);
    const cJSON *cost = claim_with(r, "lowers the cost of H-PLOC");
    assert_true(cJSON_IsFalse(cost));
    assert_non_null(strstr(why_of(cost), "cubic 1.400, 0.900"));
    cost = claim_with(r, "lowers the cost of PLOC");
    assert_true(cJSON_IsFalse(cost));
    assert_non_null(strstr(why_of(cost), "cubic 0.900, 1.200"));
    assert_true(cJSON_IsFalse(claim_with(r, "faster with HLBVH")));
    assert_non_null(
        strstr(why_of(claim_with(r, "faster with HLBVH")), "shadow: counted work 0.760"));
    const cJSON *work = claim_with(r, "it lowers the counted work");
    assert_true(cJSON_IsFalse(work));
    assert_non_null(strstr(why_of(work), "AAC-Fast: cost 0.800, work per shadow ray 1.120"));
    assert_null(strstr(why_of(work), "PLOC"));
    assert_true(cJSON_IsFalse(claim_with(r, "AAC-HQ with EMC-64-var costs"))); /* 95/80 */
    assert_true(cJSON_IsFalse(claim_with(r, "build time of other")));
    const cJSON *table = table_with(r, "inside builders: cost (SAH)");
    assert_string_equal(cJSON_GetStringValue(cell_of(table, "H-PLOC", 4)),
                        "higher (1 of 2 scenes lower, 1 higher)");
    bb_results_destroy(results);
}

/* Too few rounds decide nothing on times, and costs as before. */
static void few_rounds_decide_costs_alone(void **state)
{
    (void)state;
    made_up methods[EMC_METHODS];
    bb_results *results = new_results();
    all_better(methods);
    rounds = 3;
    const cJSON *r = reproduce_with(results, methods);
    rounds = 7;
    assert_string_equal(verdict_with(r, "faster with PLOC"), "cannot be told: too few rounds");
    assert_string_equal(cJSON_GetStringValue(cell_of(table_with(r, "time per random"), "PLOC", 6)),
                        "cannot be told: too few rounds");
    assert_true(cJSON_IsTrue(claim_with(r, "lowers the cost of PLOC")));
    bb_results_destroy(results);
}

/* Two thirds of the paper's ATRBVH rows, and ours, or one line that says why there is none. */
static void atrbvh_has_both_sides(void **state)
{
    (void)state;
    made_up methods[EMC_METHODS];
    bb_results *results = new_results();
    all_better(methods);
    const cJSON *r = reproduce_with(results, methods);
    const cJSON *table = table_with(r, "ATRBVH (over LBVH), cost");
    assert_true(number(table, "pompeii (paper)", 5) == 0.75);
    assert_true(number(table, "average (paper)", 3) == 0.66);
    bb_words missing = {0};
    if (bb_say_missing(bb_emc_methods[EMC_ATRBVH].builder, &missing)) {
        assert_string_equal(missing.text, "no such builder: atrbvh");
        assert_string_equal(cJSON_GetStringValue(cell_of(table, "average (here)", 6)),
                            missing.text);
    } else {
        assert_true(number(table, flat, 2) == 100 && number(table, flat, 3) == 1);
        assert_true(number(table, flat, 4) == 0.95 && number(table, flat, 5) == 0.7);
        assert_true(number(table, "average (here)", 5) == 0.8);
        table = table_with(r, "ATRBVH, trace performance"); /* of speeds */
        assert_true(number(table, flat, 5) == 1.11);
        assert_true(cJSON_IsTrue(claim_with(r, "faster than MC-64 with ATRBVH")));
        assert_true(cJSON_IsFalse(claim_with(r, "smaller than on LBVH")));
        assert_true(cJSON_IsTrue(claim_with(r, "build time of ATRBVH")));
    }
    bb_results_destroy(results);
}

/* With MC-64: the same costs; AAC and PLOC meet more boxes than LBVH and HLBVH. */
static void builders_are_set_beside_lbvh(void **state)
{
    (void)state;
    bb_results *results = new_results();
    bb_findings all[BB_EXPERIMENTS_MAX];
    for (int i = 0; i < 2 * EMC_METHODS; i++) {
        int id = i / 2;
        bool more = id == EMC_AAC_HQ || id == EMC_AAC_FAST || id == EMC_PLOC || id == EMC_HPLOC;
        uint32_t build =
            add_build(results, scenes[i % 2], spec_of(id, "$" EMC_PLAIN), 100 + id, 10);
        for (int k = 0; k < EMC_KINDS; k++)
            add_trace_of(results, build, "stack", "", bb_emc_rays[k], 6 + id, more ? 60 : 40);
    }
    add_build(results, flat, bb_emc_radii[0].builder, 89, 10);
    add_build(results, flat, bb_emc_radii[1].builder, 85, 10);
    add_build(results, flat, spec_of(EMC_PLOC, "$" EMC_PLAIN_CENTRED), 90, 10);
    for (int e = 0; e < BB_EXPERIMENTS_MAX; e++)
        all[e] = findings_of(results, 0);
    const cJSON *r = reproduce("emc", all, results), *table = table_with(r, "Builders with MC-64");
    assert_true(number(table, "LBVH", 1) == 1 && number(table, "PLOC", 1) == 1.04);
    assert_true(number(table, "PLOC", 5) == 1.48); /* 37/25 */
    assert_true(number(table, "HLBVH", 9) == 1.167);
    assert_true(cJSON_IsTrue(claim_with(r, "flatters agglomerative")));
    assert_true(cJSON_IsTrue(claim_with(r, "HLBVH asks for less")));
    const cJSON *radius = claim_with(r, "radius beyond 8");
    assert_true(cJSON_IsFalse(radius));
    assert_string_equal(why_of(radius), "radius 32: -5.6 %");
    bb_results_destroy(results);
}

/* What is said of every scene is not judged where one lacks its figure. */
static void every_scene_is_asked_for(void **state)
{
    (void)state;
    for (int measured = 1; measured <= 2; measured++) {
        bb_results *results = new_results();
        bb_findings all[BB_EXPERIMENTS_MAX];
        for (int s = 0; s < 2; s++) {
            add_build(results, scenes[s], EMC_MC64, 100, 10);
            if (s < measured)
                add_build(results, scenes[s], EMC_SIZES, 80, 10);
        }
        for (int e = 0; e < BB_EXPERIMENTS_MAX; e++)
            all[e] = findings_of(results, 0);
        const cJSON *r = reproduce("emc", all, results);
        assert_string_equal(verdict_with(r, "Size bits lower the cost on every scene"),
                            measured == 2 ? "held" : "cannot be told: not measured here");
        bb_results_destroy(results);
    }
}

/* Twice the time on one scene and half on the other is no difference. */
static void means_of_times_are_geometric(void **state)
{
    (void)state;
    bb_results *results = new_results();
    bb_findings all[BB_EXPERIMENTS_MAX];
    for (int s = 0; s < 2; s++) {
        uint32_t plain = add_build(results, scenes[s], spec_of(EMC_PLOC, "$" EMC_PLAIN), 100, 10),
                 var = add_build(results, scenes[s], spec_of(EMC_PLOC, "$" EMC_VAR), 100,
                                 s == 0 ? 20 : 5);
        add_trace_of(results, plain, "stack", "", "shadow", 6, 40);
        add_trace_of(results, var, "stack", "", "shadow", s == 0 ? 24 : 1.5, 40);
    }
    all[EMC_INSIDE] = findings_of(results, 0);
    const bb_paper_place at = {
        .all = &all[EMC_INSIDE], .row = &bb_emc_methods[EMC_PLOC], .view = -1};
    bool timed;
    assert_float_equal(bb_figure_at(at, &bb_emc_inside[EMC_TIME + 2], &timed).value, 1, 1e-12);
    assert_float_equal(bb_figure_at(at, &bb_emc_inside[EMC_BUILD], &timed).value, 1, 1e-12);
    assert_true(isnan(bb_figure_at(at, &bb_emc_inside[EMC_TIME], &timed).value));
    bb_results_destroy(results);
}

/* ---- builders that are not there ---- */

static void missing_stages_are_named(void **state)
{
    (void)state;
    char name[64] = "";
    assert_false(bb_missing_stage("emc:code=mc64,box=scene", name, sizeof name));
    assert_false(bb_missing_stage("embree-native:quality=low", name, sizeof name));
    assert_false(bb_missing_stage("", name, sizeof name));
    assert_true(bb_missing_stage("nobody:x=1", name, sizeof name));
    assert_string_equal(name, "nobody");
    assert_true(bb_missing_stage("emc:code=mc64+nowhere:rounds=2", name, sizeof name));
    assert_string_equal(name, "nowhere");
    bb_words words = {0};
    assert_true(bb_say_missing("emc+nobody", &words) && !bb_say_missing("emc", &words));
    assert_string_equal(words.text, "no such builder: nobody");
}

/* Left out where the experiment allows it, else refused; wrong options are always refused. */
static void missing_builders_are_left_out(void **state)
{
    (void)state;
    static const struct {
        const char *builders;
        bool optional;
        const char *words; /* of the refusal; NULL: none */
    } cases[] = {{"emc,emc+nobody:x=1", true, NULL},
                 {"emc,emc+nobody:x=1", false, "unknown builder 'nobody'"},
                 {"emc:nothing=1,nobody", true, "nothing"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const bb_experiment experiments[] = {{.name = "made up",
                                              .builders = cases[i].builders,
                                              .optional_builders = cases[i].optional,
                                              .kernels = "",
                                              .rays = "",
                                              .scenes = "cube",
                                              .quick_scenes = "cube",
                                              .width = 1,
                                              .height = 1,
                                              .max_rays = 1,
                                              .repeats = 1},
                                             {.name = NULL}};
        const bb_paper paper = {.name = "made-up", .title = "", .experiments = experiments};
        bb_reproduce_request request = {.paper = &paper, .max_prims = 10000, .seed = 1};
        bb_status status = bb_reproduce_check(&request);
        assert_int_equal(status, cases[i].words == NULL ? BB_OK : BB_INVALID);
        if (cases[i].words != NULL)
            assert_non_null(strstr(bb_message(), cases[i].words));
    }
}

/* Of several kinds of rays, only those that are asked for are looked at. */
static void kinds_of_rays_are_told_apart(void **state)
{
    (void)state;
    bb_results *results = new_results();
    uint32_t build = add_build(results, flat, "emc", 100, 10);
    add_trace_of(results, build, "stack", "", "primary", 4, 10);
    add_trace_of(results, build, "stack", "", "shadow", 8, 30);
    bb_findings f = findings_of(results, 0);
    bb_figure work = {.what = "work", .builder = "emc", .kernel = "stack"}, trace = work;
    trace.what = "trace_ms";
    assert_true(value_at(&f, flat, work) == 13);
    /* rounds take 1, 2, 1, 2 ... times as long; the first is left out */
    static const struct {
        const char *rays;
        double ms, work;
    } kinds[] = {{"primary", 8, 7}, {"shadow", 16, 19}};
    for (int k = 0; k < 2; k++) {
        work.rays = trace.rays = kinds[k].rays;
        assert_true(value_at(&f, flat, trace) == kinds[k].ms);
        assert_true(value_at(&f, flat, work) == kinds[k].work);
    }
    work.rays = trace.rays = "random";
    assert_true(isnan(value_at(&f, flat, trace)) && isnan(value_at(&f, flat, work)));
    bb_results_destroy(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(better_everywhere_is_held),
        cmocka_unit_test(what_is_worse_is_not_held),
        cmocka_unit_test(few_rounds_decide_costs_alone),
        cmocka_unit_test(atrbvh_has_both_sides),
        cmocka_unit_test(builders_are_set_beside_lbvh),
        cmocka_unit_test(every_scene_is_asked_for),
        cmocka_unit_test(means_of_times_are_geometric),
        cmocka_unit_test(missing_stages_are_named),
        cmocka_unit_test(missing_builders_are_left_out),
        cmocka_unit_test(kinds_of_rays_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
