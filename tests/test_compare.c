/* What `bvhbench compare` says: which figures count as worse, what cannot be compared. */
#include "tests/compare_edits.h"

#include "framework/compare/figures.h"
#include "framework/report/report_compare.h"
#include "framework/report/report_junit.h"

/* The comparison of the sample with an edited one, as text. */
static bb_comparison_result compare_with(edit_fn *edit, char *text, size_t capacity, bool github)
{
    static bb_cell_set sets[2];
    static bb_results *results[2];
    bb_comparison_result result;
    for (int k = 0; k < 2; k++) {
        bb_cell_set_free(&sets[k]);
        bb_results_destroy(results[k]);
        results[k] = history_run("one", "here", "2024-01-01T00:00:00Z", nothing, (uint64_t)k + 1);
    }
    edit(results[1]);
    ASSERT_OK(bb_cell_set_of_table(bb_results_table(results[0]), "OLD", &sets[0]));
    ASSERT_OK(bb_cell_set_of_table(bb_results_table(results[1]), "NEW", &sets[1]));
    ASSERT_OK(bb_compare(&(bb_side){&sets[0], 1}, &(bb_side){&sets[1], 1}, NAN, NULL, &result));
    FILE *out = fmemopen(text, capacity, "w");
    assert_non_null(out);
    ASSERT_OK(bb_report_compare(&result, github, out));
    fclose(out);
    return result;
}

static uint32_t occurrences(const char *text, const char *word)
{
    uint32_t count = 0;
    for (const char *at = text; (at = strstr(at, word)) != NULL; at += strlen(word))
        count++;
    return count;
}

/* Each cell is a test; those that are worse or missing fail, as the exit status counts them. */
static void cells_are_tests_for_ci(void **state)
{
    (void)state;
    static const struct {
        edit_fn *edit;
        uint32_t failures;
        const char *words;
    } cases[] = {
        {edit_nothing, 0, "<skipped message=\"a reference does not count\"/>"},
        {edit_sah, 1, "<failure message=\"sah: 97.3, then 99.25, ratio 1.020\">"},
        {edit_slower, 1, "<failure message=\"trace ms: "},
        {edit_faster, 0, "<testcase"},
        {edit_failed, 1, "<failure message=\"status: ok, then failed\">"},
        {edit_slower_reference, 0, "<testcase"},
        {edit_gone, 1, "<failure message=\"the cell is missing\"/>"},
        {edit_layout_gone, 0, "<skipped message=\"the cell is missing, which does not count\"/>"},
        {edit_rays, 0, "<skipped message=\"not compared: another scene, or other rays\"/>"},
    };
    static char text[1 << 20], xml[1 << 20];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_comparison_result result = compare_with(cases[i].edit, text, sizeof text, false);
        memset(xml, 0, sizeof xml);
        FILE *out = fmemopen(xml, sizeof xml - 1, "w");
        assert_non_null(out);
        ASSERT_OK(bb_report_junit(&result, out));
        fclose(out);
        char counted[40];
        snprintf(counted, sizeof counted, " failures=\"%u\"", cases[i].failures);
        if (strstr(xml, counted) == NULL || strstr(xml, cases[i].words) == NULL)
            fail_msg("case %zu: no %s, or no %s in %.2000s", i, counted, cases[i].words, xml);
        assert_int_equal(occurrences(xml, "<failure"), cases[i].failures);
        assert_int_equal(occurrences(xml, "<testcase"), occurrences(xml, "</testcase>"));
        bb_compare_free(&result);
    }
}

/* Edits; what is worse afterwards; words of the text. */
static void what_moved_and_what_is_worse(void **state)
{
    (void)state;
    static const struct {
        edit_fn *edit;
        uint32_t worse, moves;
        const char *words;
    } cases[] = {
        {edit_nothing, 0, 0, "nothing is worse"},
        {edit_sah, 1, 1, " sah "},
        {edit_sah_better, 0, 1, "\nbetter: 1\n"},
        {edit_layout_sah, 1, 1, "/layout=pair:leaf=4 layout_sah "},
        {edit_layout_slower, 1, 1, "/layout=pair:leaf=4 layout ms "},
        {edit_nodes, 0, 1, "\nchanged: 1\n"},
        {edit_bytes, 1, 1, "bytes_peak"},
        {edit_tests, 1, 1, "node_tests_per_ray"},
        {edit_missed, 1, 1, "missed"},
        {edit_failed, 1, 1, " status  ok      failed "},
        {edit_slower, 1, 1, "trace ms"},
        {edit_faster, 0, 1, "\nbetter: 1\n"},
        {edit_slower_reference, 0, 1, "(reference: does not count)"},
        {edit_slower_elsewhere, 0, 0, "WARNING: other machines: no times are compared"},
        {edit_slower_host, 1, 1, "WARNING: other hosts"},
        {edit_rays, 0, 0, "WARNING: 1 cells are not compared: their scene or their rays"},
        {edit_cut_rounds, 0, 0, "fewer than 6 rounds have no interval"},
        {edit_short_keys, 0, 0, "- 258 cells in both;"},
        {edit_gone, 0, 0, "1 cells are in OLD only"},
        {edit_twice, 0, 0, "WARNING: 1 cells are left out: their keys occur twice"},
        {edit_seed, 0, 0, "another seed: 1234567890123456789, 7"},
        {edit_governor, 0, 0, "WARNING: governor: performance, then powersave: times may differ"},
        {edit_smt, 0, 0, "WARNING: SMT: off, then on: "},
        {edit_boost, 0, 0, "WARNING: boost: off, then on: "},
        {edit_processors, 0, 0, "WARNING: processors used: all, then 0-1: "},
        {edit_faster_quiet, 0, 1, "\nbetter: 1\n"},
        {edit_faster_busy, 0, 1, "\nless, but undecided: 1\n"},
        {edit_faster_busy, 0, 1, "WARNING: the machine was busy: other programs kept 50 %"},
        {edit_slower_busy, 1, 1, "WARNING: the machine was busy: "},
        {edit_no_figure, 0, 1, "1 figures are in one of the two only"},
        {edit_no_figure, 0, 1, "\nchanged: 1\n"},
        {edit_no_tree, 0, 10, "bytes_tree"},
        {edit_unjudged, 5, 7, "missed"},
        {edit_fewer_judged, 0, 1, "checked"},
        {edit_none_judged, 1, 1, "checked"},
    };
    static char text[1 << 20];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_comparison_result r = compare_with(cases[i].edit, text, sizeof text, false);
        if (r.worse != cases[i].worse || r.move_count != cases[i].moves ||
            strstr(text, cases[i].words) == NULL)
            fail_msg("case %zu: %u worse, %u moved, expected %u, %u and '%s':\n%s", i, r.worse,
                     r.move_count, cases[i].worse, cases[i].moves, cases[i].words, text);
        assert_non_null(strstr(text, "10.00 %: assumed"));
        bb_compare_free(&r);
    }
}

/* Nobody is warned of what one of the machines does not say, or of a machine that is quiet. */
static void what_is_not_known_is_no_difference(void **state)
{
    (void)state;
    static edit_fn *const edits[] = {edit_nothing, edit_no_governor, edit_faster_quiet};
    static char text[1 << 20];
    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        bb_comparison_result r = compare_with(edits[i], text, sizeof text, false);
        assert_null(strstr(text, "differ by that alone"));
        assert_null(strstr(text, "was busy"));
        bb_compare_free(&r);
    }
}

/* Whichever of the two was measured on a busy machine; pairs bear that. */
static void only_runs_by_themselves_need_a_quiet_machine(void **state)
{
    (void)state;
    for (int busy = 0; busy < 3; busy++) {
        bb_cell_set sets[2][2];
        bb_comparison_result result;
        for (int k = 0; k < 4; k++) {
            bb_results *r = history_run("one", "here", "2024-01-01T00:00:00Z", nothing, 1);
            set_busy(r, k % 2 == busy ? 3 : 0);
            ASSERT_OK(bb_cell_set_of_table(bb_results_table(r), "RUN", &sets[k % 2][k / 2]));
            bb_results_destroy(r);
        }
        for (uint32_t count = 1; count <= 2; count++) {
            ASSERT_OK(bb_compare(&(bb_side){sets[0], count}, &(bb_side){sets[1], count}, 0.1, NULL,
                                 &result));
            assert_int_equal(result.busy, count == 1 && busy < 2);
            bb_compare_free(&result);
        }
        for (int k = 0; k < 4; k++)
            bb_cell_set_free(&sets[k % 2][k / 2]);
    }
}

/* What a cell is measured on is part of what it is. Processors count as one device. */
static void cells_of_two_devices_do_not_meet(void **state)
{
    (void)state;
    static const struct {
        const char *types[2], *names[2];
        bool meet;
    } cases[] = {
        {{"CPU", "CPU"}, {"a processor", "another"}, true},
        {{"GPU", "GPU"}, {"a card", "a card"}, true},
        {{"GPU", "GPU"}, {"a card", "another"}, false},
        {{"CPU", "GPU"}, {"a processor", "a card"}, false},
        {{"", "CPU"}, {"a processor", "a processor"}, true}, /* not recorded */
        {{"", "CPU"}, {"a card", "a processor"}, false},
        {{"", ""}, {"a card", "a processor"}, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_cell_set sets[2];
        bb_comparison_result result;
        bb_results *runs[2];
        for (int k = 0; k < 2; k++) {
            bb_results *run = history_run("one", "here", "2024-01-01T00:00:00Z", nothing, 1);
            runs[k] = run;
            set_context(run, BB_F_CONTEXT_DEVICE_TYPE, cases[i].types[k]);
            set_context(run, BB_F_CONTEXT_DEVICE, cases[i].names[k]);
            ASSERT_OK(
                bb_cell_set_of_table(bb_results_table(run), k == 0 ? "OLD" : "NEW", &sets[k]));
        }
        /* nor do they stand in one report */
        assert_int_equal(bb_results_merge(runs[0], runs[1]), cases[i].meet ? BB_OK : BB_INVALID);
        for (int k = 0; k < 2; k++)
            bb_results_destroy(runs[k]);
        bb_status status =
            bb_compare(&(bb_side){&sets[0], 1}, &(bb_side){&sets[1], 1}, NAN, NULL, &result);
        if (status != (cases[i].meet ? BB_OK : BB_INVALID))
            fail_msg("case %zu: %s", i, status == BB_OK ? "compared" : bb_message());
        if (!cases[i].meet)
            assert_non_null(strstr(bb_message(), "OLD was measured on a"));
        else
            assert_true(result.common > 0);
        bb_compare_free(&result);
        for (int k = 0; k < 2; k++)
            bb_cell_set_free(&sets[k]);
    }
}

static void edit_much(bb_results *r)
{
    edit_sah(r);
    edit_slower(r);
    edit_nodes(r);
    scale_ms(trace_at(r, 20), BB_F_TRACE_MS, 2);
    scale_ms(trace_at(r, 30), BB_F_TRACE_MS, 0.4);
    edit_gone(r); /* number 5: only 20 and 30 are left of the times */
    bb_put_text(build_at(r, 4), BB_F_BUILD_CELL, "odd|`key`\033[31m");
}

static void worst_comes_first_and_markdown_holds(void **state)
{
    (void)state;
    static char text[1 << 20];
    bb_comparison_result r = compare_with(edit_much, text, sizeof text, true);
    assert_int_equal(r.worse, 2);
    assert_true(r.moves[0].timed && r.moves[0].effect.ratio > 1.9);
    assert_string_equal(r.moves[1].what, "sah");
    assert_int_equal(r.moves[2].verdict, BB_BETTER);
    assert_int_equal(r.moves[3].verdict, BB_CHANGED);
    assert_true(
        strncmp(text, "# bvhbench compare: 2 figures are worse, 2 cells are missing\n", 61) == 0);
    assert_non_null(strstr(text, "\n## worse: 2\n"));
    assert_true(r.sight_count > 0 && bb_compare_blind(&r, 0) == r.sight_count);
    assert_int_equal(bb_compare_blind(&r, INFINITY), 0);
    for (uint32_t i = 1; i < r.sight_count; i++)
        assert_true(r.sights[i].least <= r.sights[i - 1].least);
    assert_null(strchr(text, '\033'));
    assert_non_null(strstr(text, "- odd\\|\\`key\\`?\\[31m\n"));
    bb_compare_free(&r);
}

static void edit_texts(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_REVISION,
                "[x](https://e.test) ![i](u) @all #1 <b> *a* _b_ `c | $d$\033[2J");
    set_context(r, BB_F_CONTEXT_DRIVER, "www.e.test");
    set_context(r, BB_F_CONTEXT_DEVICE, "see http://e.test");
}

/* Whatever a file says, nothing of it is markup. */
static void texts_of_files_are_no_markup(void **state)
{
    (void)state;
    static char text[1 << 20];
    bb_comparison_result r = compare_with(edit_texts, text, sizeof text, true);
    static const char *const parts[] = {"[x](", "![i]", "@all", "#1 ",      "<b>",          "*a*",
                                        "_b_",  "$d$",  "[2J",  "www.e.te", "http://e.test"};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const char *at = strstr(text, parts[i]);
        uint32_t ticks = 0;
        assert_non_null(at);
        for (; at > text && at[-1] != '\n'; at--)
            ticks += at[-1] == '`';
        if (ticks % 2 != 1)
            fail_msg("'%s' is not within code:\n%s", parts[i], text);
    }
    assert_null(strchr(text, '\033'));
    assert_null(strstr(text, "`c"));
    bb_compare_free(&r);
}

/* ---- pairs: what happens in any that counts ---- */

enum { PAIRS = 14, EACH = PAIRS };

/* As much processor time as wall time. */
static void give_cpu(bb_entry *entry, bb_field_id wall, bb_field_id cpu)
{
    bb_samples rounds;
    assert_true(bb_get_samples(entry, wall, &rounds));
    bb_put_rounds(entry, cpu, &rounds);
}

/* Equals, but for `edit` in set `number` of `side`, or EACH of them; as text. */
static bb_status compare_pairs(edit_fn *edit, int side, uint32_t number,
                               bb_comparison_result *result, char *text, size_t capacity)
{
    static bb_cell_set sets[2][PAIRS];
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < PAIRS; i++) {
            bb_results *r = history_run("one", "here", "2024-01-01T00:00:00Z", nothing, 2 * i + k);
            give_cpu(trace_at(r, 5), BB_F_TRACE_MS, BB_F_TRACE_CPU_MS);
            give_cpu(build_at(r, 3), BB_F_BUILD_MS, BB_F_BUILD_CPU_SAMPLES);
            if (k == side && (i == number || number == EACH))
                edit(r);
            bb_cell_set_free(&sets[k][i]);
            ASSERT_OK(
                bb_cell_set_of_pair(bb_results_table(r), k == 0 ? "OLD" : "NEW", &sets[k][i]));
            bb_results_destroy(r);
        }
    bb_status status =
        bb_compare(&(bb_side){sets[0], PAIRS}, &(bb_side){sets[1], PAIRS}, NAN, NULL, result);
    FILE *out = fmemopen(text, capacity, "w");
    assert_non_null(out);
    if (status == BB_OK)
        ASSERT_OK(bb_report_compare(result, false, out));
    fclose(out);
    return status;
}

static void edit_revision(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_REVISION, "two");
}

static void any_pair_that_counts_decides(void **state)
{
    (void)state;
    static const struct {
        edit_fn *edit;
        int side;
        uint32_t number, worse, moves;
        const char *words;
    } cases[] = {
        {edit_failed, 1, 5, 1, 1, " status  ok      failed "},
        {edit_failed, 0, 9, 0, 1, " status  failed  ok "},
        {edit_failed, 1, 0, 0, 0, "nothing is worse"}, /* the discarded one */
        {edit_missed, 1, 9, 1, 1, "missed"},
        {edit_missed, 0, 4, 0, 1, "better: 1"},
        {edit_missed, 1, 0, 0, 0, "nothing is worse"},
        {edit_gone, 1, 3, 0, 0, "WARNING: 1 cells are not in all pairs"},
        {edit_gone, 0, 0, 0, 0, "nothing is worse"},
        {edit_rays, 1, 7, 0, 0, "their scene or their rays"},
        {edit_sah, 1, 2, 0, 0, "nothing is worse"}, /* a builder that is not deterministic */
    };
    static char text[1 << 20];
    bb_comparison_result r;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        ASSERT_OK(
            compare_pairs(cases[i].edit, cases[i].side, cases[i].number, &r, text, sizeof text));
        if (r.worse != cases[i].worse || r.move_count != cases[i].moves ||
            strstr(text, cases[i].words) == NULL ||
            (cases[i].number == 0 && strstr(text, "not in all pairs") != NULL))
            fail_msg("case %zu: %u worse, %u moved, expected %u, %u and '%s':\n%s", i, r.worse,
                     r.move_count, cases[i].worse, cases[i].moves, cases[i].words, text);
        bb_compare_free(&r);
    }
    static const struct {
        edit_fn *edit;
        const char *words;
    } refused[] = {{edit_revision, "NEW is of another revision in pair 6"},
                   {edit_slower_host, "NEW is of another machine in pair 6"},
                   {edit_slower_elsewhere, "another machine"},
                   {edit_seed, "another seed"}};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        assert_int_equal(compare_pairs(refused[i].edit, 1, 6, &r, text, sizeof text), BB_INVALID);
        assert_non_null(strstr(bb_message(), refused[i].words));
        bb_compare_free(&r);
    }
}

static void edit_more_cpu(bb_results *r)
{
    scale_ms(trace_at(r, 5), BB_F_TRACE_CPU_MS, 1.2);
}

static void edit_build_more_cpu(bb_results *r)
{
    scale_ms(build_at(r, 3), BB_F_BUILD_CPU_SAMPLES, 1.2);
}

/* On a GPU the host's processor time is not what is measured. */
static void edit_gpu_more_cpu(bb_results *r)
{
    edit_more_cpu(r);
    set_context(r, BB_F_CONTEXT_DEVICE_TYPE, "GPU");
}

/* Fails in one of the pairs, and takes more time in all. */
static void edit_more_cpu_one_failed(bb_results *r)
{
    static uint32_t pair;
    edit_more_cpu(r);
    if (pair++ % PAIRS == 5)
        edit_failed(r);
}

static void edit_restless_cpu(bb_results *r)
{
    static uint32_t pair;
    bb_samples rounds;
    if (pair++ % 2 != 0)
        return;
    const int traces = (int)bb_section_count(bb_results_section(r, BB_TRACES));
    for (int i = 0; i < traces; i++)
        if (bb_get_samples(trace_at(r, i), BB_F_TRACE_CPU_MS, &rounds))
            scale_ms(trace_at(r, i), BB_F_TRACE_CPU_MS, 1.5);
    scale_ms(build_at(r, 3), BB_F_BUILD_CPU_SAMPLES, 1.5);
}

/* Pairs see processor time, beside wall time. */
static void pairs_see_the_processors_time(void **state)
{
    (void)state;
    static const struct {
        edit_fn *edit;
        uint32_t worse;
        const char *words;
    } cases[] = {
        {edit_more_cpu, 1, "trace CPU ms"},
        {edit_build_more_cpu, 1, "build CPU ms"},
        {edit_slower, 1, "trace ms"},
        {edit_gpu_more_cpu, 0, "nothing is worse"},
        {edit_more_cpu_one_failed, 1, " status  ok      failed "}, /* and not twice */
    };
    static char text[1 << 20];
    bb_comparison_result r;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        ASSERT_OK(compare_pairs(cases[i].edit, 1, EACH, &r, text, sizeof text));
        if (r.worse != cases[i].worse || strstr(text, cases[i].words) == NULL)
            fail_msg("case %zu: %u worse, expected %u and '%s':\n%s", i, r.worse, cases[i].worse,
                     cases[i].words, text);
        bb_compare_free(&r);
    }
}

/* Processor time has a floor of its own, and a cell with both times one sight. */
static void floors_and_sights_of_the_processors_time(void **state)
{
    (void)state;
    static char text[1 << 20];
    bb_comparison_result r;
    ASSERT_OK(compare_pairs(edit_restless_cpu, 1, EACH, &r, text, sizeof text));
    if (!(r.floor.share < 0.05 && r.floor.clocks > 0.15))
        fail_msg("floors %g, %g", r.floor.share, r.floor.clocks);
    assert_true(r.clocks > 2);
    assert_int_equal(r.worse, 0);
    assert_non_null(strstr(text, " and processor times of "));
    for (uint32_t i = 0; i < r.sight_count; i++) {
        assert_false(bb_is_clock(r.sights[i].cell->key)); /* of these, wall time shows more */
        for (uint32_t j = 0; j < i; j++)
            assert_string_not_equal(r.sights[i].cell->key, r.sights[j].cell->key);
    }
    bb_compare_free(&r);
}

static void senses_of_figures(void **state)
{
    (void)state;
    static const char *const costs[] = {"sah",        "layout_sah", "layout_bytes",
                                        "bytes_tree", "missed",     "prim_tests_per_ray",
                                        "wrong_t",    "overflowed"};
    static const char *const neutral[] = {"nodes", "depth",     "count",
                                          "prims", "t_ulp_max", "no such figure"};
    bb_cell_set set;
    bb_results *results = history_run("one", "here", "2024-01-01T00:00:00Z", nothing, 1);
    ASSERT_OK(bb_cell_set_of_table(bb_results_table(results), "it", &set));
    uint32_t found[sizeof costs / sizeof costs[0]] = {0};
    for (uint32_t c = 0; c < set.count; c++) {
        for (size_t i = 0; i < sizeof costs / sizeof costs[0]; i++)
            if (isfinite(bb_measured_figure(&set.cells[c], costs[i]))) {
                assert_int_equal(bb_measured_better(&set.cells[c], costs[i]), BB_BETTER_LESS);
                found[i]++;
            }
        for (size_t i = 0; i < sizeof neutral / sizeof neutral[0]; i++)
            assert_int_equal(bb_measured_better(&set.cells[c], neutral[i]), BB_BETTER_NEITHER);
    }
    for (size_t i = 0; i < sizeof costs / sizeof costs[0]; i++)
        if (found[i] == 0)
            fail_msg("no cell has %s", costs[i]);
    bb_cell_set_free(&set);
    bb_results_destroy(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_moved_and_what_is_worse),
        cmocka_unit_test(cells_are_tests_for_ci),
        cmocka_unit_test(what_is_not_known_is_no_difference),
        cmocka_unit_test(only_runs_by_themselves_need_a_quiet_machine),
        cmocka_unit_test(cells_of_two_devices_do_not_meet),
        cmocka_unit_test(worst_comes_first_and_markdown_holds),
        cmocka_unit_test(any_pair_that_counts_decides),
        cmocka_unit_test(pairs_see_the_processors_time),
        cmocka_unit_test(floors_and_sights_of_the_processors_time),
        cmocka_unit_test(texts_of_files_are_no_markup),
        cmocka_unit_test(senses_of_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
