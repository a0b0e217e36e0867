/* `run --metrics simt`: the same figures whatever the number of threads, in the results, in the
 * summary and in `compare`; devices on paper that are no devices. */
#include "tests/program_fixture.h"

#include <math.h>

#define RUN                                                                                        \
    "run --scene interior:n=3000 --builder lbvh,hploc,embree-native --kernel stack,stackless,"     \
    "packet8,stack8i --rays primary,ao --size 64x64 --max-rays 4096 --repeats 1 --no-pictures "    \
    "--charts "                                                                                    \
    "no "

static const cJSON *traces_of(const cJSON *results)
{
    return cJSON_GetObjectItem(results, "traces");
}

static const char *text_of(const cJSON *entry, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(entry, name));
    return text != NULL ? text : "";
}

/* Copies what is simulated: the rows of the file that have a simulation's name. */
static size_t simulated_rows(const char *name, char *text, size_t capacity)
{
    cJSON *file = read_json(name);
    const cJSON *row;
    size_t used = 0, count = 0;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(file, "rows"))
    {
        if (strncmp(text_of(row, "maker"), "simt:", 5) != 0)
            continue;
        char *line = cJSON_PrintUnformatted(row);
        used += (size_t)snprintf(text + used, capacity - used, "%s\n", line);
        assert_true(used < capacity);
        free(line);
        count++;
    }
    cJSON_Delete(file);
    return count;
}

static void figures_depend_on_nothing_else(void **state)
{
    (void)state;
    static char one[1 << 18], two[1 << 18];
    static const char *const metrics = "--metrics simt,simt:device=radeon780m,width=64 ";
    char command[1024];
    snprintf(command, sizeof command, RUN "%s --out one", metrics);
    const outcome *o = run_with("POCL_MAX_PTHREAD_COUNT=1", command);
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->err, "not simulated: bounds of kernel packet8: kernels/isa.tsv"));
    assert_non_null(strstr(o->err, "not simulated: the steps of kernel stack8i are not recorded"));
    snprintf(command, sizeof command, RUN "%s --quiet --out two", metrics);
    assert_int_equal(run_with("POCL_MAX_PTHREAD_COUNT=3", command)->exit_status, 0);
    /* two builders, two kernels, two ray sets at least (a view or more), two devices */
    const size_t count = simulated_rows("one/results.json", one, sizeof one);
    assert_true(count >= 2 * 2 * 2 * 2);
    assert_int_equal(simulated_rows("two/results.json", two, sizeof two), count);
    assert_string_equal(one, two);

    cJSON *results = read_results("one/results.json");
    const cJSON *trace;
    cJSON_ArrayForEach(trace, traces_of(results))
    {
        const cJSON *bounds = cJSON_GetObjectItem(trace, "simt_mrays_s");
        const cJSON *shares = cJSON_GetObjectItem(trace, "simt_node_efficiency");
        const char *kernel = text_of(trace, "kernel");
        const bool packet = strcmp(kernel, "packet8") == 0;
        const bool single = strncmp(kernel, "stack", 5) == 0 && strcmp(kernel, "stack8i") != 0;
        assert_int_equal(cJSON_GetArraySize(bounds), single ? 2 : 0);
        assert_int_equal(cJSON_GetArraySize(shares), single || packet ? 2 : 0);
    }
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(results, "builds"))
    {
        const cJSON *bounds = cJSON_GetObjectItem(trace, "simt_build_ms");
        const bool ours = strstr(text_of(trace, "builder"), "embree") == NULL;
        assert_int_equal(cJSON_GetArraySize(bounds), ours ? 2 : 0);
    }
    cJSON_Delete(results);

    /* said to be simulated, and never ranked */
    o = expect(0, "report one", "Simulated: neither measured nor validated, device=h100,width=32:");
    assert_non_null(
        strstr(o->out, "Simulated: neither measured nor validated, device=radeon780m,width=64:"));
}

#define MORE_STEPS "s/\"simt_steps_per_ray\":[0-9.]*/\"simt_steps_per_ray\":9999/"

static void exact_figures_are_compared(void **state)
{
    (void)state;
    static const struct {
        const char *script, *words;
        int exit_status;
    } edits[] = {
        {"", "", 0},
        {MORE_STEPS, "simt_steps_per_ray", 1},
        {"s/\"simt_build_launches\":[0-9.]*/\"simt_build_launches\":9999/", "simt_build_launches",
         1},
        /* a share, or figures of another sample, are neither better nor worse */
        {"s/\"simt_l1_hits\":[0-9.]*/\"simt_l1_hits\":0.01/", "simt_l1_hits", 0},
        {MORE_STEPS "; s/\"simt_rays\":[0-9]*/\"simt_rays\":64/", "simt_steps_per_ray", 0},
    };
    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        edit_file("one/results.json", edits[i].script, "edited.json");
        expect(edits[i].exit_status, "compare one edited.json", edits[i].words);
    }
}

/* The device of the file `name`, as results call it. */
static bb_simt device_of(const char *name)
{
    char text[1024];
    char *const metrics[] = {text};
    bb_simt simts[BB_SIMT_MAX];
    uint32_t count;
    snprintf(text, sizeof text, "simt:device=%s/%s", folder, name);
    assert_int_equal(bb_simts_parse(metrics, 1, simts, &count), BB_OK);
    return simts[0];
}

/* Two files may have one name. */
static void is_known_by_its_figures(const char *good)
{
    char text[1024];
    snprintf(text, sizeof text, "%s", good);
    write_file("same.json", text, strlen(text));
    memcpy(strstr(text, "\"units\":2"), "\"units\":3", 9);
    write_file("other.json", text, strlen(text));
    assert_string_equal(device_of("good.json").name, device_of("same.json").name);
    assert_string_not_equal(device_of("good.json").name, device_of("other.json").name);
}

static void what_is_no_device_is_refused(void **state)
{
    (void)state;
    static const char good[] =
        "{\"name\":\"x\",\"title\":\"X\",\"code\":\"sm_90\",\"units\":2,\"lanes\":32,"
        "\"clock_ghz\":1,\"issues_per_clock\":1,\"groups\":8,\"registers\":65536,"
        "\"register_step\":8,\"first_bytes\":16384,\"first_ways\":4,\"first_bytes_per_clock\":64,"
        "\"second_bytes\":1048576,\"second_ways\":16,\"second_bytes_per_clock\":64,"
        "\"memory_gb_s\":10}";
    static const struct {
        const char *from, *to, *words;
    } bad[] = {
        {"\"units\":2,", "", "'units' must be a whole number"},
        {"\"units\":2", "\"units\":0", "'units' must be"},
        {"\"units\":2", "\"units\":2.5", "'units' must be a whole number"},
        {"\"units\":2", "\"units\":\"2\"", "'units' must be"},
        {"\"lanes\":32", "\"lanes\":128", "'lanes' must be"},
        {"\"clock_ghz\":1", "\"clock_ghz\":-1", "'clock_ghz' must be a number"},
        {"\"memory_gb_s\":10", "\"memory_gb_s\":1e99", "'memory_gb_s' must be"},
        {"\"sm_90\"", "\"sm_20\"", "must be sm_90, gfx1030 or gfx90a"},
        {"\"name\":\"x\"", "\"name\":\"\"", "'name' must be a text"},
        {"\"title\":\"X\"", "\"title\":\"\\u001b[2J\"", "without control characters"},
        {"{\"name\"", "[\"name\"", "is no JSON object"},
        {"\"memory_gb_s\":10}", "\"memory_gb_s\":10} and more", "is no JSON object"},
        {"\"name\":\"x\"", "\"name\":\"x,width=64\"", "'name' may have lower-case letters"},
        {"\"name\":\"x\"", "\"name\":\"h100\"", "a device that there is already"},
        {"\"units\":2", "\"units\":4096", "'units' must be"},
        {"\"units\":2", "\"units\":2,\"units\":3", "member 'units' is there twice"},
    };
    char text[1024];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        const char *at = strstr(good, bad[i].from);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, bad[i].to,
                 at + strlen(bad[i].from));
        write_file("bad.json", text, strlen(text));
        refuses("", RUN "--metrics simt:device=bad.json --out none", bad[i].words);
    }
    refuses("", RUN "--metrics simt:device=h10 --out none", "did you mean 'h100'");
    refuses("", RUN "--metrics simt:device=nowhere.json --out none", "nowhere.json");
    refuses("", RUN "--metrics simt:width=48 --out none", "must be one of 32|64");
    refuses("", RUN "--metrics simt:units=4 --out none", "units");
    refuses("", RUN "--metrics simt,simt:device=h100 --out none", "is given twice");
    assert_int_not_equal(access("none", F_OK), 0);
    write_file("bad.json", good, sizeof good);
    refuses("", RUN "--metrics simt:device=bad.json --out none", "has a byte of value 0");
    write_file("good.json", good, sizeof good - 1);
    expect(0,
           "run --scene soup:n=200 --builder lbvh --kernel stack --rays random --max-rays 500 "
           "--repeats 1 --no-pictures --charts no --metrics simt:device=good.json --out good",
           "Simulated: neither measured nor validated, device=x-");
    is_known_by_its_figures(good);
}

/* Only of `exact` is the code known. */
static void other_intersectors_are_left_out(void **state)
{
    (void)state;
    const outcome *o = run(
        "run --scene soup:n=200 --builder lbvh --kernel stack --intersector exact,fast --rays "
        "random --max-rays 500 --repeats 1 --no-pictures --charts no --metrics simt --out both");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->err, "not simulated: kernels/isa.tsv has the code of `exact` alone"));
    cJSON *results = read_results("both/results.json");
    const cJSON *trace;
    cJSON_ArrayForEach(trace, traces_of(results))
    {
        const bool exact = strcmp(text_of(trace, "intersector"), "exact") == 0;
        assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(trace, "simt_mrays_s")), exact);
    }
    cJSON_Delete(results);
}

/* By default each kernel is simulated, and none is simulated as another one is. */
static void default_kernels_are_simulated(void **state)
{
    (void)state;
    const outcome *o = run("run --scene soup:n=200 --builder lbvh --rays random --max-rays 500 "
                           "--repeats 1 --no-pictures --charts no --metrics simt --out default");
    assert_int_equal(o->exit_status, 0);
    cJSON *results = read_results("default/results.json");
    const cJSON *trace;
    double bounds[8];
    uint32_t count = 0;
    cJSON_ArrayForEach(trace, traces_of(results))
    {
        if (strcmp(text_of(trace, "builder"), "lbvh") != 0)
            continue;
        const cJSON *bound = cJSON_GetArrayItem(cJSON_GetObjectItem(trace, "simt_mrays_s"), 0);
        assert_true(cJSON_IsNumber(bound));
        for (uint32_t i = 0; i < count; i++)
            assert_true(bounds[i] != bound->valuedouble);
        assert_in_range(count, 0, sizeof bounds / sizeof bounds[0] - 1);
        bounds[count++] = bound->valuedouble;
    }
    assert_in_range(count, 2, 8);
    cJSON_Delete(results);
}

/* A build that fails in the form for GPUs is not simulated; what was measured stays as it is. */
static void failures_are_the_simulations_alone(void **state)
{
    (void)state;
    static const char command[] =
        "run --scene soup:n=300 --builder lbvh,lbvh+relay:form=cpu --kernel stack --rays random "
        "--max-rays 500 --repeats 1 --no-pictures --charts no --metrics simt --form cpu "
        "--plugin " BB_TEST_PLUGIN_DIR "/relay.so --out cpu";
    const outcome *o = run(command);
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->err, "build not simulated in its form for GPUs: relay: has no form"));
    cJSON *results = read_results("cpu/results.json");
    const cJSON *trace;
    uint32_t count = 0;
    cJSON_ArrayForEach(trace, traces_of(results))
    {
        assert_string_equal(text_of(trace, "status"), "ok");
        count += cJSON_GetArraySize(cJSON_GetObjectItem(trace, "simt_mrays_s")) == 1;
    }
    assert_int_equal(count, 2);
    cJSON_Delete(results);
}

/* What is made on the host has no figures, rather than zeros. */
static void builds_on_the_host_are_left_out(void **state)
{
    (void)state;
    const outcome *o = run("run --scene soup:n=200 --builder lbvh,sah,lbvh+rotate --kernel stack "
                           "--rays random --max-rays 500 --repeats 1 --no-pictures --charts no "
                           "--metrics simt --out host");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->err, ": sah builds on the host"));
    assert_non_null(strstr(o->err, ": lbvh+rotate builds on the host"));
    cJSON *results = read_results("host/results.json");
    const cJSON *build;
    cJSON_ArrayForEach(build, cJSON_GetObjectItem(results, "builds"))
    {
        const bool on_device = strcmp(text_of(build, "builder"), "lbvh") == 0;
        assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(build, "simt_build_ms")),
                         on_device);
    }
    cJSON_Delete(results);
}

static void divergence_is_drawn(void **state)
{
    (void)state;
    expect(0, "render --scene soup:n=500 --show divergence --size 64x64 --out d.png",
           "steps that a ray waits, in lockstep with 32 of its row");
    const char *words = strstr(run("render --scene soup:n=500 --show divergence --lanes 1 --size "
                                   "64x64 --out d.png")
                                   ->out,
                               "0.0 at nodes and 0.0 at primitives on average");
    assert_non_null(words); /* alone, nobody waits */
    expect(0,
           "render --scene soup:n=500 --show divergence --kernel packet8 --lanes 16 --size 64x64 "
           "--out p.png",
           "steps that a ray waits, in lockstep with 16 of its row");
    refuses("",
            "render --scene soup:n=500 --show divergence --kernel packet8 --lanes 12 --out e.png",
            "--lanes must be a multiple of 8, the rays of a packet of packet8");
    refuses("", "render --scene soup:n=500 --show divergence --kernel stack8i --out e.png",
            "steps of kernel stack8i are not recorded");
    assert_int_not_equal(access("e.png", F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_depend_on_nothing_else),
        cmocka_unit_test(exact_figures_are_compared),
        cmocka_unit_test(what_is_no_device_is_refused),
        cmocka_unit_test(other_intersectors_are_left_out),
        cmocka_unit_test(default_kernels_are_simulated),
        cmocka_unit_test(failures_are_the_simulations_alone),
        cmocka_unit_test(builds_on_the_host_are_left_out),
        cmocka_unit_test(divergence_is_drawn),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
