/* `run --history` killed at any moment (SIGKILL): the result file is absent or whole, the history
 * is sound, and the next run is appended. BVHBENCH_TEST_KILLS=100 takes minutes. */
#include "tests/program_fixture.h"

#include "framework/base/clock.h"
#include "framework/base/random.h"

#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/stat.h>

static const char common[] = "--scene cube --builder lbvh --kernel stack --rays random:count=64 "
                             "--repeats 1 --no-pictures --charts no --quiet --history bench.db";

/* The number that a query of the history gives, or -1. */
static int ask(const char *sql)
{
    char path[600];
    sqlite3 *db;
    sqlite3_stmt *statement;
    int answer = -1;
    snprintf(path, sizeof path, "%s/bench.db", folder);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    if (sqlite3_prepare_v2(db, sql, -1, &statement, NULL) == SQLITE_OK &&
        sqlite3_step(statement) == SQLITE_ROW)
        answer = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    return answer;
}

static bool exists(const char *name)
{
    char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return access(path, F_OK) == 0;
}

/* The process that writes, not a shell or a guardian that would be killed in its place. */
static pid_t start_run(void)
{
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child > 0)
        return child;
    char command[2000];
    snprintf(command, sizeof command,
             "cd %s && BVHBENCH_GUARD=no exec %s run --out run %s >/dev/null 2>&1", folder,
             BB_TEST_BINARY, common);
    execl("/bin/sh", "sh", "-c", command, (char *)NULL);
    _exit(127);
}

/* Whether it ended by itself before. */
static bool wait_and_kill(pid_t child, double ms, bool from_results, int *kinds)
{
    double start = bb_wall_ms(), at = ms;
    int status;
    bool seen = false;
    for (;;) {
        if (waitpid(child, &status, WNOHANG) == child)
            return true;
        if (from_results && !seen && exists("run/results.json")) {
            seen = true;
            at = bb_wall_ms() - start + ms;
        }
        if ((!from_results || seen) && bb_wall_ms() - start >= at)
            break;
        usleep(200);
    }
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    kinds[exists("run/results.json")]++;
    return false;
}

static void kills_do_no_damage(void **state)
{
    (void)state;
    const char *given = getenv("BVHBENCH_TEST_KILLS");
    const int kills = given != NULL ? atoi(given) : 8;
    bb_random random = bb_random_make(seed_or(17), 0);
    char arguments[1000];
    int killed = 0, hot = 0, kinds[2] = {0, 0};
    snprintf(arguments, sizeof arguments, "run --out run %s", common);
    assert_int_equal(run(arguments)->exit_status, 0); /* compiles */
    double start = bb_wall_ms();
    assert_int_equal(run(arguments)->exit_status, 0);
    const double whole = bb_wall_ms() - start;
    int runs = ask("SELECT count(*) FROM runs");
    assert_int_equal(runs, 2);
    for (int i = 0; killed < kills && i < 3 * kills; i++) {
        /* half of them soon after the results are there, when the history is written */
        bool late = i % 2 == 1;
        assert_int_equal(run_program("", "rm", "-rf run")->exit_status, 0);
        pid_t child = start_run();
        killed += !wait_and_kill(
            child, late ? bb_random_range(&random, 0, 40) : bb_random_range(&random, 0, whole),
            late, kinds);
        hot += exists("bench.db-journal");
        int sound = ask("SELECT integrity_check = 'ok' FROM pragma_integrity_check");
        if (sound != 1)
            fail_msg("kill %d: the history is damaged", i);
        int now = ask("SELECT count(*) FROM runs");
        assert_true(now == runs || now == runs + 1);
        runs = now;
        assert_int_equal(ask("SELECT count(DISTINCT n) FROM (SELECT count(*) AS n FROM measurements"
                             " GROUP BY run)"),
                         1);
        if (exists("run/results.json")) {
            cJSON *results = read_results("run/results.json");
            assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(results, "traces")), 7);
            cJSON_Delete(results);
        }
        if (i % 4 == 3) {
            assert_int_equal(run(arguments)->exit_status, 0);
            assert_int_equal(ask("SELECT count(*) FROM runs"), ++runs);
        }
    }
    print_message("%d killed: %d before there were results, %d after; %d left a journal\n", killed,
                  kinds[0], kinds[1], hot);
    assert_true(killed >= kills / 2);
    assert_int_equal(run(arguments)->exit_status, 0);
    assert_int_equal(ask("SELECT count(*) FROM runs"), runs + 1);
}

static void what_cannot_be_written_is_found_before(void **state)
{
    (void)state;
    static const char base[] = "run --scene nowhere.glb --out never --history";
    char command[200];
    static const char *const cases[][2] = {{"/nowhere/bench.db", "cannot open it"},
                                           {"/dev/full", "disk is full"},
                                           {".", "cannot open it"},
                                           {"/proc/version", "unable to open database file"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        snprintf(command, sizeof command, "%s %s", base, cases[i][0]);
        refuses("", command, cases[i][1]);
        assert_false(exists("never"));
    }
    write_file("notes.txt", "these are notes, and no database at all\n", 40);
    snprintf(command, sizeof command, "%s notes.txt", base);
    refuses("", command, "file is not a database");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kills_do_no_damage),
        cmocka_unit_test(what_cannot_be_written_is_found_before),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
