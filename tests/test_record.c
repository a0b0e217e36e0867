/* Records: schema, nulls, exact numbers, reading of broken files, merging, atomic writing.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "framework/chart_script.h"
#include "framework/file.h"
#include "framework/report.h"
#include "tests/report_sample.h"

#include <cjson/cJSON.h>
#include <dirent.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

/* ---- schema ---- */

static const char *const context_fields[] = {
    "date",         "revision", "host",        "cpu",
    "load",         "device",   "driver",      "opencl",
    "seed",         "kernels",  "build_flags", "command",
    "float_config", "embree",   "handover",    "litmus_messages",
    "litmus_stale", NULL};
static const char *const scene_fields[] = {"name", "kind",    "prims", "bounds",
                                           "hash", "profile", NULL};
static const char *const build_fields[] = {"id",
                                           "scene",
                                           "builder",
                                           "params",
                                           "status",
                                           "reason",
                                           "build_ms",
                                           "cold_ms",
                                           "transfer_ms",
                                           "prepare_ms",
                                           "restore_ms",
                                           "outside_ms",
                                           "boxes_ms",
                                           "inputs",
                                           "tree",
                                           "phases_ms",
                                           "layouts_ms",
                                           "build_ms_median",
                                           "build_ms_lo",
                                           "build_ms_hi",
                                           "build_ms_least",
                                           "build_ms_most",
                                           NULL};
static const char *const tree_fields[] = {"nodes", "leaves",     "refs",       "arity", "depth",
                                          "sah",   "bytes_tree", "bytes_peak", "epo",   NULL};
static const char *const trace_fields[] = {"build",
                                           "scene",
                                           "view",
                                           "builder",
                                           "kernel",
                                           "layout",
                                           "native",
                                           "rays",
                                           "query",
                                           "count",
                                           "rays_hash",
                                           "status",
                                           "intersector",
                                           "group_size",
                                           "reason",
                                           "ms",
                                           "event_ms",
                                           "cpu_ms",
                                           "mrays_s",
                                           "mrays_s_lo",
                                           "mrays_s_hi",
                                           "mrays_s_least",
                                           "mrays_s_most",
                                           "accuracy",
                                           "unlike",
                                           "unlike_whom",
                                           "node_tests_per_ray",
                                           "prim_tests_per_ray",
                                           "counted",
                                           NULL};
static const char *const accuracy_fields[] = {
    "checked",      "wrong_ppm",      "missed",    "false",      "wrong_t",
    "ties",         "margin_limited", "t_off",     "forgiven",   "unwritten",
    "oracle_wrong", "t_ulp_max",      "t_ulp_p99", "overflowed", NULL};

static void has_fields(const cJSON *object, const char *const *fields, const char *what)
{
    for (; *fields != NULL; fields++)
        if (cJSON_GetObjectItemCaseSensitive(object, *fields) == NULL)
            fail_msg("%s lacks %s", what, *fields);
}

static cJSON *section(bb_results *results, const char *name)
{
    cJSON *array = cJSON_GetObjectItemCaseSensitive(bb_results_json(results), name);
    assert_true(cJSON_IsArray(array));
    return array;
}

static cJSON *member(const cJSON *object, const char *name)
{
    cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (item == NULL)
        fail_msg("no member %s", name);
    return item;
}

static void schema_is_complete(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    const cJSON *root = bb_results_json(results), *row;
    assert_string_equal(member(root, "schema")->valuestring, "bvhbench-results/1");
    has_fields(member(root, "context"), context_fields, "context");
    cJSON_ArrayForEach(row, section(results, "scenes")) has_fields(row, scene_fields, "a scene");
    cJSON_ArrayForEach(row, section(results, "builds"))
    {
        has_fields(row, build_fields, "a build");
        if (cJSON_IsObject(member(row, "tree")))
            has_fields(member(row, "tree"), tree_fields, "a tree");
    }
    cJSON_ArrayForEach(row, section(results, "traces"))
    {
        has_fields(row, trace_fields, "a trace");
        has_fields(member(row, "accuracy"), accuracy_fields, "an accuracy");
    }
    bb_results_destroy(results);
}

static void context_describes_the_machine(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    const cJSON *context = member(bb_results_json(results), "context");
    int year, month, day, hour, minute, second, end = 0;
    sscanf(member(context, "date")->valuestring, "%4d-%2d-%2dT%2d:%2d:%2dZ%n", &year, &month, &day,
           &hour, &minute, &second, &end);
    assert_int_equal(end, 20);
    assert_string_equal(member(context, "device")->valuestring, "pthread-sample CPU");
    assert_string_equal(member(context, "kernels")->valuestring, "embedded");
    assert_int_equal(cJSON_GetArraySize(member(context, "load")), 3);
    /* beyond 2^53: digits, not a rounded number */
    assert_string_equal(member(context, "seed")->valuestring, "1234567890123456789");
    assert_true(strlen(member(context, "build_flags")->valuestring) > 3);
    const char *const words[] = {"inf_nan", "round_to_nearest", "fma"};
    const cJSON *floats = member(context, "float_config");
    assert_int_equal(cJSON_GetArraySize(floats), 3);
    for (int i = 0; i < 3; i++)
        assert_string_equal(cJSON_GetArrayItem(floats, i)->valuestring, words[i]);
    int major = 0, minor, patch;
    const cJSON *embree = member(context, "embree");
    assert_int_equal(
        sscanf(member(embree, "version")->valuestring, "%d.%d.%d", &major, &minor, &patch), 3);
    assert_in_range(major, 3, 4);
    assert_string_equal(member(embree, "api")->valuestring, "rtcIntersect1/rtcOccluded1");
    bb_results_destroy(results);
}

static void parameters_have_their_defaults(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    const cJSON *lbvh = cJSON_GetArrayItem(section(results, "builds"), 4);
    assert_string_equal(member(lbvh, "builder")->valuestring, "lbvh:bits=63");
    const cJSON *params = member(lbvh, "params");
    assert_string_equal(member(params, "bits")->valuestring, "63");
    assert_string_equal(member(params, "quality")->valuestring, "medium");
    assert_true(cJSON_IsNull(member(params, "seedless")));
    bb_results_destroy(results);
}

static void figures_follow_from_samples(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    const cJSON *trace = section(results, "traces")->child;
    const cJSON *samples = member(trace, "ms");
    assert_int_equal(cJSON_GetArraySize(samples), 7); /* the first round is kept */
    bb_samples same = {0};
    const cJSON *value;
    cJSON_ArrayForEach(value, samples) bb_samples_add(&same, value->valuedouble);
    double expected = member(trace, "count")->valuedouble / bb_samples_median(&same) / 1e3;
    assert_true(fabs(member(trace, "mrays_s")->valuedouble - expected) < 1e-9);
    assert_true(member(trace, "mrays_s_lo")->valuedouble <= expected);
    assert_true(member(trace, "mrays_s_hi")->valuedouble >= expected);
    assert_string_equal(member(trace, "rays_hash")->valuestring, "abcdef0123496789");

    const cJSON *build = section(results, "builds")->child;
    double rate = 1247000 / member(build, "build_ms_median")->valuedouble / 1e3;
    assert_true(fabs(member(build, "mprims_s")->valuedouble - rate) < 1e-9);
    bb_results_destroy(results);
}

static const char *const spread_names[] = {"lo", "hi", "least", "most"};

/* NAME_lo, NAME_hi, NAME_least, NAME_most of a row; NAN for null. */
static void spread_of(const cJSON *row, const char *name, double ends[4])
{
    for (int i = 0; i < 4; i++) {
        char label[64];
        snprintf(label, sizeof label, "%s_%s", name, spread_names[i]);
        const cJSON *item = member(row, label);
        assert_true(cJSON_IsNumber(item) || cJSON_IsNull(item));
        ends[i] = cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
    }
}

/* The rows of the sample's scenes have 6, 3 and 1 rounds that count. */
static void too_few_rounds_have_no_interval(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    static const char *const sections[] = {"builds", "traces"}, *const names[] = {"build_ms",
                                                                                  "mrays_s"};
    int seen[SAMPLE_SCENES] = {0};
    for (int i = 0; i < 2; i++) {
        const cJSON *row;
        cJSON_ArrayForEach(row, section(results, sections[i]))
        {
            if (strcmp(member(row, "status")->valuestring, "ok") != 0)
                continue;
            int s = 0;
            double ends[4];
            while (strcmp(member(row, "scene")->valuestring, sample_scenes[s].name) != 0)
                s++;
            seen[s]++;
            spread_of(row, names[i], ends);
            for (int k = 0; k < 4; k++)
                if (isnan(ends[k]) != (sample_scenes[s].rounds < (k < 2 ? 6 : 2)))
                    fail_msg("%s_%s of %d rounds is %g", names[i], spread_names[k],
                             sample_scenes[s].rounds, ends[k]);
            if (sample_scenes[s].rounds >= 6)
                assert_true(ends[2] <= ends[0] && ends[0] < ends[1] && ends[1] <= ends[3]);
        }
    }
    for (int s = 0; s < SAMPLE_SCENES; s++)
        assert_true(seen[s] > 20);
    bb_results_destroy(results);
}

/* ---- nulls ---- */

static void no_zero_for_what_was_not_measured(void **state)
{
    (void)state;
    bb_results *results = NULL;
    bb_context context = {NULL, 1, NULL};
    assert_int_equal(bb_results_create(&context, &results), BB_OK);
    sample_add_scene(results, &sample_scenes[0], 0);
    sample_add_refusal(results, &sample_scenes[0], 0);
    static const char *const null_of_build[] = {
        "build_ms",     "build_ms_median", "mprims_s",    "cold_ms",        "transfer_ms",   "tree",
        "bytes_native", "build_ms_lo",     "build_ms_hi", "build_ms_least", "build_ms_most", NULL};
    const cJSON *build = section(results, "builds")->child;
    for (const char *const *name = null_of_build; *name != NULL; name++)
        if (!cJSON_IsNull(member(build, *name)))
            fail_msg("%s of a refused build is not null", *name);
    assert_string_equal(member(build, "status")->valuestring, "refused");

    bb_trace_record trace; /* as a careless caller leaves it: zeros */
    memset(&trace, 0, sizeof trace);
    snprintf(trace.scene, sizeof trace.scene, "coffee");
    snprintf(trace.builder, sizeof trace.builder, "null");
    snprintf(trace.kernel, sizeof trace.kernel, "stack");
    snprintf(trace.rays, sizeof trace.rays, "primary");
    trace.status = BB_UNSUPPORTED;
    trace.count = 5;
    assert_int_equal(bb_results_add_trace(results, &trace), BB_OK);
    static const char *const null_of_trace[] = {"ms",
                                                "ms_median",
                                                "event_ms",
                                                "cpu_ms",
                                                "mrays_s",
                                                "mrays_s_lo",
                                                "mrays_s_hi",
                                                "mrays_s_least",
                                                "mrays_s_most",
                                                "node_tests_per_ray",
                                                "prim_tests_per_ray",
                                                "counted",
                                                "accuracy",
                                                "group_size",
                                                "native",
                                                "view",
                                                NULL};
    const cJSON *row = section(results, "traces")->child;
    for (const char *const *name = null_of_trace; *name != NULL; name++)
        if (!cJSON_IsNull(member(row, *name)))
            fail_msg("%s of an unsupported trace is not null", *name);

    trace.status = BB_OK;
    trace.has_accuracy = true; /* of no ray: there is no rate */
    assert_int_equal(bb_results_add_trace(results, &trace), BB_OK);
    assert_true(cJSON_IsNull(member(member(row->next, "accuracy"), "wrong_ppm")));
    assert_true(cJSON_IsNull(member(member(row->next, "accuracy"), "overflowed")));

    trace.counted = 5; /* with nothing overflowed: a measured 0 */
    assert_int_equal(bb_results_add_trace(results, &trace), BB_OK);
    assert_true(member(row->next->next, "counted")->valuedouble == 5);
    assert_true(member(member(row->next->next, "accuracy"), "overflowed")->valuedouble == 0);
    assert_true(cJSON_IsNumber(member(member(row->next->next, "accuracy"), "overflowed")));
    bb_results_destroy(results);
}

/* Every millisecond of the run stands under some name. */
static void times_add_up(void **state)
{
    (void)state;
    bb_results *results = NULL;
    bb_context context = {NULL, 1, NULL};
    assert_int_equal(bb_results_create(&context, &results), BB_OK);
    assert_int_equal(bb_results_add_step(results, "load", 10), BB_OK);
    assert_int_equal(bb_results_set_total(results, 1, 2, 3), BB_OK);
    assert_int_equal(bb_results_add_step(results, "judge", 20), BB_OK);
    assert_int_equal(bb_results_set_total(results, 40, 80, 160), BB_OK);
    const cJSON *root = bb_results_json(results), *times = member(root, "time_ms");
    static const struct {
        const char *name;
        double ms;
    } expected[] = {{"build", 40}, {"trace", 80}, {"steps", 30}, {"other", 10}, {"total", 160}};
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
        assert_true(member(times, expected[i].name)->valuedouble == expected[i].ms);
    assert_int_equal(cJSON_GetArraySize(times), 5);
    bb_results_destroy(results);
}

static void a_trace_needs_its_build(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_trace_record trace;
    bb_trace_record_init(&trace);
    trace.build = 4711;
    assert_int_equal(bb_results_add_trace(results, &trace), BB_INVALID);
    assert_non_null(strstr(bb_message(), "4711"));
    bb_results_destroy(results);
}

/* ---- files ---- */

static const char *results_path(const char *test)
{
    static char path[600];
    snprintf(path, sizeof path, "%s/results.json", sample_folder(test));
    unlink(path);
    return path;
}

static void numbers_come_back_exactly(void **state)
{
    (void)state;
    const char *path = results_path("numbers");
    bb_results *results = sample_results(NULL), *read = NULL;
    bb_random random = bb_random_make(77, 0);
    double values[2000];
    cJSON *array = cJSON_AddArrayToObject(bb_results_json(results), "values");
    for (int i = 0; i < 2000; i++) {
        do {
            uint64_t bits = bb_random_u64(&random);
            memcpy(&values[i], &bits, sizeof bits);
        } while (!isfinite(values[i]));
        cJSON_AddItemToArray(array, cJSON_CreateNumber(values[i]));
    }
    assert_int_equal(bb_results_write(results, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    for (int i = 0; i < 2000; i++) {
        double back = cJSON_GetArrayItem(section(read, "values"), i)->valuedouble;
        if (memcmp(&back, &values[i], sizeof back) != 0)
            fail_msg("%a came back as %a (seed 77)", values[i], back);
    }
    assert_true(cJSON_Compare(bb_results_json(results), bb_results_json(read), 1));
    bb_results_destroy(read);
    bb_results_destroy(results);
}

static void a_failed_write_leaves_the_old_file(void **state)
{
    (void)state;
    char folder[512], path[600];
    snprintf(folder, sizeof folder, "%s", sample_folder("atomic"));
    snprintf(path, sizeof path, "%s/results.json", folder);
    assert_int_equal(bb_file_write(path, "old", 3, "test"), BB_OK);

    /* the disk is full, as far as this process can tell */
    bb_results *results = sample_results(NULL);
    struct rlimit old, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    small = old;
    small.rlim_cur = 8192;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    bb_status status = bb_results_write(results, path);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_equal(status, BB_INVALID);
    assert_non_null(strstr(bb_message(), path));
    char *text = NULL;
    size_t size;
    assert_int_equal(bb_file_read(path, 100, "test", &text, &size), BB_OK);
    assert_string_equal(text, "old");
    free(text);

    /* and nothing is left beside it */
    DIR *listing = opendir(folder);
    int files = 0;
    for (struct dirent *entry; (entry = readdir(listing)) != NULL;)
        files += entry->d_name[0] != '.';
    closedir(listing);
    assert_int_equal(files, 1);
    bb_results_destroy(results);
}

static void an_unwritable_folder_is_named(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    assert_int_equal(bb_results_write(results, "/nonexistent/out/results.json"), BB_INVALID);
    assert_non_null(strstr(bb_message(), "/nonexistent/out/results.json"));
    assert_int_equal(bb_results_write(results, "/proc/results.json"), BB_INVALID);
    assert_int_equal(bb_results_write(results, "/dev/null"), BB_INVALID);
    bb_results_destroy(results);
}

/* Earlier versions wrote bootstrap intervals, of one round even: what is read has what its samples
 * give. A speed that was only given keeps what stands beside it. */
static void intervals_of_older_files_are_drawn_anew(void **state)
{
    (void)state;
    const char *path = results_path("bootstrapped");
    bb_results *results = sample_results(NULL), *read = NULL, *fresh = sample_results(NULL);
    static const char *const sections[] = {"builds", "traces"}, *const names[] = {"build_ms",
                                                                                  "mrays_s"};
    for (int i = 0; i < 2; i++) {
        cJSON *row;
        cJSON_ArrayForEach(row, section(results, sections[i]))
        {
            char label[64];
            for (int k = 0; k < 4; k++) {
                snprintf(label, sizeof label, "%s_%s", names[i], spread_names[k]);
                cJSON_DeleteItemFromObjectCaseSensitive(row, label);
                if (k < 2)
                    cJSON_AddNumberToObject(row, label, 1.5);
            }
        }
    }
    cJSON *given = section(results, "traces")->child;
    cJSON_ReplaceItemInObject(given, "ms", cJSON_CreateNull());
    assert_int_equal(bb_results_write(results, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    assert_true(member(section(read, "traces")->child, "mrays_s_lo")->valuedouble == 1.5);
    for (int i = 0; i < 2; i++) {
        const cJSON *row = section(read, sections[i])->child,
                    *other = section(fresh, sections[i])->child;
        for (; row != NULL; row = row->next, other = other->next) {
            if (!cJSON_IsArray(member(row, i == 0 ? "build_ms" : "ms")))
                continue;
            double ends[4], expected[4];
            spread_of(row, names[i], ends);
            spread_of(other, names[i], expected);
            assert_memory_equal(ends, expected, sizeof ends);
        }
    }
    bb_results_destroy(fresh);
    bb_results_destroy(read);
    bb_results_destroy(results);
}

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
    while (cJSON_GetArraySize(section(results, "scenes")) > 1)
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
        {"+\"scenes\":[],\"builds\":[],\"traces\":[{\"build\":0,\"scene\":\"s\",\"builder\":\"b\","
         "\"kernel\":\"k\",\"rays\":\"r\",\"count\":1,\"status\":\"ok\"}]}",
         "build 0"},
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
    };
    const char *path = results_path("types");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        bool whole = cases[i].text[0] != '+';
        snprintf(text, sizeof text, "%s%s", whole ? "" : head, cases[i].text + !whole);
        write_plain(path, text, strlen(text));
        bb_results *results = NULL;
        if (bb_results_read(path, &results) != BB_INVALID ||
            strstr(bb_message(), cases[i].named) == NULL || strstr(bb_message(), path) == NULL)
            fail_msg("case %zu: message '%s'", i, bb_message());
    }
    /* the least that is one */
    char text[256];
    snprintf(text, sizeof text, "%s\"scenes\":[],\"builds\":[],\"traces\":[]}", head);
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

/* A file of before there were totals and skipped sets: what it lacks is not made up. */
static void merging_takes_older_files(void **state)
{
    (void)state;
    bb_results *old = sample_results(NULL), *read = NULL, *now = sample_results(NULL);
    cJSON_DeleteItemFromObjectCaseSensitive(bb_results_json(old), "time_ms");
    cJSON_DeleteItemFromObjectCaseSensitive(bb_results_json(old), "skipped");
    cJSON_DeleteItemFromObjectCaseSensitive(bb_results_json(old), "reproductions");
    const char *path = results_path("older");
    assert_int_equal(bb_results_write(old, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    assert_int_equal(cJSON_GetArraySize(section(read, "skipped")), 0);
    assert_int_equal(bb_results_merge(now, read), BB_OK);
    assert_null(cJSON_GetObjectItemCaseSensitive(bb_results_json(now), "time_ms"));
    assert_int_equal(cJSON_GetArraySize(section(now, "skipped")), 2);
    bb_results_destroy(now);
    now = sample_results(NULL);
    assert_int_equal(bb_results_merge(read, now), BB_OK);
    assert_null(cJSON_GetObjectItemCaseSensitive(bb_results_json(read), "time_ms"));
    assert_int_equal(cJSON_GetArraySize(section(read, "skipped")), 2);
    assert_int_equal(cJSON_GetArraySize(section(read, "reproductions")), 1);
    bb_results_destroy(now);
    bb_results_destroy(read);
    bb_results_destroy(old);
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
        cmocka_unit_test(schema_is_complete),
        cmocka_unit_test(context_describes_the_machine),
        cmocka_unit_test(parameters_have_their_defaults),
        cmocka_unit_test(figures_follow_from_samples),
        cmocka_unit_test(too_few_rounds_have_no_interval),
        cmocka_unit_test(no_zero_for_what_was_not_measured),
        cmocka_unit_test(times_add_up),
        cmocka_unit_test(a_trace_needs_its_build),
        cmocka_unit_test(numbers_come_back_exactly),
        cmocka_unit_test(a_failed_write_leaves_the_old_file),
        cmocka_unit_test(an_unwritable_folder_is_named),
        cmocka_unit_test(intervals_of_older_files_are_drawn_anew),
        cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(damaged_files_do_no_harm),
        cmocka_unit_test(wrong_types_are_named),
        cmocka_unit_test(deep_nesting_is_refused),
        cmocka_unit_test(merging_renumbers),
        cmocka_unit_test(merging_takes_older_files),
        cmocka_unit_test(merging_refuses_other_geometry),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
