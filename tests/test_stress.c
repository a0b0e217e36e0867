/* `bvhbench stress` from outside: a builder that goes wrong beyond 100 primitives, in every manner;
 * what is found of it, what becomes of the run, and that it goes on where it was cut off. All of it
 * only with BVHBENCH_SLOW_TESTS=1, a third of them with BVHBENCH_TEST_PART. */
#include "tests/program_fixture.h"

#include <math.h>
#include <signal.h>

#define WRECK "--plugin " BB_TEST_PLUGIN_DIR "/wreck.so --builder "
#define STRESS "stress --axis crowd.json --limit 20 --memory 1500 --no-pictures --quiet --out o "

static const char *const crowd =
    "{\"name\": \"crowd\", \"title\": \"A crowd\", \"parameter\": \"primitives\", \"why\": \"w\","
    " \"scene\": \"soup:n={x}\", \"rays\": [\"random\"], \"from\": 10, \"to\": 1000,"
    " \"steps\": \"whole\", \"intervals\": 2, \"builder\": \"lbvh\", \"kernel\": \"stack\"}";

static void start(void)
{
    char command[256];
    write_file("crowd.json", crowd, strlen(crowd));
    snprintf(command, sizeof command, "rm -rf %s/o", folder);
    assert_int_equal(system(command), 0);
}

/* The one threshold of this manner. */
static const cJSON *threshold_of(const cJSON *atlas, const char *manner)
{
    const cJSON *axis = cJSON_GetObjectItem(atlas, "axes")->child, *t, *found = NULL;
    cJSON_ArrayForEach(t, cJSON_GetObjectItem(axis, "thresholds"))
    {
        if (strcmp(cJSON_GetStringValue(cJSON_GetObjectItem(t, "manner")), manner) == 0)
            found = t;
    }
    if (found == NULL)
        fail_msg("there is no threshold '%s': %s", manner, cJSON_Print(atlas));
    return found;
}

static double number(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(object, name);
    return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

/* What was not measured has no figures: no method has anything but a scene with primitives. */
static bool has_false_zeros(const cJSON *atlas)
{
    const cJSON *axis, *value, *method;
    cJSON_ArrayForEach(axis, cJSON_GetObjectItem(atlas, "axes"))
        cJSON_ArrayForEach(value, cJSON_GetObjectItem(axis, "values"))
            cJSON_ArrayForEach(method, cJSON_GetObjectItem(value, "methods"))
    {
        const cJSON *prims = cJSON_GetObjectItem(method, "prims");
        if (prims != NULL && !(prims->valuedouble > 0))
            return true;
    }
    return false;
}

static void finds_every_manner(void **state)
{
    (void)state;
    const struct {
        const char *how, *manner, *words; /* on standard error, if it is a bug */
    } cases[] = {
        {"crash", "crashed", "crashes on crowd at 1000: signal 6"},
        {"exit", "crashed", "crashes on crowd at 1000: ended by exit(3)"},
        {"exit0", "crashed", "crashes on crowd at 1000: ended by exit(0)"},
        {"term", "crashed", "crashes on crowd at 1000: signal 15"},
        {"flood", "memory", "beyond the limit of memory on crowd at 1000: killed beyond 1500 MiB"},
        {"wrong", "failed", "fails on crowd at 1000: leaf 0 does not contain its primitive"},
        {"fail", "failed", "fails on crowd at 1000: wreck: it fails, as told"},
        {"refuse", "refused", NULL},
        {"big", "bigger", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char arguments[512];
        start();
        snprintf(arguments, sizeof arguments, STRESS "--quick " WRECK "wreck:how=%s,above=500",
                 cases[i].how);
        const outcome *o = run(arguments);
        if (o->exit_status != (cases[i].words != NULL) ||
            (cases[i].words != NULL && strstr(o->err, cases[i].words) == NULL))
            fail_msg("%s: exit %d\n%s%s", cases[i].how, o->exit_status, o->out, o->err);
        cJSON *atlas = read_results("o/stress.json");
        const cJSON *t = threshold_of(atlas, cases[i].manner);
        assert_true(number(t, "at") == 1000 && number(t, "below") == 100);
        assert_int_equal((int)number(atlas, "bugs"), cases[i].words != NULL);
        assert_false(has_false_zeros(atlas));
        cJSON_Delete(atlas);
    }
}

/* What dies only after many builds in one process, and so never by itself, is a bug all the same.
 */
static void tells_of_mishaps(void **state)
{
    (void)state;
    start();
    const outcome *o = run(STRESS "--quick " WRECK "wreck:how=late,above=5");
    assert_int_equal(o->exit_status, 1);
    assert_non_null(
        strstr(o->err, "crowd: a process with several measurements crashed, from 10 on"));
    assert_non_null(strstr(o->err, "none does so by itself"));
}

/* A stack that is too small answers wrongly, and says so; who is right beside it is not blamed. */
static void blames_who_is_wrong(void **state)
{
    (void)state;
    start();
    const outcome *o = run("stress --axis depth --quick --quiet --no-pictures --out o "
                           "--kernel stack:stack=4,stack8,stack");
    if (o->exit_status != 0 || o->err[0] != '\0')
        fail_msg("exit %d: %s", o->exit_status, o->err);
    assert_non_null(strstr(o->out, "stack overflow caught    stack:stack=4"));
    cJSON *atlas = read_results("o/stress.json");
    const cJSON *t = threshold_of(atlas, "wrong");
    assert_true(number(t, "method") == 0);
    cJSON_Delete(atlas);
}

/* Alone, since it takes its time: what hangs is killed, and the others that were in its process
 * have their figures all the same. */
static void kills_what_hangs(void **state)
{
    (void)state;
    start();
    const outcome *o = run("stress --axis crowd.json --limit 10 --no-pictures --quiet --out o "
                           "--quick " WRECK "wreck:how=hang,above=500,null");
    assert_int_equal(o->exit_status, 1);
    assert_non_null(
        strstr(o->err, "wreck:how=hang,above=500 hangs on crowd at 1000: killed after"));
    assert_null(strstr(o->err, "null"));
    cJSON *atlas = read_results("o/stress.json"), *value;
    cJSON_ArrayForEach(value,
                       cJSON_GetObjectItem(cJSON_GetObjectItem(atlas, "axes")->child, "values"))
    {
        const cJSON *null = cJSON_GetArrayItem(cJSON_GetObjectItem(value, "methods"), 1);
        assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(null, "outcome")), "ok");
    }
    cJSON_Delete(atlas);
}

static void judges_times_twice(void **state)
{
    (void)state;
    start();
    const outcome *o = run(STRESS WRECK "wreck:how=slow,above=500");
    assert_int_equal(o->exit_status, 0);
    cJSON *atlas = read_results("o/stress.json");
    const cJSON *t = threshold_of(atlas, "slow-build");
    assert_true(number(t, "below") < 501 && number(t, "at") > 500 && number(t, "at") < 600);
    cJSON_Delete(atlas);
}

static void bisects_and_repeats(void **state)
{
    (void)state;
    double at[2], below[2];
    for (int i = 0; i < 2; i++) {
        start();
        const outcome *o = run(STRESS WRECK "wreck:how=refuse");
        assert_int_equal(o->exit_status, 0);
        assert_non_null(strstr(o->out, "wreck: more than 100 are too many for it"));
        cJSON *atlas = read_results("o/stress.json");
        const cJSON *t = threshold_of(atlas, "refused");
        at[i] = number(t, "at");
        below[i] = number(t, "below");
        cJSON_Delete(atlas);
    }
    assert_true(below[0] == 100 && at[0] > 100 && at[0] < 110);
    assert_true(at[0] == at[1] && below[0] == below[1]);
}

/* The figures without the times of the run itself. */
static char *without_clock(const char *name)
{
    cJSON *atlas = read_results(name);
    cJSON_DeleteItemFromObject(atlas, "ms");
    cJSON_DeleteItemFromObject(atlas, "context");
    char *text = cJSON_Print(atlas);
    cJSON_Delete(atlas);
    assert_non_null(text);
    return text;
}

/* Killed at some moment, it goes on; finished, it measures nothing again: even the times are the
 * same. */
static void goes_on(void **state)
{
    (void)state;
    start();
    run_with("timeout --signal=KILL 2", STRESS "--builder lbvh,sah");
    const outcome *o = run(STRESS "--builder lbvh,sah");
    assert_int_equal(o->exit_status, 0);
    char *before = without_clock("o/stress.json");
    o = run(STRESS "--builder lbvh,sah");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "of an earlier run"));
    char *after = without_clock("o/stress.json");
    assert_string_equal(before, after);
    /* another seed is another run */
    o = run(STRESS "--builder lbvh,sah --seed 2");
    assert_null(strstr(o->out, "of an earlier run"));
    o = run(STRESS "--builder lbvh,sah --seed 9007199254740992");
    o = run(STRESS "--builder lbvh,sah --seed 9007199254740993"); /* the same as a double */
    assert_null(strstr(o->out, "of an earlier run"));
    /* a file that is cut off is measured again */
    char command[256];
    snprintf(command, sizeof command,
             "cd %s/o/points && for f in crowd-*.json; do head -c 40 $f >x && mv x $f; done",
             folder);
    assert_int_equal(system(command), 0);
    o = run(STRESS "--builder lbvh,sah --seed 2");
    assert_int_equal(o->exit_status, 0);
    assert_null(strstr(o->out, "of an earlier run"));
    cJSON_free(before);
    cJSON_free(after);
}

static void compares_parts(void **state)
{
    (void)state;
    start();
    const outcome *o = run(STRESS "--quick --kernel all --intersector exact,fast");
    assert_int_equal(o->exit_status, 0);
    cJSON *atlas = read_results("o/stress.json"), *method;
    uint32_t kernels = 0, others = 0;
    cJSON_ArrayForEach(method, cJSON_GetObjectItem(atlas, "methods"))
    {
        const char *part = cJSON_GetStringValue(cJSON_GetObjectItem(method, "part"));
        kernels += strcmp(part, "kernel") == 0;
        others += strcmp(part, "kernel") != 0;
    }
    assert_true(kernels > 5);
    assert_int_equal(others, 2);
    const cJSON *value = cJSON_GetObjectItem(cJSON_GetObjectItem(atlas, "axes")->child, "values");
    cJSON_ArrayForEach(method, cJSON_GetObjectItem(value->child, "methods"))
    {
        assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(method, "outcome")), "ok");
        assert_true(number(method, "checked") == 1024 && number(method, "trace_ms") > 0 &&
                    number(method, "tests_per_ray") > 0);
        assert_true(isnan(number(method, "bytes"))); /* the tree is not theirs */
    }
    cJSON_Delete(atlas);
}

static const cJSON *figures_of(const cJSON *atlas, int value, int method)
{
    const cJSON *axis = cJSON_GetObjectItem(atlas, "axes")->child;
    const cJSON *at = cJSON_GetArrayItem(cJSON_GetObjectItem(axis, "values"), value);
    return cJSON_GetArrayItem(cJSON_GetObjectItem(at, "methods"), method);
}

/* Methods go through frames: those that follow a motion are built again where things come and go;
 * each part has its figures, and answers of all frames are judged. */
static void goes_through_frames(void **state)
{
    (void)state;
    const char *const growing =
        "{\"name\": \"growing\", \"title\": \"t\", \"parameter\": \"p\", \"why\": \"w\","
        " \"scene\": \"crowd:kind=grow,n=800,share={x},frames=4,away=1\","
        " \"rays\": [\"random:count=64,near=1\"], \"from\": 0, \"to\": 0.2, \"steps\": \"linear\","
        " \"frames\": 3, \"intervals\": 1, \"builder\": \"lbvh\", \"kernel\": \"stack\"}";
    start();
    write_file("growing.json", growing, strlen(growing));
    const outcome *o = run("stress --axis growing.json --no-pictures --quiet --out o --quick "
                           "--builder lbvh,gs,lbvh+refit,embree-native:quality=low,mode=fast "
                           "--kernel stack8,stackless,short,trail,stack4 --intersector exact");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    assert_non_null(
        strstr(o->out, "no update: built again   gs (from 0.2), lbvh+refit (from 0.2)"));
    cJSON *atlas = read_results("o/stress.json");
    const cJSON *axis = cJSON_GetObjectItem(atlas, "axes")->child;
    assert_int_equal((int)number(axis, "frames"), 3);
    assert_true(number(threshold_of(atlas, "rebuilt"), "at") == 0.2);
    for (int value = 0; value < 2; value++)
        for (int m = 0; m < 10; m++) {
            const cJSON *f = figures_of(atlas, value, m);
            const char *end = cJSON_GetStringValue(cJSON_GetObjectItem(f, "outcome"));
            assert_string_equal(end, m == 3 ? "unsupported" : "ok");
            if (m == 3)
                continue;
            assert_true(number(f, "checked") == 3 * 64 && number(f, "rays") == 2 * 64);
            assert_true(number(f, "wrong") == 0 && number(f, "tests_per_ray") > 0);
            assert_true(number(f, "prims") == (value == 0 ? 800 : 1040));
            if (m > 3) /* the tree is not its own */
                assert_true(isnan(number(f, "build_ms")) && isnan(number(f, "rebuilt")));
            else
                assert_true(number(f, "rebuilt") == (m == 0 || value == 1));
        }
    cJSON_Delete(atlas);
    /* a scene that stays has no frames to go through */
    char text[1024];
    snprintf(text, sizeof text, "%s", growing);
    memcpy(strstr(text, "frames=4"), "frames=2", 8);
    write_file("growing.json", text, strlen(text));
    refuses("", "stress --axis growing.json --out p", "has 2 frames, not the 3 of the axis");
}

static void refuses_what_makes_no_sense(void **state)
{
    (void)state;
    start();
    const char *const broken = "{\"name\": \"crowd\"";
    write_file("broken.json", broken, strlen(broken));
    refuses("", "stress --axis nowhere --out p", "'nowhere' is no axis and no file");
    refuses("", "stress --axis broken.json --out p", "axis broken.json: the file is no JSON");
    refuses("", "stress --axis /dev/zero --out p", "axis");
    refuses("", "stress --axis crowd.json,crowd.json --out p", "two axes are called crowd");
    refuses("", "stress --builder lbvx --out p", "lbvx");
    refuses("", "stress --builder lbvh:bits=65 --axis duplicates --out p", "'65', must be");
    refuses("", "stress --builder lbvh+trbvh:rounds=0 --axis duplicates --out p", "'0', must be");
    refuses("", "stress --kernel stock --out p", "stock");
    refuses("", "stress --intersector exatc --out p", "exatc");
    refuses("", "stress --limit 0 --out p", "--limit");
    refuses("", "stress --memory much --out p", "--memory");
    refuses("", "stress --quick --axis crowd.json --device none-such --out p", "none-such");
    refuses("", "stress --axis crowd.json --out /proc/p", "/proc/p");
    char text[1024];
    snprintf(text, sizeof text, "%s", crowd);
    memcpy(strstr(text, "soup"), "soap", 4);
    write_file("soap.json", text, strlen(text));
    refuses("", "stress --axis soap.json --out p", "axis crowd: 'soap:n=10' is no file");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tells_of_mishaps),    cmocka_unit_test(compares_parts),
        cmocka_unit_test(goes_through_frames), cmocka_unit_test(refuses_what_makes_no_sense),
        cmocka_unit_test(blames_who_is_wrong), cmocka_unit_test(finds_every_manner),
        cmocka_unit_test(judges_times_twice),  cmocka_unit_test(kills_what_hangs),
        cmocka_unit_test(bisects_and_repeats), cmocka_unit_test(goes_on),
    };
    enum { ALL = sizeof tests / sizeof tests[0], QUICK = 4 };
    struct CMUnitTest chosen[ALL];
    size_t count = 0;
    for (size_t i = 0; i < ALL; i++)
        if (i < QUICK || (getenv("BVHBENCH_SLOW_TESTS") != NULL && in_this_part(i)))
            chosen[count++] = tests[i];
    return _cmocka_run_group_tests("stress", chosen, count, make_folder, remove_folder);
}
