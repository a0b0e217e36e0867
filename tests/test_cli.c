/* The program from outside: exit statuses, one clear line for bad input, whole result files. */
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

/* Under sanitizers, which see the same code with small scenes, large ones take minutes. */
static bool is_small(void)
{
    return getenv("BVHBENCH_TEST_SMALL") != NULL;
}

static void help_and_lists_are_there(void **state)
{
    (void)state;
    static const char *const commands[] = {"list", "run", "check", "render", "report", "reproduce"};
    assert_int_equal(run("--help")->exit_status, 0);
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char arguments[64];
        assert_non_null(strstr(run("--help")->out, commands[i]));
        snprintf(arguments, sizeof arguments, "%s --help", commands[i]);
        const outcome *o = run(arguments);
        assert_int_equal(o->exit_status, 0);
        assert_non_null(strstr(o->out, "usage: bvhbench"));
    }
    assert_int_equal(run("--version")->exit_status, 0);
    assert_int_equal(run("")->exit_status, 2);
    const outcome *o = run("list --json");
    assert_int_equal(o->exit_status, 0);
    cJSON *json = cJSON_Parse(o->out);
    static const char *const kinds[] = {"builders", "kernels", "layouts", "intersectors",
                                        "scenes",   "rays",    "papers",  "devices"};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        assert_true(cJSON_GetArraySize(cJSON_GetObjectItem(json, kinds[i])) > 0);
    cJSON_Delete(json);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    refuses("", "fly", "fly");
    refuses("", "run --speed 3", "--speed");
    refuses("", "run --builder", "--builder");
    refuses("", "run stray", "stray");
    refuses("", "run --scene cube --builder nobody", "nobody");
    refuses("", "run --scene cube --builder lbvh:bits=65", "'65'");
    refuses("", "run --scene cube --builder lbvh:bit=30", "'bit'");
    refuses("", "run --scene cube --builder lbvh:", "lbvh:");
    refuses("", "run --scene cube --builder embree-native:quality=best", "quality");
    refuses("", "run --scene cube --kernel warp", "warp");
    refuses("", "run --scene cube --kernel stack:leaf=0", "leaf");
    refuses("", "run --scene cube --kernel stack:group=0", "group");
    refuses("", "run --scene cube --kernel stack:group=65536", "group");
    refuses("", "run --scene cube --builder sah:bins=1000", "bins");
    refuses("", "run --scene cube --rays ao:per_hit=none", "per_hit");
    refuses("", "run --scene cube --rays ao --max-rays 3", "ao");
    refuses("", "run --scene cube --size 65536x65536", "--size");
    refuses("", "run --scene cube --kernels-from no-such-folder", "no-such-folder");
    refuses("", "run --scene cube --history h.db", "--history");
    refuses("", "list --json=yes", "--json");
    refuses("", "list -x", "-x");
    refuses("", "run --scene cube --rays gamma", "gamma");
    refuses("", "run --scene cube --intersector perfect", "perfect");
    refuses("", "run --scene cube --metrics beauty", "beauty");
    refuses("", "run --scene cube --size 10", "--size");
    refuses("", "run --scene cube --size 0x10", "--size");
    refuses("", "run --scene cube --repeats 0", "--repeats");
    refuses("", "run --scene cube --repeats -3", "--repeats");
    refuses("", "run --scene cube --max-wrong-ppm many", "--max-wrong-ppm");
    refuses("", "run --scene cube --form tpu", "--form");
    refuses("", "run --scene cube --device nowhere", "nowhere");
    refuses("", "list everything", "everything");
    refuses("", "render --scene cube", "--out");
    refuses("", "render --scene cube --out x.gif", "gif");
    refuses("", "render --scene cube --view taste --out x.png", "taste");
    refuses("", "render --scene cube --camera behind --out x.png", "behind");
    refuses("", "check --builder nobody", "nobody");
    refuses("", "report", "report");
    refuses("", "report missing.json", "missing.json");
}

static void bad_files_are_refused(void **state)
{
    (void)state;
    refuses("", "run --scene missing.glb", "missing.glb");
    refuses("", "run --scene nothing-of-the-kind", "nothing-of-the-kind");
    write_file("empty.glb", "", 0);
    refuses("", "run --scene empty.glb", "empty.glb");
    write_file("text.glb", "this is no glTF at all\n", 23);
    refuses("", "run --scene text.glb", "text.glb");
    write_file("text.gltf", "{\"asset\":", 9);
    refuses("", "run --scene text.gltf", "text.gltf");
    static const char no_triangle[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[]}]}";
    write_file("none.gltf", no_triangle, sizeof no_triangle - 1);
    refuses("", "run --scene none.gltf", "none.gltf");
    static const char nan_vertex[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"data:"
        "application/"
        "octet-stream;base64,AAAAAAAAAAAAAAAAAADAfwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":["
        "{"
        "\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
        "\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
        "\"POSITION\":0}}]}],"
        "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}";
    write_file("nan.gltf", nan_vertex, sizeof nan_vertex - 1);
    refuses("", "run --scene nan.gltf", "nan.gltf");
    /* a second scene that can't be loaded is found out before the first is measured */
    refuses("", "run --scene cube,nan.gltf", "nan.gltf");
    write_file("not-a-plugin.so", "ELF?", 4);
    refuses("", "run --scene cube --plugin not-a-plugin.so", "not-a-plugin.so");
    refuses("", "run --scene cube --plugin ./missing.so", "missing.so");
    write_file("results.json", "{\"schema\": \"bvhbench-results/1\", \"tra", 36);
    refuses("", "report results.json", "results.json");
}

static void truncated_scenes_are_refused(void **state)
{
    (void)state;
    FILE *file = fopen(BB_TEST_SOURCE_DIR "/scenes/data/mountain.glb", "rb");
    assert_non_null(file);
    static char data[700000];
    size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    static const size_t keep[] = {3, 11, 19, 100, 5000};
    for (size_t i = 0; i < sizeof keep / sizeof keep[0]; i++) {
        write_file("cut.glb", data, keep[i]);
        refuses("", "run --scene cut.glb", "cut.glb");
    }
    write_file("cut.glb", data, size - 1);
    refuses("", "run --scene cut.glb", "cut.glb");
}

static void unwritable_folders_are_refused_before_the_work(void **state)
{
    (void)state;
    refuses("", "run --scene cube --out /dev/null/out", "/dev/null/out");
    refuses("", "run --scene cube --out /proc/out", "/proc/out");
    refuses("", "run --scene cube --out no/such/folder", "no/such/folder");
    refuses("", "render --scene single --size 8x8 --out /dev/null/x.png", "/dev/null/x.png");
}

static void no_device_is_said(void **state)
{
    (void)state;
    refuses("OCL_ICD_VENDORS=/nonexistent", "run --scene cube", "no OpenCL device");
    refuses("OCL_ICD_VENDORS=/nonexistent", "check --scene cube", "no OpenCL device");
    refuses("POCL_CACHE_DIR=/proc/none", "render --scene cube --out a.png", "set POCL_CACHE_DIR");
}

static cJSON *read_results(const char *name)
{
    static char text[4 << 20];
    read_file(name, text, sizeof text);
    cJSON *json = cJSON_Parse(text);
    assert_non_null(json);
    return json;
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
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(json, "schema")),
                        "bvhbench-results/1");
    /* two builders and the reference rows, on two scenes */
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "builds")), 10);
    const cJSON *trace;
    uint32_t ours = 0, references = 0;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
    {
        const char *status = cJSON_GetStringValue(cJSON_GetObjectItem(trace, "status"));
        const char *kernel = cJSON_GetStringValue(cJSON_GetObjectItem(trace, "kernel"));
        const cJSON *accuracy = cJSON_GetObjectItem(trace, "accuracy");
        assert_string_equal(status, "ok");
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

static cJSON *read_document(const char *name)
{
    char path[600];
    static char text[4 << 20];
    snprintf(path, sizeof path, "%s/results.json", name);
    read_file(path, text, sizeof text);
    cJSON *document = cJSON_Parse(text);
    assert_non_null(document);
    return document;
}

static const char *key_of(const cJSON *entry)
{
    const char *key = cJSON_GetStringValue(cJSON_GetObjectItem(entry, "cell"));
    assert_non_null(key);
    return key;
}

/* The one entry of `section` with this key. */
static cJSON *entry_of(const cJSON *document, const char *section, const char *key)
{
    cJSON *entry, *found = NULL;
    cJSON_ArrayForEach(entry, cJSON_GetObjectItem(document, section))
    {
        if (strcmp(key_of(entry), key) != 0)
            continue;
        assert_null(found);
        found = entry;
    }
    if (found == NULL)
        fail_msg("no %s has the key %s", section, key);
    return found;
}

/* Everything that no clock decides. */
static void same_measurement(const cJSON *before, const cJSON *after, const char *key)
{
    cJSON *a = entry_of(before, "traces", key), *b = entry_of(after, "traces", key);
    static const char *const members[] = {"view",
                                          "layout",
                                          "query",
                                          "count",
                                          "rays_hash",
                                          "rays_params",
                                          "node_tests_per_ray",
                                          "prim_tests_per_ray",
                                          "stack_size"};
    cJSON *rates[2] = {cJSON_GetObjectItem(a, "accuracy"), cJSON_GetObjectItem(b, "accuracy")};
    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
        if (!cJSON_Compare(cJSON_GetObjectItem(a, members[i]), cJSON_GetObjectItem(b, members[i]),
                           1))
            fail_msg("%s: another %s", key, members[i]);
    for (int i = 0; i < 2; i++)
        cJSON_DeleteItemFromObject(rates[i], "judge_ms");
    assert_non_null(rates[0]);
    if (!cJSON_Compare(rates[0], rates[1], 1))
        fail_msg("%s: another accuracy", key);
}

/* A cell's key, from a file, measures that cell and no other. A scene's path may hold anything that
 * a shell would take for its own. */
static void cells_are_measured_again_by_their_keys(void **state)
{
    (void)state;
    char command[16384], path[600];
    snprintf(path, sizeof path, "%s/a b,c=d.glb", folder);
    assert_int_equal(symlink(BB_TEST_SOURCE_DIR "/scenes/data/scorpion.glb", path), 0);
    static const char common[] = "--repeats 1 --no-pictures --charts no --quiet";
    snprintf(
        command, sizeof command,
        "run --scene random:seed=3,n=300 --scene './a b,c=d.glb' --builder sah:leaf=2,bins=8,lbvh "
        "--builder embree-native --kernel stack,short:leaf=4 --intersector exact,fast:slab=sign "
        "--rays primary,random:count=500 --size 8x8 --max-rays 700 --seed 5 %s --out cells",
        common);
    const outcome *o = run(command);
    if (o->exit_status > 1)
        fail_msg("%s", o->err);
    cJSON *before = read_document("cells"), *trace;
    const char *keys[4] = {NULL};
    uint32_t count = 0;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(before, "traces"))
    {
        entry_of(before, "traces", key_of(trace)); /* no other has it */
        if (count % 37 == 5 && count / 37 < 3)
            keys[count / 37] = key_of(trace);
        if (strstr(key_of(trace), "embree-native") != NULL)
            keys[3] = key_of(trace);
        count++;
    }
    assert_true(count > 80 && keys[2] != NULL && keys[3] != NULL);
    assert_non_null(strstr(keys[2], "scene=.%2Fa%20b,c=d.glb/"));
    for (int i = 0; i < 4; i++) {
        snprintf(command, sizeof command, "run --cell %s %s --out again", keys[i], common);
        o = run(command);
        if (o->exit_status > 1)
            fail_msg("%s", o->err);
        cJSON *after = read_document("again");
        assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(after, "traces")), 1);
        assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(after, "builds")), 1);
        same_measurement(before, after, keys[i]);
        cJSON_Delete(after);
    }
    /* several: what they share is done once, and nothing beside them; one of another size, and a
     * build */
    const char *build = key_of(cJSON_GetObjectItem(before, "builds")->child);
    snprintf(command, sizeof command,
             "run --cell %s --cell %s --cell %s --cell %s --cell %s "
             "--cell scene=cube/rays=random:count=9/builder=null/kernel=stackless %s --out again",
             keys[0], keys[1], keys[2], keys[3], build, common);
    o = run(command);
    if (o->exit_status > 1)
        fail_msg("%s", o->err);
    cJSON *after = read_document("again");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(after, "traces")), 5);
    for (int i = 0; i < 4; i++)
        same_measurement(before, after, keys[i]);
    cJSON *tree = cJSON_GetObjectItem(entry_of(before, "builds", build), "tree");
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(after, "builds"))
    {
        if (strcmp(key_of(trace), build) == 0)
            assert_true(cJSON_Compare(cJSON_GetObjectItem(trace, "tree"), tree, 1));
    }
    cJSON_Delete(after);
    cJSON_Delete(before);
}

#define CELL "scene=cube/rays=primary/view=three-quarter/builder=lbvh/kernel=stack"

static void cells_that_cannot_be_are_refused(void **state)
{
    (void)state;
    static const char *const beside[] = {
        "scene cube",        "builder lbvh", "kernel stack", "rays ao",
        "intersector exact", "size 8x8",     "max-rays 9",   "seed 1"};
    for (size_t i = 0; i < sizeof beside / sizeof beside[0]; i++) {
        char command[400];
        snprintf(command, sizeof command, "run --cell " CELL " --%s", beside[i]);
        refuses("", command, "the key already says that");
    }
    static const char *const cases[][2] = {
        {"coffee", "its parts are scene="},
        {"scene=cube/builder=nobody", "unknown builder 'nobody'"},
        {"scene=cube/builder=lbvh:bits=sixty", "bits"},
        {"scene=nowhere/builder=lbvh", "nowhere"},
        {CELL "/intersector=blunt", "unknown intersector"},
        {CELL ":oops=1", "oops"},
        {"scene=cube/rays=primary/builder=lbvh/kernel=stack",
         "cell 'scene=cube/rays=primary/builder=lbvh/kernel=stack': rays primary are made from a "
         "view, and it names none"},
        {"scene=cube/rays=random/view=front/builder=lbvh/kernel=stack", "it names a view"},
        {"scene=cube/rays=sideways/builder=lbvh/kernel=stack", "sideways"},
        {"scene=cube/rays=primary/view=nowhere/builder=lbvh/kernel=stack", "no view 'nowhere'"},
        {"scene=cube/rays=primary/rays-hash=0123456789abcdef/builder=lbvh/kernel=stack",
         "only a hash of its rays"},
        {"scene=cube/rays=random/builder=other/kernel=outside/intersector=own", "other"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char command[600];
        snprintf(command, sizeof command, "run --quiet --out refused --cell %s", cases[i][0]);
        refuses("", command, cases[i][1]);
    }
}

/* Right, but not what the other kernels say: then one of them loses boxes, and chance has hidden
 * it. */
static void unlike_answers_give_exit_status_1(void **state)
{
    (void)state;
    char command[1024];
    snprintf(command, sizeof command,
             "mkdir -p %s/odd && sed 's/bb_lanes t = bb_primitive(/bb_lanes t = (BB_LANES == 4 ? "
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

/* A run that only builds has all that is known of builds, and nothing else. */
static void without_rays_there_are_builds_only(void **state)
{
    (void)state;
    refuses("", "run --scene cube --rays none,primary --out x", "--rays none means no rays");
    const outcome *o = expect(0,
                              "run --table --scene cube --builder lbvh --rays none --kernel stack "
                              "--repeats 2 --no-pictures --out bare",
                              "Layout ms");
    assert_null(strstr(o->out, "Wrong ppm"));
    cJSON *json = read_results("bare/results.json");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "traces")), 0);
    const cJSON *build = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "builds"), 0);
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(build, "build_ms_median")) > 0);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(build, "layouts_ms")), 1);
    cJSON_Delete(json);
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
    const cJSON *params = cJSON_GetObjectItem(build, "params");
    const cJSON *phases = cJSON_GetObjectItem(build, "phases_ms");
    const cJSON *stages = cJSON_GetObjectItem(build, "stages_ms");
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
    assert_non_null(cJSON_GetObjectItemCaseSensitive(phases, "lbvh: sort"));
    assert_non_null(cJSON_GetObjectItemCaseSensitive(phases, "rotate#2: rotate"));
    /* one round counts: its figures add up */
    double whole = cJSON_GetNumberValue(cJSON_GetObjectItem(build, "build_ms_median"));
    double sum = sum_of(stages);
    assert_true(fabs(whole - sum) <= 1e-9 * whole);
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(build, "transfer_ms")) > 0);
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(build, "inputs")),
                        "boxes geometry");
    cJSON_Delete(json);
}

/* `check` of an optimiser alone says what it was put beside; one that takes no scene has not
 * passed. */
static void check_of_stages_is_not_empty(void **state)
{
    (void)state;
    const outcome *o = run("check --scene cube --builder rotate:passes=1,presplit");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "+rotate:passes=1"));
    assert_non_null(strstr(o->out, "presplit+"));
    assert_non_null(strstr(o->out, "(beside a default builder)"));
    o = run("check --scene interior:n=1000 --builder null,lobvh+rotate");
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->out,
                           "lobvh+rotate                       supports none of the scenes: it "
                           "was not checked; interior:n=1000: rotate takes binary trees"));
    o = run("run --scene cube --builder rotate --out nothing");
    assert_int_equal(o->exit_status, 2);
    assert_non_null(strstr(o->err, "write BUILDER+rotate"));
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
        assert_int_equal(interrupt_run(i % 2 ? SIGTERM : SIGINT, times[i]), 130);
        snprintf(path, sizeof path, "%s/killed/results.json", folder);
        if (stat(path, &info) != 0) {
            read_file("killed.err", text, sizeof text);
            /* before the program was ready to listen it ends without a word */
            assert_true(text[0] == '\0' ||
                        strstr(text, "interrupted before anything was measured") != NULL);
            continue;
        }
        cJSON *json = read_results("killed/results.json");
        const cJSON *context = cJSON_GetObjectItem(json, "context");
        assert_true(cJSON_IsTrue(cJSON_GetObjectItem(context, "interrupted")));
        cJSON_Delete(json);
        read_file("killed.out", text, sizeof text);
        assert_non_null(strstr(text, "INTERRUPTED"));
        assert_non_null(strstr(text, " lbvh "));
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
    expect(0, "report answer --markdown", "| builder | trace / Embree |");
    o = expect(0, "report answer --csv", "build,cell,scene,view,builder,kernel");
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
    assert_non_null(strstr(o->out, "Fastest build"));
    assert_non_null(strstr(o->err, "the results are in full/results.json"));
    cJSON_Delete(read_results("full/results.json"));
}

/* The default gives intervals; two rounds give a range, which is called so; one gives neither. */
static void rounds_decide_what_is_said_of_medians(void **state)
{
    (void)state;
    static const struct {
        const char *option, *heading;
        int samples;
        bool interval, range;
    } cases[] = {{"", "Mrays/s [95 %]", 7, true, true},
                 {"--repeats 2", "Mrays/s [range]", 3, false, true},
                 {"--repeats 1", "Mrays/s ", 2, false, false}};
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
        assert_non_null(strstr(o->out, cases[i].heading));
        assert_true((strstr(o->out, "Mrays/s [") != NULL) == cases[i].range);
        cJSON *json = read_results("rounds/results.json"), *trace;
        cJSON_ArrayForEach(trace, cJSON_GetObjectItem(json, "traces"))
        {
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
    if (is_small())
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

static void a_scene_too_big_is_refused_with_its_bytes(void **state)
{
    (void)state;
    /* 12,000,000 boxes of 32 bytes are more than a quarter of a GiB, the largest buffer of such a
     * device */
    refuses("POCL_MEMORY_LIMIT=1", "run --scene spheres:n=12000000 --builder lbvh --rays primary",
            "384000000 bytes");
}

/* The big scenes, where they are at hand. */
static void big_scenes_are_traced_rightly(void **state)
{
    (void)state;
    if (is_small())
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

static void pictures_are_made(void **state)
{
    (void)state;
    static const char *const views[] = {"depth", "normal", "heat", "diff"};
    for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
        char arguments[256], path[512];
        struct stat info;
        snprintf(arguments, sizeof arguments,
                 "render --scene cube --view %s --size 64x48 --out %s.png", views[i], views[i]);
        const outcome *o = run(arguments);
        if (o->exit_status != 0)
            fail_msg("%s: %s", arguments, o->err);
        snprintf(path, sizeof path, "%s/%s.png", folder, views[i]);
        assert_int_equal(stat(path, &info), 0);
        assert_true(info.st_size > 100);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_and_lists_are_there),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(bad_files_are_refused),
        cmocka_unit_test(truncated_scenes_are_refused),
        cmocka_unit_test(unwritable_folders_are_refused_before_the_work),
        cmocka_unit_test(no_device_is_said),
        cmocka_unit_test(a_small_run_leaves_results_report_and_pictures),
        cmocka_unit_test(careless_cells_are_marked_but_not_counted),
        cmocka_unit_test(wrong_answers_give_exit_status_1),
        cmocka_unit_test(cells_are_measured_again_by_their_keys),
        cmocka_unit_test(cells_that_cannot_be_are_refused),
        cmocka_unit_test(unlike_answers_give_exit_status_1),
        cmocka_unit_test(without_a_judgement_exit_status_is_1),
        cmocka_unit_test(without_rays_there_are_builds_only),
        cmocka_unit_test(work_outside_the_clock_is_recorded),
        cmocka_unit_test(a_pipeline_is_recorded_by_stages),
        cmocka_unit_test(check_of_stages_is_not_empty),
        cmocka_unit_test(an_interrupted_run_leaves_what_it_has),
        cmocka_unit_test(a_run_ends_with_its_answer),
        cmocka_unit_test(earlier_results_are_kept),
        cmocka_unit_test(a_full_device_costs_no_answer),
        cmocka_unit_test(rounds_decide_what_is_said_of_medians),
        cmocka_unit_test(what_does_not_fit_together_is_built_again),
        cmocka_unit_test(a_scene_too_big_is_refused_with_its_bytes),
        cmocka_unit_test(big_scenes_are_traced_rightly),
        cmocka_unit_test(pictures_are_made),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
