/* `bvhbench stress` from outside: a builder that goes wrong beyond 100 primitives, in every manner;
 * what is found of it, what becomes of the run, and that it goes on where it was cut off. All of it
 * only with BVHBENCH_SLOW_TESTS=1. */
#include "framework/table/table.h"
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

static bb_table *read_atlas(void)
{
    char path[600];
    bb_table *atlas;
    snprintf(path, sizeof path, "%s/o/stress.json", folder);
    ASSERT_OK(bb_table_read(path, &atlas));
    return atlas;
}

static bool has_text(const bb_table *atlas, uint32_t row, const char *column, const char *text)
{
    return strcmp(bb_table_get_text(atlas, row, column), text) == 0;
}

/* The row of the one failure in this manner. */
static uint32_t failure_of(const bb_table *atlas, const char *manner)
{
    uint32_t found = BB_NO_ROW;
    for (uint32_t row = 0; row < bb_table_row_count(atlas); row++)
        if (strcmp(bb_table_name(atlas, row, BB_MAKER), manner) == 0)
            found = row;
    if (found == BB_NO_ROW)
        fail_msg("there is no failure '%s': %s", manner, bb_table_json(atlas));
    return found;
}

/* The row of a method at a value: both by their order. */
static uint32_t row_of(const bb_table *atlas, uint32_t value, uint32_t method)
{
    const char *known = "";
    uint32_t values = 0, methods = 0;
    for (uint32_t row = 0; row < bb_table_row_count(atlas); row++) {
        const char *name = bb_table_name(atlas, row, BB_FRAME);
        if (name[0] == '\0')
            continue;
        methods = strcmp(name, known) == 0 ? methods + 1 : 0;
        values += strcmp(name, known) != 0;
        known = name;
        if (values == value + 1 && methods == method)
            return row;
    }
    return BB_NO_ROW;
}

/* What was not measured has no figures: no method has anything but a scene with primitives. */
static bool has_false_zeros(const bb_table *atlas)
{
    for (uint32_t row = 0; row < bb_table_row_count(atlas); row++)
        if (bb_table_get_number(atlas, row, "prims") <= 0)
            return true;
    return false;
}

/* Of the row without names. */
static double of_run(const bb_table *atlas, const char *column)
{
    return bb_table_get_number(atlas, bb_table_find(atlas, (bb_cell){{NULL}}), column);
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
        {"wrong", "failed", "leaf 0 does not contain its primitive"}, /* seen or unseen */
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
        bb_table *atlas = read_atlas();
        const uint32_t t = failure_of(atlas, cases[i].manner);
        assert_true(bb_table_get_number(atlas, t, "at") == 1000 &&
                    bb_table_get_number(atlas, t, "below") == 100);
        assert_int_equal((int)of_run(atlas, "bugs"), cases[i].words != NULL);
        assert_false(has_false_zeros(atlas));
        bb_table_free(atlas);
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
    bb_table *atlas = read_atlas();
    const uint32_t t = failure_of(atlas, "wrong");
    assert_string_equal(bb_table_name(atlas, t, BB_INTERSECTOR), "stack:stack=4");
    bb_table_free(atlas);
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
    bb_table *atlas = read_atlas();
    assert_int_not_equal(row_of(atlas, 1, 1), BB_NO_ROW);
    for (uint32_t value = 0; row_of(atlas, value, 1) != BB_NO_ROW; value++)
        assert_true(has_text(atlas, row_of(atlas, value, 1), "outcome", "ok"));
    bb_table_free(atlas);
}

static void judges_times_twice(void **state)
{
    (void)state;
    start();
    const outcome *o = run(STRESS WRECK "wreck:how=slow,above=500");
    assert_int_equal(o->exit_status, 0);
    bb_table *atlas = read_atlas();
    const uint32_t t = failure_of(atlas, "slow-build");
    assert_true(bb_table_get_number(atlas, t, "below") < 501 &&
                bb_table_get_number(atlas, t, "at") > 500 &&
                bb_table_get_number(atlas, t, "at") < 600);
    bb_table_free(atlas);
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
        bb_table *atlas = read_atlas();
        const uint32_t t = failure_of(atlas, "refused");
        at[i] = bb_table_get_number(atlas, t, "at");
        below[i] = bb_table_get_number(atlas, t, "below");
        bb_table_free(atlas);
    }
    assert_true(below[0] == 100 && at[0] > 100 && at[0] < 110);
    assert_true(at[0] == at[1] && below[0] == below[1]);
}

/* The figures without those of the run itself, which the clock and the date decide. */
static char *without_run(void)
{
    cJSON *atlas = read_json("o/stress.json"), *row;
    for (row = cJSON_GetObjectItem(atlas, "rows")->child; row != NULL;) {
        cJSON *next = row->next;
        if (cJSON_GetObjectItem(row, "revision") != NULL)
            cJSON_Delete(cJSON_DetachItemViaPointer(cJSON_GetObjectItem(atlas, "rows"), row));
        row = next;
    }
    char *all = cJSON_Print(atlas);
    cJSON_Delete(atlas);
    assert_non_null(all);
    return all;
}

/* Killed at some moment, it goes on; finished, it measures nothing again: even the times are the
 * same. */
static void goes_on(void **state)
{
    (void)state;
    start();
    const outcome *o = run(STRESS "--builder lbvh,sah --time 0.3s");
    if (o->exit_status != 0 || strstr(o->err, "--time was over: the same command") == NULL)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    run_with("timeout --signal=KILL 2", STRESS "--builder lbvh,sah");
    o = run(STRESS "--builder lbvh,sah");
    assert_int_equal(o->exit_status, 0);
    assert_null(strstr(o->err, "--time"));
    char *before = without_run();
    o = run(STRESS "--builder lbvh,sah");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "of an earlier run"));
    char *after = without_run();
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
    bb_table *atlas = read_atlas();
    uint32_t kernels = 0, others = 0;
    for (uint32_t row = 0; row < bb_table_row_count(atlas); row++) {
        const char *part = bb_table_get_text(atlas, row, "part");
        kernels += strcmp(part, "kernel") == 0;
        others += part[0] != '\0' && strcmp(part, "kernel") != 0;
    }
    assert_true(kernels > 5);
    assert_int_equal(others, 2);
    for (uint32_t m = 0; m < kernels + others; m++) {
        const uint32_t row = row_of(atlas, 0, m);
        assert_true(has_text(atlas, row, "outcome", "ok"));
        assert_true(bb_table_get_number(atlas, row, "checked") == 1024);
        assert_true(bb_table_get_number(atlas, row, "trace_ms") > 0);
        assert_true(bb_table_get_number(atlas, row, "tests_per_ray") > 0);
        assert_true(isnan(bb_table_get_number(atlas, row, "bytes"))); /* the tree is not theirs */
    }
    bb_table_free(atlas);
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
    bb_table *atlas = read_atlas();
    const uint32_t axis = bb_table_find(atlas, (bb_cell){{[BB_QUESTION] = "growing"}});
    assert_true(bb_table_get_number(atlas, axis, "frames") == 3);
    assert_true(bb_table_get_number(atlas, failure_of(atlas, "rebuilt"), "at") == 0.2);
    for (int value = 0; value < 2; value++)
        for (int m = 0; m < 10; m++) {
            const uint32_t f = row_of(atlas, (uint32_t)value, (uint32_t)m);
            assert_true(has_text(atlas, f, "outcome", m == 3 ? "unsupported" : "ok"));
            if (m == 3)
                continue;
            assert_true(bb_table_get_number(atlas, f, "checked") == 3 * 64 &&
                        bb_table_get_number(atlas, f, "rays") == 2 * 64);
            assert_true(bb_table_get_number(atlas, f, "wrong") == 0 &&
                        bb_table_get_number(atlas, f, "tests_per_ray") > 0);
            assert_true(bb_table_get_number(atlas, f, "prims") == (value == 0 ? 800 : 1040));
            if (m > 3) /* the tree is not its own */
                assert_true(isnan(bb_table_get_number(atlas, f, "build_ms")) &&
                            isnan(bb_table_get_number(atlas, f, "rebuilt")));
            else
                assert_true(bb_table_get_number(atlas, f, "rebuilt") == (m == 0 || value == 1));
        }
    bb_table_free(atlas);
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
    refuses("", "stress --axis crowd.json,crowd.json --out p", "'crowd.json' is given twice");
    refuses("", "stress --axis crowd.json,./crowd.json --out p", "two axes are called crowd");
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
        if (i < QUICK || getenv("BVHBENCH_SLOW_TESTS") != NULL)
            chosen[count++] = tests[i];
    return _cmocka_run_group_tests("stress", chosen, count, make_folder, remove_folder);
}
