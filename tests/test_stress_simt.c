/* `stress --metrics simt`: simulated figures along an axis, and failures that stay as they are. */
#include "tests/simulated_rows.h"

#include <math.h>

#define STRESS "stress --limit 60 --no-pictures --quiet --quick "
#define METHODS "--builder lbvh,sah --kernel stack8,stack8i --intersector exact,fast "

static int make_axes(void **state)
{
    static const char crowd[] =
        "{\"name\": \"crowd\", \"title\": \"A crowd\", \"parameter\": \"primitives\", \"why\": "
        "\"w\", \"scene\": \"soup:n={x}\", \"rays\": [\"random\"], \"from\": 10, \"to\": 1000, "
        "\"steps\": \"whole\", \"intervals\": 2, \"builder\": \"lbvh\", \"kernel\": \"stack\"}";
    static const char moving[] =
        "{\"name\": \"moving\", \"title\": \"Moves\", \"parameter\": \"primitives\", \"why\": "
        "\"w\", \"scene\": \"twist:n={x},frames=3\", \"rays\": [\"random\"], \"from\": 300, "
        "\"to\": 600, \"steps\": \"whole\", \"intervals\": 1, \"frames\": 3, \"builder\": "
        "\"lbvh\", \"kernel\": \"stack\"}";
    if (make_folder(state) != 0)
        return -1;
    write_file("crowd.json", crowd, sizeof crowd - 1);
    write_file("moving.json", moving, sizeof moving - 1);
    return 0;
}

/* The row of a method at a value: a builder, or a kernel or an intersector (`builder` ""). */
static const cJSON *simulated(const cJSON *atlas, const char *value, const char *builder,
                              const char *other)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, rows_of(atlas))
    {
        if (strcmp(text_in(row, "maker"), H100) == 0 && strcmp(text_in(row, "frame"), value) == 0 &&
            strcmp(text_in(row, "builder"), builder) == 0 &&
            strcmp(text_in(row, "intersector"), other) == 0)
            return row;
    }
    fail_msg("no row at %s of %s%s", value, builder, other);
    return NULL;
}

static void figures_are_those_of_run(void **state)
{
    (void)state;
    expect(0, STRESS METHODS "--axis crowd.json --out s --metrics simt,simt:width=64", "");
    expect(0,
           "run --scene soup:n=1000 --builder lbvh,sah --kernel stack,stack8 --rays random "
           "--max-rays 1024 --repeats 1 --no-pictures --charts no --quiet --out ran --metrics "
           "simt,simt:width=64",
           "");
    cJSON *atlas = read_json("s/stress.json"), *ran = read_json("ran/results.json");
    has_the_same_figures(simulated(atlas, "1000", "lbvh", ""),
                         run_row(rows_of(ran), H100, "lbvh", "stack", "random"));
    has_the_same_figures(simulated(atlas, "1000", "sah", ""),
                         run_row(rows_of(ran), H100, "sah", "stack", "random"));
    has_the_same_figures(simulated(atlas, "1000", "", "stack8"),
                         run_row(rows_of(ran), H100, "lbvh", "stack8", "random"));
    has_the_same_figures(simulated(atlas, "1000", "", "exact"),
                         run_row(rows_of(ran), H100, "lbvh", "stack", "random"));
    const cJSON *row;
    uint32_t count = 0;
    cJSON_ArrayForEach(row, rows_of(atlas))
    {
        count += is_simulated(row);
        assert_true(!is_simulated(row) || strncmp(text_in(row, "maker"), "simt:", 5) == 0);
        assert_true(!is_simulated(row) ||
                    cJSON_GetObjectItemCaseSensitive(row, "trace_ms") == NULL);
    }
    assert_int_equal(count, 3 * 4 * 2); /* values; stack8i and fast are not simulated; devices */
    cJSON_Delete(ran);
    cJSON_Delete(atlas);
    expect(0, "report s/stress.json", "Simulated: neither measured nor validated, " H100);
}

/* Failures, and figures that do not depend on a clock. */
static void measured_text(const char *name, char *text, size_t capacity)
{
    cJSON *atlas = read_json(name);
    const cJSON *row, *member;
    size_t used = 0;
    cJSON_ArrayForEach(row, rows_of(atlas))
    {
        if (strncmp(text_in(row, "maker"), "simt:", 5) == 0 ||
            cJSON_GetObjectItemCaseSensitive(row, "question") == NULL)
            continue;
        cJSON_ArrayForEach(member, row)
        {
            char *value = cJSON_PrintUnformatted(member);
            if (strstr(member->string, "_ms") == NULL)
                used +=
                    (size_t)snprintf(text + used, capacity - used, "%s=%s ", member->string, value);
            free(value);
        }
        used += (size_t)snprintf(text + used, capacity - used, "\n");
        assert_true(used < capacity);
    }
    cJSON_Delete(atlas);
}

/* In the folder of the run before, whose points are others. */
static void failures_are_the_same(void **state)
{
    (void)state;
    static char one[1 << 16], two[1 << 16];
    measured_text("s/stress.json", one, sizeof one);
    assert_non_null(strstr(one, "more-tests"));
    expect(0, STRESS METHODS "--axis crowd.json --out s", "");
    measured_text("s/stress.json", two, sizeof two);
    assert_string_equal(one, two);
    cJSON *atlas = read_json("s/stress.json");
    const cJSON *row;
    cJSON_ArrayForEach(row, rows_of(atlas)) assert_false(is_simulated(row));
    cJSON_Delete(atlas);
}

static double bound_by_file(const char *gb_s)
{
    char text[512];
    snprintf(text, sizeof text,
             "{\"name\":\"x\",\"title\":\"X\",\"code\":\"sm_90\",\"units\":2,\"lanes\":32,"
             "\"clock_ghz\":1,\"issues_per_clock\":4,\"groups\":8,\"registers\":65536,"
             "\"register_step\":8,\"first_bytes\":16384,\"first_ways\":4,"
             "\"first_bytes_per_clock\":64,\"second_bytes\":1048576,\"second_ways\":16,"
             "\"second_bytes_per_clock\":64,\"memory_gb_s\":%s}",
             gb_s);
    write_file("x.json", text, strlen(text));
    expect(0, STRESS "--builder lbvh --axis crowd.json --out x --metrics simt:device=x.json", "");
    cJSON *atlas = read_json("x/stress.json");
    const cJSON *row;
    double bound = NAN;
    cJSON_ArrayForEach(row, rows_of(atlas))
    {
        if (is_simulated(row) && strcmp(text_in(row, "frame"), "1000") == 0)
            bound = number_in(row, "simt_mrays_s");
    }
    cJSON_Delete(atlas);
    return bound;
}

/* Points are kept by what the file says, not by its name. */
static void another_device_is_another_point(void **state)
{
    (void)state;
    const double fast = bound_by_file("1000"), slow = bound_by_file("0.1");
    if (!(slow > 0 && slow < fast))
        fail_msg("%g Mrays/s with 1000 GB/s, %g with 0.1", fast, slow);
    assert_true(bound_by_file("1000") == fast);
}

/* Of a scene that moves, the last frame counts, as `animate` simulates it. */
static void the_last_frame_is_simulated(void **state)
{
    (void)state;
    expect(0, STRESS "--builder lbvh,lbvh+refit --axis moving.json --out m --metrics simt", "");
    expect(0,
           "animate --scene twist:n=600,frames=3 --builder lbvh+refit --kernel stack --rays random "
           "--size 32x32 --max-rays 1024 --repeats 1 --quiet --out a --metrics simt",
           "");
    cJSON *atlas = read_json("m/stress.json"), *animated = read_json("a/animate.json");
    const cJSON *row;
    uint32_t count = 0;
    cJSON_ArrayForEach(row, rows_of(animated))
    {
        if (!is_simulated(row) || strcmp(text_in(row, "frame"), "2") != 0)
            continue;
        has_the_same_figures(simulated(atlas, "600", "lbvh+refit", ""), row);
        count++;
    }
    assert_int_equal(count, 1);
    cJSON_Delete(animated);
    cJSON_Delete(atlas);
}

static void what_cannot_be_simulated_is_refused(void **state)
{
    (void)state;
    refuses_bad_simulations("stress --axis crowd.json --out none");
    assert_int_not_equal(access("none", F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_are_those_of_run),
        cmocka_unit_test(failures_are_the_same),
        cmocka_unit_test(another_device_is_another_point),
        cmocka_unit_test(the_last_frame_is_simulated),
        cmocka_unit_test(what_cannot_be_simulated_is_refused),
    };
    return cmocka_run_group_tests(tests, make_axes, remove_folder);
}
