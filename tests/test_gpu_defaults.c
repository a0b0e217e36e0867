/* What `run` does by default where the device is no CPU: on the mock GPU (tests/mock_gpu), whose
 * times mean nothing. The whole command is run with few rays, but for those tests that are about
 * their number. */
#include "framework/device/device_private.h"
#include "tests/program_fixture.h"
#include "traversal/stack_room.h"
#include "traversal/traversal.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define MOCK "LD_PRELOAD=" BB_TEST_MOCK_GPU " MOCK_GPU_MEMORY=16384 "
#define FEW "--size 16x16 --max-rays 256 --repeats 1 --no-pictures --charts no "

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    return text != NULL ? text : "";
}

static double number_of(const cJSON *object, const char *name)
{
    return cJSON_GetNumberValue(cJSON_GetObjectItem(object, name)); /* NAN: there is none */
}

static bool is_reference(const cJSON *trace)
{
    return cJSON_IsTrue(cJSON_GetObjectItem(trace, "reference"));
}

/* The result of a run that must end well, for cJSON_Delete(). */
static cJSON *results_of(const char *before, const char *arguments, const char *name)
{
    char all[1024], path[128];
    snprintf(all, sizeof all, "run %s --out %s", arguments, name);
    const outcome *o = run_with(before, all);
    if (o->exit_status != 0)
        fail_msg("bvhbench %s: exit %d: %s", all, o->exit_status, o->err);
    snprintf(path, sizeof path, "%s/results.json", name);
    return read_results(path);
}

/* Of all traces but references those by this kernel. */
static uint32_t traces_by(const cJSON *results, const char *kernel)
{
    const cJSON *trace;
    uint32_t count = 0;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(results, "traces"))
    {
        count += !is_reference(trace) && strcmp(text_of(trace, "kernel"), kernel) == 0;
    }
    return count;
}

static void expect_word(const char *text, const char *word, bool there)
{
    if ((strstr(text, word) != NULL) != there)
        fail_msg("'%s' is %s in:\n%.2000s", word, there ? "not" : "still", text);
}

/* ---- what is compared ---- */

/* Four ways to trace on a GPU, none that is for CPUs, each right. */
static void gpus_compare_kernels_of_theirs(void **state)
{
    (void)state;
    cJSON *gpu = results_of(MOCK,
                            FEW "--scene cube,sphere-mesh:n=12 --builder lbvh,sah "
                                "--rays primary,ao,random",
                            "gpu");
    static const char *const expected[] = {"stack", "stack:persistent=yes", "short"};
    uint32_t each = traces_by(gpu, "stack"), wide = 0, ours = 0;
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
        assert_int_equal(traces_by(gpu, expected[i]), each);
    assert_true(each > 0);
    const cJSON *trace;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(gpu, "traces"))
    {
        bb_spec spec;
        const bb_kernel *kernel;
        if (is_reference(trace)) /* of which the library may lack some */
            continue;
        assert_string_equal(text_of(trace, "status"), "ok");
        ours++;
        assert_int_equal(bb_kernel_parse(text_of(trace, "kernel"), &spec, &kernel), BB_OK);
        assert_false(kernel->batched);
        wide += bb_layout_find(kernel->layout)->width == 8;
        assert_true(number_of(cJSON_GetObjectItem(trace, "accuracy"), "wrong_ppm") == 0);
        assert_true(number_of(trace, "count") <= 256);
        assert_true(number_of(trace, "warm_rounds") >= 2);
        assert_true(number_of(trace, "launches") == 1);
    }
    assert_int_equal(wide, each);
    assert_int_equal(ours, 4 * each);
    cJSON_Delete(gpu);

    cJSON *cpu = results_of("", FEW "--scene cube --builder lbvh --rays primary", "cpu");
    each = traces_by(cpu, "packet:group=256");
    assert_true(each > 0);
    assert_int_equal(traces_by(cpu, "packet8:leaf=8,group=256"), each);
    assert_int_equal(traces_by(cpu, "stack8i:leaf=8,group=256"), each);
    uint32_t all = 0;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(cpu, "traces"))
    {
        assert_true(isnan(number_of(trace, "warm_rounds")));
        all += !is_reference(trace);
    }
    assert_int_equal(all, 3 * each);
    cJSON_Delete(cpu);
}

/* What is for CPUs says what it takes. */
static void kernels_for_cpus_tell_their_memory(void **state)
{
    (void)state;
    const outcome *o = run_with(
        MOCK, "run " FEW
              "--scene cube --builder lbvh --rays random --kernel stack8i,stack,stack4,packet8 "
              "--out private");
    assert_int_equal(o->exit_status, 0);
    /* 32 rays in flight, each with 16 entries of 8 bytes */
    expect_word(o->err, "stack8i is for CPUs: the stacks of a work-item are 4096 bytes", true);
    expect_word(o->err, "stack4 is for CPUs: the stacks of a work-item are 128 bytes", true);
    /* one stack, as large as 16 */
    expect_word(o->err, "packet8 is for CPUs: the stacks of a work-item are 2048 bytes", true);
    expect_word(o->err, "stack is for CPUs", false);
    o = run("run " FEW "--scene cube --builder lbvh --rays random --kernel stack8i --out private");
    expect_word(o->err, "is for CPUs", false);
}

/* ---- labels ---- */

static void embree_is_on_the_cpu_wherever_it_is_shown(void **state)
{
    (void)state;
    static const char *const arguments = FEW "--scene cube --builder lbvh,sah --rays random";
    static char text[4 << 20];
    cJSON *results = results_of(MOCK, arguments, "labels");
    assert_string_equal(text_of(cJSON_GetObjectItem(results, "context"), "device_type"), "GPU");
    const cJSON *trace;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(results, "traces"))
    {
        assert_string_equal(text_of(trace, "traced_on"), is_reference(trace) ? "CPU" : "");
        assert_true(is_reference(trace) == isnan(number_of(trace, "warm_rounds")));
    }
    cJSON_Delete(results);
    expect(0, "report labels", " as Embree on the CPU");
    expect(0, "report labels", " trace ");
    expect(0, "report labels", " at the end, tracers, which trace trees of their own");
    expect(0, "report labels", "/ref: Embree on the CPU, by its fastest row");
    expect(0, "report labels --table", " /Embree on the CPU ");
    expect(0, "report labels --table", " mis/fal/t ");
    expect(0, "report labels --table", "/Embree on the CPU: to the fastest");
    expect(0, "report labels --markdown", "/ref: Embree on the CPU, by its fastest row");
    expect(0, "report labels --csv", "traced_on");
    expect(0, "report labels --csv", ",CPU,");
    read_file("labels/report.html", text, sizeof text);
    expect_word(text, "\"reference\":\"Embree on the CPU\"", true);
    expect_word(text, "\"traced_on\":\"CPU\"", true);
    assert_int_equal(run("report labels --charts yes --out labels.html")->exit_status, 0);

    results = results_of("", arguments, "plain");
    assert_string_equal(text_of(cJSON_GetObjectItem(results, "context"), "device_type"), "CPU");
    cJSON_Delete(results);
    expect_word(expect(0, "report plain", "/ref: Embree, by its fastest row")->out, "on the CPU",
                false);
    expect_word(expect(0, "report plain --table", "/Embree")->out, "on the CPU", false);
    expect_word(expect(0, "report plain --markdown", "/ref: Embree, by its fastest row")->out,
                "the CPU", false);
    refuses("", "compare plain labels", "cells of two devices are not compared");
    expect(0, "compare plain plain", "nothing is worse");
}

/* A machine whose processors are idle may still be busy. */
static void what_is_not_seen_is_said(void **state)
{
    (void)state;
    const outcome *o = run_with(MOCK, "run " FEW "--scene cube --builder lbvh --rays none --out x");
    expect_word(o->err, "cannot be seen: keep them off it", true);
    o = run("run " FEW "--scene cube --builder lbvh --rays none --out x");
    expect_word(o->err, "cannot be seen", false);
}

/* ---- rays and launches ---- */

/* A GPU's sets have 2^20 rays or more, however small the pictures; slow ones go in several
 * launches. */
static void sets_fill_a_gpu(void **state)
{
    (void)state;
    cJSON *results = results_of(
        MOCK,
        "--quick --scene sphere-mesh:n=200 --builder lbvh,embree-native --kernel stackless "
        "--rays primary,shadow,random --repeats 1 --no-pictures --charts no",
        "full");
    const cJSON *trace;
    uint32_t slow = 0;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(results, "traces"))
    {
        assert_string_equal(text_of(trace, "status"), "ok");
        if (number_of(trace, "count") < 1 << 20)
            fail_msg("%s: %g rays", text_of(trace, "rays"), number_of(trace, "count"));
        bool random = strcmp(text_of(trace, "rays"), "random") == 0;
        assert_true((strstr(text_of(trace, "cell"), ",least=1048576/") == NULL) == random);
        if (is_reference(trace) || number_of(trace, "ms_median") < 500)
            continue;
        slow++;
        if (number_of(trace, "launches") < 2)
            fail_msg("%s: %g ms in %g launches", text_of(trace, "rays"),
                     number_of(trace, "ms_median"), number_of(trace, "launches"));
    }
    assert_true(slow > 0);
    cJSON_Delete(results);
}

/* What is given by hand wins, and that sets are small then is said. */
static void sizes_that_are_given_win(void **state)
{
    (void)state;
    static const char words[] = "sets may have fewer than the 1048576 rays";
    const char *const common = "run --scene cube --builder lbvh --kernel stack --rays primary "
                               "--repeats 1 --no-pictures --charts no --out given ";
    char arguments[512];
    snprintf(arguments, sizeof arguments, "%s --size 24x24", common);
    expect_word(run_with(MOCK, arguments)->err, words, true);
    cJSON *results = read_results("given/results.json");
    const cJSON *traces = cJSON_GetObjectItem(results, "traces");
    assert_true(number_of(cJSON_GetArrayItem(traces, 0), "count") == 24 * 24);
    cJSON_Delete(results);
    expect_word(run(arguments)->err, words, false);
    /* least=N is for whoever asks for it, on any device */
    snprintf(
        arguments, sizeof arguments,
        "run --scene cube --builder lbvh --kernel stack --rays primary:least=1000 --size 24x24 "
        "--repeats 1 --no-pictures --charts no --out given");
    assert_int_equal(run(arguments)->exit_status, 0);
    results = read_results("given/results.json");
    assert_true(number_of(cJSON_GetArrayItem(cJSON_GetObjectItem(results, "traces"), 0), "count") ==
                2 * 24 * 24);
    cJSON_Delete(results);
}

/* ---- stacks ---- */

/* All that is in flight has room in a quarter of the memory; the least is always granted. */
static void stacks_have_room(void **state)
{
    (void)state;
    bb_device device = {.is_cpu = false, .compute_units = 80, .global_bytes = 16ull << 30};
    assert_int_equal(bb_stack_room(&device, 1), 2048); /* 26 KB for each of 163,840 */
    assert_int_equal(bb_stack_room(&device, 32), 64);
    for (uint64_t bytes = 1 << 20; bytes < 1ull << 40; bytes *= 3)
        for (uint32_t stacks = 1; stacks <= 64; stacks *= 4) {
            device.global_bytes = bytes;
            const uint32_t room = bb_stack_room(&device, stacks);
            const double taken = 8.0 * room * stacks * 80 * 2048;
            assert_true(room == BB_STACK_LEAST || taken <= (double)bytes / 4);
            assert_true(2 * taken > (double)bytes / 4);
        }
    device.is_cpu = true;
    assert_int_equal(bb_stack_room(&device, 32), UINT32_MAX);
}

static void stacks_are_cut_to_the_device(void **state)
{
    (void)state;
    static const char small[] = "LD_PRELOAD=" BB_TEST_MOCK_GPU " MOCK_GPU_MEMORY=64 ";
    const outcome *o =
        run_with(small, "run " FEW "--scene sphere-mesh:n=64 --builder lbvh --rays random "
                        "--kernel stack,stack:stack=64,stack:stack=16,short --out cut");
    expect_word(o->err, "stack has a stack of 16 entries: the tree needs ", true);
    expect_word(o->err, "the kernel short takes any tree", true);
    char path[600];
    bb_results *results;
    uint32_t cut = 0, refused = 0;
    snprintf(path, sizeof path, "%s/cut/results.json", folder);
    assert_int_equal(bb_results_read(path, &results), BB_OK);
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        const char *kernel = bb_get_text(trace, BB_F_TRACE_KERNEL);
        const char *by = bb_get_named_text(trace, BB_F_DECIDED_BY, "stack entries");
        if (strcmp(kernel, "stack") == 0) {
            cut++;
            assert_string_equal(by, "device");
            assert_true(bb_get_decided(trace, "stack entries") == 16);
        } else if (strcmp(kernel, "stack:stack=64") == 0) {
            refused++;
            assert_string_equal(bb_get_text(trace, BB_F_TRACE_STATUS), "refused");
            expect_word(bb_get_text(trace, BB_F_TRACE_REASON),
                        "at most stack=16, or take the kernel short", true);
        } else if (strcmp(kernel, "stack:stack=16") == 0) {
            assert_string_equal(by, "given");
        } else if (strcmp(kernel, "short") == 0) {
            assert_true(bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM) == 0);
        }
    }
    assert_true(cut == 1 && refused == 1);
    bb_results_destroy(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gpus_compare_kernels_of_theirs),
        cmocka_unit_test(kernels_for_cpus_tell_their_memory),
        cmocka_unit_test(embree_is_on_the_cpu_wherever_it_is_shown),
        cmocka_unit_test(what_is_not_seen_is_said),
        cmocka_unit_test(sets_fill_a_gpu),
        cmocka_unit_test(sizes_that_are_given_win),
        cmocka_unit_test(stacks_have_room),
        cmocka_unit_test(stacks_are_cut_to_the_device),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
