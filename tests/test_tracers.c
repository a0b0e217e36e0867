/* Tracer plug-ins from outside: one enters the same rounds as builders, and what it breaks costs
 * its own row alone. Half a minute. */
#include "tests/program_fixture.h"

#include <unistd.h>

#define BRUTE BB_TEST_PLUGIN_DIR "/brute.so"
#define RUN                                                                                        \
    "run --quiet --scene random:n=50 --builder lbvh --kernel stack --rays primary,shadow "         \
    "--size 24x24 --max-rays 500 --repeats 2 --no-pictures --charts no --out out "

static const cJSON *row_of(const cJSON *json, const char *section, const char *builder)
{
    const cJSON *row;
    cJSON_ArrayForEach(
        row, cJSON_GetObjectItem(
                 json, section)) if (strcmp(cJSON_GetObjectItem(row, "builder")->valuestring,
                                            builder) == 0) return row;
    fail_msg("no row of %s among %s", builder, section);
    return NULL;
}

static const char *text_of(const cJSON *row, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(row, name);
    return cJSON_IsString(item) ? item->valuestring : "";
}

static void a_tracer_is_a_row(void **state)
{
    (void)state;
    const outcome *o = run(RUN "--tracer " BRUTE " --tracer " BRUTE ":kind=blind");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    assert_non_null(strstr(o->out, "brute"));
    assert_non_null(strstr(o->out, "embree-native"));
    cJSON *json = read_results("out/results.json");
    const cJSON *build = row_of(json, "builds", "brute:pace=two");
    assert_string_equal(text_of(build, "status"), "ok");
    assert_true(cJSON_IsTrue(cJSON_GetObjectItem(build, "reference")));
    assert_string_equal(text_of(build, "about"), "brute 1.0");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(build, "build_ms")), 3);
    assert_true(cJSON_GetObjectItem(build, "bytes_native")->valuedouble >= 8 * 12);
    assert_non_null(cJSON_GetObjectItem(build, "phase_ms"));
    /* the same tree, with the same times */
    assert_true(cJSON_Compare(cJSON_GetObjectItem(build, "build_ms"),
                              cJSON_GetObjectItem(row_of(json, "builds", "brute"), "build_ms"),
                              true));
    uint32_t right = 0, wrong = 0;
    const cJSON *trace;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
    {
        const char *builder = text_of(trace, "builder");
        const double ppm =
            cJSON_GetObjectItem(cJSON_GetObjectItem(trace, "accuracy"), "wrong_ppm")->valuedouble;
        if (strncmp(builder, "brute", 5) != 0)
            continue;
        assert_string_equal(text_of(trace, "kernel"), "brute");
        right += strstr(builder, "blind") == NULL && ppm == 0;
        wrong += strstr(builder, "blind") != NULL && ppm > 0;
    }
    const cJSON *cell = cJSON_GetObjectItem(row_of(json, "traces", "brute"), "cell");
    assert_true(right > 4 && wrong > 2);
    assert_null(strstr(cell->valuestring, "kernel="));
    char command[2048];
    snprintf(command, sizeof command,
             "run --quiet --repeats 1 --no-pictures --charts no --out one "
             "--tracer " BRUTE " --cell '%s'",
             cell->valuestring);
    cJSON_Delete(json);
    expect(0, command, "brute");
    expect(0, "compare out out", "");
}

/* All other rows are as they would be without it. */
static void only_it_failed(const cJSON *json, const char *kind)
{
    const cJSON *row;
    cJSON_ArrayForEach(
        row, cJSON_GetObjectItem(json, "builds")) if (strncmp(text_of(row, "builder"), "brute",
                                                              5) != 0 &&
                                                      strcmp(text_of(row, "status"), "failed") == 0)
        fail_msg("%s: %s failed: %s", kind, text_of(row, "builder"), text_of(row, "reason"));
}

static void what_it_breaks_costs_its_row(void **state)
{
    (void)state;
    static const struct {
        const char *kind, *section, *status, *reason;
        int exit_status;
    } cases[] = {
        {"lacks", "builds", "unsupported", "this library lacks it", 0},
        {"lacks-late", "builds", "unsupported", "it lacks that", 0},
        {"fails", "builds", "failed", "cannot build", 1},
        {"fails-late", "traces", "failed", "cannot trace", 1},
        {"crashes", "traces", "failed", "died in trace()", 1},
        {"crashes-early", "builds", "failed", "died in create()", 1},
        {"scene", "builds", "failed", "wrote into the scene's vertices", 1},
        {"threads", "builds", "failed", "a thread at work", 1},
        {"rays", "traces", "failed", "changed the rays", 1},
        {"hangs", "traces", "failed", "died in trace()", 1},
        {"late", "traces", "failed", "wrote answers after trace() had returned", 1},
        {"lazy", "builds", "failed", "answers otherwise later than right after build()", 1},
        {"floats", "traces", "failed", "changed the rounding mode in trace()", 1},
        {"remembers", "traces", "failed", "it remembers answers: of rays that it had not", 1},
        {"remembers-well", "traces", "failed", "it remembers answers: of 4 sets of rays", 1},
        {"scene-last", "builds", "failed", "cannot build", 1},
        {"stale", "builds", "failed", "does not build anew", 1},
        {"late-build", "builds", "failed", "goes on building after build()", 1},
        {"pins", "traces", "failed", "changed in trace() where a thread may run", 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char command[1024], builder[64];
        if (strcmp(cases[i].kind, "pins") == 0 && sysconf(_SC_NPROCESSORS_ONLN) < 2)
            continue; /* there is nowhere else to run */
        snprintf(builder, sizeof builder, "brute:kind=%s", cases[i].kind);
        snprintf(command, sizeof command, RUN "--patience %d --tracer " BRUTE ":kind=%s",
                 strcmp(cases[i].kind, "hangs") == 0 ? 5 : 60, cases[i].kind);
        const outcome *o = run(command);
        if (o->exit_status != cases[i].exit_status)
            fail_msg("%s: exit %d: %s%s", cases[i].kind, o->exit_status, o->out, o->err);
        cJSON *json = read_results("out/results.json");
        const cJSON *row = row_of(json, cases[i].section, builder);
        if (strcmp(text_of(row, "status"), cases[i].status) != 0 ||
            strstr(text_of(row, "reason"), cases[i].reason) == NULL)
            fail_msg("%s: %s, %s", cases[i].kind, text_of(row, "status"), text_of(row, "reason"));
        only_it_failed(json, cases[i].kind);
        const cJSON *ours = row_of(json, "traces", "lbvh");
        assert_string_equal(text_of(ours, "status"), "ok");
        assert_true(
            cJSON_GetObjectItem(cJSON_GetObjectItem(ours, "accuracy"), "wrong_ppm")->valuedouble ==
            0);
        cJSON_Delete(json);
    }
}

/* Where OpenCL has one thread, so has a tracer. */
/* Beside other programs its threads may get no more than one processor: three tries. */
static void more_threads_than_given_are_seen(void **state)
{
    (void)state;
    if (sysconf(_SC_NPROCESSORS_ONLN) < 2)
        skip();
    int exit_status = 0;
    for (int i = 0; i < 3 && exit_status == 0; i++)
        exit_status =
            run_with("POCL_MAX_PTHREAD_COUNT=1", RUN "--tracer " BRUTE ":kind=greedy")->exit_status;
    assert_int_equal(exit_status, 1);
    cJSON *json = read_results("out/results.json");
    const cJSON *row = row_of(json, "traces", "brute:kind=greedy");
    assert_string_equal(text_of(row, "status"), "failed");
    assert_non_null(strstr(text_of(row, "reason"), "it has more"));
    cJSON_Delete(json);
}

/* Answers that are not written are wrong ones. */
static void fewer_answers_are_wrong(void **state)
{
    (void)state;
    run(RUN "--tracer " BRUTE ":kind=fewer");
    cJSON *json = read_results("out/results.json");
    const cJSON *accuracy =
        cJSON_GetObjectItem(row_of(json, "traces", "brute:kind=fewer"), "accuracy");
    assert_true(cJSON_GetObjectItem(accuracy, "wrong_ppm")->valuedouble > 0);
    cJSON_Delete(json);
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    refuses("", "run --scene cube --tracer none.so", "plug-in none.so");
    refuses("", "run --scene cube --tracer nobody:x=y", "unknown");
    refuses("", "run --scene cube --tracer " BRUTE ":kind=odd", "'odd'");
    refuses("", "run --scene cube --tracer " BRUTE ":colour=red", "colour");
    refuses("", "run --scene cube --tracer " BB_TEST_PLUGIN_DIR "/median.so", "is a builder");
    refuses("", "run --scene cube --tracer " BRUTE " --tracer " BRUTE, "is given twice");
    refuses("", "run --scene cube --builder brute+lbvh --plugin " BRUTE,
            "traces with its own tree");
    refuses("", "run --scene cube --builder brute", "unknown builder 'brute'");
    expect(0, "list tracers --plugin " BRUTE, "brute force, for tests");
    expect(0, "list tracers", "embree-native");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tracer_is_a_row),
        cmocka_unit_test(what_it_breaks_costs_its_row),
        cmocka_unit_test(more_threads_than_given_are_seen),
        cmocka_unit_test(fewer_answers_are_wrong),
        cmocka_unit_test(bad_input_is_refused),
    };
    return cmocka_run_group_tests_name("tracers", tests, make_folder, remove_folder);
}
