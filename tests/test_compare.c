/* `bvhbench compare`: which figures count as worse, what is said of what cannot be compared; files,
 * revisions and programs from outside. */
#include "tests/history_sample.h"
#include "tests/program_fixture.h"

#include "framework/compare/figures.h"
#include "framework/report/report_compare.h"

#include <sys/stat.h>

static const history_change nothing = {-1, -1, -1};

/* ---- made-up documents ---- */

typedef void edit_fn(bb_results *results);

static bb_entry *trace_at(bb_results *results, int index)
{
    return entry_at(results, BB_TRACES, index);
}

static bb_entry *build_at(bb_results *results, int index)
{
    return entry_at(results, BB_BUILDS, index);
}

static void scale(bb_entry *entry, bb_field_id field, double factor)
{
    bb_put_number(entry, field, factor * bb_get_number(entry, field));
}

static void scale_metric(bb_results *results, bb_entry *build, const char *name, double factor)
{
    put_metric(results, build, name, factor * metric_of(build, name));
}

static void scale_ms(bb_entry *trace, double factor)
{
    bb_samples rounds;
    assert_true(bb_get_samples(trace, BB_F_TRACE_MS, &rounds));
    for (uint32_t i = 0; i < rounds.count; i++)
        rounds.values[i] *= factor;
    bb_put_rounds(trace, BB_F_TRACE_MS, &rounds);
}

/* Takes away all figures of a part of the entry. */
static void clear_part(bb_entry *entry, bb_field_part part)
{
    for (int id = 0; id < BB_FIELDS; id++)
        if (bb_fields[id].part == part)
            bb_put_number(entry, (bb_field_id)id, (double)NAN);
}

static void set_context(bb_results *results, bb_field_id field, const char *text)
{
    ASSERT_OK(bb_results_set_text(results, field, text));
}

static void edit_nothing(bb_results *results)
{
    (void)results;
}

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

/* Edits; what is worse afterwards; words of the text. */
static void edit_sah(bb_results *r)
{
    scale_metric(r, build_at(r, 3), "sah", 1.02);
}
static void edit_sah_better(bb_results *r)
{
    scale_metric(r, build_at(r, 3), "sah", 0.98);
}
static void edit_layout_sah(bb_results *r)
{
    scale(bb_results_part(r, build_at(r, 3), "pair:leaf=4"), BB_F_BUILD_LAYOUTS_SAH, 1 + 1e-12);
}
static void edit_nodes(bb_results *r)
{
    scale(build_at(r, 3), BB_F_TREE_NODES, 1.5);
}
static void edit_bytes(bb_results *r)
{
    bb_entry *build = build_at(r, 3);
    bb_put_number(build, BB_F_TREE_BYTES_PEAK, bb_get_number(build, BB_F_TREE_BYTES_PEAK) + 1);
}
static void edit_tests(bb_results *r)
{
    scale(trace_at(r, 5), BB_F_TRACE_NODE_TESTS, 1.001);
}
static void edit_missed(bb_results *r)
{
    bb_put_number(trace_at(r, 0), BB_F_ACCURACY_MISSED, 1);
}
static void edit_failed(bb_results *r)
{
    bb_put_text(trace_at(r, 5), BB_F_TRACE_STATUS, "failed");
}
static void edit_slower(bb_results *r)
{
    scale_ms(trace_at(r, 5), 1.5);
}
static void edit_faster(bb_results *r)
{
    scale_ms(trace_at(r, 5), 0.5);
}
static void edit_slower_reference(bb_results *r)
{
    bb_entry *trace = trace_at(r, 0);
    while (!bb_get_true(trace, BB_F_TRACE_REFERENCE))
        trace = trace->next;
    scale_ms(trace, 1.5);
}
static void edit_slower_elsewhere(bb_results *r)
{
    edit_slower(r);
    set_context(r, BB_F_CONTEXT_DEVICE, "another device");
}
static void edit_slower_host(bb_results *r)
{
    edit_slower(r);
    set_context(r, BB_F_CONTEXT_HOST, "there");
}
static void edit_rays(bb_results *r)
{
    bb_put_text(trace_at(r, 5), BB_F_TRACE_RAYS_HASH, "0123");
    scale_ms(trace_at(r, 5), 1.5);
    scale(trace_at(r, 5), BB_F_TRACE_NODE_TESTS, 1.5);
}
static void edit_cut_rounds(bb_results *r)
{
    edit_slower(r);
    bb_samples rounds;
    assert_true(bb_get_samples(trace_at(r, 5), BB_F_TRACE_MS, &rounds));
    rounds.count--;
    bb_put_rounds(trace_at(r, 5), BB_F_TRACE_MS, &rounds);
}
static void edit_gone(bb_results *r)
{
    leave_out_entry(r, trace_at(r, 5));
}
static void edit_twice(bb_results *r)
{
    bb_put_text(trace_at(r, 6), BB_F_TRACE_CELL, bb_get_text(trace_at(r, 5), BB_F_TRACE_CELL));
}
static void edit_seed(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_SEED, "7");
}
static void edit_no_figure(bb_results *r)
{
    put_metric(r, build_at(r, 3), "sah", (double)NAN);
}

static void edit_no_tree(bb_results *r)
{
    bb_entry *build = build_at(r, 3);
    clear_part(build, BB_IN_TREE);
    for (uint32_t m = 0; m < bb_metric_count(); m++)
        put_metric(r, build, bb_metrics[m]->name, (double)NAN);
}
static void edit_unjudged(bb_results *r)
{
    clear_part(trace_at(r, 5), BB_IN_ACCURACY);
}
static void edit_fewer_judged(bb_results *r)
{
    scale(trace_at(r, 5), BB_F_ACCURACY_CHECKED, 0.5);
}
static void edit_none_judged(bb_results *r)
{
    scale(trace_at(r, 5), BB_F_ACCURACY_CHECKED, 0);
}
static void put_in_all(bb_results *r, bb_section_id section, bb_field_id field, const char *text)
{
    for (bb_entry *entry = entry_at(r, section, 0); entry != NULL; entry = entry->next)
        bb_put_text(entry, field, text);
}

static void edit_all_scenes(bb_results *r)
{
    put_in_all(r, BB_SCENES, BB_F_SCENE_HASH, "0123456789abcdef");
}

static void edit_all_failed(bb_results *r)
{
    put_in_all(r, BB_BUILDS, BB_F_BUILD_STATUS, "failed");
    put_in_all(r, BB_TRACES, BB_F_TRACE_STATUS, "failed");
}

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
        {edit_layout_sah, 1, 1, "layout_sah pair:leaf=4"},
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
        {edit_gone, 0, 0, "1 cells are in OLD only"},
        {edit_twice, 0, 0, "WARNING: 1 cells are left out: their keys occur twice"},
        {edit_seed, 0, 0, "another seed: 1234567890123456789, 7"},
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

/* Each build has as many rounds as an interval needs, and more. */
static void edit_many_rounds(bb_results *r)
{
    bb_each(build, bb_results_section(r, BB_BUILDS))
    {
        bb_samples rounds = {0};
        for (int i = 0; i < 10; i++)
            bb_samples_add(&rounds, 10 + 0.01 * i);
        bb_put_rounds(&(bb_entry){.table = build->table, .row = build->row}, BB_F_BUILD_MS,
                      &rounds);
    }
}

static void edit_much(bb_results *r)
{
    edit_sah(r);
    edit_slower(r);
    edit_nodes(r);
    scale_ms(trace_at(r, 20), 2);
    scale_ms(trace_at(r, 30), 0.4);
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

enum { PAIRS = 10 };

/* Equals, but for `edit` in set `number` of `side`; as text. */
static bb_status compare_pairs(edit_fn *edit, int side, uint32_t number,
                               bb_comparison_result *result, char *text, size_t capacity)
{
    static bb_cell_set sets[2][PAIRS];
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < PAIRS; i++) {
            bb_results *r = history_run("one", "here", "2024-01-01T00:00:00Z", nothing, 2 * i + k);
            if (k == side && i == number)
                edit(r);
            bb_cell_set_free(&sets[k][i]);
            ASSERT_OK(
                bb_cell_set_of_table(bb_results_table(r), k == 0 ? "OLD" : "NEW", &sets[k][i]));
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

static void senses_of_figures(void **state)
{
    (void)state;
    static const char *const costs[] = {"sah",       "layout_sah pair",    "bytes_tree",
                                        "missed",    "prim_tests_per_ray", "wrong_t",
                                        "overflowed"};
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

/* ---- from outside ---- */

static void write_document(const char *name, edit_fn *edit, uint64_t seed)
{
    char path[600];
    bb_results *results = history_run("one", "here", "2024-01-01T00:00:00Z", nothing, seed);
    edit(results);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    ASSERT_OK(bb_results_write(results, path));
    bb_results_destroy(results);
}

static void write_texts(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_SHARD, "\033[2J\033]0;title\007");
}

/* Nor does it steer the terminal from within a message. */
static void messages_do_not_steer(void **state)
{
    (void)state;
    write_document("a.json", edit_nothing, 1);
    write_document("steer.json", write_texts, 1);
    const char *script = "#!/bin/sh\nprintf 'bvhbench: \\033[2J\\302\\233 broken\\n' >&2\nexit 2\n";
    char path[600];
    write_file("steers", script, strlen(script));
    snprintf(path, sizeof path, "%s/steers", folder);
    assert_int_equal(chmod(path, 0755), 0);
    static const char *const arguments[] = {"merge a.json steer.json --out m",
                                            "compare --run ./steers ./steers --quiet",
                                            "compare a.json $'\\033[2J'"};
    for (size_t i = 0; i < sizeof arguments / sizeof arguments[0]; i++) {
        const outcome *o = run(arguments[i]);
        assert_int_equal(o->exit_status, 2);
        assert_null(strchr(o->err, '\033'));
        assert_null(strstr(o->err, "\302\233"));
        assert_non_null(strstr(o->err, "bvhbench: "));
    }
    refuses("", "compare --run ./steers ./steers --quiet", "?[2J? broken");
    refuses("", "merge a.json steer.json --out m", "?[2J");
}

static void files_are_compared(void **state)
{
    (void)state;
    write_document("a.json", edit_nothing, 1);
    write_document("b.json", edit_nothing, 2);
    write_document("slow.json", edit_slower, 2);
    write_document("sah.json", edit_sah, 2);
    write_document("elsewhere.json", edit_all_scenes, 2);
    refuses("", "compare a.json elsewhere.json", "nothing can be compared");
    write_document("failed.json", edit_all_failed, 2);
    refuses("", "compare failed.json failed.json", "nothing can be compared");
    expect(1, "compare a.json failed.json", " status  ok      failed ");
    expect(0, "compare a.json b.json", "nothing is worse");
    expect(1, "compare a.json slow.json", "1 figures are worse");
    expect(0, "compare slow.json a.json", "better: 1");
    expect(1, "compare a.json sah.json --format github", " | sah | 97.3 | 99.25 | 1.020 |");
    expect(0, "compare a.json slow.json --threshold 60", "the 60.00 %: --threshold");
    expect(1, "compare a.json slow.json --threshold 40", "worse: 1");
    write_document("gone.json", edit_gone, 2);
    expect(1, "compare a.json gone.json", "1 cells are missing");
    expect(0, "compare gone.json a.json", "nothing is worse");
    write_document("many.json", edit_many_rounds, 1);
    expect(0, "compare many.json many.json --detect 900", "could have shown a slowing by");
    expect(1, "compare a.json slow.json --detect 1", "1 figures are worse");
    const outcome *o = run("compare a.json b.json --detect 1");
    if (o->exit_status != 2 || strstr(o->out, "nothing is worse") == NULL ||
        strstr(o->err, "times could not have shown 1 %: take") == NULL)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    refuses("", "compare a.json b.json --detect -1", "--detect");
    refuses("", "compare a.json", "give two: result files");
    refuses("", "compare a.json b.json a.json", "give two");
    refuses("", "compare a.json nothing.json", "nothing.json");
    refuses("", "compare a.json b.json --format html", "must be text or github");
    refuses("", "compare a.json b.json --threshold -1", "--threshold");
    refuses("", "compare a.json b.json --rounds 7", "--rounds needs --run");
    refuses("", "compare a.json b.json --history nowhere.db", "nowhere.db: cannot open it");
    write_file("cut.json", "{\"schema\": \"bvh", 15);
    refuses("", "compare a.json cut.json", "truncated");
}

/* As Google Benchmark's tools/compare.py reads it: rounds that count, by name. */
static void results_as_google_benchmark(void **state)
{
    (void)state;
    static const char *const texts[] = {"name", "run_name", "run_type", "time_unit"};
    static const char *const numbers[] = {"repetitions", "repetition_index", "iterations",
                                          "real_time",   "cpu_time",         "family_index",
                                          "threads"};
    write_document("a.json", edit_nothing, 1);
    const outcome *o =
        run_program("", "sh", "-c '" BB_TEST_PROGRAM " report a.json --google-benchmark >gb.json'");
    assert_int_equal(o->exit_status, 0);
    cJSON *json = read_json("gb.json"), *entry, *a = read_results("a.json"), *trace;
    cJSON *list = cJSON_GetObjectItem(json, "benchmarks");
    assert_true(cJSON_IsString(member(member(json, "context"), "host_name")));
    int rounds = 0;
    cJSON_ArrayForEach(entry, list)
    {
        for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
            assert_true(cJSON_IsString(member(entry, texts[i])));
        for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
            assert_true(cJSON_IsNumber(member(entry, numbers[i])));
        assert_string_equal(member(entry, "run_type")->valuestring, "iteration");
    }
    trace = cJSON_GetArrayItem(cJSON_GetObjectItem(a, "traces"), 5);
    cJSON_ArrayForEach(entry, list)
    {
        if (strcmp(member(entry, "name")->valuestring, member(trace, "cell")->valuestring) != 0)
            continue;
        double ms = cJSON_GetArrayItem(member(trace, "ms"), rounds + 1)->valuedouble;
        assert_int_equal(member(entry, "repetition_index")->valueint, rounds);
        assert_int_equal(member(entry, "repetitions")->valueint, 6);
        ASSERT_NEAR(member(entry, "real_time")->valuedouble, 1e6 * ms, 1e-3);
        rounds++;
    }
    assert_int_equal(rounds, 6); /* the first does not count */
    cJSON_Delete(json);
    cJSON_Delete(a);
}

static void revisions_are_compared(void **state)
{
    (void)state;
    char path[600];
    snprintf(path, sizeof path, "%s/bench.db", folder);
    history_fill(path);
    expect(0, "compare --history bench.db aaaa abab",
           "between runs of one revision in the history");
    expect(1, "compare --history bench.db abab cccc", "trace ms");
    expect(1, "compare --history bench.db cccc dddd", " sah ");
    /* eeee was measured in the south last, but both in the north */
    expect(0, "compare --history bench.db dddd eeee", "\nbetter: 1\n");
    expect(1, "compare --history bench.db eeee dddd", "\nworse: 1\n");
    refuses("", "compare --history bench.db a cccc", "write more of it");
    refuses("", "compare --history bench.db abab ffff", "has no revision 'ffff'");
    write_document("a.json", edit_nothing, 1);
    expect(0, "compare --history bench.db abab a.json", "in both");
    expect(0, "report --history bench.db --out history.html",
           "dddd444444444  2024-01-04T00:00:00Z     1    228      1       0        0\n");
    refuses("", "report --history bench.db a.json", "a report of its own");
    refuses("", "report --history bench.db --csv", "do not go together");
    refuses("", "report --history nowhere.db", "cannot open it");
}

static void a_page_never_replaces_its_database(void **state)
{
    (void)state;
    char path[600];
    static const char *const made[] = {"-c 'cp kept.db page.html'", "-c 'ln -s kept.db soft.db'",
                                       "-c 'ln kept.db hard.db'"};
    snprintf(path, sizeof path, "%s/kept.db", folder);
    history_fill(path);
    for (size_t i = 0; i < sizeof made / sizeof made[0]; i++)
        assert_int_equal(run_program("", "sh", made[i])->exit_status, 0);
    refuses("", "report --history page.html", "would overwrite the database");
    refuses("", "report --history kept.db --out kept.db", "would overwrite the database");
    refuses("", "report --history kept.db --out ./kept.db", "would overwrite the database");
    refuses("", "report --history kept.db --out hard.db", "would overwrite the database");
    refuses("", "report --history soft.db --out kept.db", "would overwrite the database");
    expect(0, "report --history kept.db --out other.html",
           "dddd444444444  2024-01-04T00:00:00Z     1    228      1       0        0\n");
    expect(0, "report --history page.html --out page2.html",
           "dddd444444444  2024-01-04T00:00:00Z     1    228      1       0        0\n");
}

/* Programs that run at once: they hand out a file, with a bit of noise by turns. */
static void write_programs(void)
{
    static const char *const names[] = {"quick", "slow", "broken", "dead"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char script[2000], path[600];
        snprintf(script, sizeof script,
                 "#!/bin/sh\n[ \"$1\" = run ] || exit 2\n"
                 "while [ $# -gt 1 ]; do [ \"$1\" = --out ] && out=$2; shift; done\n"
                 "echo %s >>'%s/order'\n"
                 "mkdir -p \"$out\" && cp '%s/%s.json' \"$out/results.json\"\n%s",
                 names[i], folder, folder, i == 1 ? "slow" : "a",
                 i == 2   ? "echo 'bvhbench: it is broken' >&2; exit 2\n"
                 : i == 3 ? "kill -9 $$\n"
                          : "exit 1\n");
        write_file(names[i], script, strlen(script));
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        assert_int_equal(chmod(path, 0755), 0);
    }
}

static void programs_are_run_in_turns(void **state)
{
    (void)state;
    char order[4000], path[600];
    write_document("a.json", edit_nothing, 1);
    write_document("slow.json", edit_slower, 1);
    write_programs();
    expect(1, "compare --run ./quick ./slow --rounds 9 --history programs.db", "in pairs");
    /* 10 pairs, each of both, and not always in the same order */
    size_t size = read_file("order", order, sizeof order);
    assert_int_equal(size, 10 * strlen("quick\nslow\n"));
    uint32_t first = 0;
    for (int i = 0; i < 10; i++) {
        const char *pair = order + i * 11;
        bool quick = strncmp(pair, "quick\nslow\n", 11) == 0;
        assert_true(quick || strncmp(pair, "slow\nquick\n", 11) == 0);
        first += quick;
    }
    assert_true(first > 0 && first < 10);
    expect(0, "compare --run ./quick ./quick --rounds 9 --quiet -- --repeats 6",
           "nothing is worse");
    expect(0, "compare a.json a.json --history programs.db", "(compare --run)");
    refuses("", "compare --run ./quick", "give two programs");
    refuses("", "compare --run ./quick ./nobody", "./nobody: No such file");
    refuses("", "compare --run ./quick .", "is no program that can be run");
    refuses("", "compare --run ./quick ./slow --rounds 6", "--rounds");
    refuses("", "compare --run ./quick ./slow -- --out x", "leave --out out");
    refuses("", "compare --run ./quick ./broken --quiet", "it is broken");
    refuses("", "compare --run ./dead ./quick --quiet", "killed by signal 9");
    /* nothing is left of them */
    const outcome *o =
        run_with("mkdir t && TMPDIR=$PWD/t", "compare --run ./quick ./quick --quiet");
    assert_int_equal(o->exit_status, 0);
    assert_int_equal(rmdir(strcat(strcpy(path, folder), "/t")), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_moved_and_what_is_worse),
        cmocka_unit_test(cells_of_two_devices_do_not_meet),
        cmocka_unit_test(worst_comes_first_and_markdown_holds),
        cmocka_unit_test(any_pair_that_counts_decides),
        cmocka_unit_test(texts_of_files_are_no_markup),
        cmocka_unit_test(messages_do_not_steer),
        cmocka_unit_test(senses_of_figures),
        cmocka_unit_test(files_are_compared),
        cmocka_unit_test(results_as_google_benchmark),
        cmocka_unit_test(revisions_are_compared),
        cmocka_unit_test(a_page_never_replaces_its_database),
        cmocka_unit_test(programs_are_run_in_turns),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
