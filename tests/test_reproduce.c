/* Papers reproduced: look-ups and claims on made-up results whose answers are known, the form in
 * the result file, and the command from outside. */
#include "tests/paper_fixture.h"
#include "tests/report_sample.h"

#include <math.h>
#include <stdlib.h>
#include <sys/wait.h>

/* ---- look-ups ---- */

static void what_was_measured_is_found(void **state)
{
    (void)state;
    bb_results *results = new_results();
    add_build(results, flat, "emc:code=mc64", 7, 9); /* of another experiment */
    uint32_t first = bb_results_begin_run(results);
    uint32_t a = add_build(results, flat, "emc:code=mc64", 100, 2);
    uint32_t b = add_build(results, flat, "emc:code=emc64-var", 50, 3);
    add_trace(results, a, "front", 4, 10);
    add_trace(results, a, "back", 8, 20);
    add_trace(results, b, "front", 2, 5);
    add_trace(results, b, "back", 1, 9);
    bb_findings f = findings_of(results, first);

    const char *mc64_spec = "emc:code=mc64", *var = "emc:code=emc64-var";
    bb_figure sah = {.what = "sah", .builder = mc64_spec};
    assert_true(value_at(&f, flat, sah) == 100);
    assert_true(isnan(value_at(&f, cubic, sah)));
    sah.builder = "emc";
    assert_true(isnan(value_at(&f, flat, sah)));
    bb_figure build = {.what = "build_ms", .builder = var, .base = mc64_spec};
    const bb_estimate e = figure_at(&f, flat, -1, build);
    assert_true(e.value == 1.5 && e.low == 1.5 && e.high == 1.5);
    assert_true(isnan(value_at(&f, cubic, build)));

    /* both views together, round by round: 12, 24, 12, 24; the first round is left out */
    bb_figure trace = {.what = "trace_ms", .builder = mc64_spec, .kernel = "stack"};
    assert_true(value_at(&f, flat, trace) == 24);
    bb_figure rate = trace, boxes = trace;
    rate.what = "rays";
    rate.per = "trace_ms";
    rate.scale = 1e-3;
    assert_true(fabs(value_at(&f, flat, rate) - 2000 / 24e3) < 1e-12);
    boxes.what = "node_tests_per_ray";
    assert_true(value_at(&f, flat, boxes) == 15);
    trace.base = var;
    assert_true(value_at(&f, flat, trace) == 4);
    /* build and both views: 3 + 2 + 1 over 2 + 4 + 8 */
    build.what = "build_ms+trace_ms";
    assert_true(value_at(&f, flat, build) == 6.0 / 14);
    assert_true(figure_at(&f, flat, 1, trace).value == 8);
    boxes.builder = var;
    assert_true(figure_at(&f, flat, 1, boxes).value == 9);
    trace.base_kernel = "other";
    assert_true(isnan(value_at(&f, flat, trace)));
    /* one view against both */
    add_trace(results, add_build(results, cubic, mc64_spec, 1, 1), "front", 4, 10);
    const uint32_t both = add_build(results, cubic, var, 1, 1);
    add_trace(results, both, "front", 4, 10);
    add_trace(results, both, "back", 4, 10);
    f = findings_of(results, first);
    trace.base_kernel = NULL;
    assert_true(isnan(value_at(&f, cubic, trace)));
    /* a sum of which one part is missing, whichever */
    assert_true(isnan(value_at(
        &f, flat, (bb_figure){.what = "phase_ms+build_ms", .builder = mc64_spec, .base = var})));
    trace.base = NULL;
    trace.kernel = "other";
    assert_true(isnan(value_at(&f, flat, trace)));

    assert_true(value_at(&f, flat, (bb_figure){.what = "prims"}) == 1000);
    assert_true(value_at(&f, flat, (bb_figure){.what = "flatness"}) == 0.01);
    assert_true(isnan(value_at(&f, "nowhere", (bb_figure){.what = "prims"})));
    assert_string_equal(bb_view_name(&f, flat, 1), "back");
    assert_string_equal(bb_view_name(&f, flat, 3), "");
    bb_results_destroy(results);
}

/* The median of a sum is not the sum of the medians. */
static void sums_are_of_rounds(void **state)
{
    (void)state;
    static const bb_column build_ms = BB_FOUND_ROUNDS("build_ms", "Builds."),
                           trace_ms = BB_FOUND_ROUNDS("trace_ms", "Traces.");
    const bb_samples build = {.count = 4, .values = {9, 1, 5, 3}},
                     trace = {.count = 4, .values = {9, 4, 1, 1}};
    bb_findings f = {.scenes = scenes, .scene_count = 2};
    ASSERT_OK(bb_table_create("reproduce", &f.table));
    const uint32_t row = bb_table_row(f.table, (bb_cell){{[BB_SCENE] = flat, [BB_BUILDER] = "x"}});
    bb_table_set_rounds(f.table, row, &build_ms, &build);
    bb_table_set_rounds(f.table, row, &trace_ms, &trace);
    const bb_figure both = {.what = "build_ms+trace_ms", .builder = "x"};
    assert_true(value_at(&f, flat, both) == 5); /* of 5, 6 and 4 */
    bb_table_free(f.table);
}

/* As many scenes and views as an experiment may have. */
static void no_scene_is_left_out(void **state)
{
    (void)state;
    static char names[128][8], *many[128];
    bb_findings f = {.scenes = many, .scene_count = 128};
    static const bb_figure any = {.what = "sah", .views = 3};
    ASSERT_OK(bb_table_create("reproduce", &f.table));
    for (int i = 0; i < 128; i++) {
        snprintf(names[i], sizeof names[i], "s%d", i);
        many[i] = names[i];
    }
    const bb_paper_series s = bb_figure_series((bb_paper_place){.all = &f, .view = -1}, &any);
    assert_int_equal(s.count, 3 * 128);
    assert_string_equal(s.places[s.count - 1].scene, "s127");
    /* of a table's columns some are, which it says */
    static const bb_paper_entrant rows[] = {{.name = "row", .builder = "x"}, {.name = NULL}};
    static const bb_paper_column columns[] = {{.heading = "", .shown = BB_SHOW_SCENES},
                                              {.heading = NULL}};
    static const bb_paper_table tables[] = {
        {.title = "all", .columns = columns, .figure = &any, .rows = rows}, {.title = NULL}};
    const bb_paper paper = {.name = "made-up", .title = "", .tables = tables};
    bb_results *results = new_results();
    ASSERT_OK(bb_reproduction_add(&paper, &f, results));
    const cJSON *list = cJSON_GetObjectItem(document_of(results), "reproductions");
    table_with(cJSON_GetArrayItem(list, 0), "all (columns: the first 23 of 128 scenes)");
    bb_results_destroy(results);
    bb_table_free(f.table);
}

/* Names of files are bytes, those of tables UTF-8. */
static void any_name_of_a_scene_is_found(void **state)
{
    (void)state;
    bb_results *results = new_results();
    bb_scene scene = {.prim_count = 7, .prims = {[BB_TRIANGLE] = {.count = 7}}};
    bb_findings f = {.scene_count = 0};
    snprintf(scene.name, sizeof scene.name, "a\xff.obj");
    scene.kinds = BB_TRIANGLES;
    ASSERT_OK(bb_results_add_scene(results, &scene, NULL));
    add_build(results, scene.name, "emc", 3, 1);
    ASSERT_OK(bb_table_create("reproduce", &f.table));
    ASSERT_OK(bb_paper_add_scene(&f, scene.name));
    ASSERT_OK(bb_paper_measured(results, 0, &f));
    assert_string_equal(f.scenes[0], "a%FF.obj");
    assert_true(value_at(&f, f.scenes[0], (bb_figure){.what = "prims"}) == 7);
    assert_true(value_at(&f, NULL, (bb_figure){.what = "sah", .builder = "emc"}) == 3);
    free(f.scenes[0]);
    free(f.scenes);
    bb_table_free(f.table);
    bb_results_destroy(results);
}

static void means_leave_out_what_is_missing(void **state)
{
    (void)state;
    bb_results *results = new_results();
    add_build(results, flat, "emc", 1, 1);
    add_build(results, cubic, "emc", 3, 1);
    add_build(results, cubic, "lbvh", 0.5, 1);
    bb_findings f = findings_of(results, 0);
    const bb_figure both = {.what = "sah", .builder = "emc"},
                    one = {.what = "sah", .builder = "lbvh"},
                    none = {.what = "sah", .builder = "sah"};
    const bb_figure *const figures[] = {&one, &none};
    const bb_paper_place at = {.all = &f, .view = -1};
    assert_true(value_at(&f, NULL, both) == 2 && value_at(&f, NULL, one) == 0.5);
    assert_true(isnan(value_at(&f, NULL, none)));
    bb_paper_series s = bb_figure_series(at, &one);
    assert_true(bb_series_mean(&s) == 0.5 && bb_series_least(&s) == 0.5);
    bb_words words = {0};
    bb_say_text(&words, "cost {0~}", at, figures);
    assert_string_equal(words.text, "cost 0.5 on average, 0.5 (cubic) to 0.5 (cubic)");
    bb_say_text(&words, "; speed {1~}", at, figures);
    assert_non_null(strstr(words.text, "; speed not measured"));
    for (int i = 0; i < 2000; i++) /* what does not fit is left out */
        bb_say(&words, "%d ", i);
    assert_true(words.length == strlen(words.text) && words.length < sizeof words.text);
    assert_string_equal(words.text + words.length - 3, "...");
    bb_results_destroy(results);
}

static void texts_have_figures(void **state)
{
    (void)state;
    bb_results *results = new_results();
    add_two_builders(results);
    bb_findings f = findings_of(results, 0);
    static const bb_paper_entrant row = {.name = "the row", .builder = "e$", .base = "lbvh"};
    static const bb_figure over = {.what = "sah", .builder = "$mc", .base = "="},
                           inverse = {.what = "sah",
                                      .builder = "$mc",
                                      .base = "=",
                                      .inverse = true},
                           growth = {.what = "sah", .builder = "emc", .previous = true},
                           part = {
                               .what = "sah", .builder = "emc", .previous = true, .scale = 0.25};
    static const bb_figure *const figures[] = {&over, &inverse, &growth, &part};
    bb_paper_place at = {.all = &f, .row = &row, .view = -1};
    static const struct {
        char *scene; /* NULL: the mean */
        const char *text, *said;
    } cases[] = {
        {flat, "{row}, {scene}: {0.2}, {0%0}, {1.1}", "the row, flat: 2.00, +100 %, 0.5"},
        {cubic, "{0} {0%1} {2.1} {3.1}", "0.500 -50.0 % 2.0 0.5"},
        {flat, "{2}", "not measured"}, /* there is none before */
        {flat, "{0#} measured, {0<1} below, {0>1} above", "2 measured, 1 below, 1 above"},
        {NULL, "{0} {0!} {0~}", "1.250 100.0 % 1.25 on average, 0.5 (cubic) to 2 (flat)"},
        {NULL, "{0/}", "1.250 on average, 0.50 to 2.00"},
        {flat, "no figure", "no figure"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_words words = {0};
        at.scene = cases[i].scene;
        bb_say_text(&words, cases[i].text, at, figures);
        assert_string_equal(words.text, cases[i].said);
    }
    bb_results_destroy(results);
}

/* ---- claims ---- */

/* How often each verdict is given, by tests of made-up claims. */
static void tests_of_claims_decide(void **state)
{
    (void)state;
    bb_results *results = new_results();
    add_two_builders(results);
    bb_findings f = findings_of(results, 0);
    static const bb_figure over = {.what = "sah", .builder = "emc", .base = "lbvh"},
                           back = {.what = "sah", .builder = "lbvh", .base = "emc"},
                           none = {.what = "sah", .builder = "sah"};
    static const bb_paper_numbers theirs[] = {{.numbers = {2.1, 3}}, {.numbers = {0.5, 0.5}}};
    static const struct {
        bb_test test;
        uint32_t scenes;
        const char *verdict;
    } cases[] = {
        {{.side = BB_ABOVE, .bound = 1.2}, 0, "held"}, /* the mean is 1.25 */
        {{.side = BB_BELOW, .bound = 1.25}, 0, "not held"},
        {{.side = BB_AT_MOST, .bound = 1.25}, 2, "held"},
        {{.side = BB_AT_MOST, .bound = 1.25}, 3, "cannot be told: not measured here"},
        {{.over = BB_EACH, .side = BB_AT_LEAST, .bound = 0.5}, 0, "held"},
        {{.over = BB_EACH, .side = BB_ABOVE, .bound = 0.5}, 0, "not held"},
        {{.over = BB_MOST_OF, .side = BB_BELOW, .bound = 1}, 0, "not held"}, /* one of two */
        {{.over = BB_MORE, .side = BB_BELOW, .bound = 1}, 0, "not held"},
        {{.over = BB_MORE, .side = BB_BELOW, .bound = 0.1}, 0, "not held"},
        {{.side = BB_ABOVE, .bound = 1, .claimed = 1.3}, 0, "held"}, /* by the margin */
        {{.side = BB_ABOVE, .bound = 1, .claimed = 1.4}, 0, "direction only"},
        {{.over = BB_EACH, .side = BB_ABOVE, .bound = 0.4, .paper = theirs}, 0, "held"},
        {{.over = BB_EACH, .side = BB_ABOVE, .bound = 0.4, .paper = theirs, .number = 1},
         0,
         "direction only"},
        {{.side = BB_AT_LEAST, .than = 2}, 0, "held"}, /* both means are 1.25 */
        {{.side = BB_ABOVE, .than = 2}, 0, "not held"},
        {{.figure = 2, .side = BB_ABOVE, .bound = 0}, 0, "cannot be told: not measured here"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const bb_paper_claim claims[] = {{.text = "made up",
                                          .paper = "",
                                          .figures = {&over, &back, &none},
                                          .tests = {cases[i].test},
                                          .scenes = cases[i].scenes},
                                         {.text = NULL}};
        const bb_paper_table tables[] = {{.title = NULL}};
        const bb_paper paper = {
            .name = "made-up", .title = "", .tables = tables, .claims = {claims}};
        bb_results *own = new_results();
        assert_int_equal(bb_reproduction_add(&paper, &f, own), BB_OK);
        assert_int_equal(bb_reproduction_add(&paper, &f, own), BB_INVALID); /* a second time */
        const cJSON *all = cJSON_GetObjectItem(document_of(own), "reproductions");
        bb_results_destroy(own);
        const char *verdict = verdict_with(cJSON_GetArrayItem(all, 0), "made up");
        if (strcmp(verdict, cases[i].verdict) != 0)
            fail_msg("case %zu: %s", i, verdict);
    }
    bb_results_destroy(results);
}

/* Claims on times are judged by each simulation, too: by its times alone, and never in place of
 * what was measured. */
static void times_are_judged_by_simulations(void **state)
{
    (void)state;
    static const bb_figure trace = {.what = "trace_ms", .builder = "emc", .base = "lbvh"},
                           sah = {.what = "sah", .builder = "emc", .base = "lbvh"},
                           both = {.what = "build_ms+trace_ms", .builder = "emc"};
    const bb_paper_claim claims[] = {
        {.text = "traces faster",
         .paper = "",
         .figures = {&trace},
         .tests = {{.side = BB_BELOW, .bound = 1, .claimed = 0.25}},
         .ours = {{.text = "{0}"}}},
        {.text = "costs less", .paper = "", .figures = {&sah}, .tests = {{.side = BB_BELOW}}},
        {.text = "takes no time",
         .paper = "",
         .figures = {&both},
         .tests = {{.side = BB_BELOW, .bound = 1e-9}}},
        {.text = NULL}};
    const bb_paper_table tables[] = {{.title = NULL}};
    const bb_paper paper = {.name = "made-up", .title = "", .tables = tables, .claims = {claims}};
    bb_results *results = new_results();
    const uint32_t emc = add_build(results, flat, "emc", 2, 1);
    const uint32_t lbvh = add_build(results, flat, "lbvh", 1, 1);
    /* measured 16 ms to 4; 2 views: by the first 1000 / 4 + 1000 / 12 us to 1000 + 1000 / 3, a
     * quarter; by the second 3 / 2 */
    add_simulated_trace(results, emc, "stack", "front", "diffuse", 8, 1, (double[]){4, 1}, 2);
    add_simulated_trace(results, emc, "stack", "back", "diffuse", 8, 1, (double[]){12, 2}, 2);
    add_simulated_trace(results, lbvh, "stack", "front", "diffuse", 2, 1, (double[]){1, 2}, 2);
    add_simulated_trace(results, lbvh, "stack", "back", "diffuse", 2, 1, (double[]){3, 2}, 2);
    bb_findings f = findings_of(results, 0);
    f.scene_count = 1;
    bool timed;
    const bb_figure alone = {.what = "trace_ms", .builder = "emc"};
    const bb_paper_place at = {.all = &f, .scene = flat, .view = -1, .simulated = 1};
    const double ms = bb_figure_at(at, &alone, &timed).value;
    assert_true(!timed && fabs(ms - (1.0 / 4 + 1.0 / 12)) < 1e-12);
    ASSERT_OK(bb_reproduction_add(&paper, &f, results));
    const cJSON *r =
        cJSON_GetArrayItem(cJSON_GetObjectItem(document_of(results), "reproductions"), 0);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(r, "claims")), 3 + 2);
    const cJSON *measured = claim_of(r, "traces faster");
    assert_string_equal(json_text(measured, "simulated"), "");
    assert_string_equal(json_text(measured, "verdict"), "cannot be told: too few rounds");
    assert_string_equal(json_text(claim_of(r, "simt:0: traces faster"), "simulated"), "simt:0");
    assert_string_equal(verdict_with(r, "simt:0: traces faster"), "held");
    assert_string_equal(json_text(claim_of(r, "simt:0: traces faster"), "ours"), "0.250");
    assert_string_equal(verdict_with(r, "simt:1: traces faster"), "not held");
    assert_string_equal(json_text(claim_of(r, "simt:1: traces faster"), "ours"), "1.500");

    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    ASSERT_OK(bb_reproduction_print(results, file));
    fclose(file);
    assert_non_null(strstr(text, "claims: 0 held"));
    assert_non_null(strstr(text, "neither measured nor validated: 1 held"));
    free(text);
    bb_results_destroy(results);
}

static void claims_follow_the_figures(void **state)
{
    (void)state;
    bb_results *results = new_results();
    const double faster[] = {2, 1};
    const cJSON *r = reproduce_emc(results, (code_costs){{.8, .9}, {.5, 1}}, faster);
    assert_true(cJSON_IsTrue(claim_with(r, "lowers the cost of LBVH")));
    assert_true(cJSON_IsTrue(claim_with(r, "before EMC-64-sort")));
    assert_true(cJSON_IsTrue(claim_with(r, "highest on flat scenes")));
    assert_true(cJSON_IsTrue(claim_with(r, "traces diffuse rays faster")));
    assert_true(cJSON_IsTrue(claim_with(r, "follows the cost")));
    /* emc64-var takes 1.2 times as long */
    const cJSON *build = claim_with(r, "do not increase the build time");
    assert_true(cJSON_IsFalse(build));
    assert_non_null(strstr(why_of(build), "1.200"));
    assert_null(strstr(why_of(build), sort64));
    /* what was not measured is not judged */
    assert_true(cJSON_IsNull(claim_with(r, "full sweep")));
    assert_true(cJSON_IsNull(claim_with(r, "In 32 bits")));
    assert_true(cJSON_IsNull(claim_with(r, "ATRBVH")));
    bb_results_destroy(results);

    results = new_results();
    const double slower[] = {0.5, 1};
    r = reproduce_emc(results, (code_costs){{.6, .6}, {.9, 1.1}}, slower);
    const cJSON *cost = claim_with(r, "lowers the cost of LBVH");
    assert_true(cJSON_IsFalse(cost));
    assert_non_null(strstr(why_of(cost), "cubic: EMC-64-var 1.100"));
    assert_true(cJSON_IsFalse(claim_with(r, "before EMC-64-sort")));
    assert_true(cJSON_IsFalse(claim_with(r, "traces diffuse rays faster")));
    const cJSON *follows = claim_with(r, "follows the cost");
    assert_true(cJSON_IsFalse(follows));
    assert_non_null(strstr(why_of(follows), "box tests per ray -25.0 %"));
    bb_results_destroy(results);
}

static void tables_have_both_sides(void **state)
{
    (void)state;
    bb_results *results = new_results();
    const double speed[] = {2, 1};
    const cJSON *r = reproduce_emc(results, (code_costs){{.8, .9}, {.5, 1}}, speed);
    const cJSON *table = cJSON_GetArrayItem(cJSON_GetObjectItem(r, "tables"), 0);
    assert_true(cell_of(table, "pompeii (paper)", 5)->valuedouble == 0.53);
    assert_true(cell_of(table, flat, 3)->valuedouble == 100);
    assert_true(cell_of(table, flat, 5)->valuedouble == 0.5);
    assert_true(cJSON_IsNull(cell_of(table, flat, 6)));
    assert_true(cell_of(table, "average (paper)", 5)->valuedouble == 0.8);
    assert_true(cell_of(table, "average (here)", 5)->valuedouble == 0.75);
    table = cJSON_GetArrayItem(cJSON_GetObjectItem(r, "tables"), 1);
    assert_true(cell_of(table, "average (here)", 5)->valuedouble == 1.5);
    bb_results_destroy(results);
}

/* ---- the result file ---- */

static void reproductions_survive_the_file_and_merging(void **state)
{
    (void)state;
    char path[600];
    snprintf(path, sizeof path, "%s/results.json", sample_folder("reproduce"));
    bb_results *a = new_results(), *b = new_results(), *read = NULL;
    const double speed[] = {2, 1};
    reproduce_emc(a, (code_costs){{.8, .9}, {.5, 1}}, speed);
    reproduce_emc(b, (code_costs){{.8, .9}, {.5, 1}}, speed);
    assert_int_equal(bb_results_write(a, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    assert_int_equal(bb_results_merge(read, b), BB_OK);
    const cJSON *all = cJSON_GetObjectItem(document_of(read), "reproductions");
    assert_int_equal(cJSON_GetArraySize(all), 2);
    static const char *const members[] = {"title", "claims", "tables"};
    for (int i = 0; i < 3; i++)
        assert_true(cJSON_Compare(cJSON_GetObjectItem(cJSON_GetArrayItem(all, 0), members[i]),
                                  cJSON_GetObjectItem(cJSON_GetArrayItem(all, 1), members[i]), 1));
    FILE *out = tmpfile();
    assert_int_equal(bb_reproduction_print(read, out), BB_OK);
    assert_true(ftell(out) > 1000);
    fclose(out);
    bb_results_destroy(read);
    /* also into a document without any */
    read = new_results();
    assert_int_equal(bb_results_merge(read, b), BB_OK);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(document_of(read), "reproductions")),
                     1);
    bb_results_destroy(read);
    bb_results_destroy(a);
    bb_results_destroy(b);
}

/* ---- papers ---- */

static void papers_are_sound(void **state)
{
    (void)state;
    const bb_paper *found = NULL;
    assert_int_equal(bb_paper_find("nobody", &found), BB_INVALID);
    for (const bb_paper *const *p = bb_papers; *p != NULL; p++) {
        uint32_t count = 0;
        assert_int_equal(bb_paper_find((*p)->name, &found), BB_OK);
        assert_ptr_equal(found, *p);
        for (const bb_experiment *e = (*p)->experiments; e != NULL && e->name != NULL;
             e++, count++) {
            /* by default claims on times can be decided; of a single round only costs are used */
            assert_true(e->repeats == 1 || e->repeats >= BB_INTERVAL_ROUNDS);
            assert_true(e->width > 0 && e->height > 0 && e->max_rays > 0);
            assert_true((e->rays[0] == '\0') == (e->kernels[0] == '\0'));
            assert_true(e->scenes[0] != '\0' && e->quick_scenes[0] != '\0');
        }
        assert_true((count > 0 || (*p)->measure != NULL) && count <= BB_EXPERIMENTS_MAX);
    }
}

/* Figures that a text names are the claim's. */
static bool names_figures(const bb_paper_claim *claim, const char *text)
{
    for (const char *at = text; at != NULL && (at = strchr(at, '{')) != NULL; at++)
        if (at[1] >= '0' && at[1] <= '9' && claim->figures[at[1] - '0'] == NULL)
            return false;
    return true;
}

/* A test compares a figure that is there with what it may miss; a mean of times has an interval. */
static bool may_fail(const bb_paper_claim *claim, const bb_test *test)
{
    const bb_figure *figure = claim->figures[test->figure];
    if (figure == NULL || (test->than > 0 && claim->figures[test->than - 1] == NULL) ||
        (test->over == BB_OVER_MEAN && strstr(figure->what, "_ms") != NULL &&
         figure->mean == BB_MEAN_OF_SCENES))
        return false;
    return test->than > 0 || test->bound > 0 || test->claimed > 0;
}

static void each_claim_may_fail(void **state)
{
    (void)state;
    for (const bb_paper *const *p = bb_papers; *p != NULL; p++)
        for (int half = 0; half < 2; half++)
            for (const bb_paper_claim *c = (*p)->claims[half]; c != NULL && c->text != NULL; c++) {
                bool sound = c->judge != NULL || c->tests[0].side != BB_NO_SIDE;
                for (int i = 0; i < BB_CLAIM_TESTS && c->tests[i].side != BB_NO_SIDE; i++)
                    sound = sound && may_fail(c, &c->tests[i]);
                for (int i = 0; i < BB_CLAIM_SAYINGS; i++)
                    sound = sound && names_figures(c, c->ours[i].text) &&
                            names_figures(c, c->why[i].text) && names_figures(c, c->why[i].also);
                if (!sound)
                    fail_msg("%s: %s", (*p)->name, c->text);
            }
}

/* Nothing measured at all: no claim is judged, nothing crashes. */
static void nothing_measured_judges_nothing(void **state)
{
    (void)state;
    for (const bb_paper *const *p = bb_papers; *p != NULL; p++) {
        bb_results *results = new_results();
        bb_findings all[BB_EXPERIMENTS_MAX];
        for (int e = 0; e < BB_EXPERIMENTS_MAX; e++)
            all[e] = findings_of(results, 0);
        const cJSON *claim, *r = reproduce((*p)->name, all, results);
        cJSON_ArrayForEach(claim, cJSON_GetObjectItem(r, "claims"))
        {
            if (!cJSON_IsNull(cJSON_GetObjectItem(claim, "held")))
                fail_msg("%s: judged without a figure: %s", (*p)->name, json_text(claim, "claim"));
        }
        bb_results_destroy(results);
    }
}

/* ---- the command ---- */

static int run_program(const char *arguments, const char *folder)
{
    char command[4096];
    snprintf(command, sizeof command,
             BB_TEST_PROGRAM " reproduce %s >%s/stdout 2>%s/stderr </dev/null", arguments, folder,
             folder);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static const char *text_of(const char *folder, const char *name)
{
    static char text[1 << 17];
    char path[700];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

/* Of an OLBVH, table 2 has the arrays as published, beside the tree of this bench. */
static void expect_arrays_alone(const cJSON *reproduction)
{
    const cJSON *memory = cJSON_GetArrayItem(cJSON_GetObjectItem(reproduction, "tables"), 1);
    const cJSON *row = cJSON_GetArrayItem(cJSON_GetObjectItem(memory, "rows"), 0);
    enum { LBVH = 2, ARRAYS = 3, TREE = 6, RATIO = 9 };
    const double lbvh = cJSON_GetArrayItem(row, LBVH)->valuedouble;
    const double arrays = cJSON_GetArrayItem(row, ARRAYS)->valuedouble;
    assert_true(arrays > 0 && arrays < cJSON_GetArrayItem(row, TREE)->valuedouble);
    assert_true(fabs(cJSON_GetArrayItem(row, RATIO)->valuedouble - arrays / lbvh) < 0.2);
}

/* A paper whose builders or kernels are not there is refused by name; the others run through. */
static void quick_papers_run(void **state)
{
    (void)state;
    const char *folder = sample_folder("reproduce");
    for (const bb_paper *const *p = bb_papers; *p != NULL; p++) {
        bb_reproduce_request request = {.paper = *p, .quick = true, .max_prims = 10000, .seed = 1};
        char arguments[1024], path[700];
        bool there = bb_reproduce_check(&request) == BB_OK;
        snprintf(arguments, sizeof arguments, "%s --quick --quiet --out %s/out", (*p)->name,
                 folder);
        int exit_status = run_program(arguments, folder);
        if (!there) {
            assert_int_equal(exit_status, 2);
            assert_non_null(strstr(text_of(folder, "stderr"), (*p)->name));
            continue;
        }
        if (exit_status != 0)
            fail_msg("reproduce %s: exit %d, %s", arguments, exit_status,
                     text_of(folder, "stderr"));
        assert_non_null(strstr(text_of(folder, "stdout"), "claims: "));
        if (strcmp((*p)->name, "simt") == 0) /* nothing of it is timed */
            assert_non_null(strstr(text_of(folder, "stdout"), "claims: 4 held"));
        else
            assert_non_null(
                strstr(text_of(folder, "stdout"), "\ncannot be told: too few rounds\n"));
        snprintf(path, sizeof path, "%s/out/results.json", folder);
        bb_results *results = NULL;
        assert_int_equal(bb_results_read(path, &results), BB_OK);
        const cJSON *all = cJSON_GetObjectItem(document_of(results), "reproductions");
        assert_int_equal(cJSON_GetArraySize(all), 1);
        assert_string_equal(json_text(cJSON_GetArrayItem(all, 0), "name"), (*p)->name);
        if (strcmp((*p)->name, "olbvh") == 0)
            expect_arrays_alone(cJSON_GetArrayItem(all, 0));
        bb_results_destroy(results);
        bb_table *table; /* the contests' clocks are checked, too */
        ASSERT_OK(bb_table_read(path, &table));
        assert_true(bb_table_get_number(table, 0, "timings") > 0);
        bb_table_free(table);
    }
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *arguments, *words;
    } bad[] = {
        {"", "give one paper"},
        {"nobody", "unknown paper 'nobody': there are dynamic, emc"},
        {"emc loose-octree", "give one paper"},
        {"emc --max-prims 10", "--max-prims"},
        {"emc --repeats 0", "--repeats"},
        {"emc --quick --repeats 3", "--quick"},
        {"emc --scene nowhere.glb --quick", "nowhere.glb"},
        {"emc --speed", "--speed"},
        {"emc --metrics sah", "only simt"},
        {"emc --metrics simt:device=abacus", "abacus"},
        {"volume --quick --scene cube", "--scene cube is no volume"},
    };
    const char *folder = sample_folder("reproduce");
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char arguments[1024];
        snprintf(arguments, sizeof arguments, "%s --out %s/bad", bad[i].arguments, folder);
        int exit_status = run_program(arguments, folder);
        const char *text = text_of(folder, "stderr"), *newline = strchr(text, '\n');
        if (exit_status != 2 || newline == NULL || newline[1] != '\0' ||
            strstr(text, bad[i].words) == NULL)
            fail_msg("reproduce %s: exit %d, '%s', expected one line with '%s'", arguments,
                     exit_status, text, bad[i].words);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_measured_is_found),
        cmocka_unit_test(sums_are_of_rounds),
        cmocka_unit_test(no_scene_is_left_out),
        cmocka_unit_test(any_name_of_a_scene_is_found),
        cmocka_unit_test(means_leave_out_what_is_missing),
        cmocka_unit_test(texts_have_figures),
        cmocka_unit_test(tests_of_claims_decide),
        cmocka_unit_test(times_are_judged_by_simulations),
        cmocka_unit_test(claims_follow_the_figures),
        cmocka_unit_test(tables_have_both_sides),
        cmocka_unit_test(reproductions_survive_the_file_and_merging),
        cmocka_unit_test(papers_are_sound),
        cmocka_unit_test(each_claim_may_fail),
        cmocka_unit_test(nothing_measured_judges_nothing),
        cmocka_unit_test(quick_papers_run),
        cmocka_unit_test(bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
