/* `advise --metrics simt`: the least by simulation, beside an advice that stays as it is. */
#include "tests/simulated_rows.h"

#include <math.h>

#define SCENE "--scene interior:n=3000 --size 64x64 --max-rays 4096 --quick "
#define ADVISE                                                                                     \
    "advise " SCENE "--quiet --count 1000 --builder lbvh,sah,hploc --kernel "                      \
    "stack,stackless,stack8i,stack8q:leaf=8 "

/* "stack, exact" becomes "stack". */
static void kernel_of(const cJSON *row, char *kernel, size_t capacity)
{
    snprintf(kernel, capacity, "%s", text_in(row, "intersector"));
    char *end = strstr(kernel, ", exact");
    assert_non_null(end);
    *end = '\0';
}

/* All pairs, by all simulations. */
static void bounds_are_those_of_run(void **state)
{
    (void)state;
    const cJSON *row;
    uint32_t count = 0;
    char kernel[256];
    cJSON *json = json_of("", ADVISE "--rays primary --exhaustive --json --metrics "
                                     "simt,simt:device=radeon780m,width=64,cache=0.5");
    expect(0,
           "run " SCENE "--quiet --builder lbvh,sah,hploc --kernel stack,stackless,stack8q:leaf=8 "
           "--rays primary --repeats 1 --no-pictures --charts no --out ran "
           "--metrics simt,simt:device=radeon780m,width=64,cache=0.5",
           "");
    cJSON *ran = read_json("ran/results.json");
    cJSON_ArrayForEach(row, rows_of(json))
    {
        if (strcmp(text_in(row, "question"), "race, simulated") != 0)
            continue;
        kernel_of(row, kernel, sizeof kernel);
        has_the_same_figures(row, run_row(rows_of(ran), text_in(row, "maker"),
                                          text_in(row, "builder"), kernel, "primary"));
        assert_true(fabs(number_in(row, "simt_image_ms") * number_in(row, "simt_mrays_s") - 1) <
                    1e-12); /* of 1000 rays */
        count++;
    }
    assert_int_equal(count, 3 * 3 * 2);
    cJSON_Delete(ran);
    cJSON_Delete(json);
}

/* The order of members does not matter: it follows from the first row with each, and clocks decide
 * what measured rows have. Bytes of builds may differ: builders take more scratch for more threads.
 */
static void has_the_same_members(const cJSON *row, const cJSON *other)
{
    const cJSON *member;
    assert_int_equal(cJSON_GetArraySize(row), cJSON_GetArraySize(other));
    cJSON_ArrayForEach(member, row)
    {
        const cJSON *same = cJSON_GetObjectItemCaseSensitive(other, member->string);
        assert_non_null(same);
        if (strcmp(member->string, "bytes") == 0 || strcmp(member->string, "bytes_build") == 0)
            continue;
        char *value = cJSON_PrintUnformatted(member), *expected = cJSON_PrintUnformatted(same);
        assert_string_equal(value, expected);
        free(value);
        free(expected);
    }
}

static const cJSON *simulated_from(const cJSON *row)
{
    while (row != NULL && strncmp(text_in(row, "maker"), "simt:", 5) != 0)
        row = row->next;
    return row;
}

static void has_the_same_simulations(const cJSON *json, const cJSON *other)
{
    const cJSON *row = simulated_from(rows_of(json)->child);
    const cJSON *same = simulated_from(rows_of(other)->child);
    assert_non_null(row);
    for (; row != NULL && same != NULL;
         row = simulated_from(row->next), same = simulated_from(same->next))
        has_the_same_members(row, same);
    assert_true(row == same); /* both ended */
}

static const cJSON *chosen_of(const cJSON *json, const char *maker)
{
    const cJSON *row, *found = NULL;
    cJSON_ArrayForEach(row, rows_of(json))
    {
        if (strcmp(text_in(row, "question"), "race, simulated") != 0 ||
            strcmp(text_in(row, "maker"), maker) != 0 ||
            strcmp(text_in(row, "state"), "chosen") != 0)
            continue;
        assert_null(found);
        found = row;
    }
    assert_non_null(found);
    return found;
}

/* The least of those within the slack, by memory first; none of the others is faster by more. */
static void the_least_is_chosen(const cJSON *json)
{
    const cJSON *row, *chosen = chosen_of(json, H100);
    uint32_t slower = 0;
    bool has_fastest = false;
    assert_true(number_in(chosen, "simt_ratio") <= 1.05);
    cJSON_ArrayForEach(row, rows_of(json))
    {
        if (strcmp(text_in(row, "question"), "race, simulated") != 0)
            continue;
        const double ratio = number_in(row, "simt_ratio");
        assert_true(ratio >= 1);
        has_fastest = has_fastest || ratio == 1;
        slower += ratio > 1.05;
        if (ratio <= 1.05)
            assert_true(number_in(chosen, "bytes") <= 1.02 * number_in(row, "bytes"));
        else
            assert_string_equal(text_in(row, "state"), "slower");
    }
    assert_true(has_fastest && slower > 0);
}

static void the_least_depends_on_nothing_else(void **state)
{
    (void)state;
    static const char arguments[] = ADVISE "--rays primary,ao --json --metrics simt";
    cJSON *json = json_of("POCL_MAX_PTHREAD_COUNT=1", arguments);
    cJSON *other = json_of("POCL_MAX_PTHREAD_COUNT=3", arguments);
    const cJSON *row;
    uint32_t scouts = 0;
    the_least_is_chosen(json);
    cJSON_ArrayForEach(row, rows_of(json))
    {
        scouts += strcmp(text_in(row, "question"), "kernels, simulated") == 0 ||
                  strcmp(text_in(row, "question"), "builders, simulated") == 0;
        if (!is_simulated(row))
            continue;
        /* 1000 rays of two kinds: what is summed up, and what cannot be */
        assert_null(cJSON_GetObjectItemCaseSensitive(row, "simt_l1_hits"));
        assert_true(fabs(number_in(row, "simt_image_ms") * number_in(row, "simt_mrays_s") - 1) <
                    1e-12);
    }
    assert_int_equal(scouts, 3 + 3);
    has_the_same_simulations(json, other);
    cJSON_Delete(other);
    cJSON_Delete(json);
}

/* What is measured, without times and what depends on them; the forecast in seconds. */
static double measured_text(const cJSON *json, char *text, size_t capacity)
{
    const cJSON *row, *member;
    double foretold = NAN;
    size_t used = 0;
    cJSON_ArrayForEach(row, rows_of(json))
    {
        if (cJSON_GetObjectItemCaseSensitive(row, "scene") == NULL)
            continue;
        if (strcmp(text_in(row, "question"), "foretold") == 0)
            foretold = number_in(row, "seconds");
        if (strncmp(text_in(row, "maker"), "simt:", 5) == 0 ||
            strcmp(text_in(row, "question"), "foretold") == 0 ||
            strcmp(text_in(row, "question"), "taken") == 0)
            continue;
        cJSON_ArrayForEach(member, row)
        {
            const bool timed = strstr(member->string, "_ms") != NULL ||
                               strcmp(member->string, "ms_more") == 0 ||
                               strcmp(member->string, "ratio") == 0;
            assert_true(strncmp(member->string, "simt_", 5) != 0);
            if (timed)
                continue;
            char *value = cJSON_PrintUnformatted(member);
            used += (size_t)snprintf(text + used, capacity - used, "%s=%s ", member->string, value);
            free(value);
        }
        used += (size_t)snprintf(text + used, capacity - used, "\n");
        assert_true(used < capacity);
    }
    return foretold;
}

/* One configuration, so that no clock decides; the simulated ones are two. */
static void what_is_measured_stays_as_it_is(void **state)
{
    (void)state;
    static char one[1 << 17], two[1 << 17];
#define ONE                                                                                        \
    "advise " SCENE "--quiet --count 1000 --builder lbvh --kernel stack --rays primary --json "
    cJSON *json = json_of("", ONE);
    const double without = measured_text(json, one, sizeof one);
    cJSON_Delete(json);
    json = json_of("", ONE "--metrics simt,simt:cache=2,simt:width=64,simt:device=rtx4090");
    const double with = measured_text(json, two, sizeof two);
    assert_string_equal(one, two);
    assert_true(with > without);
    const cJSON *row;
    cJSON_ArrayForEach(row, rows_of(json))
    {
        if (!is_simulated(row))
            continue;
        assert_string_equal(text_in(row, "builder"), "lbvh");
        assert_null(cJSON_GetObjectItemCaseSensitive(row, "image_ms"));
        assert_null(cJSON_GetObjectItemCaseSensitive(row, "trace_ms"));
        assert_null(cJSON_GetObjectItemCaseSensitive(row, "ratio"));
    }
    cJSON_Delete(json);
#undef ONE
}

/* By default the simulated kernels are those for GPUs, whatever is measured. */
static void it_is_said_to_be_simulated(void **state)
{
    (void)state;
    const outcome *o = expect(0,
                              "advise --scene soup:n=300 --rays random --max-rays 1024 --quick "
                              "--quiet --builder lbvh --metrics simt --out said --charts no",
                              "Simulated: neither measured nor validated, " H100 ": the least is");
    assert_non_null(
        strstr(o->out, "The least by simulation, neither measured nor validated, " H100));
    assert_non_null(strstr(o->out, "cwbvh"));
    const char *again = strstr(o->out, "Simulated again by, " H100);
    assert_non_null(again);
    assert_non_null(strstr(again, " --metrics simt\n"));
    cJSON *json = read_json("said/advise.json");
    chosen_of(json, H100);
    cJSON_Delete(json);
    expect(0, "report said/advise.json", "The least by simulation");
}

static void what_cannot_be_simulated_is_refused(void **state)
{
    (void)state;
    refuses_bad_simulations("advise --scene cube");
    refuses("", "advise --scene cube --kernel packet8 --metrics simt",
            "bounds for none of the kernels, of which 'packet8' is");
    refuses("", "advise --scene cube --intersector fast --max-wrong-ppm 9 --metrics simt",
            "only `exact` is simulated, not 'fast'");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_are_those_of_run),
        cmocka_unit_test(the_least_depends_on_nothing_else),
        cmocka_unit_test(what_is_measured_stays_as_it_is),
        cmocka_unit_test(it_is_said_to_be_simulated),
        cmocka_unit_test(what_cannot_be_simulated_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
