/* Cells measured again by the keys that a file has of them. */
#include "tests/program_fixture.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

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
                                          "parameter",
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
    cJSON *before = read_results("cells/results.json"), *trace;
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
        cJSON *after = read_results("again/results.json");
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
    cJSON *after = read_results("again/results.json");
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

/* Cells that differ in size share no rays, and none is said to lack a scene. */
static void cells_of_several_sizes_have_no_rank(void **state)
{
    (void)state;
#define SIZE(size) "--cell scene=cube/rays=primary/size=" size "/view=back/builder="
    static const char same[] =
        "run " SIZE("8x8") "lbvh/kernel=stack " SIZE("8x8") "sah/kernel=stack",
                      other[] =
                          "run " SIZE("8x8") "lbvh/kernel=stack " SIZE("9x8") "sah/kernel=stack";
    static const char tail[] = "--repeats 1 --no-pictures --charts no --quiet --out sizes";
    char command[512];
    snprintf(command, sizeof command, "%s %s", same, tail);
    assert_null(strstr(expect(0, command, "no wrong one in")->out, "have no rank"));
    snprintf(command, sizeof command, "%s %s", other, tail);
    const outcome *o = expect(0, command, "builders were not traced with the same rays: size or ");
    assert_null(strstr(o->out, "lack scenes"));
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
        refuses("", command, "do not go together: drop one of them");
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_measured_again_by_their_keys),
        cmocka_unit_test(cells_of_several_sizes_have_no_rank),
        cmocka_unit_test(cells_that_cannot_be_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
