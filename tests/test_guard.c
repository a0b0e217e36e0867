/* The death of a builder, in each of its hooks and in each manner, costs its row and no other's. */
#include "tests/program_fixture.h"

#include <signal.h>

#define WRECK "--plugin " BB_TEST_PLUGIN_DIR "/wreck.so "
#define SMALL                                                                                      \
    WRECK "--kernel stack --rays primary --size 32x32 --repeats 1 --no-pictures --charts no "      \
          "--out "

static const cJSON *field(const cJSON *row, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(row, name);
}

static bool has(const cJSON *row, const char *name, const char *text)
{
    const char *value = cJSON_GetStringValue(field(row, name));
    return value != NULL && strcmp(value, text) == 0;
}

typedef struct fates {
    int ours_ok, ours_bad, dead, alive; /* builds by lbvh, by wreck */
    char reason[512];                   /* of the last dead */
} fates;

static fates fates_in(const char *file)
{
    fates f = {0};
    const cJSON *build;
    cJSON *json = read_results(file);
    cJSON_ArrayForEach(build, field(json, "builds"))
    {
        const bool ok = has(build, "status", "ok");
        if (has(build, "builder", "lbvh")) {
            f.ours_ok += ok;
            f.ours_bad += !ok;
        } else if (strncmp(cJSON_GetStringValue(field(build, "builder")), "wreck", 5) == 0) {
            f.alive += ok;
            f.dead += !ok;
            if (!ok)
                snprintf(f.reason, sizeof f.reason, "%s",
                         cJSON_GetStringValue(field(build, "reason")));
        }
    }
    cJSON_Delete(json);
    return f;
}

/* `words` must be in the row's reason and on standard error. */
static void dies(const char *how, const char *options, const char *words, int dead)
{
    char arguments[1024];
    snprintf(arguments, sizeof arguments,
             "run --scene sphere-mesh:n=8,cube --builder lbvh,wreck:how=%s " SMALL "died %s", how,
             options);
    const outcome *o = run_with("timeout 60", arguments);
    if (o->exit_status != 1 || strstr(o->err, words) == NULL ||
        strstr(o->err, "; beginning again without it\n") == NULL)
        fail_msg("%s: exit %d: %s", how, o->exit_status, o->err);
    const fates f = fates_in("died/results.json");
    if (f.ours_ok != 2 || f.ours_bad != 0 || f.dead != dead || f.alive != 2 - dead ||
        strstr(f.reason, words) == NULL)
        fail_msg("%s: %d and %d, %d and %d: %s", how, f.ours_ok, f.ours_bad, f.dead, f.alive,
                 f.reason);
}

static void each_hook_may_die(void **state)
{
    (void)state;
    static const char *const hooks[] = {"create", "prepare",  "restore",
                                        "decide", "describe", "destroy"};
    for (size_t i = 0; i < sizeof hooks / sizeof hooks[0]; i++) {
        char how[64], words[64];
        snprintf(how, sizeof how, "%s,at=%s", i % 2 ? "crash" : "exit0", hooks[i]);
        snprintf(words, sizeof words, "wreck died in %s(): ", hooks[i]);
        dies(how, "", words, 2);
    }
}

/* In a scene of more than 100 primitives: the other is measured. */
static void a_build_may_end_in_each_manner(void **state)
{
    (void)state;
    dies("crash", "", "wreck died in build(): signal 6 (Aborted)", 1);
    dies("exit", "", "wreck died in build(): it called exit(3)", 1);
    dies("exit0", "", "wreck died in build(): it called exit(0)", 1);
    dies("overflow", "", "wreck died in build(): signal 11 (Segmentation fault)", 1);
    dies("hang", "--patience 4",
         "wreck died in build(): it had not returned after 4 s (--patience), and was killed", 1);
}

/* What was foretold of all holds for those that are left, too. */
static void a_death_does_not_undo_a_forecast(void **state)
{
    (void)state;
    const outcome *o =
        run("run --scene soup:n=70000 --builder lbvh,wreck:how=crash,above=66000 " WRECK
            "--kernel stack --rays random:count=1000 --no-pictures --charts no --out told "
            "--time 1h");
    if (o->exit_status != 1 || strstr(o->err, "; beginning again without it\n") == NULL ||
        strstr(o->err, "takes about ") == NULL)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    const char *told = strstr(o->err, "soup:n=70000: takes about ");
    assert_true(told != NULL && strstr(told + 1, "soup:n=70000: takes about ") == NULL);
    const fates f = fates_in("told/results.json");
    assert_true(f.ours_ok == 1 && f.dead == 1);
}

static void after_three_scenes_it_is_not_started_again(void **state)
{
    (void)state;
    const outcome *o =
        run("run --scene sphere-mesh:n=8,sphere-mesh:n=9,sphere-mesh:n=10,sphere-"
            "mesh:n=11,sphere-mesh:n=12 --builder lbvh,wreck:how=crash " SMALL "three");
    uint32_t lines = 0;
    for (const char *at = o->err; (at = strstr(at, "beginning again")) != NULL; at++)
        lines++;
    assert_int_equal(lines, 3);
    const fates f = fates_in("three/results.json");
    assert_int_equal(f.dead, 5);
    assert_int_equal(f.ours_ok, 5);
}

static void other_commands_go_on_too(void **state)
{
    (void)state;
    const outcome *o = run("animate --scene twist:n=500,frames=3 --builder lbvh,wreck:how=crash "
                           "--size 32x32 --max-rays 1000 --repeats 1 --quiet " WRECK);
    if (o->exit_status != 1 || strstr(o->err, "beginning again") == NULL ||
        strstr(o->out, "lbvh") == NULL)
        fail_msg("animate: exit %d: %s%s", o->exit_status, o->err, o->out);
    o = run("advise --scene sphere-mesh:n=8 --quick --quiet --builder lbvh,wreck:how=exit0 " WRECK);
    if (o->exit_status != 1 || strstr(o->err, "beginning again") == NULL ||
        strstr(o->out, "lbvh") == NULL)
        fail_msg("advise: exit %d: %s%s", o->exit_status, o->err, o->out);
}

/* Hangs one of two kernels: the other is traced by. */
static void a_kernel_that_hangs_costs_its_cells(void **state)
{
    (void)state;
    char command[1024];
    snprintf(
        command, sizeof command,
        "mkdir -p %s/kernels && sed 's/bb_trail_start(.*;/& for (volatile int spin = 0; spin == "
        "0;) ;/' " BB_TEST_SOURCE_DIR "/kernels/short.cl >%s/kernels/short.cl",
        folder, folder);
    assert_int_equal(system(command), 0);
    const outcome *o =
        run_with("timeout 120", "run --scene cube --builder lbvh --kernel stack,short --rays "
                                "primary --size 32x32 --repeats 1 --no-pictures --charts no --out "
                                "hung --kernels-from kernels --patience 3");
    if (o->exit_status != 1 || strstr(o->err, "short on lbvh died in ") == NULL)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    const cJSON *trace;
    int right = 0, hung = 0;
    cJSON *json = read_results("hung/results.json");
    cJSON_ArrayForEach(trace, field(json, "traces"))
    {
        right += has(trace, "kernel", "stack") && has(trace, "status", "ok");
        hung += has(trace, "kernel", "short") && has(trace, "status", "failed");
    }
    cJSON_Delete(json);
    assert_true(right > 0 && hung > 0);
}

static void says(const char *arguments, int exit_status, const char *words)
{
    const outcome *o = run(arguments);
    if (o->exit_status != exit_status || strcmp(o->err, words) != 0)
        fail_msg("%s: exit %d: %s", arguments, o->exit_status, o->err);
}

/* What does nothing without the builder is not begun again. */
static void a_command_that_cannot_go_on_says_who_died(void **state)
{
    (void)state;
    static const char words[] =
        "bvhbench: sphere-mesh:n=8: wreck:how=exit0: wreck died in build(): it called exit(0)\n";
    says("render --scene sphere-mesh:n=8 --builder wreck:how=exit0 --out died.png " WRECK, 1,
         words);
}

static uint32_t lines_with(const char *text, const char *words)
{
    uint32_t count = 0;
    while ((text = strstr(text, words)) != NULL) {
        text += strlen(words);
        count++;
    }
    return count;
}

/* It prints as it goes: each line once, whatever was done again. */
static void a_check_goes_on_without_who_died(void **state)
{
    (void)state;
    const outcome *o = run(
        "check --scene sphere-mesh:n=8 --scene sphere-mesh:n=7 --builder lbvh,wreck:how=exit0,sah "
        "--quiet --side 6 " WRECK);
    assert_int_equal(o->exit_status, 1);
    if (lines_with(o->out, "\nok ") != 4 || lines_with(o->out, "\nFAILED ") != 2 ||
        lines_with(o->out, "wreck died in build(): it called exit(0)") != 2 ||
        strstr(o->out, "builders: 3, scenes: 2; 6 trees checked, 2 checks failed") == NULL)
        fail_msg("%s%s", o->out, o->err);
}

static void a_constructor_that_ends_the_program_is_refused(void **state)
{
    (void)state;
    static const char words[] =
        "bvhbench: " BB_TEST_PLUGIN_DIR "/deadly.so died in dlopen(): it called exit(0)\n";
    says("list builders --plugin " BB_TEST_PLUGIN_DIR "/deadly.so", 2, words);
    says("run --scene cube --out deadly --plugin " BB_TEST_PLUGIN_DIR "/deadly.so", 2, words);
}

/* Nobody knows whose thread it was: the row of the last hook is suspected. Builders are tried
 * before the scene is loaded, which takes longer than the thread lives. */
static void a_death_outside_of_hooks_costs_the_suspect(void **state)
{
    (void)state;
    const outcome *o = run(
        "run --scene hairball:n=100000 --builder lbvh,wreck:how=beside,at=destroy " SMALL "beside");
    if (o->exit_status != 1 || strstr(o->err, "; the last hook was destroy() of wreck") == NULL ||
        strstr(o->err, "; beginning again without it\n") == NULL)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    const fates f = fates_in("beside/results.json");
    if (f.dead != 1 || f.ours_ok != 1 || strstr(f.reason, "is suspected") == NULL)
        fail_msg("%d and %d: %s", f.ours_ok, f.dead, f.reason);
}

/* Whatever a plug-in does when the program ends, and whichever signal it uses. */
static void the_exit_status_is_ours(void **state)
{
    (void)state;
    const outcome *o = run("run --scene sphere-mesh:n=8 --builder "
                           "wreck:how=fail,wreck:how=atexit,at=create " SMALL "late");
    assert_int_equal(o->exit_status, 1);
    dies("sigpipe", "", "wreck died in build(): signal 13 (Broken pipe)", 1);
}

static void who_is_killed_at_a_limit_of_time_lacks_no_memory(void **state)
{
    (void)state;
    static const char arguments[] = "check --scene sphere-mesh:n=8 --builder wreck:how=%s --quiet "
                                    "--side 6 " WRECK;
    static const char *const cases[][3] = {
        {"ulimit -S -t 1000;", "xcpu",
         "limit exceeded), at the limit of 1000 s of CPU time (ulimit"},
        {"ulimit -t 1;", "spin", "(Killed), at the limit of 1 s of CPU time (ulimit -t);"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[512];
        snprintf(text, sizeof text, arguments, cases[i][1]);
        const outcome *o = run_with(cases[i][0], text);
        if (o->exit_status == 0 || strstr(o->err, cases[i][2]) == NULL)
            fail_msg("%s: exit %d: %s", text, o->exit_status, o->err);
    }
}

/* A shell's own children, if it has become this program, are left alone. */
static void nothing_that_a_hook_started_survives_it(void **state)
{
    (void)state;
    char text[32];
    run_program("{ sleep 600 >/dev/null 2>&1 & }; echo $! >other.pid; exec", BB_TEST_PROGRAM,
                "check --scene sphere-mesh:n=8 --builder wreck:how=orphan --quiet " WRECK);
    read_file("orphan.pid", text, sizeof text);
    assert_true(atoi(text) > 0);
    assert_int_not_equal(kill((pid_t)atoi(text), 0), 0);
    read_file("other.pid", text, sizeof text);
    assert_int_equal(kill((pid_t)atoi(text), SIGTERM), 0);
}

static void without_a_guard_the_death_is_its_own(void **state)
{
    (void)state;
    const outcome *o = run_with("BVHBENCH_GUARD=no", "run --scene sphere-mesh:n=8 --builder "
                                                     "wreck:how=exit " SMALL "unguarded");
    assert_int_equal(o->exit_status, 3);
    assert_null(strstr(o->err, "died"));
}

/* ---- signals ---- */

static pid_t start_long_run(void)
{
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (chdir(folder) != 0 || freopen("long.err", "w", stderr) == NULL ||
            freopen("long.out", "w", stdout) == NULL)
            _exit(99);
        execl(BB_TEST_BINARY, BB_TEST_BINARY, "run", "--scene", "cube", "--builder", "lbvh",
              "--kernel", "stack", "--rays", "primary", "--repeats", "255", "--size", "512x512",
              "--no-pictures", "--charts", "no", "--out", "long", (char *)NULL);
        _exit(99);
    }
    return child;
}

/* Returns the process that works for the guardian, once it is there. */
static pid_t worker_of(pid_t guardian)
{
    char path[64];
    long worker = 0;
    snprintf(path, sizeof path, "/proc/%ld/task/%ld/children", (long)guardian, (long)guardian);
    for (int i = 0; i < 500 && worker == 0; i++) {
        FILE *file = fopen(path, "r");
        if (file != NULL && fscanf(file, "%ld", &worker) != 1)
            worker = 0;
        if (file != NULL)
            fclose(file);
        usleep(10000);
    }
    assert_true(worker > 0);
    return (pid_t)worker;
}

/* Returns the letter of the state in /proc/PID/stat; 0: there is no such process. */
static char state_of(pid_t process)
{
    char path[64], letter = 0;
    snprintf(path, sizeof path, "/proc/%ld/stat", (long)process);
    FILE *file = fopen(path, "r");
    if (file != NULL && fscanf(file, "%*d %*s %c", &letter) != 1)
        letter = 0;
    if (file != NULL)
        fclose(file);
    return letter;
}

/* Waits until the process has one of these states; a dead one has 'Z' or 0. */
static void wait_for(pid_t process, const char *states)
{
    const bool gone = strchr(states, 'Z') != NULL;
    char now = 0;
    for (int i = 0; i < 1000; i++) {
        now = state_of(process);
        if (now == 0 ? gone : strchr(states, now) != NULL)
            return;
        usleep(10000);
    }
    fail_msg("process %ld is in state '%c', not in one of %s", (long)process, now, states);
}

static void both_stop_and_go_on_together(void **state)
{
    (void)state;
    int status;
    const pid_t guardian = start_long_run(), worker = worker_of(guardian);
    usleep(300000);
    kill(guardian, SIGTSTP);
    wait_for(worker, "T");
    wait_for(guardian, "T");
    kill(guardian, SIGCONT);
    wait_for(worker, "RSD");
    kill(guardian, SIGINT);
    waitpid(guardian, &status, 0);
    assert_true(WIFEXITED(status) ? WEXITSTATUS(status) == 130 : WTERMSIG(status) == SIGINT);
}

static void nobody_works_on_without_its_guardian(void **state)
{
    (void)state;
    int status;
    const pid_t guardian = start_long_run(), worker = worker_of(guardian);
    usleep(300000);
    kill(guardian, SIGKILL);
    waitpid(guardian, &status, 0);
    wait_for(worker, "Z");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_hook_may_die),
        cmocka_unit_test(a_build_may_end_in_each_manner),
        cmocka_unit_test(a_death_does_not_undo_a_forecast),
        cmocka_unit_test(after_three_scenes_it_is_not_started_again),
        cmocka_unit_test(other_commands_go_on_too),
        cmocka_unit_test(a_kernel_that_hangs_costs_its_cells),
        cmocka_unit_test(a_check_goes_on_without_who_died),
        cmocka_unit_test(a_command_that_cannot_go_on_says_who_died),
        cmocka_unit_test(a_constructor_that_ends_the_program_is_refused),
        cmocka_unit_test(a_death_outside_of_hooks_costs_the_suspect),
        cmocka_unit_test(the_exit_status_is_ours),
        cmocka_unit_test(who_is_killed_at_a_limit_of_time_lacks_no_memory),
        cmocka_unit_test(nothing_that_a_hook_started_survives_it),
        cmocka_unit_test(without_a_guard_the_death_is_its_own),
        cmocka_unit_test(both_stop_and_go_on_together),
        cmocka_unit_test(nobody_works_on_without_its_guardian),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
