/* The program from outside: exit statuses, and one clear line for bad input. (Runs: test_run.c.) */
#include "tests/program_fixture.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

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
    refuses("", "run --scene cube --builder presplit+lbvh:bits=65", "'65'");
    refuses("", "run --scene cube --builder lbvh:bit=30", "'bit'");
    refuses("", "run --scene cube --builder lbvh:", "lbvh:");
    refuses("", "run --scene cube --builder embree-native:quality=best", "quality");
    refuses("", "run --scene cube --builder lbvh:leaf=4", "no leaf=");
    refuses("", "run --scene cube --builder lbvh:arity=8,link=karras", "no link=");
    refuses("", "run --scene cube --builder lbvh:arity=8,leaf=65", "'65'");
    refuses("", "run --scene cube --builder lbvh:arity=4", "'4'");
    refuses("", "run --scene cube --kernel cwbvh:plan=native", "plan=native");
    refuses("", "run --scene cube --kernel warp", "warp");
    refuses("", "run --scene cube --kernel stack:leaf=0", "leaf");
    refuses("", "run --scene cube --kernel stack:group=0", "group");
    refuses("", "run --scene cube --kernel stack:group=65536", "group");
    refuses("", "run --scene cube --builder sah:bins=1000", "bins");
    refuses("", "run --scene cube --rays ao:per_hit=none", "per_hit");
    refuses("", "run --scene cube --rays ao --max-rays 3", "ao");
    refuses("", "run --scene cube --size 65536x65536", "--size");
    refuses("", "run --scene cube --kernels-from no-such-folder", "no-such-folder");
    refuses("", "run --scene cube --volume v.raw", "--volume");
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
    refuses("", "render --scene cube --view behind --out x.png", "behind");
    refuses("", "render --scene cube --camera behind --out x.png", "unknown option '--camera'");
    refuses("", "check --builder nobody", "nobody");
    refuses("", "report", "report");
    refuses("", "report missing.json", "missing.json");
}

static void times_are_kept_or_refused(void **state)
{
    (void)state;
    static const char cheap[] = "run --scene cube --builder lbvh --kernel stack --charts no "
                                "--no-pictures --rays random:count=1000";
    char arguments[256];
    refuses("", "run --scene cube --time soon", "--time is 'soon'");
    refuses("", "run --scene cube --time 1min --size 9x9", "--size");
    refuses("", "run --scene crowd:kind=explode,n=100,frames=4 --builder lbvh --time 1h",
            "it moves");
    /* what the comparison refuses is refused before anything is measured */
    refuses("POCL_MEMORY_LIMIT=1", "run --scene cube,spheres:n=12000000 --builder lbvh --time 1h",
            "384000000 bytes");
    snprintf(arguments, sizeof arguments, "%s --out soon --time 0.01s", cheap);
    refuses("", arguments, "--time: "); /* foretelling took it up, or nothing is short enough */
    snprintf(arguments, sizeof arguments, "%s --out late --time 1h", cheap);
    const outcome *o = run(arguments);
    if (o->exit_status != 0 || strstr(o->err, "takes about ") == NULL ||
        strstr(o->err, "pictures of") != NULL)
        fail_msg("exit %d, '%s'", o->exit_status, o->err);
}

/* What is left out to keep a time is said, and noted in the results. */
static void thrift_is_noted(void **state)
{
    (void)state;
    static const char *const times[] = {"8s", "40s", "3min"}; /* sanitizers take longer */
    const outcome *o = NULL;
    char arguments[256];
    for (size_t i = 0; i < sizeof times / sizeof times[0] && (o == NULL || o->exit_status == 2);
         i++) {
        snprintf(arguments, sizeof arguments,
                 "run --scene soup:n=20000 --builder lbvh --kernel stack --charts no --no-pictures "
                 "--rays primary,random,diffuse,ao,shadow --out thrifty --time %s",
                 times[i]);
        o = run(arguments);
    }
    const char *said = strstr(o->err, " with pictures of ");
    if (o->exit_status != 0)
        fail_msg("exit %d, '%s'", o->exit_status, o->err);
    if (said == NULL)
        skip(); /* on so fast a machine nothing is left out */
    cJSON *json = read_results("thrifty/results.json");
    const char *noted = cJSON_GetStringValue(
        cJSON_GetObjectItem(cJSON_GetObjectItem(json, "context"), "reduced_to"));
    said += strlen(" with ");
    if (noted == NULL || strlen(noted) != strcspn(said, "\n") ||
        strncmp(said, noted, strlen(noted)) != 0)
        fail_msg("'%s' is noted of '%s'", noted != NULL ? noted : "nothing", said);
    cJSON_Delete(json);
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
    refuses("", "render --scene single --size 8x8 --out /dev/null/x.png", "/dev/null/x.png");
}

static void no_device_is_said(void **state)
{
    (void)state;
    refuses("OCL_ICD_VENDORS=/nonexistent", "run --scene cube", "no OpenCL device");
    refuses("OCL_ICD_VENDORS=/nonexistent", "check --scene cube", "no OpenCL device");
    refuses("POCL_CACHE_DIR=/proc/none", "render --scene cube --out a.png", "set POCL_CACHE_DIR");
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

static void a_scene_too_big_is_refused_with_its_bytes(void **state)
{
    (void)state;
    /* 12,000,000 boxes of 32 bytes are more than a quarter of a GiB, the largest buffer of such a
     * device */
    refuses("POCL_MEMORY_LIMIT=1", "run --scene spheres:n=12000000 --builder lbvh --rays primary",
            "384000000 bytes");
}

static void pictures_are_made(void **state)
{
    (void)state;
    static const char *const shown[] = {"depth", "normal", "heat", "diff"};
    for (size_t i = 0; i < sizeof shown / sizeof shown[0]; i++) {
        char arguments[256], path[512];
        struct stat info;
        snprintf(arguments, sizeof arguments,
                 "render --scene cube --show %s --size 64x48 --out %s.png", shown[i], shown[i]);
        const outcome *o = run(arguments);
        if (o->exit_status != 0)
            fail_msg("%s: %s", arguments, o->err);
        snprintf(path, sizeof path, "%s/%s.png", folder, shown[i]);
        assert_int_equal(stat(path, &info), 0);
        assert_true(info.st_size > 100);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_and_lists_are_there),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(times_are_kept_or_refused),
        cmocka_unit_test(thrift_is_noted),
        cmocka_unit_test(bad_files_are_refused),
        cmocka_unit_test(truncated_scenes_are_refused),
        cmocka_unit_test(unwritable_folders_are_refused_before_the_work),
        cmocka_unit_test(no_device_is_said),
        cmocka_unit_test(check_of_stages_is_not_empty),
        cmocka_unit_test(a_scene_too_big_is_refused_with_its_bytes),
        cmocka_unit_test(pictures_are_made),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
