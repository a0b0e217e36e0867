/* Drivers that lie, or fail midway, as the mock GPU plays them: one line, and what was measured is
 * kept. */
#include "tests/mock_fixture.h"
#include "tests/table_fixture.h"

#define STRESS "stress --quick --axis sorted --builder lbvh --quiet --out stressed"
#define ANIMATE                                                                                    \
    "animate --scene twist:n=300,frames=3 --size 16x16 --max-rays 256 --repeats 1 --quiet"
#define RUN                                                                                        \
    "run --scene sphere-mesh:n=12 --builder lbvh --builder hlbvh --kernel stack --rays primary "   \
    "--size 16x16 --repeats 1 --no-pictures --charts no --quiet --out out"

static void limits_of_nothing(void **state)
{
    (void)state;
    refuses(MOCK("MOCK_GPU_GROUP=0"), RUN, "Mock GPU gives 0 as CL_DEVICE_MAX_WORK_GROUP_SIZE");
    refuses(MOCK("MOCK_GPU_LOCAL=0"), RUN, "Mock GPU gives 0 as CL_DEVICE_LOCAL_MEM_SIZE");
    refuses(MOCK("MOCK_GPU_LARGEST=0"), RUN, "Mock GPU gives 0 as CL_DEVICE_MAX_MEM_ALLOC_SIZE");
    refuses(MOCK("MOCK_GPU_MEMORY=0"), RUN, "Mock GPU gives 0 as CL_DEVICE_GLOBAL_MEM_SIZE");
    refuses(MOCK("MOCK_GPU_UNITS=0"), RUN, "Mock GPU gives 0 as CL_DEVICE_MAX_COMPUTE_UNITS");
    assert_int_not_equal(run_with(MOCK("MOCK_GPU_KERNEL_GROUP=trace:0"), RUN)->exit_status, 2);
    assert_int_equal(counted("launches trace"), 0);
    const outcome *o = run_with("", "report --table out");
    assert_non_null(strstr(o->out, "kernel trace needs groups of 64 work-items, and Mock GPU runs "
                                   "it in groups of up to 0"));
}

static void small_buffers(void **state)
{
    (void)state;
    refuses(MOCK("MOCK_GPU_LARGEST=1"), RUN " --rays random --max-rays 1M",
            ", the largest that Mock GPU allows is 1048576");
    assert_int_equal(counted("refused"), 0); /* our own account knows */
}

static void builds_that_fail_without_a_word(void **state)
{
    (void)state;
    static const char words[] =
        "CL_BUILD_PROGRAM_FAILURE: the driver does not say why (its build log is empty)";
    refuses(MOCK("MOCK_GPU_SILENT_BUILD=scan_gpu.cl"), RUN, words);
    assert_int_equal(run_with(MOCK("MOCK_GPU_SILENT_BUILD=hlbvh.cl"), RUN)->exit_status, 1);
    cJSON *results = read_results("out/results.json");
    const cJSON *build;
    uint32_t failed = 0, built = 0;
    cJSON_ArrayForEach(build, cJSON_GetObjectItem(results, "builds"))
    {
        const char *reason = cJSON_GetStringValue(cJSON_GetObjectItem(build, "reason"));
        failed += reason != NULL && strstr(reason, words) != NULL;
        built += reason == NULL;
    }
    cJSON_Delete(results);
    assert_int_equal(failed, 1);
    assert_true(built >= 1);
}

/* One launch that is refused is one row's affair. */
static void one_launch_too_many(void **state)
{
    (void)state;
    const outcome *o = run_with(MOCK("MOCK_GPU_FAIL=trace:3:resources"), RUN);
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->err, "1 cells or builds are wrong: see the rows marked WRONG"));
    o = run_with("", "report --table out");
    assert_non_null(strstr(o->out, "CL_OUT_OF_RESOURCES (the kernel needs more registers or "));
    refuses(MOCK("MOCK_GPU_FAIL=trace:1:resources"), "render --scene cube --out x.png",
            "CL_OUT_OF_RESOURCES (the kernel needs");
}

static bool is_marked(const char *path)
{
    cJSON *results = read_results(path);
    const cJSON *context = cJSON_GetObjectItem(results, "context");
    const bool marked = cJSON_IsTrue(cJSON_GetObjectItem(context, "interrupted"));
    cJSON_Delete(results);
    return marked;
}

/* A device that is lost ends the command; the rows that there are can be read, and reported. */
static void lost_devices(void **state)
{
    (void)state;
    static const char *const manners[] = {"late", "lost"};
    static const char *const codes[] = {"(CL_OUT_OF_RESOURCES)", "(CL_DEVICE_NOT_AVAILABLE)"};
    char mock[1024], words[160];
    for (int i = 0; i < 2; i++) {
        assert_int_equal(run_program("", "rm", "-rf out stressed")->exit_status, 0);
        snprintf(mock, sizeof mock, MOCK("MOCK_GPU_FAIL=trace:5:%s"), manners[i]);
        snprintf(words, sizeof words, "Mock GPU does not answer any more %s: see ", codes[i]);
        refuses(mock, RUN, words);
        const outcome *o = run_with(mock, RUN);
        assert_non_null(strstr(o->err, " (earlier measurements are in out/results.json)\n"));
        cJSON *results = read_results("out/results.json");
        assert_true(cJSON_GetArraySize(cJSON_GetObjectItem(results, "builds")) >= 2);
        assert_true(cJSON_GetArraySize(cJSON_GetObjectItem(results, "traces")) >= 2);
        cJSON_Delete(results);
        assert_int_equal(run_with("", "report out")->exit_status, 0);
        assert_true(is_marked("out/results.json")); /* as what an interrupt left */
        snprintf(mock, sizeof mock, MOCK("MOCK_GPU_FAIL=link_chunks:1:%s"), manners[i]);
        /* it says nothing of the methods, and nothing of it is taken over */
        refuses(mock, STRESS, words);
        assert_int_equal(run_with(MOCK(""), STRESS)->exit_status, 0);
        o = run_with(mock, "check --builder lbvh --builder hlbvh --scene cube --quiet");
        assert_int_equal(o->exit_status, 2);
        assert_non_null(strstr(o->err, words));
        snprintf(mock, sizeof mock, MOCK("MOCK_GPU_FAIL=trace:5:%s"), manners[i]);
        refuses(mock, ANIMATE, words);
        snprintf(mock, sizeof mock, MOCK("MOCK_GPU_FAIL=trace:40:%s"), manners[i]);
        refuses(mock, ANIMATE " --out lost", words);
        o = run_with(mock, ANIMATE " --out lost");
        assert_non_null(strstr(o->err, " (what was measured is in lost/animate.json)\n"));
        bb_table *table = read_table("lost/animate.json");
        const bb_cell frame = {{[BB_SCENE] = "twist:n=300,frames=3",
                                [BB_FRAME] = "0",
                                [BB_BUILDER] = "lbvh",
                                [BB_INTERSECTOR] = "stack"}};
        assert_string_equal(bb_table_get_text(table, 0, "interrupted"), "yes");
        assert_true(number(table, frame, "wrong") == 0);
        bb_table_free(table);
        assert_int_equal(run_with("", "report lost/animate.json")->exit_status, 0);
    }
}

/* A device that is lost in the second scene leaves the first one's figures, marked as what an
 * interrupt left. */
static void lost_in_a_later_scene(void **state)
{
    (void)state;
    static const char *const commands[] = {"slice", "volume"};
    char arguments[256], file[32];
    for (int i = 0; i < 2; i++) {
        snprintf(file, sizeof file, "later/%s.json", commands[i]);
        snprintf(arguments, sizeof arguments,
                 "%s --scene tets:side=3 --scene tets:side=2 --builder lbvh --search skip "
                 "--size 8x8 --repeats 1 --json --quiet --out later",
                 commands[i]);
        assert_int_equal(run_with(MOCK(""), arguments)->exit_status, 0);
        bb_table *table = read_table(file);
        assert_string_equal(bb_table_get_text(table, 0, "interrupted"), "");
        bb_table_free(table);
        const outcome *o = run_with(MOCK("MOCK_GPU_FAIL=skip_nodes:4:late"), arguments);
        assert_int_equal(o->exit_status, 2);
        assert_non_null(strstr(o->err, " (what was measured is in later/"));
        table = read_table(file);
        assert_string_equal(bb_table_get_text(table, 0, "interrupted"), "yes");
        assert_true(bb_table_row_count(table) > 2);
        bb_table_free(table);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(limits_of_nothing),
        cmocka_unit_test(small_buffers),
        cmocka_unit_test(builds_that_fail_without_a_word),
        cmocka_unit_test(one_launch_too_many),
        cmocka_unit_test(lost_devices),
        cmocka_unit_test(lost_in_a_later_scene),
    };
    return cmocka_run_group_tests_name("mock_drivers", tests, make_folder, remove_folder);
}
