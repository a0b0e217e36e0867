/* Reports of merged results: each row says of which run it is, and what is said holds for all. */
#include "tests/record_fixture.h"
#include "tests/slice_table.h"

#include "framework/report/report.h"
#include "framework/table/outline.h"
#include "framework/table/page.h"

/* The sample with itself as a second run, which was interrupted or not. */
static bb_results *merged_sample(bool interrupted)
{
    bb_results *first = sample_results(NULL), *second = sample_results(NULL);
    if (interrupted)
        ASSERT_OK(bb_results_set_interrupted(second));
    ASSERT_OK(bb_results_merge(first, second));
    bb_results_destroy(second);
    return first;
}

/* What a report prints; from malloc. */
static char *print(bb_status (*report)(const bb_results *, FILE *), const bb_results *results)
{
    static char *text;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    ASSERT_OK(report(results, out));
    fclose(out);
    return text;
}

static int count_of(const char *text, const char *words)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, words)) != NULL; at++)
        count++;
    return count;
}

static void the_table_marks_later_runs(void **state)
{
    (void)state;
    bb_results *one = sample_results(NULL), *two = merged_sample(false);
    char *before = print(bb_report_table, one), *after = print(bb_report_table, two);
    const int builders = count_of(before, "\nlbvh:bits=63 ");
    assert_true(builders > SAMPLE_SCENES);
    assert_null(strstr(before, " #"));
    assert_int_equal(count_of(after, "\nlbvh:bits=63 "), 2 * builders);
    /* builds in two parts, layouts and traces; tables of a run's own column begin with it */
    assert_int_equal(count_of(after, "\nlbvh:bits=63 #2 "), builders);
    assert_int_equal(count_of(after, "\n1 "), count_of(after, "\n2 "));
    assert_true(count_of(after, "\n2    lbvh:bits=30  code: 30 bits") == 1);
    free(after);
    free(before);
    bb_results_destroy(two);
    bb_results_destroy(one);
}

static void an_interruption_of_any_run_is_said(void **state)
{
    (void)state;
    for (int cut = 0; cut < 2; cut++) {
        bb_results *results = merged_sample(cut == 1);
        char *text = print(bb_report_verdict, results);
        assert_int_equal(strstr(text, "INTERRUPTED") != NULL, cut);
        free(text);
        bb_results_destroy(results);
    }
}

/* The line of a summary's row, from its builder on. */
static void find_row(const char *summary, const char *builder, char row[512])
{
    const char *begin = strstr(summary, builder);
    if (begin == NULL)
        fail_msg("no row of %s: %s", builder, summary);
    else
        snprintf(row, 512, "%.*s", (int)strcspn(begin, "\n"), begin);
}

/* So does a reference that lacks ray sets. */
static void what_is_partial_says_of_how_many_sets(void **state)
{
    (void)state;
    static const char reference[] = "embree-native:quality=medium,mode=fast";
    bb_results *results = sample_results(NULL);
    bb_entry *lost = NULL;
    for (bb_entry *trace = entry_at(results, BB_TRACES, 0); trace != NULL; trace = trace->next)
        if (strcmp(bb_get_text(trace, BB_F_TRACE_BUILDER), reference) == 0)
            lost = trace;
    assert_non_null(lost);
    leave_out_entry(results, lost);
    char *text = print(bb_report_verdict, results);
    char row[512];
    unsigned sets, all;
    find_row(text, "embree-native:medium,fast ", row);
    if (sscanf(row, "embree-native:medium,fast %u/%u ", &sets, &all) != 2 || sets + 1 != all)
        fail_msg("not of how many sets: %s", row);
    assert_non_null(strstr(text, "n/m: without a rank"));
    free(text);
    bb_results_destroy(results);
}

/* 0 is no number among others: it is what all builders should have, and not what nobody judged. */
static void no_wrong_answer_is_none(void **state)
{
    (void)state;
    static const char *const rows[][2] = {
        {"lbvh:bits=30 ", " none"}, {"embree:quality=low ", " 3"}, {"null ", " -"}};
    bb_results *results = sample_results(NULL);
    char *text = print(bb_report_verdict, results);
    for (int i = 0; i < 3; i++) {
        char row[512];
        find_row(text, rows[i][0], row);
        const char *last = strrchr(row, ' ');
        if (last == NULL || strcmp(last, rows[i][1]) != 0)
            fail_msg("not%s: %s", rows[i][1], row);
    }
    free(text);
    bb_results_destroy(results);
}

/* ---- other tables ---- */

/* A file may have lost the first run, or what a run says of itself. */
static void runs_are_not_invented(void **state)
{
    (void)state;
    static const bb_page_outline outline = {.command = "slice", .title = "slices"};
    bb_table *table;
    bb_page *page;
    ASSERT_OK(bb_table_create("slice", &table));
    bb_table_row(table, (bb_cell){{[BB_RUN] = "1", [BB_SCENE] = "tets"}});
    bb_table_row(table, (bb_cell){{[BB_RUN] = "3"}});
    ASSERT_OK(bb_outline_page(&outline, table, &page));
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    bb_page_print(page, out);
    fclose(out);
    assert_int_equal(count_of(text, "Run "), 2);
    const char *second = strstr(text, "Run 2\n");
    assert_true(second != NULL && strstr(second, "tets\n") != NULL);
    assert_non_null(strstr(text, "Run 4\n"));
    free(text);
    bb_page_free(page);
    bb_table_free(table);
}

/* Whatever another program wrote into a file, or was called, does not steer the terminal. */
static void csv_and_json_do_not_steer(void **state)
{
    (void)state;
    change c = none;
    c.device = "a\033[2J\302\233\342\200\256 card,\n\"b\"";
    write_table("steer.json", c);
    const outcome *o = expect(0, "report steer.json --csv", "\"a?[2J?? card,?\"\"b\"\"\",");
    assert_int_equal(count_of(o->out, "\r\n"), 5);
    assert_int_equal(count_of(o->out, "\n"), 5);
    static char file[1 << 16];
    read_file("steer.json", file, sizeof file);
    assert_non_null(strstr(file, "\"a\\u001b[2J\\u009b\\u202e card,\\n\\\"b\\\"\""));
    expect(0, "report steer.json --table", "a?[2J??");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_table_marks_later_runs),
        cmocka_unit_test(an_interruption_of_any_run_is_said),
        cmocka_unit_test(what_is_partial_says_of_how_many_sets),
        cmocka_unit_test(no_wrong_answer_is_none),
        cmocka_unit_test(runs_are_not_invented),
        cmocka_unit_test(csv_and_json_do_not_steer),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
