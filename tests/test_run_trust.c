/* What a run must not take on trust: that an answer that was right once stays right, that what was
 * not answered was, that kernels which are right agree, that a builder's scratch was paid for, that
 * a clock saw the work, that a set which takes several launches took as long as the last. Half a
 * minute. */
#include "tests/program_fixture.h"

/* Device code that answers a ray twice, and then no more: it counts in the rays themselves. */
static void answers_of_later_rounds_are_judged(void **state)
{
    (void)state;
    char command[1024];
    snprintf(command, sizeof command,
             "mkdir -p %s/tired && sed 's/^    if (enough)$/"
             "    global float *end = (global float *)\\&rays[id].tmax;"
             "    bool tired = *end == 0x1p125f;"
             "    *end = *end > 0x1p126f ? 0x1p126f : 0x1p125f;"
             "    if (enough \\&\\& !tired)/' " BB_TEST_SOURCE_DIR
             "/kernels/trace_alone.clh >%s/tired/trace_alone.clh",
             folder, folder);
    assert_int_equal(system(command), 0);
    const outcome *o = run("run --scene cube --builder lbvh --kernel stack --rays primary --size "
                           "32x32 --repeats 3 --no-pictures --kernels-from tired --out tired");
    if (o->exit_status != 1)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    cJSON *json = read_results("tired/results.json"), *trace;
    uint32_t ours = 0;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
    {
        const cJSON *accuracy = cJSON_GetObjectItem(trace, "accuracy");
        if (strcmp(cJSON_GetObjectItem(trace, "builder")->valuestring, "lbvh") != 0)
            continue;
        ours++;
        assert_true(cJSON_GetObjectItem(accuracy, "missed")->valuedouble == 32 * 32);
        assert_true(cJSON_IsTrue(cJSON_GetObjectItem(trace, "wrong")));
    }
    assert_true(ours > 0);
    cJSON_Delete(json);
}

/* Right, but not what the other kernels say: then one of them loses boxes, and chance has hidden
 * it. */
static void unlike_answers_give_exit_status_1(void **state)
{
    (void)state;
    char command[1024];
    snprintf(command, sizeof command,
             "mkdir -p %s/odd && sed 's/bb_lanes t = bb_primitive(/bb_lanes t = (BB_WIDTH == 4 ? "
             "1.0000002f : 1.0f) * bb_primitive(/' " BB_TEST_SOURCE_DIR
             "/kernels/search.clh >%s/odd/search.clh",
             folder, folder);
    assert_int_equal(system(command), 0);
    const outcome *o =
        run("run --table --scene cube --builder lbvh --kernel stack,stack4 --rays primary "
            "--size 16x16 --repeats 1 --no-pictures --kernels-from odd --out odd");
    assert_int_equal(o->exit_status, 1);
    assert_null(strstr(o->out, "WRONG"));
    assert_non_null(strstr(o->out, "unlike"));
    o = run("check --scene cube --builder lbvh --kernels-from odd");
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->out, "is answered by primitive"));
}

/* lbvh: a code and an index each, twice. sah by sweeps: centroids, three orders, a cost, a flag,
 * the places of a split; and while it sorts a key each, which is gone when the build ends. */
static void scratch_is_in_the_peak(void **state)
{
    (void)state;
    expect(0,
           "run --scene random:n=20000 --builder lbvh,sah:method=sweep --rays none --repeats 1 "
           "--out scratch",
           "");
    cJSON *json = read_results("scratch/results.json"), *build;
    uint32_t builds = 0;
    cJSON_ArrayForEach(build, cJSON_GetObjectItem(json, "builds"))
    {
        const cJSON *tree = cJSON_GetObjectItem(build, "tree");
        if (!cJSON_IsObject(tree) || !cJSON_IsNumber(cJSON_GetObjectItem(tree, "bytes_peak")))
            continue;
        double scratch = cJSON_GetObjectItem(tree, "bytes_peak")->valuedouble -
                         cJSON_GetObjectItem(tree, "bytes_tree")->valuedouble;
        bool is_lbvh = strcmp(cJSON_GetObjectItem(build, "builder")->valuestring, "lbvh") == 0;
        builds++;
        const cJSON *seen = cJSON_GetObjectItem(build, "event_ms");
        assert_true(!is_lbvh || cJSON_GetArrayItem(seen, 0)->valuedouble > 0); /* by the device */
        print_message("%s: %g bytes beside the tree\n",
                      cJSON_GetObjectItem(build, "builder")->valuestring, scratch);
        assert_true(scratch >= 20000.0 * (is_lbvh ? 2 * 8 : 45));
    }
    assert_int_equal(builds, 2);
    cJSON_Delete(json);
}

/* More rays than go into one launch: the clock saw what the device saw of all of them. */
static void all_launches_of_a_set_are_timed(void **state)
{
    (void)state;
    run("run --scene cube --builder lbvh --kernel stack8 --rays random:count=4300000 --max-rays "
        "4300000 --repeats 1 --no-pictures --charts no --out batches");
    cJSON *json = read_results("batches/results.json");
    const cJSON *text;
    const cJSON *trace = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "traces"), 0);
    double ms = cJSON_GetObjectItem(trace, "ms_median")->valuedouble;
    double event_ms = cJSON_GetObjectItem(trace, "event_ms")->valuedouble;
    assert_true(cJSON_GetObjectItem(trace, "count")->valuedouble == 4300000);
    assert_true(ms >= 0.98 * event_ms && event_ms > 0);
    text = cJSON_GetObjectItem(cJSON_GetObjectItem(json, "context"), "clock_complaint");
    if (cJSON_IsString(text)) /* a busy machine may make it complain */
        print_message("%s\n", text->valuestring);
    cJSON_Delete(json);
}

/* To compare answers takes as long as to find those that meet nothing, and is told apart. */
static void the_time_of_comparing_is_booked(void **state)
{
    (void)state;
    run("run --quiet --scene single --builder lbvh --kernel stack,stack8 --rays primary --size "
        "1024x1024 --repeats 60 --no-pictures --charts no --out booked");
    cJSON *json = read_results("booked/results.json");
    const cJSON *context = cJSON_GetObjectItem(json, "context");
    const double rest = cJSON_GetObjectItem(context, "rest_ms")->valuedouble;
    const double judged =
        cJSON_GetObjectItem(cJSON_GetObjectItem(json, "steps_ms"), "judge answers")->valuedouble;
    print_message("%.0f ms are left of the run, %.0f ms went into answers\n", rest, judged);
    assert_true(rest < 0.5 * judged);
    cJSON_Delete(json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(answers_of_later_rounds_are_judged),
        cmocka_unit_test(unlike_answers_give_exit_status_1),
        cmocka_unit_test(scratch_is_in_the_peak),
        cmocka_unit_test(all_launches_of_a_set_are_timed),
        cmocka_unit_test(the_time_of_comparing_is_booked),
    };
    return cmocka_run_group_tests_name("run_trust", tests, make_folder, remove_folder);
}
