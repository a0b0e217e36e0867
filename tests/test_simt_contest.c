/* `volume`, `slice`, `overlap` --metrics simt: the same figures whatever the number of threads,
 * beside what was measured and never in place of it; what is no simulation. */
#include "tests/program_fixture.h"

#include <math.h>

#define SIMTS "--metrics simt,simt:device=radeon780m,width=64 --repeats 1 --quiet "

static const struct {
    const char *command, *file;
    uint32_t ways, simulated;
} runs[] = {
    {"volume --scene nbody:n=24 --builder lbvh --kernel stack,stackless,packet8 --size 48x48 "
     "--steps none ",
     "volume.json", 4, 3},
    {"volume --scene tets:side=3 --builder olbvh --search skip,octree,olbvh --size 24x24 "
     "--steps none ",
     "volume.json", 3, 3},
    {"slice --scene tets:side=3 --builder olbvh --search skip,octree,olbvh --no-tree --size 40x40 "
     "--slices 2 ",
     "slice.json", 4, 4},
    {"overlap tets:side=4 tets:side=3 --builder olbvh --search skip,octree,olbvh --no-tree ",
     "overlap.json", 4, 4},
};
enum { RUNS = sizeof runs / sizeof runs[0] };

static const cJSON *member(const cJSON *entry, const char *name)
{
    return cJSON_GetObjectItem(entry, name);
}

static double number(const cJSON *entry, const char *name)
{
    const cJSON *value = member(entry, name);
    return cJSON_IsNumber(value) ? value->valuedouble : (double)NAN;
}

static bool is_simulated(const cJSON *row)
{
    const char *maker = cJSON_GetStringValue(member(row, "maker"));
    return maker != NULL && strncmp(maker, "simt:", 5) == 0;
}

/* A simulation of a way: figures that follow from each other. */
static void expect_figures(const cJSON *row)
{
    static const char *const bounds[] = {"simt_issue_mrays_s", "simt_l1_mrays_s", "simt_l2_mrays_s",
                                         "simt_memory_mrays_s"};
    double least = (double)INFINITY;
    for (int i = 0; i < 4; i++)
        least = fmin(least, number(row, bounds[i]));
    assert_true(least > 0);
    assert_true(number(row, "simt_mrays_s") == least);
    assert_true(number(row, "simt_efficiency") > 0 && number(row, "simt_efficiency") <= 1);
    assert_non_null(member(row, "simt_binds"));
    assert_true(number(row, "simt_steps_per_ray") > 0);
    assert_true(number(row, "simt_rays") > 0);
}

/* Copies the rows of what is simulated; checks how many they are. */
static void simulated_rows(size_t run, const char *folder_name, char *text, size_t capacity)
{
    char name[64];
    snprintf(name, sizeof name, "%s/%s", folder_name, runs[run].file);
    cJSON *file = read_json(name);
    const cJSON *row;
    uint32_t simulated = 0, others = 0;
    size_t used = 0;
    cJSON_ArrayForEach(row, member(file, "rows"))
    {
        if (!is_simulated(row)) {
            assert_null(member(row, "simt_steps_per_ray")); /* in rows of their own */
            continue;
        }
        assert_null(member(row, "answer_ms"));
        if (member(row, "simt_unsimulated") == NULL) {
            expect_figures(row);
            simulated++;
        } else {
            others++;
        }
        char *line = cJSON_PrintUnformatted(row);
        used += (size_t)snprintf(text + used, capacity - used, "%s\n", line);
        assert_true(used < capacity);
        free(line);
    }
    cJSON_Delete(file);
    assert_int_equal(simulated, 2 * runs[run].simulated);
    assert_int_equal(others, 2 * (runs[run].ways - runs[run].simulated));
}

static void figures_depend_on_nothing_else(void **state)
{
    (void)state;
    static char one[1 << 16], two[1 << 16];
    char command[1024];
    for (size_t i = 0; i < RUNS; i++) {
        snprintf(command, sizeof command, "%s" SIMTS "--out one", runs[i].command);
        const outcome *o = run_with("POCL_MAX_PTHREAD_COUNT=1", command);
        assert_int_equal(o->exit_status, 0);
        assert_non_null(
            strstr(o->out, "Simulated: neither measured nor validated, simt:device=h100,width=32"));
        assert_int_equal(strstr(o->out, "are not recorded") != NULL,
                         runs[i].simulated < runs[i].ways);
        snprintf(command, sizeof command, "%s" SIMTS "--out two", runs[i].command);
        assert_int_equal(run_with("POCL_MAX_PTHREAD_COUNT=3", command)->exit_status, 0);
        simulated_rows(i, "one", one, sizeof one);
        simulated_rows(i, "two", two, sizeof two);
        assert_string_equal(one, two);
    }
}

static void exact_figures_are_compared(void **state)
{
    (void)state;
    edit_file("one/slice.json", "s/\"simt_steps_per_ray\":[0-9.]*/\"simt_steps_per_ray\":9999/",
              "worse.json");
    expect(0, "compare one/slice.json one/slice.json", "");
    expect(1, "compare one/slice.json worse.json", "simt_steps_per_ray");
}

static void nothing_is_simulated_unasked(void **state)
{
    (void)state;
    const outcome *o = run("slice --scene tets:side=2 --builder olbvh --search skip --size 8x8 "
                           "--repeats 1 --quiet --json");
    assert_int_equal(o->exit_status, 0);
    assert_null(strstr(o->out, "simt"));
}

static void what_is_no_simulation_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *metrics, *words;
    } bad[] = {{"simt:device=h10", "did you mean 'h100'"},
               {"simt:width=48", "must be one of 32|64"},
               {"simt,simt:device=h100", "is given twice"},
               {"simt:cache=1,simt:cache=2,simt:cache=4,simt:cache=0.5,simt:cache=0.25",
                "at most 4 simulations"},
               {"sah", "there is no 'sah' here"}};
    char command[1024];
    for (size_t i = 0; i < RUNS; i++)
        for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
            snprintf(command, sizeof command, "%s--metrics %s --out none", runs[i].command,
                     bad[k].metrics);
            refuses("", command, bad[k].words);
        }
    assert_int_not_equal(access("none", F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_depend_on_nothing_else),
        cmocka_unit_test(exact_figures_are_compared),
        cmocka_unit_test(nothing_is_simulated_unasked),
        cmocka_unit_test(what_is_no_simulation_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
