/* Result files that others wrote: truncated, damaged, with rows that do not fit, too deep; and
 * merging. */
#include "tests/record_fixture.h"

#include "framework/base/file.h"
#include "framework/report/chart_script.h"
#include "framework/report/report.h"

/* ---- broken files ---- */

static void write_plain(const char *path, const char *data, size_t size)
{
    unlink(path); /* some file systems flush a file that is cut and written again */
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    fclose(file);
}

/* Either it is refused with a message, or the document can be reported. */
static bool survives(const char *path, FILE *sink)
{
    bb_results *results = NULL;
    bb_status status = bb_results_read(path, &results);
    if (status != BB_OK) {
        assert_null(results);
        assert_int_equal(status, BB_INVALID);
        assert_true(strlen(bb_message()) > 10);
        return false;
    }
    assert_int_equal(bb_report_table(results, sink), BB_OK);
    bb_charts charts;
    uint32_t pictures;
    assert_int_equal(bb_charts_make(results, &charts), BB_OK);
    assert_int_equal(bb_charts_script(&charts, NULL, sink, &pictures), BB_OK);
    bb_charts_free(&charts);
    bb_results *twice = NULL;
    assert_int_equal(bb_results_read(path, &twice), BB_OK);
    assert_int_equal(bb_results_merge(results, twice), BB_OK);
    bb_results_destroy(twice);
    bb_results_destroy(results);
    return true;
}

/* A small document with one row of each sort. */
static char *small_document(size_t *size)
{
    bb_results *results = sample_results(NULL);
    bool *out = calloc(bb_table_row_count(results->table), sizeof *out);
    assert_non_null(out);
    for (uint32_t row = 0; row < bb_table_row_count(results->table); row++) {
        const char *scene = bb_table_name(results->table, row, BB_SCENE);
        const char *builder = bb_table_name(results->table, row, BB_BUILDER);
        out[row] = (scene[0] != '\0' && strcmp(scene, "coffee") != 0) ||
                   (builder[0] != '\0' && strcmp(builder, "sah") != 0);
    }
    leave_out(results, out);
    free(out);
    const char *path = results_path("small");
    assert_int_equal(bb_results_write(results, path), BB_OK);
    bb_results_destroy(results);
    char *text = NULL;
    assert_int_equal(bb_file_read(path, 1 << 20, "small", &text, size), BB_OK);
    return text;
}

static void truncated_files_are_refused(void **state)
{
    (void)state;
    size_t size;
    char *text = small_document(&size);
    const char *path = results_path("truncated");
    FILE *sink = fopen("/dev/null", "w");
    write_plain(path, text, size);
    assert_true(survives(path, sink));
    for (size_t cut = 0; cut < size - 2; cut += 37) {
        write_plain(path, text, cut);
        if (survives(path, sink))
            fail_msg("a file cut at byte %zu was taken", cut);
    }
    fclose(sink);
    free(text);
}

static void damaged_files_do_no_harm(void **state)
{
    (void)state;
    size_t size;
    char *text = small_document(&size);
    char *damaged = malloc(size);
    const char *path = results_path("damaged");
    FILE *sink = fopen("/dev/null", "w");
    bb_random random = bb_random_make(11, 0);
    static const char bytes[] = "{}[]\",:0-9eE.ntf\\u \0\xff";
    int taken = 0;
    for (int round = 0; round < 3000; round++) {
        memcpy(damaged, text, size);
        for (uint32_t i = 0; i <= round % 4u; i++)
            damaged[bb_random_below(&random, (uint32_t)size)] =
                bytes[bb_random_below(&random, sizeof bytes - 1)];
        write_plain(path, damaged, size);
        taken += survives(path, sink);
    }
    assert_in_range(taken, 1, 2999); /* both ways were taken */
    fclose(sink);
    free(damaged);
    free(text);
}

/* A table with these columns and rows. */
static void write_rows(const char *path, const char *columns, const char *rows)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs("{\"schema\":\"bvhbench-table/1\",\"command\":\"run\",\"columns\":[", file);
    for (const char *at = columns; *at != '\0';
         at += strcspn(at, " ") + (strchr(at, ' ') != NULL)) {
        char name[64], kind[16];
        assert_int_equal(sscanf(at, "%63[^:]:%15[a-z]", name, kind), 2);
        fprintf(file,
                "%s{\"name\":\"%s\",\"heading\":\"\",\"unit\":\"%s\",\"help\":\"\",\"kind\":\"%s\","
                "\"sense\":\"timed\",\"better\":\"less\",\"decimals\":0}",
                at == columns ? "" : ",", name, strstr(name, "ms") != NULL ? "ms" : "", kind);
    }
    fprintf(file, "],\"rows\":[%s]}", rows);
    fclose(file);
}

#define COLUMNS                                                                                    \
    "prims:number status:text cell:text count:number ms:rounds layout_ms:rounds tree_run:text "    \
    "title:text verdict:text"
#define SCENE "{},{\"scene\":\"s\",\"prims\":1}"
#define BUILD SCENE ",{\"scene\":\"s\",\"builder\":\"b\",\"status\":\"ok\"}"
#define TRACE_OF(scene, builder, more)                                                             \
    ",{\"scene\":\"" scene "\",\"question\":\"r\",\"builder\":\"" builder                          \
    "\",\"kernel\":\"k\",\"cell\":\"c\",\"count\":1,\"status\":\"ok\"" more "}"

static void wrong_rows_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *columns, *rows, *named;
    } cases[] = {
        {COLUMNS, "", "context"},
        {COLUMNS, "{\"run\":\"1\"}", "context"},
        {"prims:text", "{}", "\"prims\" is of the wrong kind"},
        {"ms:number", "{}", "\"ms\" is of the wrong kind"},
        {"sah:text", "{}", "\"sah\" is of the wrong kind"},
        {"epo_half:text", "{}", "\"epo_half\" is of the wrong kind"},
        {"alpha:text", "{}", "\"alpha\" is of the wrong kind"},
        {"held:number", "{}", "\"held\" is of the wrong kind"},
        {"title:number", "{}", "\"title\" is of the wrong kind"},
        {"verdict:number", "{}", "\"verdict\" is of the wrong kind"},
        {COLUMNS, "{},{\"question\":\"emc\",\"frame\":\"t\",\"maker\":\"1\"}",
         "rows[1] is part of a row"},
        {"busy_processors:text", "{}", "\"busy_processors\" is of the wrong kind"},
        {"build_ms:rounds mrays_s_given:number", "{}", "\"mrays_s_given\" is not of times"},
        {COLUMNS, "{},{\"run\":\"1\",\"scene\":\"s\",\"prims\":1}", "rows[1] is of a run"},
        {COLUMNS " wrong_ppm:number", BUILD TRACE_OF("s", "b", ",\"wrong_ppm\":1e7"),
         "rows[3]: \"wrong_ppm\" is too large"},
        {COLUMNS " missed:number", BUILD TRACE_OF("s", "b", ",\"missed\":-5"),
         "rows[3]: \"missed\" is negative"},
        {COLUMNS " checked:number", BUILD TRACE_OF("s", "b", ",\"checked\":1e308"),
         "rows[3]: \"checked\" is too large"},
        {COLUMNS " wrong:text", BUILD TRACE_OF("s", "b", ",\"wrong\":\"maybe\""),
         "rows[3]: \"wrong\" is 'maybe'"},
        {COLUMNS, SCENE ",{\"scene\":\"s\",\"builder\":\"b\",\"status\":\"weird\"}",
         "rows[2]: \"status\" is 'weird'"},
        {COLUMNS, "{},{\"run\":\"x\"}", "rows[1]: the run 'x' is no number"},
        {COLUMNS, "{},{\"run\":\"-1\"}", "rows[1]: the run '-1' is no number"},
        {COLUMNS, "{},{\"run\":\"01\"}", "rows[1]: the run '01' is no number"},
        {COLUMNS, "{},{\"run\":\"0\"}", "rows[1]: the run '0' is no number"},
        {COLUMNS, "{},{\"run\":\"4294967297\"}", "rows[1]: the run '4294967297' is no number"},
        {COLUMNS, "{},{\"scene\":\"s\"}", "rows[1]: \"prims\" is missing"},
        {COLUMNS, "{},{\"builder\":\"b\"}", "rows[1] has the names of no sort"},
        {COLUMNS, "{},{\"scene\":\"s\",\"kernel\":\"k\"}", "rows[1] has the names of no sort"},
        {COLUMNS, "{},{\"scene\":\"s\",\"builder\":\"b\",\"status\":\"ok\"}",
         "rows[1] names scene 's', which is missing"},
        {COLUMNS, SCENE ",{\"scene\":\"s\",\"builder\":\"b\"}", "rows[2]: \"status\" is missing"},
        {COLUMNS, SCENE ",{\"scene\":\"s\",\"builder\":\"b\",\"maker\":\"pair\"}",
         "rows[2] is part of a row that does not stand before it"},
        {COLUMNS, "{},{\"scene\":\"s\",\"view\":\"v\"}", "rows[1] is part of a row"},
        {COLUMNS, SCENE TRACE_OF("s", "b", ""), "rows[2] names a build of 'b', which is missing"},
        {COLUMNS, BUILD TRACE_OF("other", "b", ""),
         "rows[3] names scene 'other', which is missing"},
        {COLUMNS, BUILD TRACE_OF("s", "b", ",\"tree_run\":\"2\""), "rows[3] names a build of 'b'"},
        {COLUMNS, BUILD TRACE_OF("s", "b", ",\"run\":\"1\""), "rows[3] names a build of 'b'"},
        {COLUMNS, BUILD TRACE_OF("s", "b", ",\"ms\":[1,-1,2,3]"), "rows[3]: \"ms\" is negative"},
        {COLUMNS,
         BUILD ",{\"scene\":\"s\",\"builder\":\"b\",\"maker\":\"pair\",\"layout_ms\":[-1]}",
         "rows[3]: \"layout_ms\" is negative"},
        {COLUMNS, BUILD TRACE_OF("s", "b", "") TRACE_OF("s", "b", ""),
         "rows[4] is of the same cell as rows[3]"},
        {COLUMNS, BUILD ",{\"scene\":\"s\",\"question\":\"r\",\"builder\":\"b\"}",
         "rows[3]: \"cell\" is missing"},
        {COLUMNS, "{},{\"question\":\"emc\",\"maker\":\"claim\",\"verdict\":\"held\"}",
         "rows[1] is part of a row"},
        {COLUMNS, "{},{\"scene\":7}", "scene"},
        {COLUMNS, "{},{\"scene\":\"s\",\"unheard\":7}", "unheard"},
    };
    const char *path = results_path("rows");
    bb_results *results = NULL;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_rows(path, cases[i].columns, cases[i].rows);
        if (bb_results_read(path, &results) != BB_INVALID ||
            strstr(bb_message(), cases[i].named) == NULL || strstr(bb_message(), path) == NULL)
            fail_msg("case %zu: message '%s'", i, bb_message());
    }
    FILE *sink = fopen("/dev/null", "w");
    write_rows(path, "host:text", "{}"); /* the least that is one */
    assert_true(survives(path, sink));
    write_rows(path, COLUMNS, BUILD TRACE_OF("s", "b", ""));
    assert_true(survives(path, sink));
    fclose(sink);
}

/* What is no table of a run, and files of before there were tables. */
static void other_files_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *text, *named;
    } cases[] = {
        {"", "not JSON"},
        {"[]", "schema"},
        {"{\"schema\":1}", "schema"},
        {"{\"schema\":\"bvhbench-table/9\"}", "bvhbench-table/9"},
        {"{\"schema\":\"bvhbench-results/1\",\"context\":{},\"scenes\":[],\"builds\":[],"
         "\"traces\":[],\"skipped\":[],\"pictures\":[],\"steps_ms\":{}}",
         "its schema is \"bvhbench-results/1\", this program reads \"bvhbench-table/1\": measure "
         "again"},
        {"{\"schema\":\"bvhbench-table/1\"}", "command"},
        {"{\"schema\":\"bvhbench-table/1\",\"command\":\"slice\",\"columns\":[],\"rows\":[]}",
         "a table of slice, not of a run"},
        {"{\"schema\":\"bvhbench-table/1\",\"command\":\"run\",\"columns\":[],\"rows\":[]} x",
         "not JSON"},
        {"\xef\xbb\xbf{\"schema\":\"bvhbench-table/1\",\"command\":\"run\",\"columns\":[],"
         "\"rows\":[]}",
         "not JSON"},
        {"{\"schema\":\"bvhbench-table/"
         "1\",\"command\":\"run\",\"columns\":[],\"rows\":[{\"x\":01}]}",
         "not JSON"},
    };
    const char *path = results_path("others");
    bb_results *results = NULL;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_plain(path, cases[i].text, strlen(cases[i].text));
        if (bb_results_read(path, &results) != BB_INVALID ||
            strstr(bb_message(), cases[i].named) == NULL || strstr(bb_message(), path) == NULL)
            fail_msg("case %zu: message '%s'", i, bb_message());
    }
}

static void deep_nesting_is_refused(void **state)
{
    (void)state;
    enum { DEEP = 3000000 };
    char *text = malloc(DEEP);
    memset(text, '[', DEEP);
    const char *path = results_path("deep");
    write_plain(path, text, DEEP);
    free(text);
    bb_results *results = NULL;
    assert_int_equal(bb_results_read(path, &results), BB_INVALID);
    assert_int_equal(bb_results_read("/nonexistent.json", &results), BB_INVALID);
    assert_int_equal(bb_results_read("/tmp", &results), BB_INVALID);
}

/* ---- merging ---- */

static void merging_numbers_runs(void **state)
{
    (void)state;
    bb_results *a = sample_results(NULL), *b = sample_results(NULL), *c = sample_results(NULL);
    int builds = cJSON_GetArraySize(section(a, "builds"));
    int traces = cJSON_GetArraySize(section(a, "traces"));
    assert_int_equal(bb_results_merge(a, b), BB_OK);
    assert_int_equal(bb_results_merge(a, c), BB_OK);
    assert_int_equal(cJSON_GetArraySize(section(a, "scenes")), SAMPLE_SCENES);
    assert_int_equal(cJSON_GetArraySize(section(a, "builds")), 3 * builds);
    assert_int_equal(cJSON_GetArraySize(section(a, "traces")), 3 * traces);
    assert_int_equal(cJSON_GetArraySize(section(a, "merged")), 2);
    const bb_entry *last = a->sections[BB_TRACES].last, *its = bb_build_of(last);
    assert_string_equal(bb_get_text(its, BB_F_BUILD_BUILDER),
                        bb_get_text(last, BB_F_TRACE_BUILDER));
    assert_int_equal(bb_run_of(last), 2);
    assert_int_equal(bb_run_of(its), 2);
    assert_int_equal(bb_run_of(entry_at(a, BB_TRACES, 0)), 0);
    assert_int_equal(bb_run_of(entry_at(a, BB_TRACES, traces)), 1);
    assert_true(bb_results_step_ms(a, "load") == 3 * 320.5);
    assert_true(bb_results_time_ms(a, "build") == 3 * 2500);
    assert_true(bb_results_time_ms(a, "steps") == 3 * (21 * 320.5 + 100));
    assert_true(bb_results_time_ms(a, "total") == 3 * 31000);
    assert_int_equal(cJSON_GetArraySize(section(a, "skipped")), 3 * 2);
    const bb_entry *skipped = entry_at(a, BB_SKIPPED, 5);
    assert_string_equal(bb_get_text(skipped, BB_F_SKIPPED_RAYS), "edges");
    assert_int_equal(bb_run_of(skipped), 2);
    assert_int_equal(cJSON_GetArraySize(section(a, "reproductions")), 3);
    const cJSON *paper = cJSON_GetArrayItem(section(a, "reproductions"), 2);
    assert_int_equal(cJSON_GetArraySize(member(paper, "claims")), 4);
    assert_int_equal(cJSON_GetArraySize(member(member(paper, "tables")->child, "rows")), 2);

    const char *path = results_path("merged");
    bb_results *read = NULL;
    assert_int_equal(bb_results_write(a, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    assert_true(cJSON_Compare(document_of(a), document_of(read), 1));
    assert_int_equal(bb_results_merge(read, c), BB_OK); /* from a file, columns are its own */
    assert_int_equal(bb_run_of(read->sections[BB_TRACES].last), 3);
    bb_results_destroy(read);
    bb_results_destroy(c);
    bb_results_destroy(b);
    bb_results_destroy(a);
}

/* Tables of one paper in two files may have other columns. */
static void merged_papers_keep_their_headings(void **state)
{
    (void)state;
    static const char *const headings[2][3] = {{"scene", "cube", "spheres"}, {"scene", "boards"}};
    bb_results *both[2];
    for (int r = 0; r < 2; r++) {
        assert_int_equal(bb_results_create(&(bb_context){NULL, 1, "test"}, &both[r]), BB_OK);
        assert_int_equal(bb_results_add_paper(both[r], "emc", "codes"), BB_OK);
        for (uint32_t i = 0; i < 3 && headings[r][i] != NULL; i++) {
            assert_int_equal(
                bb_results_print_heading(both[r], "emc", "Table 2", 1, i, headings[r][i]), BB_OK);
            assert_int_equal(bb_results_print_cell(both[r], "emc", "Table 2", 1, 1, i,
                                                   i == 0 ? "lbvh" : NULL, 10 * r + (int)i),
                             BB_OK);
        }
    }
    assert_int_equal(bb_results_merge(both[0], both[1]), BB_OK);
    const cJSON *papers = section(both[0], "reproductions");
    for (int r = 0; r < 2; r++) {
        const cJSON *table = member(cJSON_GetArrayItem(papers, r), "tables")->child;
        const cJSON *names = member(table, "columns"), *row = member(table, "rows")->child;
        assert_int_equal(cJSON_GetArraySize(names), 3 - r);
        assert_int_equal(cJSON_GetArraySize(row), 3 - r);
        for (int i = 0; i < 3 - r; i++)
            assert_string_equal(cJSON_GetArrayItem(names, i)->valuestring, headings[r][i]);
        assert_true(cJSON_GetArrayItem(row, 1)->valuedouble == 10 * r + 1);
        bb_results_destroy(r == 1 ? both[1] : NULL);
    }
    bb_results_destroy(both[0]);
}

/* Of a run without a total there is none after merging; reproductions are those of the other. */
static void merging_takes_files_without_totals(void **state)
{
    (void)state;
    bb_results *old = sample_results(NULL), *read = NULL, *now = sample_results(NULL);
    const bb_entry *paper = entry_at(old, BB_PAPERS, 0);
    assert_int_equal(bb_results_set_total(old, NAN, NAN, NAN), BB_OK);
    leave_out_entry(old, paper);
    const char *path = results_path("without-total");
    assert_int_equal(bb_results_write(old, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    assert_int_equal(bb_results_merge(now, read), BB_OK);
    assert_true(isnan(bb_results_time_ms(now, "total")));
    assert_true(isnan(bb_results_time_ms(now, "build")));
    assert_int_equal(cJSON_GetArraySize(section(now, "skipped")), 4);
    bb_results_destroy(now);
    now = sample_results(NULL);
    assert_int_equal(bb_results_merge(read, now), BB_OK);
    assert_true(isnan(bb_results_time_ms(read, "total")));
    assert_int_equal(cJSON_GetArraySize(section(read, "skipped")), 4);
    assert_int_equal(cJSON_GetArraySize(section(read, "reproductions")), 1);
    bb_results_destroy(now);
    bb_results_destroy(read);
    bb_results_destroy(old);
}

static void the_first_ray_waits_for_what_adds_up(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    const bb_section *builds = bb_results_section(results, BB_BUILDS);
    const bb_entry *fresh = bb_first(builds);
    double first = bb_first_ray_ms(fresh, "pair");
    assert_true(first == bb_get_number(fresh, BB_F_BUILD_MS_MEDIAN) +
                             bb_get_named(fresh, BB_F_BUILD_LAYOUTS_MS, "pair") +
                             bb_get_number(fresh, BB_F_BUILD_BOXES_MS) +
                             bb_get_number(fresh, BB_F_BUILD_TRANSFER_MS));
    assert_true(bb_get_named(fresh, BB_F_BUILD_FIRST_RAY, "pair") == first);
    assert_true(bb_first_ray_ms(fresh, "no such layout") != first);
    bb_each(build, builds)
    {
        if (bb_get_true(build, BB_F_BUILD_REFERENCE)) /* its commit makes all that is needed */
            assert_true(bb_first_ray_ms(build, "") == bb_get_number(build, BB_F_BUILD_MS_MEDIAN));
    }
    bb_results_destroy(results);
}

static void merging_refuses_other_geometry(void **state)
{
    (void)state;
    bb_results *a = sample_results(NULL), *b = sample_results(NULL);
    bb_put_text(entry_at(b, BB_SCENES, 0), BB_F_SCENE_HASH, "0123456789abcdef");
    int traces = cJSON_GetArraySize(section(a, "traces"));
    assert_int_equal(bb_results_merge(a, b), BB_INVALID);
    assert_non_null(strstr(bb_message(), "coffee"));
    assert_int_equal(cJSON_GetArraySize(section(a, "traces")), traces);
    bb_results_destroy(b);
    bb_results_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(damaged_files_do_no_harm),
        cmocka_unit_test(wrong_rows_are_named),
        cmocka_unit_test(other_files_are_named),
        cmocka_unit_test(deep_nesting_is_refused),
        cmocka_unit_test(merging_numbers_runs),
        cmocka_unit_test(merged_papers_keep_their_headings),
        cmocka_unit_test(merging_takes_files_without_totals),
        cmocka_unit_test(the_first_ray_waits_for_what_adds_up),
        cmocka_unit_test(merging_refuses_other_geometry),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
