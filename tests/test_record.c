/* Records: schema, nulls, exact numbers, atomic writing. (Reading and merging:
 * test_record_read.c.) */
#include "tests/record_fixture.h"

#include "framework/base/file.h"
#include "framework/judge/queries.h"
#include "framework/report/report.h"

#include <dirent.h>
#include <signal.h>
#include <sys/resource.h>

/* ---- schema ---- */

static const char *const context_fields[] = {"date",         "revision",
                                             "host",         "cpu",
                                             "load_1",       "device",
                                             "driver",       "opencl",
                                             "seed",         "kernels",
                                             "build_flags",  "command",
                                             "float_config", "embree_version",
                                             "handover",     "litmus_messages",
                                             "litmus_stale", NULL};
static const char *const scene_fields[] = {"name", "kind",  "prims",   "lo_x", "hi_z",
                                           "hash", "views", "profile", NULL};
static const char *const build_fields[] = {
    "id",          "scene",          "builder",       "status",
    "reason",      "build_ms",       "cold_ms",       "transfer_ms",
    "prepare_ms",  "restore_ms",     "outside_ms",    "boxes_ms",
    "inputs",      "build_handover", "build_ms_lo",   "build_ms_median",
    "build_ms_hi", "build_ms_least", "build_ms_most", NULL};
static const char *const build_parts[] = {"parameter", "phase_ms", "layout_ms", NULL};
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
                                           "work_per_ray",
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

static void schema_is_complete(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    const cJSON *root = document_of(results), *row;
    has_fields(member(root, "context"), context_fields, "context");
    cJSON_ArrayForEach(row, section(results, "scenes")) has_fields(row, scene_fields, "a scene");
    cJSON_ArrayForEach(row, section(results, "builds"))
    {
        has_fields(row, build_fields, "a build");
        if (cJSON_GetObjectItem(row, "tree") == NULL)
            continue;
        has_fields(member(row, "tree"), tree_fields, "a tree");
        has_fields(row, build_parts, "a built tree");
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
    const cJSON *context = member(document_of(results), "context");
    int year, month, day, hour, minute, second, end = 0;
    sscanf(member(context, "date")->valuestring, "%4d-%2d-%2dT%2d:%2d:%2dZ%n", &year, &month, &day,
           &hour, &minute, &second, &end);
    assert_int_equal(end, 20);
    assert_string_equal(member(context, "device")->valuestring, "pthread-sample CPU");
    assert_string_equal(member(context, "kernels")->valuestring, "embedded");
    assert_true(member(context, "load_1")->valuedouble >= 0);
    assert_true(member(context, "load_15")->valuedouble >= 0);
    /* beyond 2^53: digits, not a rounded number */
    assert_string_equal(member(context, "seed")->valuestring, "1234567890123456789");
    assert_true(strlen(member(context, "build_flags")->valuestring) > 3);
    assert_string_equal(member(context, "float_config")->valuestring,
                        "inf_nan round_to_nearest fma");
    int major = 0, minor, patch;
    assert_int_equal(
        sscanf(member(context, "embree_version")->valuestring, "%d.%d.%d", &major, &minor, &patch),
        3);
    assert_in_range(major, 3, 4);
    assert_string_equal(member(context, "embree_api")->valuestring,
                        "rtcIntersect and rtcOccluded: 1, 4, 8, 16 or 1M, by query=");
    bb_results_destroy(results);
}

static void parameters_have_their_defaults(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    const cJSON *lbvh = cJSON_GetArrayItem(section(results, "builds"), 4);
    assert_string_equal(member(lbvh, "builder")->valuestring, "lbvh:bits=63");
    const cJSON *params = member(lbvh, "parameter");
    assert_string_equal(member(params, "bits")->valuestring, "63");
    assert_string_equal(member(params, "quality")->valuestring, "medium");
    assert_null(cJSON_GetObjectItem(params, "seedless"));
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
    sample_add_refusal(results, &sample_scenes[0]);
    static const char *const null_of_build[] = {
        "build_ms",       "build_ms_median", "mprims_s",    "cold_ms",
        "transfer_ms",    "bytes_native",    "build_ms_lo", "build_ms_hi",
        "build_ms_least", "build_ms_most",   NULL};
    const cJSON *build = section(results, "builds")->child;
    for (const char *const *name = null_of_build; *name != NULL; name++)
        if (!cJSON_IsNull(member(build, *name)))
            fail_msg("%s of a refused build is not null", *name);
    assert_null(cJSON_GetObjectItem(build, "tree"));
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
                                                "group_size",
                                                "native",
                                                "view",
                                                NULL};
    const cJSON *row = section(results, "traces")->child;
    for (const char *const *name = null_of_trace; *name != NULL; name++)
        if (!cJSON_IsNull(member(row, *name)))
            fail_msg("%s of an unsupported trace is not null", *name);

    assert_null(cJSON_GetObjectItem(row, "accuracy"));

    trace.status = BB_OK;
    trace.has_accuracy = true; /* of no ray: there is no rate */
    snprintf(trace.view, sizeof trace.view, "second");
    assert_int_equal(bb_results_add_trace(results, &trace), BB_OK);
    snprintf(trace.view, sizeof trace.view, "third");
    trace.counted = 5; /* with nothing overflowed: a measured 0 */
    assert_int_equal(bb_results_add_trace(results, &trace), BB_OK);
    row = section(results, "traces")->child->next;
    assert_true(cJSON_IsNull(member(member(row, "accuracy"), "wrong_ppm")));
    assert_true(cJSON_IsNull(member(member(row, "accuracy"), "overflowed")));
    assert_true(member(row->next, "counted")->valuedouble == 5);
    assert_true(member(member(row->next, "accuracy"), "overflowed")->valuedouble == 0);
    assert_true(cJSON_IsNumber(member(member(row->next, "accuracy"), "overflowed")));
    assert_int_equal(bb_results_add_trace(results, &trace), BB_INVALID); /* a second time */
    assert_non_null(strstr(bb_message(), "already"));
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
    const cJSON *times = member(document_of(results), "time_ms");
    static const struct {
        const char *name;
        double ms;
    } expected[] = {{"build", 40}, {"trace", 80}, {"steps", 30}, {"other", 10}, {"total", 160}};
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
        assert_true(member(times, expected[i].name)->valuedouble == expected[i].ms);
    assert_int_equal(cJSON_GetArraySize(times), 5);
    /* steps that overlap leave less than nothing, which is read back */
    bb_results *read = NULL;
    const char *path = results_path("times");
    assert_int_equal(bb_results_set_total(results, 40, 80, 140), BB_OK);
    assert_int_equal(bb_results_set_number(results, BB_F_CONTEXT_AUDIT_REST, -10), BB_OK);
    assert_int_equal(bb_results_write(results, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    assert_true(bb_results_time_ms(read, "other") == -10);
    bb_results_destroy(read);
    bb_results_destroy(results);
}

static void a_trace_needs_its_build(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_trace_record trace;
    bb_trace_record_init(&trace);
    trace.query = &bb_query_closest;
    strcpy(trace.scene, "coffee");
    strcpy(trace.builder, "unheard");
    strcpy(trace.rays, "primary");
    assert_int_equal(bb_results_add_trace(results, &trace), BB_INVALID);
    assert_non_null(strstr(bb_message(), "unheard"));
    bb_results_destroy(results);
}

/* ---- files ---- */

static void numbers_come_back_exactly(void **state)
{
    (void)state;
    const char *path = results_path("numbers");
    bb_results *results = sample_results(NULL), *read = NULL;
    bb_random random = bb_random_make(77, 0);
    double values[2000];
    char name[16];
    for (int i = 0; i < 2000; i++) {
        do {
            uint64_t bits = bb_random_u64(&random);
            memcpy(&values[i], &bits, sizeof bits);
        } while (!isfinite(values[i]) || values[i] < 0); /* times are not negative */
        snprintf(name, sizeof name, "value %d", i);
        assert_int_equal(bb_results_add_step(results, name, values[i]), BB_OK);
    }
    assert_int_equal(bb_results_write(results, path), BB_OK);
    assert_int_equal(bb_results_read(path, &read), BB_OK);
    for (int i = 0; i < 2000; i++) {
        snprintf(name, sizeof name, "value %d", i);
        double back = bb_results_step_ms(read, name);
        if (memcmp(&back, &values[i], sizeof back) != 0)
            fail_msg("%a came back as %a (seed 77)", values[i], back);
    }
    assert_true(cJSON_Compare(document_of(results), document_of(read), 1));
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

/* Each figure of the file is that of its own member: all are different here. */
static void fields_are_of_their_members(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    static bb_build_record build;
    static bb_trace_record trace;
    static bb_scene scene = {
        .name = "other", .prim_count = 31, .prims = {[BB_TRIANGLE] = {.count = 32}}};
    bb_spec spec;
    bb_build_record_init(&build);
    bb_trace_record_init(&trace);
    assert_int_equal(bb_spec_parse("lbvh", &spec), BB_OK);
    scene.prims[BB_SPHERE].count = 33;
    scene.ignored = 34;
    scene.out_of_range = 35;
    scene.scale = 36;
    scene.load_ms = 37;
    scene.profile = (bb_profile){.flatness = 1,
                                 .size_min = 2,
                                 .size_median = 3,
                                 .size_max = 4,
                                 .zero_area = 5,
                                 .duplicate_boxes = 6,
                                 .duplicate_centroids = 7,
                                 .overlap = 8,
                                 .closed = 1,
                                 .code_bits = 9,
                                 .octree_depth = 10,
                                 .size_low = 38,
                                 .size_high = 39,
                                 .bits_apart = 40,
                                 .bits_useful = 41};
    assert_int_equal(bb_results_add_scene(results, &scene, NULL), BB_OK);
    build.spec = &spec;
    strcpy(build.scene, "other");
    build.cold_ms = 11;
    build.prepare_ms = 12;
    build.boxes_ms = 13;
    build.bytes_native = 14;
    build.has_tree = true;
    build.tree = (bb_tree_info){0, 15, 16, 17, 18, 19};
    build.bytes_tree = 20;
    build.bytes_peak = 21;
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        build.metrics[i] = (bb_metric_value){100 + i, 200 + i};
    bb_samples *const samples[] = {
        &build.build_ms,    &build.event_ms, &build.cpu_ms,   &build.restore_ms, &build.outside_ms,
        &build.transfer_ms, &trace.ms,       &trace.event_ms, &trace.cpu_ms,     &trace.sort_ms};
    for (int i = 0; i < 10; i++)
        bb_samples_add(samples[i], 300 + i);
    assert_int_equal(bb_results_add_build(results, &build), BB_OK);
    strcpy(trace.scene, "other");
    strcpy(trace.builder, "lbvh");
    strcpy(trace.rays, "primary");
    trace.count = 22;
    trace.group_size = 23;
    trace.stack_size = 24;
    trace.counted = 25;
    trace.node_tests_per_ray = 26;
    trace.prim_tests_per_ray = 27;
    trace.has_accuracy = true;
    trace.accuracy =
        (bb_accuracy){41, 42, 43, 44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 57};
    trace.overflowed = 58;
    assert_int_equal(bb_results_add_trace(results, &trace), BB_OK);
    const struct {
        const bb_entry *entry;
        bb_field_id field;
        double value;
    } cases[] = {
#define OF(section, id, value) {section, BB_F_##id, value}
#define SCENE bb_results_scene(results, "other")
#define BUILD results->sections[BB_BUILDS].last
#define TRACE results->sections[BB_TRACES].last
        OF(SCENE, SCENE_PRIMS, 31),
        OF(SCENE, SCENE_IGNORED, 34),
        OF(SCENE, SCENE_OUT_OF_RANGE, 35),
        OF(SCENE, SCENE_SCALE, 36),
        OF(SCENE, SCENE_LOAD_MS, 37),
        OF(SCENE, PROFILE_FLATNESS, 1),
        OF(SCENE, PROFILE_SIZE_MIN, 2),
        OF(SCENE, PROFILE_SIZE_MEDIAN, 3),
        OF(SCENE, PROFILE_SIZE_MAX, 4),
        OF(SCENE, PROFILE_ZERO_AREA, 5),
        OF(SCENE, PROFILE_DUPLICATE_BOXES, 6),
        OF(SCENE, PROFILE_DUPLICATE_CENTROIDS, 7),
        OF(SCENE, PROFILE_OVERLAP, 8),
        OF(SCENE, PROFILE_CODE_BITS, 9),
        OF(SCENE, PROFILE_OCTREE_DEPTH, 10),
        OF(SCENE, PROFILE_SIZE_LOW, 38),
        OF(SCENE, PROFILE_SIZE_HIGH, 39),
        OF(SCENE, PROFILE_BITS_APART, 40),
        OF(SCENE, PROFILE_BITS_USEFUL, 41),
        OF(BUILD, BUILD_COLD_MS, 11),
        OF(BUILD, BUILD_PREPARE_MS, 12),
        OF(BUILD, BUILD_BOXES_MS, 13),
        OF(BUILD, BUILD_BYTES_NATIVE, 14),
        OF(BUILD, TREE_NODES, 15),
        OF(BUILD, TREE_LEAVES, 16),
        OF(BUILD, TREE_REFS, 17),
        OF(BUILD, TREE_ARITY, 18),
        OF(BUILD, TREE_DEPTH, 19),
        OF(BUILD, TREE_BYTES, 20),
        OF(BUILD, TREE_BYTES_PEAK, 21),
        OF(BUILD, BUILD_MS_MEDIAN, 300),
        OF(BUILD, BUILD_RESTORE_MS, 303),
        OF(BUILD, BUILD_OUTSIDE_MS, 304),
        OF(BUILD, BUILD_TRANSFER_MS, 305),
        OF(TRACE, TRACE_COUNT, 22),
        OF(TRACE, TRACE_GROUP, 23),
        OF(TRACE, TRACE_STACK, 24),
        OF(TRACE, TRACE_COUNTED, 25),
        OF(TRACE, TRACE_NODE_TESTS, 26),
        OF(TRACE, TRACE_PRIM_TESTS, 27),
        OF(TRACE, TRACE_WORK, 1.2 * 0.5 * 26 + 27),
        OF(TRACE, TRACE_MS_MEDIAN, 306),
        OF(TRACE, TRACE_EVENT_MS, 307),
        OF(TRACE, TRACE_CPU_MS, 308),
        OF(TRACE, TRACE_SORT_MS, 309),
        OF(TRACE, ACCURACY_CHECKED, 41),
        OF(TRACE, ACCURACY_RIGHT, 42),
        OF(TRACE, ACCURACY_TIES, 43),
        OF(TRACE, ACCURACY_MISSED, 44),
        OF(TRACE, ACCURACY_FALSE, 45),
        OF(TRACE, ACCURACY_WRONG_T, 46),
        OF(TRACE, ACCURACY_UNWRITTEN, 47),
        OF(TRACE, ACCURACY_MARGIN, 48),
        OF(TRACE, ACCURACY_T_OFF, 49),
        OF(TRACE, ACCURACY_ORACLE_WRONG, 50),
        OF(TRACE, ACCURACY_FORGIVEN, 51),
        OF(TRACE, ACCURACY_ARBITRATED, 52),
        OF(TRACE, ACCURACY_WRONG_PPM, 53),
        OF(TRACE, ACCURACY_T_ULP_MAX, 54),
        OF(TRACE, ACCURACY_T_ULP_P99, 55),
        OF(TRACE, ACCURACY_JUDGE_MS, 56),
        OF(TRACE, ACCURACY_FIRST_WRONG, 57),
        OF(TRACE, ACCURACY_OVERFLOWED, 58),
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        if (bb_get_number(cases[i].entry, cases[i].field) != cases[i].value)
            fail_msg("%s is %g, not %g", bb_fields[cases[i].field].name,
                     bb_get_number(cases[i].entry, cases[i].field), cases[i].value);
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        assert_true(bb_get_metric(BUILD, bb_metrics[i]) == 100 + i);
        assert_true(!bb_metrics[i]->sampled || bb_get_metric_half(BUILD, bb_metrics[i]) == 200 + i);
    }
    const uint32_t scene_row = bb_place_of(SCENE);
    assert_true(bb_table_get_number(results->table, scene_row, "triangles") == 32);
    assert_true(bb_table_get_number(results->table, scene_row, "spheres") == 33);
    bb_results_destroy(results);
}

/* A metric's fields are nobody else's. */
static void names_of_metrics_are_free(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        const char *half = bb_metric_column(bb_metrics[i], true)->name;
        assert_in_range(strlen(bb_metrics[i]->name), 1, 48);
        assert_int_equal(bb_metric_find(bb_metrics[i]->name), i);
        for (size_t f = 0; f < BB_FIELDS; f++)
            assert_true(strcmp(bb_fields[f].name, bb_metrics[i]->name) != 0 &&
                        strcmp(bb_fields[f].name, half) != 0);
    }
    assert_true(bb_metrics[bb_metric_count()] == NULL); /* else raise BB_METRICS_MAX */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_are_of_their_members),
        cmocka_unit_test(names_of_metrics_are_free),
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
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
