/* Builders that cheat, in one run with some that do not: each is found by name, nobody else is
 * blamed. */
#include "tests/program_fixture.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <string.h>

#define CHEATS                                                                                     \
    "cheat,cheat:kind=content,cheat:kind=sleeper,cheat:kind=refuses,cheat:kind=first,"             \
    "cheat:kind=prepared,"                                                                         \
    "cheat:kind=early,cheat:kind=spins,cheat:kind=late,cheat:kind=process,cheat:kind=boxes,"       \
    "cheat:kind=device-boxes,cheat:kind=new-boxes,cheat:kind=last-boxes,cheat:kind=hides,lbvh,"    \
    "sah,embree-native"

static const cJSON *rows;

static void expect_status(const char *kind, const char *expected, const char *words)
{
    char builder[64];
    snprintf(builder, sizeof builder, "cheat:kind=%s", kind);
    const cJSON *row = build_of(rows, builder);
    const char *status = cJSON_GetStringValue(cJSON_GetObjectItem(row, "status"));
    const char *reason = cJSON_GetStringValue(cJSON_GetObjectItem(row, "reason"));
    if (status == NULL || strcmp(status, expected) != 0 || reason == NULL ||
        strstr(reason, words) == NULL)
        fail_msg("%s: %s: %s", builder, status, reason);
}

static void expect_reason(const char *kind, const char *words)
{
    expect_status(kind, "failed", words);
}

static void expect_ok(const char *builder)
{
    const cJSON *row = build_of(rows, builder);
    const char *reason = cJSON_GetStringValue(cJSON_GetObjectItem(row, "reason"));
    if (reason != NULL)
        fail_msg("%s: %s", builder, reason);
}

/* Where another program takes the processor, one of its copies takes as long as a build. */
static void expect_remembered(const char *kind)
{
    char builder[64];
    snprintf(builder, sizeof builder, "cheat:kind=%s", kind);
    const cJSON *row = build_of(rows, builder);
    assert_true(cJSON_IsTrue(cJSON_GetObjectItem(row, "remembers")));
    if (strcmp(cJSON_GetStringValue(cJSON_GetObjectItem(row, "status")), "ok") != 0)
        expect_reason(kind, "it remembers inputs: of 4 that it had not seen");
}

static double bytes_of(const char *builder, const char *name)
{
    const cJSON *tree = cJSON_GetObjectItem(build_of(rows, builder), "tree");
    return cJSON_GetNumberValue(cJSON_GetObjectItem(tree, name));
}

static void each_is_found_and_nobody_else(void **state)
{
    (void)state;
    const outcome *o =
        run("run --scene soup:n=2000 --plugin " BB_TEST_PLUGIN_DIR "/cheat.so --builder " CHEATS
            " --kernel stack --rays primary --size 16x16 --repeats 5 --no-pictures "
            "--out cheats");
    if (o->exit_status != 1)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = read_results("cheats/results.json");
    rows = cJSON_GetObjectItem(json, "builds");
    expect_remembered("content");
    /* whoever refuses what it has not seen is shown nothing twice */
    expect_status("refuses", "refused", "no memory, it says");
    expect_reason("first", "which it had not seen: ");
    expect_reason("prepared", "which it had not seen: ");
    expect_reason("early", "which it had not seen: ");
    expect_reason("spins", "cheat left a thread at work (");
    expect_reason("late", "cheat left a thread at work (");
    expect_reason("process", "cheat left a process behind in build()");
    expect_reason("boxes", "cheat wrote into the scene's boxes in build()");
    expect_reason("device-boxes", "cheat wrote into the scene's boxes on the device in build()");
    expect_reason("new-boxes", "cheat wrote into the scene's boxes in build()");
    expect_reason("last-boxes", "cheat: gives up");
    expect_ok("cheat");
    expect_ok("lbvh");
    expect_ok("sah");
    expect_ok("embree-native");
    expect_ok("cheat:kind=hides");
    assert_true(bytes_of("cheat:kind=hides", "bytes_unbooked") >= 90e6);
    assert_true(bytes_of("cheat:kind=hides", "bytes_peak") >= 96e6);
    assert_true(isnan(bytes_of("cheat", "bytes_unbooked")));
    expect_ok("cheat:kind=sleeper"); /* its slow build excuses it */
    assert_false(cJSON_IsTrue(cJSON_GetObjectItem(build_of(rows, "cheat"), "remembers")));
    cJSON_Delete(json);
}

/* One that writes into the scene, by turns with others that read it: nobody else is blamed. */
static void who_writes_hurts_nobody(void **state)
{
    (void)state;
    static const char *const kinds[] = {"new-boxes", "last-boxes"};
    static const char *const others[] = {"lbvh",  "sah",  "ploc",   "aac",   "hlbvh",
                                         "lobvh", "sbvh", "bonsai", "hploc", "cheat"};
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        char line[512], file[64];
        snprintf(line, sizeof line,
                 "run --scene soup:n=2000 --plugin " BB_TEST_PLUGIN_DIR
                 "/cheat.so --builder cheat:kind=%s,lbvh,sah,ploc,aac,hlbvh,lobvh,sbvh,bonsai,"
                 "hploc,cheat --kernel stack --rays primary --size 16x16 --repeats 5 "
                 "--no-pictures --out %s",
                 kinds[k], kinds[k]);
        (void)run(line);
        snprintf(file, sizeof file, "%s/results.json", kinds[k]);
        cJSON *json = read_results(file);
        rows = cJSON_GetObjectItem(json, "builds");
        expect_reason(kinds[k], k == 0 ? "wrote into the scene's boxes" : "gives up");
        for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
            expect_ok(others[i]);
        cJSON_Delete(json);
    }
}

/* Whether a builder is said to remember, in one of three runs: where another program takes the
 * processor, its builds of what it has seen take long, too. */
static bool is_found(const char *kind, const outcome **last)
{
    bool found = false;
    for (int i = 0; i < 3 && !found; i++) {
        char builder[64], command[512];
        snprintf(builder, sizeof builder, "cheat:kind=%s", kind);
        snprintf(command, sizeof command,
                 "run --scene soup:n=2000 --plugin " BB_TEST_PLUGIN_DIR "/cheat.so --builder "
                 "%s,lbvh --kernel stack --rays primary --size 16x16 --repeats 5 --no-pictures "
                 "--out one",
                 builder);
        *last = run(command);
        cJSON *json = read_results("one/results.json");
        rows = cJSON_GetObjectItem(json, "builds");
        found = cJSON_IsTrue(cJSON_GetObjectItem(build_of(rows, builder), "remembers"));
        cJSON_Delete(json);
    }
    return found;
}

/* Who builds as it should only now that it is asked. */
static void who_repents_is_found(void **state)
{
    (void)state;
    const outcome *o;
    assert_true(is_found("repents", &o));
}

/* A slow copy excuses it, but does not make it the fastest. */
static void who_remembers_is_not_the_fastest(void **state)
{
    (void)state;
    const outcome *o;
    assert_true(is_found("sleeper", &o));
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    assert_non_null(strstr(o->out, "Not clocked: with each build cheat:kind=sleeper"));
    assert_non_null(strstr(o->out, "Fastest build: lbvh"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_is_found_and_nobody_else),
        cmocka_unit_test(who_writes_hurts_nobody),
        cmocka_unit_test(who_repents_is_found),
        cmocka_unit_test(who_remembers_is_not_the_fastest),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
