/* What a run leaves: whole result files, its answer, the right exit status, whatever happens. */
#include "framework/table/table.h"
#include "tests/program_fixture.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* What takes minutes: scripts/test --long. */
static bool is_long(void)
{
    return getenv("BVHBENCH_TEST_LONG") != NULL;
}

static void a_small_run_leaves_results_report_and_pictures(void **state)
{
    (void)state;
    const outcome *o = run("run --scene cube,single --builder null,lbvh --size 32x32 --max-rays "
                           "2000 --repeats 1 --out small");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    assert_non_null(strstr(o->out, "lbvh"));
    cJSON *json = read_results("small/results.json");
    /* two builders and six reference rows, on two scenes */
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "builds")), 16);
    /* references that differ in their query have one tree, and its times */
    cJSON *all = cJSON_GetObjectItem(json, "builds");
    const cJSON *single = build_of(all, "embree-native:quality=high,mode=fast");
    const cJSON *packets = build_of(all, "embree-native:quality=high,mode=fast,query=packet8");
    const cJSON *other = build_of(all, "embree-native:quality=medium,mode=fast");
    assert_true(cJSON_Compare(cJSON_GetObjectItem(single, "build_ms"),
                              cJSON_GetObjectItem(packets, "build_ms"), true));
    assert_false(cJSON_Compare(cJSON_GetObjectItem(single, "build_ms"),
                               cJSON_GetObjectItem(other, "build_ms"), true));
    const cJSON *trace;
    uint32_t ours = 0, references = 0;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
    {
        const char *status = cJSON_GetStringValue(cJSON_GetObjectItem(trace, "status"));
        const char *kernel = cJSON_GetStringValue(cJSON_GetObjectItem(trace, "kernel"));
        const char *builder = cJSON_GetStringValue(cJSON_GetObjectItem(trace, "builder"));
        const cJSON *accuracy = cJSON_GetObjectItem(trace, "accuracy");
        if (strstr(builder, "query=") != NULL && strcmp(status, "unsupported") == 0)
            continue; /* Embree 4 has no streams, some processors have no wide packets */
        if (strcmp(status, "ok") != 0)
            fail_msg("%s", cJSON_Print(trace));
        assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(trace, "mrays_s")) > 0);
        assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(accuracy, "checked")) > 0);
        if (strcmp(kernel, "embree") == 0) {
            references++;
        } else {
            ours++;
            assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(accuracy, "wrong_ppm")) == 0);
        }
    }
    assert_true(ours > 0 && references > 0);
    assert_true(cJSON_GetArraySize(cJSON_GetObjectItem(json, "pictures")) >= 2);
    cJSON_Delete(json);
    char path[512];
    struct stat info;
    snprintf(path, sizeof path, "%s/small/report.html", folder);
    assert_int_equal(stat(path, &info), 0);
    assert_true(info.st_size > 100000);
}

/* Only cells of `exact` count for the exit status; a careless one is marked all the same. */
static void careless_cells_are_marked_but_not_counted(void **state)
{
    (void)state;
    const outcome *o =
        run("run --table --scene sphere-mesh:n=32 --builder lbvh --rays edges --max-rays "
            "50000 --intersector fast "
            "--size 32x32 --repeats 1 --no-pictures --out careless");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    assert_non_null(strstr(o->out, " wrong  "));
    cJSON *json = read_results("careless/results.json");
    double missed = 0;
    const cJSON *trace;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
    {
        if (strcmp(cJSON_GetStringValue(cJSON_GetObjectItem(trace, "intersector")), "fast") == 0)
            missed += cJSON_GetNumberValue(
                cJSON_GetObjectItem(cJSON_GetObjectItem(trace, "accuracy"), "missed"));
    }
    assert_true(missed > 0);
    cJSON_Delete(json);
}

/* Device code that is broken on purpose (edit and run): `run` and `check` must exit 1. */
static void wrong_answers_give_exit_status_1(void **state)
{
    (void)state;
    char command[1024];
    snprintf(command, sizeof command,
             "mkdir -p %s/kernels && sed 's/bb_lanes t = bb_primitive(/bb_lanes t = 1.001f * "
             "bb_primitive(/' " BB_TEST_SOURCE_DIR "/kernels/search.clh >%s/kernels/search.clh",
             folder, folder);
    assert_int_equal(system(command), 0);
    const outcome *o =
        run("run --table --scene cube --builder lbvh --rays primary --size 16x16 --repeats 1 "
            "--no-pictures --kernels-from kernels --out wrong");
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->out, "WRONG"));
    assert_int_equal(run("check --scene cube --builder lbvh --kernels-from kernels")->exit_status,
                     1);
    refuses("mkdir -p empty;", "check --scene cube --kernels-from empty",
            "no .cl, .clh or .h file");
    refuses("mkdir -p typo; touch typo/stak.cl;", "check --scene cube --kernels-from typo",
            "stak.cl would not be used");
    refuses("mkdir -p typo2; touch typo2/stack.clh;", "check --scene cube --kernels-from typo2",
            "stack.clh would not be used");
    refuses("mkdir -p typo3; touch typo3/sah.cl;", "check --scene cube --kernels-from typo3",
            "sah.cl would not be used");
    o = run_with("mkdir -p header; cp " BB_TEST_SOURCE_DIR "/kernels/bb_device.h header;",
                 "check --scene cube --builder lbvh --kernels-from header");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    o = run("check --scene cube --builder lbvh");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
}

/* Nothing wrong is no success where nothing was looked at. */
static void without_a_judgement_exit_status_is_1(void **state)
{
    (void)state;
    const outcome *o = run("run --scene spheres:n=100 --builder lbvh --rays edges --size 16x16 "
                           "--repeats 1 --no-pictures --out nothing");
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->err, "no answer was judged"));
    o = run("check --scene spheres:n=100 --plugin " BB_TEST_PLUGIN_DIR "/rogue.so --builder rogue");
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->err, "nothing was checked"));
}

/* What a large scene takes is said before it is taken; of a small one, and quietly, nothing is. */
static void a_large_scene_is_foretold(void **state)
{
    (void)state;
    static const struct {
        const char *more;
        bool said;
    } cases[] = {{"soup:n=70000", true},
                 {"soup:n=65536", false},
                 {"soup:n=70000 --quick", false},
                 {"soup:n=70000 --quiet", false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char command[512];
        snprintf(command, sizeof command,
                 "run --builder lbvh --kernel stack --rays random --max-rays 1000 --size 32x32 "
                 "--repeats 1 --no-pictures --charts no --out large --scene %s",
                 cases[i].more);
        const outcome *o = run(command);
        if (o->exit_status != 0)
            fail_msg("exit %d: %s", o->exit_status, o->err);
        const char *said = strstr(o->err, "soup:n=70000: takes about ");
        if ((said != NULL) != cases[i].said)
            fail_msg("%s: %s", cases[i].more, o->err);
        assert_true(said == NULL || strstr(said, " GB of memory\n") != NULL);
    }
}

/* Of a build and its layout: launches, and what they take if they do nothing. */
static double launches_of(const bb_results *results, const char *builder)
{
    const double us = bb_get_number(bb_results_context(results), BB_F_CONTEXT_LAUNCH);
    double launches = 0;
    bb_each(build, bb_results_section(results, BB_BUILDS))
        bb_each_part(layout, build, BB_F_BUILD_LAYOUTS_MS)
    {
        if (strcmp(bb_get_text(build, BB_F_BUILD_BUILDER), builder) != 0)
            continue;
        launches = bb_get_number(layout, BB_F_BUILD_LAYOUTS_LAUNCHES);
        const double floor = bb_get_number(layout, BB_F_BUILD_LAYOUTS_FLOOR);
        assert_true(us > 0 && us < 1e5 && launches >= 1);
        assert_true(fabs(floor - launches * us * 1e-3) <= 1e-6 * floor);
        assert_true(bb_first_ray_ms(build, bb_part_name(layout)) > 1e-6 * us); /* its unit */
    }
    return launches;
}

static void launches_are_counted_and_timed(void **state)
{
    (void)state;
    const outcome *o = run("run --scene cube --builder lbvh,sah --kernel stack --rays none "
                           "--repeats 1 --no-pictures --charts no --table --out launches");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    assert_non_null(strstr(o->out, "Launch floor"));
    char path[1024];
    bb_results *results;
    snprintf(path, sizeof path, "%s/launches/results.json", folder);
    ASSERT_OK(bb_results_read(path, &results));
    /* both have the same layout, and sah builds on the host */
    assert_true(launches_of(results, "lbvh") > launches_of(results, "sah") + 4);
    bb_results_destroy(results);
}

/* Where not all trees fit, builders have theirs, and Embree's make room: their rows say so. */
static void references_give_way(void **state)
{
    (void)state;
    const outcome *o =
        run_with("SLURM_JOB_ID=7 SLURM_CPUS_PER_TASK=2 SLURM_MEM_PER_NODE=90",
                 "run --scene soup:n=100000 --builder lbvh,hploc,ploc --kernel stack "
                 "--rays random --max-rays 1000 --size 32x32 --repeats 1 --no-pictures "
                 "--charts no --table --quiet --out narrow");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = read_results("narrow/results.json"), *build, *trace;
    uint32_t given_up = 0, ours = 0;
    cJSON_ArrayForEach(build, cJSON_GetObjectItem(json, "builds"))
    {
        const char *reason = cJSON_GetStringValue(cJSON_GetObjectItem(build, "reason"));
        given_up += reason != NULL && (strstr(reason, "made room for a builder's") != NULL ||
                                       strstr(reason, "Embree has no room") != NULL);
    }
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
    {
        const char *status = cJSON_GetStringValue(cJSON_GetObjectItem(trace, "status"));
        const char *kernel = cJSON_GetStringValue(cJSON_GetObjectItem(trace, "kernel"));
        ours += strcmp(kernel, "embree") != 0 && strcmp(status, "ok") == 0;
    }
    if (given_up == 0 || ours < 3)
        fail_msg("%s", o->out);
    cJSON_Delete(json);
}

/* A run that only builds has all that is known of builds, and nothing else. */
static void without_rays_there_are_builds_only(void **state)
{
    (void)state;
    refuses("", "run --scene cube --rays none,primary --out x", "--rays none means no rays");
    const outcome *o = expect(0,
                              "run --table --scene cube --builder lbvh --rays none --kernel stack "
                              "--repeats 7 --no-pictures --out bare",
                              "Layout ms");
    assert_null(strstr(o->out, "Wrong ppm"));
    cJSON *json = read_results("bare/results.json");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "traces")), 0);
    const cJSON *build = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "builds"), 0);
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(build, "build_ms_median")) > 0);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(build, "layout_ms")), 1);
    cJSON_Delete(json);
    /* a layout has as many rounds as a build */
    char path[600];
    bb_table *table;
    snprintf(path, sizeof path, "%s/bare/results.json", folder);
    assert_int_equal(bb_table_read(path, &table), BB_OK);
    const bb_cell cell = {{[BB_SCENE] = "cube", [BB_BUILDER] = "lbvh", [BB_MAKER] = "pair"}};
    const uint32_t row = bb_table_find(table, cell);
    assert_true(row != BB_NO_ROW);
    assert_int_equal(bb_table_get_rounds(table, row, "layout_ms")->count, 8);
    bb_table_free(table);
    expect(0, "report bare --out bare/again.html", "again.html");
}

/* What a builder does outside its clock is no secret, and in no sum. */
static void work_outside_the_clock_is_recorded(void **state)
{
    (void)state;
    const outcome *o =
        run("run --scene cube --plugin " BB_TEST_PLUGIN_DIR
            "/rogue.so --builder rogue:kind=early --rays primary --size 16x16 --repeats 3 "
            "--no-pictures --out early");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    assert_non_null(strstr(o->out, "Not clocked: with each build rogue:kind=early "));
    assert_null(strstr(o->out, "Fastest build"));
    assert_non_null(strstr(run("report early --markdown")->out, " ! |"));
    cJSON *json = read_results("early/results.json");
    const cJSON *build = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "builds"), 0);
    static const char *const outside[] = {"prepare_ms", "restore_ms", "outside_ms"};
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        double ms = cJSON_GetNumberValue(cJSON_GetObjectItem(build, outside[i]));
        if (!(ms >= 20))
            fail_msg("%s is %g", outside[i], ms);
    }
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(build, "build_ms_median")) < 20);
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(build, "inputs")), "boxes");
    cJSON_Delete(json);
}

static double sum_of(const cJSON *figures)
{
    double sum = 0;
    const cJSON *figure;
    cJSON_ArrayForEach(figure, figures) sum += cJSON_GetNumberValue(figure);
    return sum;
}

/* Stages are recorded each by itself, with the parameters of all, and add up. */
static void a_pipeline_is_recorded_by_stages(void **state)
{
    (void)state;
    const outcome *o =
        run("run --scene interior:n=2000 --builder "
            "presplit:saves=-1,above=1e+0+lbvh+rotate:passes=2+rotate --rays primary "
            "--kernel stack --size 16x16 --repeats 1 --no-pictures --out stages");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = read_results("stages/results.json");
    const cJSON *build = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "builds"), 0);
    const cJSON *params = cJSON_GetObjectItem(build, "parameter");
    const cJSON *phases = cJSON_GetObjectItem(build, "phase_ms");
    const cJSON *stages = cJSON_GetObjectItem(build, "stage_ms");
    static const char *const steps[] = {"presplit", "lbvh", "map", "rotate", "rotate#2"};
    static const struct {
        const char *name, *value;
    } expected[] = {{"presplit: above", "1e+0"},
                    {"presplit: budget", "1.5"},
                    {"lbvh: code", "mc32"},
                    {"rotate: passes", "2"},
                    {"rotate#2: passes", "3"}};
    for (size_t i = 0; i < 5; i++) {
        const char *value =
            cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(params, expected[i].name));
        if (value == NULL || strcmp(value, expected[i].value) != 0)
            fail_msg("%s is %s", expected[i].name, value != NULL ? value : "not there");
        if (cJSON_GetObjectItemCaseSensitive(stages, steps[i]) == NULL)
            fail_msg("there is no time of %s", steps[i]);
    }
    assert_int_equal(cJSON_GetArraySize(stages), 5);
    const cJSON *sah = cJSON_GetObjectItem(build, "stage_sah");
    assert_null(cJSON_GetObjectItemCaseSensitive(sah, "presplit"));
    double before = cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(sah, "lbvh"));
    double after = cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(sah, "rotate#2"));
    assert_true(after < before);
    assert_true(after == cJSON_GetNumberValue(
                             cJSON_GetObjectItem(cJSON_GetObjectItem(build, "tree"), "sah")));
    assert_non_null(cJSON_GetObjectItemCaseSensitive(phases, "lbvh: sort"));
    assert_non_null(cJSON_GetObjectItemCaseSensitive(phases, "rotate#2: rotate"));
    /* one round counts: its figures add up */
    double whole = cJSON_GetNumberValue(cJSON_GetObjectItem(build, "build_ms_median"));
    double sum = sum_of(stages);
    assert_true(fabs(whole - sum) <= 1e-9 * whole);
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(build, "transfer_ms")) > 0);
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(build, "inputs")),
                        "boxes geometry profile");
    cJSON_Delete(json);
}

/* Starts a run, sends it `signal_number` after `ms`, and returns its exit status, as a shell has
 * it. */
static int interrupt_run(int signal_number, unsigned ms)
{
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (chdir(folder) != 0 || freopen("killed.err", "w", stderr) == NULL ||
            freopen("killed.out", "w", stdout) == NULL)
            _exit(99);
        execl(BB_TEST_BINARY, BB_TEST_BINARY, "run", "--scene", "cube", "--builder", "lbvh",
              "--kernel", "stack", "--rays", "primary", "--repeats", "255", "--size", "512x512",
              "--no-pictures", "--charts", "no", "--out", "killed", (char *)NULL);
        _exit(99);
    }
    usleep(ms * 1000);
    kill(child, signal_number);
    int status;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/* Whenever it comes: what was measured is whole and is printed, and that it is not all is said. */
static void an_interrupted_run_leaves_what_it_has(void **state)
{
    (void)state;
    static const unsigned times[] = {100, 700, 1500, 3000};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
        char path[512], text[4096];
        struct stat info;
        const int signal_number = i % 2 ? SIGTERM : SIGINT;
        const int ended = interrupt_run(signal_number, times[i]);
        snprintf(path, sizeof path, "%s/killed/results.json", folder);
        const bool written = stat(path, &info) == 0;
        if (!written) {
            read_file("killed.err", text, sizeof text);
            /* before the program was ready to listen the signal ends it, without a word */
            if (text[0] == '\0') {
                assert_int_equal(ended, 128 + signal_number);
                continue;
            }
            assert_non_null(strstr(text, "interrupted before anything was measured"));
        }
        assert_int_equal(ended, 130);
        if (!written)
            continue;
        cJSON *json = read_results("killed/results.json");
        const cJSON *context = cJSON_GetObjectItem(json, "context");
        assert_true(cJSON_IsTrue(cJSON_GetObjectItem(context, "interrupted")));
        cJSON_Delete(json);
        read_file("killed.out", text, sizeof text);
        assert_non_null(strstr(text, "INTERRUPTED"));
        assert_non_null(strstr(text, "\nlbvh "));
    }
    expect(0, "report killed --out killed/again.html --charts no", "INTERRUPTED");
}

/* One screen: who is best, and where the rest is. */
static void a_run_ends_with_its_answer(void **state)
{
    (void)state;
    const outcome *o = expect(0,
                              "run --scene cube,single --builder lbvh,sah --kernel stack,stack8 "
                              "--rays primary,random --size 32x32 --max-rays 4000 --no-pictures "
                              "--charts no --out answer",
                              "Fastest trace");
    int lines = 0;
    for (const char *line = o->out; *line != '\0'; lines++) {
        size_t length = strcspn(line, "\n");
        if (length > 100)
            fail_msg("%zu columns: %.*s", length, (int)length, line);
        line += length + (line[length] == '\n');
    }
    assert_true(lines <= 45);
    static const char *const words[] = {"Fastest build", "For 1 M rays",       "For 1 G rays",
                                        "Right answers", "answer/report.html", "answer/tables.txt"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        assert_non_null(strstr(o->out, words[i]));
    expect(0, "report answer --table", "where the time went");
    expect(0, "report answer --markdown", "| builder | \\# | trace /ref |");
    o = expect(0, "report answer --csv", "scene,question,view,builder,kernel,intersector,cell,");
    lines = 0;
    for (const char *at = o->out; (at = strchr(at, '\n')) != NULL; at++)
        lines++;
    cJSON *json = read_results("answer/results.json");
    assert_int_equal(lines, 1 + cJSON_GetArraySize(cJSON_GetObjectItem(json, "traces")));
    cJSON_Delete(json);
}

/* What an earlier run left is moved, not lost. */
static void earlier_results_are_kept(void **state)
{
    (void)state;
    static const char command[] = "run --scene cube --builder lbvh --kernel stack --rays primary "
                                  "--size 16x16 --repeats 1 --no-pictures --charts no --out twice";
    expect(0, command, "twice/results.json");
    const outcome *o = expect(0, command, "twice/results.json");
    const char *place = strstr(o->err, "to twice/earlier/");
    assert_non_null(place);
    char path[600];
    snprintf(path, sizeof path, "%.*s/results.json", (int)strcspn(place + 3, "\n"), place + 3);
    cJSON_Delete(read_results(path));
    /* what fails beforehand moves nothing, and leaves no empty folder */
    refuses("", "run --scene missing.glb --out twice", "missing.glb");
    cJSON_Delete(read_results("twice/results.json"));
    struct stat info;
    refuses("", "run --scene missing.glb --out never", "missing.glb");
    snprintf(path, sizeof path, "%s/never", folder);
    assert_int_not_equal(stat(path, &info), 0);
}

/* Where nothing can be written to, the answer is printed all the same. */
static void a_full_device_costs_no_answer(void **state)
{
    (void)state;
    char path[600];
    snprintf(path, sizeof path, "%s/full", folder);
    assert_int_equal(mkdir(path, 0777), 0);
    snprintf(path, sizeof path, "%s/full/report.html", folder);
    assert_int_equal(mkdir(path, 0777), 0); /* where the page would go there is a folder */
    const outcome *o = run("run --scene cube --builder lbvh --kernel stack --rays primary --size "
                           "16x16 --repeats 1 --no-pictures --charts no --out full");
    assert_int_equal(o->exit_status, 2);
    if (strstr(o->out, "Fastest build") == NULL)
        fail_msg("%s%s", o->out, o->err);
    assert_non_null(strstr(o->err, "the results are in full/results.json"));
    cJSON_Delete(read_results("full/results.json"));
}

/* The default gives intervals; two rounds give a range, which is called so; one gives neither. */
static void rounds_decide_what_is_said_of_medians(void **state)
{
    (void)state;
    static const struct {
        const char *option;
        int samples;
        bool interval, range;
    } cases[] = {
        {"", 7, true, true}, {"--repeats 2", 3, false, true}, {"--repeats 1", 2, false, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char arguments[512];
        snprintf(
            arguments, sizeof arguments,
            "run --table --scene cube --builder lbvh --kernel stack --rays primary --size 16x16 "
            "--no-pictures --charts no --out rounds %s",
            cases[i].option);
        const outcome *o = run(arguments);
        if (o->exit_status != 0)
            fail_msg("%s: exit %d: %s", arguments, o->exit_status, o->err);
        const char *row = strstr(o->out, "Mrays/s");
        assert_non_null(row);
        row = strstr(row, "\nlbvh ");
        assert_non_null(row);
        char line[256];
        snprintf(line, sizeof line, "%.*s", (int)strcspn(row + 1, "\n"), row + 1);
        assert_true((strchr(line, '[') != NULL) == cases[i].range);
        assert_true((strstr(line, "] range ") != NULL) == (cases[i].range && !cases[i].interval));
        cJSON *json = read_results("rounds/results.json"), *trace;
        cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
        {
            if (strcmp(cJSON_GetStringValue(cJSON_GetObjectItem(trace, "status")), "ok") != 0)
                continue; /* a query that the library lacks */
            assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(trace, "ms")),
                             cases[i].samples);
            assert_true(cJSON_IsNumber(cJSON_GetObjectItem(trace, "mrays_s_lo")) ==
                        cases[i].interval);
            assert_true(cJSON_IsNumber(cJSON_GetObjectItem(trace, "mrays_s_least")) ==
                        cases[i].range);
        }
        cJSON_Delete(json);
    }
}

/* With a device that has room for one builder at a time, the others are built again when their turn
 * comes. */
static void what_does_not_fit_together_is_built_again(void **state)
{
    (void)state;
    if (!is_long())
        return;
    const outcome *o =
        run_with("POCL_MEMORY_LIMIT=1", "run --scene spheres:n=2500000 --builder "
                                        "lbvh,lbvh:bits=63,embree-native:quality=low "
                                        "--kernel stack --rays primary --size 64x64 --repeats 1 "
                                        "--no-pictures --out tight");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = read_results("tight/results.json");
    const cJSON *trace;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
        assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(trace, "status")), "ok");
    cJSON_Delete(json);
}

/* The big scenes, where they are at hand. */
static void big_scenes_are_traced_rightly(void **state)
{
    (void)state;
    if (!is_long())
        return;
    static const char *const names[] = {"kitchen", "bathroom2"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char path[512], arguments[1024];
        struct stat info;
        snprintf(path, sizeof path, "%s/../shared/data/tri/%s/%s.glb", BB_TEST_SOURCE_DIR, names[i],
                 names[i]);
        if (stat(path, &info) != 0) {
            print_message("skipped: %s is not there\n", path);
            skip();
        }
        snprintf(arguments, sizeof arguments,
                 "run --scene %s --builder lbvh --size 128x128 --max-rays 65536 "
                 "--repeats 1 --no-pictures --out big",
                 path);
        const outcome *o = run(arguments);
        if (o->exit_status != 0)
            fail_msg("%s: exit %d: %s", names[i], o->exit_status, o->err);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_small_run_leaves_results_report_and_pictures),
        cmocka_unit_test(careless_cells_are_marked_but_not_counted),
        cmocka_unit_test(wrong_answers_give_exit_status_1),
        cmocka_unit_test(without_a_judgement_exit_status_is_1),
        cmocka_unit_test(a_large_scene_is_foretold),
        cmocka_unit_test(launches_are_counted_and_timed),
        cmocka_unit_test(references_give_way),
        cmocka_unit_test(without_rays_there_are_builds_only),
        cmocka_unit_test(work_outside_the_clock_is_recorded),
        cmocka_unit_test(a_pipeline_is_recorded_by_stages),
        cmocka_unit_test(an_interrupted_run_leaves_what_it_has),
        cmocka_unit_test(a_run_ends_with_its_answer),
        cmocka_unit_test(earlier_results_are_kept),
        cmocka_unit_test(a_full_device_costs_no_answer),
        cmocka_unit_test(rounds_decide_what_is_said_of_medians),
        cmocka_unit_test(what_does_not_fit_together_is_built_again),
        cmocka_unit_test(big_scenes_are_traced_rightly),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
