/* What is said of a result document: means, order, ties, best, sentences. Documents are made here,
 * with times that are known. */
#include "tests/summary_fixture.h"

/* The summary of all of a document, which it takes over; returns its results. */
static bb_results *summary_of(bb_results *document, bb_summary *s)
{
    bb_results *results = read_back(document);
    ASSERT_OK(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, s));
    return results;
}

static void means_are_geometric_and_over_all_sets(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    assert_int_equal(s.builder_count, 3);
    assert_int_equal(s.row_count, 4);
    assert_int_equal(s.scenes, 2);
    assert_int_equal(s.sets, 2);
    assert_int_equal(s.rounds, ROUNDS - 1);
    const bb_summary_row *slow = row_of(&s, "slow"), *fast = row_of(&s, "fast");
    assert_near(slow->trace.value, sqrt(1.0 * 2.0));
    assert_near(fast->trace.value, sqrt(0.25 * 1.0));
    assert_near(slow->build.value, 1);
    assert_near(fast->build.value, 100);
    assert_string_equal(slow->kernel, "stack");
    /* 10^5 rays take a tenth of the times above, 10^10 ten thousand times these */
    assert_near(slow->image[0].value, sqrt(1020.0 / 60 * 1015.0 / 30));
    assert_true(fast->image[0].best && !slow->image[0].best);
    assert_true(slow->image[5].best);
    assert_near(fast->image[5].value, sqrt((20 + 4e6) / (1010 + 1e6) * (20 + 1e6) / (1010 + 5e5)));
    assert_true(s.rows[3].reference);
    assert_near(s.rows[3].trace.value, 1);
    expect_words(&s, "Fastest build", "fast, 100 Mprims/s");
    uint32_t held = 0;
    while (fast->curve_first[held + 1])
        held++;
    /* 10^3 rays and four more to each power of ten */
    assert_near(bb_summary_curve_count(held), 1e6 * pow(10, 0.75));
    expect_words(&s, "Fastest image", "fast up to 5.6 M rays; ");
    expect_words(&s, "Fastest image", "beyond, slow");
    expect_words(&s, "For 1 G rays", "slow, not told from alike; fast takes ");
    expect_words(&s, "Right answers", "no wrong one in 12 M, on 2 M different rays: below 1.5 per");
    bb_summary_free(&s);
    assert_int_equal(bb_summary_make(results, &(bb_summary_choice){"b", NULL}, &s), BB_OK);
    assert_near(row_of(&s, "slow")->trace.value, 2);
    bb_summary_free(&s);
    bb_results_destroy(results);
}

static void ties_are_what_rounds_cannot_tell(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    const bb_summary_row *slow = row_of(&s, "slow"), *alike = row_of(&s, "alike");
    assert_int_equal(slow->group, 0);
    assert_int_equal(alike->group, 0);
    assert_int_equal(row_of(&s, "fast")->group, 1);
    assert_true(slow->trace.best && alike->trace.tied && !slow->trace.tied);
    assert_true(alike->trace.low < slow->trace.value && alike->trace.high > slow->trace.value);
    expect_words(&s, "Fastest trace", "not told apart; fast is ");
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* What other tracers lose is said of them, not of the builders. */
static void wrong_answers_of_tracers_are_theirs(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    const traced t = {.scene = "a",
                      .builder = "peer",
                      .rays = "random",
                      .kernel = "own",
                      .intersector = "own",
                      .ms = 100,
                      .wrong_ppm = 3,
                      .reference = true};
    add_build(d, t.scene, t.builder, 100, true);
    add_trace(d, &t);
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    expect_words(&s, "Other tracers", "of a million rays they get 0 (");
    expect_words(&s, "Other tracers", ") to 3 (peer) wrong");
    expect_words(&s, "Right answers", "no wrong one in ");
    assert_null(strstr(sentence_of(&s, "Right answers"), "peer"));
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* A builder whose answers are wrong on some rays has no rank by them, and is named. */
static void wrong_answers_win_nothing(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    const traced t = {.scene = "a",
                      .builder = "fast",
                      .rays = "random",
                      .kernel = "wrong",
                      .intersector = "exact",
                      .ms = 1,
                      .wrong_ppm = 3};
    add_trace(d, &t);
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    assert_near(row_of(&s, "fast")->trace.value, 0.5);
    assert_true(row_of(&s, "fast")->wrong == 3);
    expect_words(&s, "Right answers", "WRONG: fast lost 3 of 5 M rays");
    bb_summary_free(&s);
    bb_results_destroy(results);
}

static void same_standing(const cJSON *json, const bb_standing *standing)
{
    assert_near(cJSON_GetNumberValue(cJSON_GetObjectItem(json, "value")), standing->value);
    assert_int_equal(cJSON_IsTrue(cJSON_GetObjectItem(json, "best")), standing->best);
    assert_int_equal(cJSON_IsTrue(cJSON_GetObjectItem(json, "tied")), standing->tied);
}

/* One choice of each scene and of rays, and of all; figure by figure what the terminal has. */
static void the_page_gets_the_same_figures(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    double bytes = 1000;
    for (bb_entry *build = d->sections[BB_BUILDS].first; build != NULL; build = build->next) {
        bb_put_number(build, BB_F_TREE_BYTES_PEAK, bytes += 10);
        bb_table_set_number(d->table, build->row, bb_metric_column(&bb_metric_sah, false),
                            bytes / 7);
    }
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    char *text = bb_summary_json(results);
    cJSON *page = cJSON_Parse(text), *choices = cJSON_GetObjectItem(page, "choices");
    assert_int_equal(cJSON_GetArraySize(choices), 3 * 2);
    const cJSON *rows = cJSON_GetObjectItem(cJSON_GetArrayItem(choices, 0), "rows");
    assert_int_equal(cJSON_GetArraySize(rows), (int)s.row_count);
    for (uint32_t i = 0; i < s.row_count; i++) {
        const cJSON *row = cJSON_GetArrayItem(rows, (int)i);
        const bb_summary_row *same = &s.rows[i];
        const struct {
            const char *name;
            double value;
        } figures[] = {{"peak", same->peak},       {"wrong", same->wrong},
                       {"checked", same->checked}, {"failed", same->failed},
                       {"sets", same->sets},       {"mrays_s", same->mrays_s}};
        assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(row, "builder")),
                            same->builder);
        for (size_t k = 0; k < sizeof figures / sizeof figures[0]; k++)
            assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(row, figures[k].name)) ==
                        figures[k].value);
        same_standing(cJSON_GetObjectItem(row, "trace"), &same->trace);
        same_standing(cJSON_GetObjectItem(row, "build"), &same->build);
        same_standing(cJSON_GetObjectItem(row, "ready"), &same->ready);
        same_standing(cJSON_GetObjectItem(row, "quality"), &same->quality);
        for (int k = 0; k < BB_SUMMARY_COUNTS; k++)
            same_standing(cJSON_GetArrayItem(cJSON_GetObjectItem(row, "image"), k),
                          &same->image[k]);
        for (int k = 0; k < BB_SUMMARY_CURVE; k++)
            assert_near(
                cJSON_GetNumberValue(cJSON_GetArrayItem(cJSON_GetObjectItem(row, "curve"), k)),
                same->curve[k]);
    }
    cJSON_Delete(page);
    free(text);
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* So have answers that other trees do not give, however right they seem; what failed is counted. */
static void unlike_and_failed_cells_are_counted(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    traced t = {.scene = "a",
                .builder = "fast",
                .rays = "random",
                .kernel = "odd",
                .intersector = "exact",
                .ms = 1,
                .unlike = 2};
    add_trace(d, &t);
    t = (traced){.scene = "a",
                 .builder = "slow",
                 .rays = "random",
                 .kernel = "broken",
                 .intersector = "exact",
                 .ms = 1};
    bb_put_text(add_trace(d, &t), BB_F_TRACE_STATUS, "failed");
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    assert_near(row_of(&s, "fast")->trace.value, 0.5);
    assert_true(row_of(&s, "fast")->wrong == 2);
    assert_int_equal(row_of(&s, "slow")->failed, 1);
    assert_near(row_of(&s, "slow")->trace.value, sqrt(2));
    expect_words(&s, "Right answers", "WRONG: fast lost 2 of ");
    expect_words(&s, "Right answers", "1 builds or cells were refused or failed");
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* Rays that one of three builders traced do not compare them. */
static void lonely_sets_are_left_aside(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    traced t = {.scene = "a",
                .builder = "slow",
                .rays = "edges",
                .kernel = "stack",
                .intersector = "exact",
                .ms = 1};
    add_trace(d, &t);
    t.intersector = "careless";
    t.wrong_ppm = 40;
    t.ms = 0.5;
    add_trace(d, &t);
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    assert_int_equal(s.sets, 2);
    assert_int_equal(s.sets_aside, 1);
    assert_near(row_of(&s, "slow")->trace.value, sqrt(2));
    assert_int_equal(s.accuracy_count, 2);
    assert_string_equal(s.accuracy[0].intersector, "exact");
    assert_near(s.accuracy[1].speed, 2);
    assert_near(s.accuracy[1].wrong, 40);
    expect_words(&s, "Intersectors", "exact none, 1.00x; careless 40, 2.00x");
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* A builder that traced nothing but such rays has no row, unless it answered wrong. */
static void who_traced_no_common_rays_has_no_row(void **state)
{
    (void)state;
    for (int wrong = 0; wrong < 2; wrong++) {
        bb_results *d = three_builders();
        const traced t = {.scene = "a",
                          .builder = "lonely",
                          .rays = "edges",
                          .kernel = "stack",
                          .intersector = "exact",
                          .wrong_ppm = wrong * 40,
                          .ms = 1};
        add_build(d, "a", t.builder, 10, false);
        add_trace(d, &t);
        bb_summary s;
        bb_results *results = summary_of(d, &s);
        assert_int_equal(s.builder_count, 3 + wrong);
        assert_int_equal(s.row_count, 4 + wrong);
        if (wrong != 0)
            assert_true(row_of(&s, "lonely")->wrong > 0);
        bb_summary_free(&s);
        /* alone with its rays, it has one */
        assert_int_equal(bb_summary_make(results, &(bb_summary_choice){NULL, "edges"}, &s), BB_OK);
        assert_int_equal(s.sets, 0);
        assert_non_null(row_of(&s, "lonely"));
        bb_summary_free(&s);
        bb_results_destroy(results);
    }
}

static void nothing_to_say_is_no_error(void **state)
{
    (void)state;
    bb_results *results = read_back(empty_document());
    bb_summary s;
    assert_int_equal(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, &s), BB_OK);
    assert_int_equal(s.row_count, 0);
    bb_summary_free(&s);
    bb_results_destroy(results);

    bb_results *builds = empty_document(); /* as with --rays none */
    add_scene(builds, "a", 1e6);
    add_build(builds, "a", "one", 10, false);
    add_build(builds, "a", "two", 20, false);
    results = read_back(builds);
    assert_int_equal(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, &s), BB_OK);
    assert_string_equal(s.rows[0].builder, "one");
    assert_true(isnan(s.rows[0].trace.value) && s.rows[0].build.best);
    expect_words(&s, "Fastest build", "one, 100 Mprims/s; 2.00x two");
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* Builders that lack scenes or rays, or whose layout is not known, win nothing. */
static void what_is_partial_has_no_rank(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    static const char *const names[] = {"lucky", "failing", "weightless"};
    for (int b = 0; b < 3; b++)
        for (int s = 0; s < 2; s++) {
            traced t = {.scene = s == 0 ? "a" : "b",
                        .builder = names[b],
                        .rays = "random",
                        .kernel = "stack",
                        .intersector = "exact",
                        .ms = b == 2 ? 300 : 1};
            t.layout = b == 2 ? "unknown" : NULL;
            bb_entry *build = add_build(d, t.scene, t.builder, 0.1, false);
            if (b == 1)
                bb_put_text(build, BB_F_BUILD_STATUS, "failed");
            else if (b == 2 || s == 1)
                add_trace(d, &t);
        }
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    assert_int_equal(s.builder_count, 6);
    const bb_summary_row *lucky = row_of(&s, "lucky"), *failing = row_of(&s, "failing");
    assert_true(lucky->partial && !lucky->trace.best && !lucky->build.best);
    assert_int_equal(lucky->sets, 1);
    assert_true(failing->partial && failing->failed == 2 && isnan(failing->build.value));
    assert_true(isnan(row_of(&s, "weightless")->image[0].value));
    expect_words(&s, "Fastest trace", "slow, alike");
    expect_words(&s, "Right answers", "2 builds or cells were refused or failed");
    expect_words(&s, "Right answers", "2 builders lack scenes or rays");
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* Rounds of two runs were not next to each other: nothing is said of their differences. */
static void runs_are_not_held_against_each_other(void **state)
{
    (void)state;
    bb_results *first = three_builders(), *second = three_builders();
    for (bb_entry *trace = second->sections[BB_TRACES].first; trace != NULL; trace = trace->next) {
        bb_samples ms; /* on a machine half as fast */
        assert_true(bb_get_samples(trace, BB_F_TRACE_MS, &ms));
        for (uint32_t i = 0; i < ms.count; i++)
            ms.values[i] *= 2;
        bb_put_rounds(trace, BB_F_TRACE_MS, &ms);
    }
    bb_results *a = read_back(first), *b = read_back(second);
    bb_summary s;
    assert_int_equal(bb_results_merge(a, b), BB_OK);
    assert_int_equal(bb_summary_make(a, &(bb_summary_choice){NULL, NULL}, &s), BB_OK);
    assert_int_equal(s.builder_count, 6);
    for (uint32_t i = 0; i < s.builder_count; i++) {
        const bb_summary_row *row = &s.rows[i];
        assert_true(!row->build.tied || row->run == row_of(&s, "fast")->run);
        if (strcmp(row->builder, "slow") == 0) /* to its own run's reference */
            assert_near(row->trace.value, sqrt(2));
    }
    assert_int_equal(s.rounds, ROUNDS - 1);
    assert_true(s.distinct == 2e6);
    bb_summary_free(&s);
    bb_results_destroy(b);
    bb_results_destroy(a);
}

static void a_busy_machine_is_said(void **state)
{
    (void)state;
    static const double others[] = {0.2, 0.9};
    for (int i = 0; i < 2; i++) {
        bb_results *d = empty_document();
        char text[256];
        bb_put_number(d->context, BB_F_CONTEXT_OTHERS, others[i]);
        bb_results *results = read_back(d);
        assert_int_equal(bb_summary_busy(results, text), i == 1);
        if (i == 1)
            assert_non_null(strstr(text, "0.9 of its 4 threads"));
        bb_results_destroy(results);
    }
}

/* Names fit their column, and say which run of several. */
static void long_names_are_shortened(void **state)
{
    (void)state;
    static const char of_options[] = "tree:quality=medium,mode=robust,query=stream";
    bb_results *d = empty_document();
    add_scene(d, "a", 1e6);
    add_build(d, "a", of_options, 10, false);
    add_build(d, "a", "a-tree-with-a-name-that-is-much-too-long-for-a-column", 10, false);
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    assert_string_equal(row_of(&s, of_options)->name, "tree:medium,robust,stream");
    for (uint32_t i = 0; i < s.row_count; i++)
        assert_true(strlen(s.rows[i].name) <= 32);
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* Traces are divided by the reference that is fastest on the ray set; the words say which. */
static void the_fastest_reference_is_named(void **state)
{
    (void)state;
    bb_results *d = three_builders();
    for (int s = 0; s < 2; s++) {
        const traced t = {.scene = s == 0 ? "a" : "b",
                          .builder = "embree-native:query=packets",
                          .rays = "random",
                          .kernel = "own",
                          .intersector = "own",
                          .ms = s == 0 ? 50 : 200,
                          .reference = true};
        add_build(d, t.scene, t.builder, 100, true);
        add_trace(d, &t);
    }
    bb_summary s;
    bb_results *results = summary_of(d, &s);
    assert_near(row_of(&s, "slow")->trace.value, sqrt(0.5 * 2.0));
    assert_int_equal(row_of(&s, "embree-native:query=packets")->yardstick, 1);
    assert_int_equal(row_of(&s, "embree-native:mode=fast")->yardstick, 1);
    expect_words(&s, "Fastest of Embree", "on 1 of 2 ray sets, ");
    expect_words(&s, "Fastest of Embree", "packets");
    expect_words(&s, "Other tracers", "the fastest on all ray sets, traces ");
    expect_words(&s, "Other tracers", "; none of their answers was wrong");
    bb_summary_free(&s);
    assert_int_equal(bb_summary_make(results, &(bb_summary_choice){"a", NULL}, &s), BB_OK);
    assert_int_equal(row_of(&s, "embree-native:query=packets")->yardstick, 1);
    assert_int_equal(row_of(&s, "embree-native:mode=fast")->yardstick, 0);
    bb_summary_free(&s);
    bb_results_destroy(results);
}

/* Who loses most rays is fast for that reason: a tracer that loses more than one in a hundred is no
 * yardstick, and has no speed. */
static void who_loses_rays_has_no_speed(void **state)
{
    (void)state;
    static const double wrong_ppm[] = {9999, 10001};
    for (int i = 0; i < 2; i++) {
        bb_results *d = three_builders();
        const traced t = {.scene = "a",
                          .builder = "embree-native:query=packets",
                          .rays = "random",
                          .kernel = "own",
                          .intersector = "own",
                          .ms = 1,
                          .wrong_ppm = wrong_ppm[i],
                          .reference = true};
        add_build(d, t.scene, t.builder, 100, true);
        add_trace(d, &t);
        bb_results *results = read_back(d);
        bb_summary s;
        assert_int_equal(bb_summary_make(results, &(bb_summary_choice){"a", NULL}, &s), BB_OK);
        assert_int_equal(row_of(&s, "embree-native:mode=fast")->yardstick, i);
        bb_summary_free(&s);
        bb_results_destroy(results);
    }
}

/* In one scene of two, `part` of the builds of "fast" is done once more outside the clock. */
static bb_results *with_untimed(double part, bb_field_id where)
{
    bb_results *d = three_builders();
    const bb_samples rounds = samples(part * 10, 0);
    const bb_cell cell = {{[BB_SCENE] = "b", [BB_BUILDER] = "fast"}};
    bb_put_rounds(bb_results_find(d, cell), where, &rounds);
    return read_back(d);
}

static void work_outside_the_clock_wins_nothing_by_builds(void **state)
{
    (void)state;
    bb_summary s;
    for (int i = 0; i < 2; i++) {
        bb_results *results =
            with_untimed(0.2, i == 0 ? BB_F_BUILD_RESTORE_MS : BB_F_BUILD_OUTSIDE_MS);
        assert_int_equal(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, &s), BB_OK);
        const bb_summary_row *fast = row_of(&s, "fast"), *slow = row_of(&s, "slow");
        assert_true(fast->leaves_out && !slow->leaves_out);
        assert_near(fast->untimed, 0.2);
        assert_near(fast->build.value, 100); /* the figure itself stays */
        assert_true(!fast->build.best && !fast->build.tied && !fast->image[0].best);
        assert_true(slow->build.best || slow->build.tied);
        assert_true(!fast->curve_first[0]);
        assert_null(strstr(sentence_of(&s, "Fastest build"), "fast"));
        assert_null(strstr(sentence_of(&s, "Fastest image"), "fast"));
        expect_words(&s, "Not clocked", "with each build fast does other work for 0.20x its time");
        bb_summary_free(&s);
        bb_results_destroy(results);
    }
    bb_results *results = with_untimed(0.09, BB_F_BUILD_RESTORE_MS);
    assert_int_equal(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, &s), BB_OK);
    assert_true(!row_of(&s, "fast")->leaves_out && row_of(&s, "fast")->build.best);
    assert_string_equal(sentence_of(&s, "Not clocked"), "");
    bb_summary_free(&s);
    bb_results_destroy(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(means_are_geometric_and_over_all_sets),
        cmocka_unit_test(ties_are_what_rounds_cannot_tell),
        cmocka_unit_test(wrong_answers_of_tracers_are_theirs),
        cmocka_unit_test(wrong_answers_win_nothing),
        cmocka_unit_test(unlike_and_failed_cells_are_counted),
        cmocka_unit_test(the_page_gets_the_same_figures),
        cmocka_unit_test(lonely_sets_are_left_aside),
        cmocka_unit_test(who_traced_no_common_rays_has_no_row),
        cmocka_unit_test(nothing_to_say_is_no_error),
        cmocka_unit_test(what_is_partial_has_no_rank),
        cmocka_unit_test(runs_are_not_held_against_each_other),
        cmocka_unit_test(a_busy_machine_is_said),
        cmocka_unit_test(long_names_are_shortened),
        cmocka_unit_test(the_fastest_reference_is_named),
        cmocka_unit_test(who_loses_rays_has_no_speed),
        cmocka_unit_test(work_outside_the_clock_wins_nothing_by_builds),
    };
    return cmocka_run_group_tests_name("summary", tests, NULL, NULL);
}
