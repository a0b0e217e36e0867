/* Result files that others wrote: truncated, damaged, of other types, too deep; and merging, older
 * files included. */
#include "tests/record_fixture.h"

#include "framework/base/file.h"
#include "framework/chart/chart_script.h"
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
    assert_int_equal(bb_charts_script(&charts, sink, &pictures), BB_OK);
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
    while (cJSON_GetArraySize(section(results, "traces")) > 3)
        cJSON_DeleteItemFromArray(section(results, "traces"), 3);
    while (cJSON_GetArraySize(section(results, "builds")) > 2)
        cJSON_DeleteItemFromArray(section(results, "builds"), 1);
    while (cJSON_GetArraySize(section(results, "scenes")) > 2) /* of the first and the last build */
        cJSON_DeleteItemFromArray(section(results, "scenes"), 1);
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

static void wrong_types_are_named(void **state)
{
    (void)state;
    static const char head[] = "{\"schema\":\"bvhbench-results/1\",\"context\":{},";
    static const char tail[] = ",\"skipped\":[],\"pictures\":[],\"steps_ms\":{}";
    static const struct {
        const char *text, *named;
    } cases[] = {
        {"", "not JSON"},
        {"[]", "schema"},
        {"{\"schema\":1}", "schema"},
        {"{\"schema\":\"bvhbench-results/9\"}", "bvhbench-results/9"},
        {"{\"schema\":\"bvhbench-results/1\"}", "context"},
        {"+\"scenes\":[],\"builds\":[]}", "traces"},
        {"+\"scenes\":{},\"builds\":[],\"traces\":[]}", "scenes"},
        {"+\"scenes\":[7],\"builds\":[],\"traces\":[]}", "scenes[0]"},
        {"+\"scenes\":[{\"name\":7,\"prims\":1}],\"builds\":[],\"traces\":[]}", "name"},
        {"+\"scenes\":[],\"builds\":[{\"id\":\"x\"}],\"traces\":[]}", "id"},
        {"+\"scenes\":[],\"builds\":[{\"id\":-1,\"scene\":\"s\",\"builder\":\"b\",\"status\":"
         "\"ok\"}],"
         "\"traces\":[]}",
         "-1"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[{\"build\":0,\"cell\":\"c\",\"scene\":\"s\","
         "\"builder\":\"b\","
         "\"kernel\":\"k\",\"rays\":\"r\",\"count\":1,\"status\":\"ok\"}]}",
         "build 0"},
        {"+\"scenes\":[],\"builds\":[{\"id\":0,\"scene\":\"s\",\"builder\":\"b\",\"status\":"
         "\"ok\"}],\"traces\":[]}",
         "builds[0] names scene 's', which is missing"},
        {"+\"scenes\":[{\"name\":\"s\",\"prims\":1}],\"builds\":[{\"id\":0,\"scene\":\"s\","
         "\"builder\":\"b\",\"status\":\"ok\"}],\"traces\":[{\"build\":0,\"cell\":\"c\",\"scene\":"
         "\"other\","
         "\"builder\":\"b\",\"kernel\":\"k\",\"rays\":\"r\",\"count\":1,\"status\":\"ok\"}]}",
         "traces[0] names scene 'other', which is missing"},
        {"+\"scenes\":[{\"name\":\"s\",\"prims\":1}],\"builds\":[{\"id\":0,\"scene\":\"s\","
         "\"builder\":\"b\",\"status\":\"ok\",\"layouts_ms\":{\"pair\":-1}}],\"traces\":[]}",
         "builds[0]: \"layouts_ms\" is negative"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[{\"build\":0,\"cell\":\"c\",\"scene\":\"s\","
         "\"builder\":\"b\","
         "\"kernel\":\"k\",\"rays\":\"r\",\"count\":1,\"status\":\"ok\",\"ms\":[1,-1]}]}",
         "traces[0]: \"ms\" is negative"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"steps_ms\":{\"a\":\"b\"}}", "steps_ms"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"time_ms\":{\"total\":\"b\"}}", "time_ms"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"time_ms\":7}", "time_ms"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"skipped\":{}}", "skipped"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"skipped\":[{\"scene\":\"s\",\"rays\":7}]}",
         "skipped[0]: \"rays\""},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"pictures\":[{}]}", "path"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"reproductions\":[{}]}", "name"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"reproductions\":[{\"name\":\"emc\","
         "\"tables\":[{\"columns\":[\"a\",\"b\"],\"rows\":[[1]]}]}]}",
         "emc"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"reproductions\":[{\"name\":\"emc\","
         "\"tables\":[{\"columns\":[\"a\"]}]}]}",
         "\"rows\""},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"reproductions\":[{\"name\":\"emc\","
         "\"claims\":[{\"claim\":\"c\",\"held\":\"yes\"}]}]}",
         "held"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"reproductions\":[{\"name\":\"emc\","
         "\"claims\":[{\"claim\":\"c\",\"held\":null,\"verdict\":7}]}]}",
         "verdict"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[]} x", "not JSON"},
        {"+\"scenes\":[],\"builds\":[],\"traces\":[],\"x\":[\"\\\"\",01]}", "not JSON"},
        {"\xef\xbb\xbf{\"schema\":\"bvhbench-results/1\"}", "not JSON"},
    };
    const char *path = results_path("types");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        bool whole = cases[i].text[0] != '+';
        const char *end = strrchr(cases[i].text, '}'); /* what stands in it twice counts once */
        if (whole)
            snprintf(text, sizeof text, "%s", cases[i].text);
        else
            snprintf(text, sizeof text, "%s%.*s%s%s", head, (int)(end - cases[i].text - 1),
                     cases[i].text + 1, tail, end);
        write_plain(path, text, strlen(text));
        bb_results *results = NULL;
        if (bb_results_read(path, &results) != BB_INVALID ||
            strstr(bb_message(), cases[i].named) == NULL || strstr(bb_message(), path) == NULL)
            fail_msg("case %zu: message '%s'", i, bb_message());
    }
    /* the least that is one */
    char text[256];
    snprintf(text, sizeof text, "%s\"scenes\":[],\"builds\":[],\"traces\":[]%s}", head, tail);
    write_plain(path, text, strlen(text));
    FILE *sink = fopen("/dev/null", "w");
    assert_true(survives(path, sink));
    fclose(sink);
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

static void merging_renumbers(void **state)
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
    const cJSON *build;
    int index = 0;
    cJSON_ArrayForEach(build, section(a, "builds"))
        assert_int_equal(member(build, "id")->valueint, index++);
    const cJSON *last = cJSON_GetArrayItem(section(a, "traces"), 3 * traces - 1);
    const cJSON *its = cJSON_GetArrayItem(section(a, "builds"), member(last, "build")->valueint);
    assert_string_equal(member(its, "builder")->valuestring, member(last, "builder")->valuestring);
    assert_int_equal(member(last, "run")->valueint, 2);
    assert_int_equal(member(its, "run")->valueint, 2);
    double load = member(member(bb_results_json(a), "steps_ms"), "load")->valuedouble;
    assert_true(load == 3 * 320.5);
    const cJSON *times = member(bb_results_json(a), "time_ms");
    assert_true(member(times, "build")->valuedouble == 3 * 2500);
    assert_true(member(times, "steps")->valuedouble == 3 * (21 * 320.5 + 100));
    assert_true(member(times, "total")->valuedouble == 3 * 31000);
    assert_int_equal(cJSON_GetArraySize(section(a, "skipped")), 3 * 2);
    const cJSON *skipped = cJSON_GetArrayItem(section(a, "skipped"), 5);
    assert_string_equal(member(skipped, "rays")->valuestring, "edges");
    assert_int_equal(member(skipped, "run")->valueint, 2);
    assert_int_equal(cJSON_GetArraySize(section(a, "reproductions")), 3);

    const char *path = results_path("merged");
    bb_results *read = NULL;
    assert_int_equal(bb_results_write(a, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    bb_results_destroy(read);
    bb_results_destroy(c);
    bb_results_destroy(b);
    bb_results_destroy(a);
}

/* Of a run without a total there is none after merging; reproductions are those of the other. */
static void merging_takes_files_without_totals(void **state)
{
    (void)state;
    bb_results *old = sample_results(NULL), *read = NULL, *now = sample_results(NULL);
    cJSON_DeleteItemFromObjectCaseSensitive(bb_results_json(old), "time_ms");
    cJSON_DeleteItemFromObjectCaseSensitive(bb_results_json(old), "reproductions");
    const char *path = results_path("without-total");
    assert_int_equal(bb_results_write(old, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    assert_int_equal(bb_results_merge(now, read), BB_OK);
    assert_null(cJSON_GetObjectItemCaseSensitive(bb_results_json(now), "time_ms"));
    assert_int_equal(cJSON_GetArraySize(section(now, "skipped")), 4);
    bb_results_destroy(now);
    now = sample_results(NULL);
    assert_int_equal(bb_results_merge(read, now), BB_OK);
    assert_null(cJSON_GetObjectItemCaseSensitive(bb_results_json(read), "time_ms"));
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

/* Before there were keys, skipped sets, pictures or steps: what a file lacks is not made up. */
static void older_files_are_refused(void **state)
{
    (void)state;
    static const char *const members[] = {"skipped", "pictures", "steps_ms", "cell"};
    const char *path = results_path("older");
    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++) {
        bb_results *results = sample_results(NULL), *read = NULL;
        cJSON *of = i < 3 ? bb_results_json(results) : section(results, "traces")->child;
        cJSON_DeleteItemFromObjectCaseSensitive(of, members[i]);
        assert_int_equal(bb_results_write(results, path), BB_OK);
        assert_int_equal(bb_results_read(path, &read), BB_INVALID);
        assert_non_null(strstr(bb_message(), members[i]));
        assert_non_null(strstr(bb_message(), "missing"));
        bb_results_destroy(results);
    }
}

static void merging_refuses_other_geometry(void **state)
{
    (void)state;
    bb_results *a = sample_results(NULL), *b = sample_results(NULL);
    cJSON_SetValuestring(member(section(b, "scenes")->child, "hash"), "0123456789abcdef");
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
        cmocka_unit_test(wrong_types_are_named),
        cmocka_unit_test(deep_nesting_is_refused),
        cmocka_unit_test(merging_renumbers),
        cmocka_unit_test(merging_takes_files_without_totals),
        cmocka_unit_test(the_first_ray_waits_for_what_adds_up),
        cmocka_unit_test(older_files_are_refused),
        cmocka_unit_test(merging_refuses_other_geometry),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
