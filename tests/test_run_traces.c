/* What a run takes of its traces: answers that they gave, not those of others before, and work
 * counted of rays all over the set. */
#include "tests/program_fixture.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <string.h>

static const cJSON *trace_by(const cJSON *json, const char *kernel)
{
    const cJSON *trace;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
    {
        if (strcmp(cJSON_GetStringValue(cJSON_GetObjectItem(trace, "kernel")), kernel) == 0)
            return trace;
    }
    fail_msg("no trace by %s", kernel);
    return NULL;
}

/* A kernel that writes nothing, after others that were right: their answers are not its own. */
static void answers_of_others_do_not_count(void **state)
{
    (void)state;
    static const char *const others[] = {"stack", "stack4", "stack8", "stack8i", "trail"};
    const outcome *o = run_with(
        "mkdir -p silent && sed 's/    return true;/    return false;/' " BB_TEST_SOURCE_DIR
        "/kernels/stackless.cl >silent/stackless.cl &&",
        "run --kernels-from silent --scene cube --builder lbvh --kernel "
        "stack,stack4,stack8,stack8i,trail,stackless --rays primary --size 32x32 --repeats 2 "
        "--seed 1 --no-pictures --charts no --out silent");
    if (o->exit_status != 1)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = read_results("silent/results.json");
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(
                        cJSON_GetObjectItem(trace_by(json, others[i]), "accuracy"), "wrong_ppm")) ==
                    0);
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(
                    cJSON_GetObjectItem(trace_by(json, "stackless"), "accuracy"), "wrong_ppm")) ==
                1e6);
    cJSON_Delete(json);
}

/* The boxes that a ray of a picture meets, on the average: those of the first rows meet other ones.
 * Of the small picture all rays are counted, of the large one some. */
static void work_is_counted_all_over_the_set(void **state)
{
    (void)state;
    double boxes[2];
    for (int large = 0; large < 2; large++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments,
                 "run --scene terrain:n=5000 --builder lbvh --kernel stack --rays primary "
                 "--size %s --repeats 1 --no-pictures --charts no --out work%d",
                 large ? "512x512" : "128x128", large);
        expect(0, arguments, "Right answers");
        cJSON *json = read_results(large ? "work1/results.json" : "work0/results.json");
        boxes[large] = cJSON_GetNumberValue(
            cJSON_GetObjectItem(trace_by(json, "stack"), "node_tests_per_ray"));
        cJSON_Delete(json);
    }
    if (!(fabs(boxes[1] / boxes[0] - 1) < 0.05))
        fail_msg("%g boxes of a ray, and %g where some are counted", boxes[0], boxes[1]);
}

static double median_of(const cJSON *trace, const char *name)
{
    return cJSON_GetNumberValue(cJSON_GetObjectItem(trace, name));
}

/* Sorting is part of each round's time, even where it takes much longer than the trace, and is told
 * apart; kernels that do not sort have no such time. */
static void the_sort_is_inside_the_clock(void **state)
{
    (void)state;
    const outcome *o = run_with(
        "mkdir -p slow && sed 's/    ids.id. = id;/& for (volatile uint i = 0; i < 3000u; i++) "
        ";/' " BB_TEST_SOURCE_DIR "/kernels/ray_order.cl >slow/ray_order.cl &&",
        "run --kernels-from slow --scene interior:n=2000 --builder lbvh "
        "--kernel stack,stack:sort=yes --rays random --max-rays 20000 --repeats 3 --no-pictures "
        "--charts no --out sorted");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = read_results("sorted/results.json");
    const cJSON *sorted = trace_by(json, "stack:sort=yes");
    const double ms = median_of(sorted, "ms_median"), sort_ms = median_of(sorted, "sort_ms");
    if (!(sort_ms > 10 && sort_ms < ms))
        fail_msg("%g ms with a sort of %g ms", ms, sort_ms);
    assert_true(isnan(median_of(trace_by(json, "stack"), "sort_ms")));
    cJSON_Delete(json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(answers_of_others_do_not_count),
        cmocka_unit_test(work_is_counted_all_over_the_set),
        cmocka_unit_test(the_sort_is_inside_the_clock),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
