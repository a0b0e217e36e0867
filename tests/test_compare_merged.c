/* Merged results compared: their runs are told apart, and what is said of them holds for all. */
#include "tests/history_sample.h"
#include "tests/slice_table.h"

static const history_change nothing = {-1, -1, -1};

/* A run with one slow trace, or without. */
static bb_results *run_of(const char *revision, const char *host, int slow)
{
    history_change change = nothing;
    change.slow_trace = slow;
    return history_run(revision, host, slow < 0 ? "2024-01-01T00:00:00Z" : "2024-03-01T00:00:00Z",
                       change, 1);
}

/* Writes the first run with the second one merged, which it frees. */
static void write_merged(const char *name, bb_results *first, bb_results *second)
{
    char path[600];
    ASSERT_OK(bb_results_merge(first, second));
    snprintf(path, sizeof path, "%s/%s", folder, name);
    ASSERT_OK(bb_results_write(first, path));
    bb_results_destroy(second);
    bb_results_destroy(first);
}

/* What became slower in the second run alone is found, and not taken for the first run's. */
static void runs_of_one_file_are_cells_of_their_own(void **state)
{
    (void)state;
    write_merged("even.json", run_of("one", "here", -1), run_of("one", "here", -1));
    write_merged("slow.json", run_of("one", "here", -1), run_of("one", "here", 5));
    const outcome *o = expect(0, "compare even.json even.json", "nothing is worse");
    assert_null(strstr(o->out, "occur twice"));
    o = expect(1, "compare even.json slow.json", "worse: 1");
    const char *row = strstr(o->out, "trace ms");
    assert_non_null(row);
    while (row > o->out && row[-1] != '\n')
        row--;
    char line[1024];
    snprintf(line, sizeof line, "%.*s", (int)strcspn(row, "\n"), row);
    if (strstr(line, "/run=1 ") == NULL || strstr(line, "max-rays=1048576") != NULL)
        fail_msg("no short key of the second run: %s", line);
}

static void other_tables_keep_their_runs_apart(void **state)
{
    (void)state;
    bb_cell_set set;
    bb_table *table = make_table(none), *more = make_table(none);
    const uint32_t scene = bb_table_row(more, (bb_cell){{[BB_SCENE] = "cube"}});
    bb_table_set_text(more, scene, &scene_hash, "00000000000000ff");
    const uint32_t row = bb_table_row(more, (bb_cell){{[BB_SCENE] = "cube", [BB_BUILDER] = "x"}});
    bb_table_set_number(more, row, &nodes, 1);
    ASSERT_OK(bb_table_merge(table, more));
    ASSERT_OK(bb_cell_set_of_table(table, "it", &set));
    assert_int_equal(set.count, 2 * 2 * 3 + 1);
    assert_int_equal(set.duplicates, 0);
    assert_non_null(bb_cell_set_find(
        &set,
        "command=slice/scene=tets/question=z/builder=lbvh/intersector=skip/time=build_ms/run=1"));
    const bb_measured *cell = bb_cell_set_find(&set, "command=slice/scene=cube/builder=x/run=1");
    assert_non_null(cell);
    assert_string_equal(cell->scene_hash, "00000000000000ff");
    bb_cell_set_free(&set);
    bb_table_free(more);
    bb_table_free(table);
}

/* Where runs differ, no run's name stands for all of them. */
static void the_origin_is_that_of_all_runs(void **state)
{
    (void)state;
    bb_cell_set set;
    bb_results *first = run_of("one", "here", -1), *second = run_of("two", "there", 5);
    ASSERT_OK(bb_results_set_interrupted(second));
    ASSERT_OK(bb_results_merge(first, second));
    ASSERT_OK(bb_cell_set_of_table(bb_results_table(first), "it", &set));
    const bb_entry *context = bb_results_context(first);
    assert_string_equal(set.origin.revision, "several");
    assert_string_equal(set.origin.host, "several");
    assert_string_equal(set.origin.device, bb_get_text(context, BB_F_CONTEXT_DEVICE));
    assert_string_equal(set.origin.device_type, bb_get_text(context, BB_F_CONTEXT_DEVICE_TYPE));
    assert_string_equal(set.origin.date, "2024-03-01T00:00:00Z");
    assert_true(set.origin.interrupted);
    bb_cell_set_free(&set);
    bb_results_destroy(second);
    bb_results_destroy(first);
}

static void set_cpu(bb_results *results, const char *cpu)
{
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_CPU, cpu));
}

/* Several machines on both sides need not be the same ones. */
static void times_of_several_machines_are_not_compared(void **state)
{
    (void)state;
    write_merged("hosts.json", run_of("one", "here", -1), run_of("two", "there", 5));
    const outcome *o = expect(0, "compare hosts.json hosts.json", "WARNING: other hosts");
    assert_non_null(strstr(o->out, "revision several, 2024-03-01T00:00:00Z, several"));
    for (int slow = 0; slow < 2; slow++) {
        bb_results *first = run_of("one", "here", -1), *second = run_of("one", "here", slow - 1);
        set_cpu(first, "a processor");
        set_cpu(second, "another processor");
        write_merged(slow == 1 ? "later.json" : "cpus.json", first, second);
    }
    expect(0, "compare cpus.json later.json", "WARNING: other machines: no times are compared");
    expect(0, "merge later.json --history several.db", "");
    expect(0, "report --history several.db --out several.html", "several.html");
}

static void an_interrupted_run_is_said(void **state)
{
    (void)state;
    bb_results *second = run_of("one", "here", -1);
    ASSERT_OK(bb_results_set_interrupted(second));
    write_merged("cut.json", run_of("one", "here", -1), second);
    expect(0, "compare cut.json cut.json", "here, INTERRUPTED");
}

static void runs_that_are_no_numbers_are_refused(void **state)
{
    (void)state;
    static const char *const runs[] = {"x", "0", "01", "1000001"};
    write_table("a.json", none);
    for (size_t i = 0; i < sizeof runs / sizeof runs[0]; i++) {
        char path[600], words[64];
        bb_table *table = make_table(none);
        bb_table_row(table, (bb_cell){{[BB_RUN] = runs[i], [BB_SCENE] = "tets"}});
        snprintf(path, sizeof path, "%s/runs.json", folder);
        ASSERT_OK(bb_table_write(table, path));
        bb_table_free(table);
        snprintf(words, sizeof words, "runs.json: rows[4]: the run '%s' is no number", runs[i]);
        refuses("", "compare a.json runs.json", words);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_of_one_file_are_cells_of_their_own),
        cmocka_unit_test(other_tables_keep_their_runs_apart),
        cmocka_unit_test(the_origin_is_that_of_all_runs),
        cmocka_unit_test(times_of_several_machines_are_not_compared),
        cmocka_unit_test(an_interrupted_run_is_said),
        cmocka_unit_test(runs_that_are_no_numbers_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
