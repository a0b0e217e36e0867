/* The history: what is appended comes back, after whatever death. */
#include "tests/history_sample.h"

#include "framework/compare/history_private.h"
#include "framework/compare/schema.h"
#include "framework/compare/trend.h"
#include "framework/report/report_history.h"

#include <signal.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

static const history_change nothing = {-1, -1, -1};

/* Of a file that is not there yet. */
static const char *history_path(const char *test)
{
    static char path[600];
    char name[80];
    snprintf(name, sizeof name, "history_%s", test);
    snprintf(path, sizeof path, "%s/bench.db", sample_folder(name));
    char journal[620];
    snprintf(journal, sizeof journal, "%s-journal", path);
    unlink(path);
    unlink(journal);
    return path;
}

static void execute(const char *path, const char *sql)
{
    sqlite3 *db;
    char *error = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    if (sqlite3_exec(db, sql, NULL, NULL, &error) != SQLITE_OK)
        fail_msg("%s: %s", sql, error);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

/* The first column of the first row, as text. */
static const char *ask(const char *path, const char *sql)
{
    static char answer[400];
    sqlite3 *db;
    sqlite3_stmt *statement;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &statement, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(statement), SQLITE_ROW);
    snprintf(answer, sizeof answer, "%s", (const char *)sqlite3_column_text(statement, 0));
    sqlite3_finalize(statement);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    return answer;
}

/* One line that holds `words`. */
static void refuses_to_open(const char *path, const char *words)
{
    for (int create = 0; create < 2; create++) {
        bb_history *history = NULL;
        bb_status status = bb_history_open(path, create, &history);
        if (status == BB_OK || history != NULL || strstr(bb_message(), words) == NULL ||
            strchr(bb_message(), '\n') != NULL)
            fail_msg("%s: '%s', expected '%s'", path, bb_message(), words);
    }
}

static void what_is_appended_comes_back(void **state)
{
    (void)state;
    const char *path = history_path("roundtrip");
    bb_results *results = history_run("feed123", "here", "2024-05-06T07:08:09Z", nothing, 9);
    bb_history *history;
    bb_history_entry entry;
    bb_cell_set wanted, found;
    uint32_t others;
    ASSERT_OK(bb_results_set_number(results, BB_F_CONTEXT_OTHERS, 3));
    ASSERT_OK(bb_cell_set_of_table(bb_results_table(results), "it", &wanted));
    ASSERT_OK(bb_history_open(path, true, &history));
    ASSERT_OK(bb_history_append(history, bb_results_table(results)));
    ASSERT_OK(bb_history_find(history, "feed", NULL, &entry, &others));
    ASSERT_OK(bb_history_set(history, &entry, &found));
    assert_int_equal(found.count, wanted.count);
    assert_true(wanted.count > 200);
    uint32_t figures = 0;
    for (uint32_t i = 0; i < wanted.count; i++) {
        const bb_measured *a = &wanted.cells[i], *b = &found.cells[i];
        assert_string_equal(a->key, b->key);
        assert_string_equal(a->status, b->status);
        assert_string_equal(a->scene_hash, b->scene_hash);
        assert_string_equal(a->rays_hash, b->rays_hash);
        assert_string_equal(a->time, b->time);
        assert_int_equal(a->reference, b->reference);
        assert_int_equal(a->ms.count, b->ms.count);
        assert_memory_equal(a->ms.values, b->ms.values, a->ms.count * sizeof(double));
        assert_int_equal(a->figure_count, b->figure_count);
        for (uint32_t k = 0; k < a->figure_count; k++)
            assert_true(bb_measured_figure(b, a->figures[k].name) == a->figures[k].value);
        figures += a->figure_count;
    }
    assert_true(figures > 1000);
    assert_string_equal(found.origin.host, "here");
    assert_string_equal(found.origin.date, "2024-05-06T07:08:09Z");
    assert_string_equal(found.origin.device, wanted.origin.device);
    assert_string_equal(found.origin.device_type, "CPU");
    assert_string_equal(found.origin.seed, "1234567890123456789");
    assert_string_equal(found.origin.governor, "performance");
    assert_string_equal(found.origin.smt, "off");
    assert_string_equal(found.origin.boost, "off");
    assert_string_equal(found.origin.processors, "all");
    assert_true(found.origin.busy == 0.75);
    bb_history_close(history);
    bb_cell_set_free(&wanted);
    bb_cell_set_free(&found);
    bb_results_destroy(results);
    assert_string_equal(ask(path, "PRAGMA journal_mode"), "delete");
}

static void empty_files_become_histories(void **state)
{
    (void)state;
    const char *path = history_path("empty");
    bb_history *history;
    refuses_to_open("/nowhere/bench.db", "unable to open");
    bb_status status = bb_history_open(path, false, &history);
    assert_int_equal(status, BB_INVALID);
    assert_int_not_equal(access(path, F_OK), 0);
    fclose(fopen(path, "w"));
    ASSERT_OK(bb_history_open(path, false, &history));
    bb_history_close(history);
    assert_string_equal(ask(path, "PRAGMA user_version"), "5");
    assert_string_equal(ask(path, "PRAGMA application_id"), "1112950850");
}

static void what_is_no_history_is_refused(void **state)
{
    (void)state;
    const char *path = history_path("newer");
    history_add(path, "a", "north", "2024-01-01T00:00:00Z", nothing, 1);
    execute(path, "PRAGMA user_version=6");
    refuses_to_open(path, "is of version 6, this program reads 5: name another file");
    execute(path, "PRAGMA user_version=4");
    refuses_to_open(path, "is of version 4, this program reads 5: name another file");
    assert_string_equal(ask(path, "SELECT count(*) FROM runs"), "1");
    execute(path, "PRAGMA user_version=0; PRAGMA application_id=0"); /* as .dump leaves it */
    refuses_to_open(path, "PRAGMA application_id=1112950850; PRAGMA user_version=5");
    execute(path, "PRAGMA application_id=1112950850; PRAGMA user_version=5");
    history_add(path, "b", "north", "2024-01-02T00:00:00Z", nothing, 2);
    path = history_path("foreign");
    execute(path, "CREATE TABLE bookmarks(url)");
    refuses_to_open(path, "another program's database");
    assert_string_equal(ask(path, "SELECT count(*) FROM sqlite_master"), "1");
    path = history_path("text");
    FILE *file = fopen(path, "w");
    for (int i = 0; i < 200; i++)
        fputs("date,revision,median\n", file);
    fclose(file);
    refuses_to_open(path, "not a database");
    refuses_to_open("/tmp", "unable to open");
    refuses_to_open("", "history '' is not a file");
    refuses_to_open(":memory:", "history ':memory:' is not a file");
    refuses_to_open("file:runs?mode=memory", "is not a file");
}

/* Whatever could change what is appended: nothing is written into such a file. */
static void a_history_of_other_parts_is_refused(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"CREATE TRIGGER gone AFTER INSERT ON runs BEGIN DELETE FROM runs; END",
         "its trigger gone is not this program's"},
        {"CREATE VIEW seen AS SELECT * FROM runs", "its view seen is not this program's"},
        {"CREATE TABLE more(x)", "its table more is not this program's"},
        {"ALTER TABLE cells ADD COLUMN note", "its table cells is not this program's"},
        {"DROP INDEX measurements_cell", "its index measurements_cell is missing from"},
        {"DROP TABLE floors", "its table floors is missing from"},
        {"ALTER TABLE measurements RENAME TO kept;"
         "CREATE VIEW measurements AS SELECT * FROM kept",
         "is not this program's"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *path = history_path("parts");
        history_fill(path);
        execute(path, "ANALYZE"); /* SQLite's own tables are no harm */
        bb_history *history;
        ASSERT_OK(bb_history_open(path, true, &history));
        bb_history_close(history);
        execute(path, cases[i][0]);
        refuses_to_open(path, cases[i][1]);
    }
}

/* A page in the middle, which no query of a new run would read. */
static void damage_anywhere_is_found_at_once(void **state)
{
    (void)state;
    const char *path = history_path("page");
    history_fill(path);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    const long pages = ftell(file) / 4096;
    assert_true(pages > 8);
    assert_int_equal(fseek(file, (pages - 2) * 4096, SEEK_SET), 0);
    for (int i = 0; i < 4096; i++)
        fputc(0x5A, file);
    fclose(file);
    refuses_to_open(path, "is damaged: ");
}

/* A trigger of the connection, which is in no file, stands for a disk that forgets. */
static void what_was_appended_is_read_back(void **state)
{
    (void)state;
    static const char *const triggers[] = {
        "CREATE TEMP TRIGGER t AFTER INSERT ON figures BEGIN DELETE FROM figures; END",
        "CREATE TEMP TRIGGER t AFTER INSERT ON measurements BEGIN UPDATE measurements SET "
        "samples = '[1]'; END",
        "CREATE TEMP TRIGGER t AFTER INSERT ON measurements WHEN new.id % 3 = 0 BEGIN UPDATE "
        "measurements SET samples = NULL WHERE id = new.id; END",
    };
    for (size_t i = 0; i < sizeof triggers / sizeof triggers[0]; i++) {
        const char *path = history_path("forgets");
        bb_history *history;
        bb_results *run = history_run("a", "north", "2024-01-01T00:00:00Z", nothing, 1);
        ASSERT_OK(bb_history_open(path, true, &history));
        assert_int_equal(sqlite3_exec(history->db, triggers[i], NULL, NULL, NULL), SQLITE_OK);
        assert_int_equal(bb_history_append(history, bb_results_table(run)), BB_FAILED);
        if (strstr(bb_message(), "does not read back") == NULL)
            fail_msg("%s: %s", triggers[i], bb_message());
        bb_history_close(history);
        bb_results_destroy(run);
        assert_string_equal(ask(path, "SELECT count(*) FROM runs"), "0");
    }
}

/* Cut off, overwritten in the middle, and with samples that are none: a line, not a crash. */
static void damaged_files_are_refused(void **state)
{
    (void)state;
    const char *path = history_path("damaged");
    history_fill(path);
    execute(path, "UPDATE measurements SET samples = '[1,2,' WHERE id = 30");
    bb_history *history;
    bb_trend *trends;
    uint32_t count;
    ASSERT_OK(bb_history_open(path, false, &history));
    assert_int_equal(bb_history_trends(history, &trends, &count), BB_INVALID);
    assert_non_null(strstr(bb_message(), "are no list of times"));
    bb_trends_free(trends, count);
    bb_history_close(history);
    static const char *const others[] = {"[-1]", "nan", "[1,nan]", "[]", "[1,2] ", "[1;2]", "[,]"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        char sql[200];
        snprintf(sql, sizeof sql, "UPDATE measurements SET samples = '%s' WHERE id = 30",
                 others[i]);
        execute(path, sql);
        ASSERT_OK(bb_history_open(path, false, &history));
        if (bb_history_trends(history, &trends, &count) != BB_INVALID)
            fail_msg("%s is taken", others[i]);
        bb_trends_free(trends, count);
        bb_history_close(history);
    }
    for (long size = 40000; size > 100; size /= 3) {
        assert_int_equal(truncate(path, size), 0);
        bb_status status = bb_history_open(path, false, &history);
        if (status == BB_OK)
            status = bb_history_trends(history, &trends, &count);
        assert_int_not_equal(status, BB_OK);
        if (history != NULL)
            bb_trends_free(trends, count);
        bb_history_close(history);
    }
}

static void revisions_are_found_by_their_beginnings(void **state)
{
    (void)state;
    const char *path = history_path("revisions");
    bb_history *history;
    bb_history_entry entry;
    uint32_t others;
    history_fill(path);
    ASSERT_OK(bb_history_open(path, false, &history));
    static const char *const found[][2] = {{"aaaa111111111", "aaaa111111111"},
                                           {"c", "cccc333333333"},
                                           {"abab", "abab222222222"},
                                           {"dddd4444444449876543210", "dddd444444444"}};
    for (size_t i = 0; i < sizeof found / sizeof found[0]; i++) {
        ASSERT_OK(bb_history_find(history, found[i][0], NULL, &entry, &others));
        assert_string_equal(entry.origin.revision, found[i][1]);
        assert_int_equal(others, 0);
    }
    static const char *const not_found[][2] = {
        {"a", "'a' is aaaa111111111 or abab222222222: write more"},
        {"f", "has no revision 'f': its latest is eeee555555555"},
        {"dddd5", "has no revision"},
        {"", "an empty revision"}};
    for (size_t i = 0; i < sizeof not_found / sizeof not_found[0]; i++) {
        assert_int_equal(bb_history_find(history, not_found[i][0], NULL, &entry, &others),
                         BB_INVALID);
        if (strstr(bb_message(), not_found[i][1]) == NULL)
            fail_msg("'%s': %s", not_found[i][0], bb_message());
    }
    /* of two machines the latest, or the one that is asked for */
    ASSERT_OK(bb_history_find(history, "eeee", NULL, &entry, &others));
    assert_string_equal(entry.origin.host, "south");
    assert_int_equal(others, 1);
    bb_origin like = entry.origin;
    strcpy(like.host, "north");
    ASSERT_OK(bb_history_find(history, "eeee", &like, &entry, &others));
    assert_string_equal(entry.origin.host, "north");
    ASSERT_OK(bb_history_find(history, "aaaa", NULL, &entry, &others));
    assert_int_equal(entry.runs, 2);
    bb_history_close(history);
}

static const bb_change *only_move(const bb_comparison_result *step, bb_change_verdict verdict)
{
    const bb_change *found = NULL;
    for (uint32_t i = 0; i < step->move_count; i++) {
        if (step->moves[i].verdict != verdict)
            continue;
        if (found != NULL)
            fail_msg("%s and %s moved", found->after->key, step->moves[i].after->key);
        found = &step->moves[i];
    }
    return found;
}

/* Marks stand at the revisions that moved a cell, and nowhere else. */
static void trends_mark_what_moved(void **state)
{
    (void)state;
    const char *path = history_path("trend");
    bb_history *history;
    bb_trend *trends;
    uint32_t count;
    history_fill(path);
    ASSERT_OK(bb_history_open(path, false, &history));
    ASSERT_OK(bb_history_trends(history, &trends, &count));
    assert_int_equal(count, 2);
    assert_string_equal(trends[0].entries[0].origin.host, "south");
    const bb_trend *north = &trends[1];
    assert_int_equal(north->count, 5);
    assert_true(north->floor.share >= 0.01 && north->floor.share < 0.02);
    assert_non_null(strstr(north->floor.from, "between runs of one revision"));
    assert_true(isnan(trends[0].floor.share));
    assert_int_equal(north->steps[0].move_count + north->steps[1].move_count, 0);
    const bb_change *slow = only_move(&north->steps[2], BB_WORSE);
    assert_non_null(slow);
    assert_string_equal(slow->what, "trace ms");
    ASSERT_NEAR(slow->effect.ratio, 1.3, 0.03);
    const bb_change *sah = only_move(&north->steps[3], BB_WORSE);
    assert_non_null(sah);
    assert_string_equal(sah->what, "sah");
    const bb_change *fast = only_move(&north->steps[4], BB_BETTER);
    assert_non_null(fast);
    ASSERT_NEAR(fast->effect.ratio, 0.7, 0.03);
    assert_int_equal(north->steps[4].worse, 0);
    bb_trends_free(trends, count);

    /* a run of few cells in between hides nothing: each cell is compared with its own last */
    execute(path, "DELETE FROM measurements WHERE run = 3 AND cell % 2 = 0");
    ASSERT_OK(bb_history_trends(history, &trends, &count));
    assert_non_null(only_move(&trends[1].steps[2], BB_WORSE));
    assert_int_equal(trends[1].steps[2].only_after, 0);
    bb_trends_free(trends, count);
    bb_history_close(history);
}

/* A machine with two devices has two histories: no trend, floor or look-up mixes them. */
static void devices_are_told_apart(void **state)
{
    (void)state;
    static const history_change slower = {SLOW_TRACE, -1, WORSE_SAH};
    const char *path = history_path("devices");
    bb_history *history;
    bb_trend *trends;
    bb_history_entry card, other;
    uint32_t count, others;
    for (int i = 0; i < 4; i++) /* the card is worse than the processor, and does not change */
        history_add(path, i < 2 ? "aaaa" : "bbbb", "north", "2024-01-01T00:00:00Z",
                    i % 2 == 0 ? nothing : slower, 1);
    execute(path, "UPDATE runs SET device = 'a card', device_type = 'GPU' WHERE id % 2 = 0");
    ASSERT_OK(bb_history_open(path, false, &history));
    ASSERT_OK(bb_history_trends(history, &trends, &count));
    assert_int_equal(count, 2);
    for (uint32_t t = 0; t < count; t++) {
        assert_int_equal(trends[t].count, 2);
        assert_int_equal(trends[t].steps[1].move_count, 0);
        assert_true(trends[t].steps[1].common > 0);
    }
    assert_string_equal(trends[0].entries[0].origin.device_type, "GPU");
    bb_trends_free(trends, count);
    ASSERT_OK(bb_history_find(history, "bbbb", NULL, &card, &others));
    assert_string_equal(card.origin.device, "a card");
    ASSERT_OK(bb_history_find(history, "aaaa", &card.origin, &other, &others));
    assert_string_equal(other.origin.device, "a card");
    assert_int_equal(others, 1);
    bb_history_close(history);
}

/* Origin and labels are those of the latest run, whatever order the rows are in. */
static void an_entry_is_its_latest_run(void **state)
{
    (void)state;
    const char *path = history_path("latest");
    bb_history *history;
    bb_history_entry *entries;
    uint32_t count;
    history_add(path, "bbbb", "north", "2024-01-01T00:00:00Z", nothing, 1);
    history_add(path, "aaaa", "north", "2024-01-02T00:00:00Z", nothing, 2);
    history_add(path, "bbbb", "north", "2024-01-03T00:00:00Z", nothing, 3);
    execute(path, "UPDATE runs SET interrupted = 1, seed = '5', shard = '1/2', busy = 0.5,"
                  " boost = 'on' WHERE id = 1;"
                  "UPDATE runs SET seed = '7', embree = 'late' WHERE id = 3");
    ASSERT_OK(bb_history_open(path, false, &history));
    ASSERT_OK(bb_history_list(history, &entries, &count));
    assert_int_equal(count, 2);
    assert_string_equal(entries[0].origin.revision, "bbbb"); /* its first run is the oldest */
    assert_string_equal(entries[0].origin.date, "2024-01-03T00:00:00Z");
    assert_string_equal(entries[0].origin.seed, "7");
    assert_string_equal(entries[0].origin.embree, "late");
    assert_string_equal(entries[0].origin.shard, "");
    assert_string_equal(entries[0].origin.boost, "off");
    assert_true(entries[0].origin.busy == 0.5); /* some of its cells may be of that run */
    assert_false(entries[0].origin.interrupted);
    assert_int_equal(entries[0].last, 3);
    assert_int_equal(entries[0].runs, 2);
    free(entries);
    bb_history_close(history);
}

/* Keys that earlier programs spelled otherwise, and that stand before today's: the latest run's
 * cells count, each once. */
static void spellings_of_a_key_are_one_cell(void **state)
{
    (void)state;
    const char *path = history_path("spellings");
    bb_history *history;
    bb_history_entry entry;
    bb_cell_set kept, latest;
    uint32_t others;
    for (uint64_t run = 1; run <= 3; run++) {
        history_add(path, "bbbb", "north", "2024-01-01T00:00:00Z", nothing, run);
        if (run < 3)
            execute(path, run == 1
                              ? "UPDATE cells SET key = replace(key, 'group=64', 'group=064')"
                              : "UPDATE cells SET key = replace(key, 'group=64', 'group=0064')");
    }
    bb_results *results = history_run("bbbb", "north", "2024-01-01T00:00:00Z", nothing, 3);
    ASSERT_OK(bb_cell_set_of_table(bb_results_table(results), "it", &latest));
    ASSERT_OK(bb_history_open(path, false, &history));
    ASSERT_OK(bb_history_find(history, "bbbb", NULL, &entry, &others));
    ASSERT_OK(bb_history_set(history, &entry, &kept));
    assert_int_equal(kept.count, latest.count);
    assert_int_equal(kept.duplicates, 0);
    for (uint32_t i = 0; i < kept.count; i++) {
        const bb_measured *a = &kept.cells[i], *b = &latest.cells[i];
        assert_string_equal(a->key, b->key);
        assert_int_equal(a->ms.count, b->ms.count);
        assert_memory_equal(a->ms.values, b->ms.values, a->ms.count * sizeof *a->ms.values);
    }
    bb_cell_set_free(&kept);
    bb_cell_set_free(&latest);
    bb_history_close(history);
    bb_results_destroy(results);
}

/* Two runs of a revision are evidence of one program only if the revision says which. */
static void unclear_revisions_make_no_floor(void **state)
{
    (void)state;
    static const struct {
        const char *revision;
        bool floor;
    } cases[] = {{"", false}, {"aaaa-dirty", false}, {"aaaa", true}};
    const char *path = history_path("unclear");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_history *history;
        bb_history_entry *entries;
        uint32_t count;
        bb_floor floor;
        unlink(path);
        history_add(path, cases[i].revision, "north", "2024-01-01T00:00:00Z", nothing, 1);
        history_add(path, cases[i].revision, "north", "2024-01-02T00:00:00Z", nothing, 2);
        ASSERT_OK(bb_history_open(path, false, &history));
        ASSERT_OK(bb_history_list(history, &entries, &count));
        ASSERT_OK(bb_history_floor(history, &entries[0].origin, &floor));
        assert_int_equal(isfinite(floor.share) != 0, cases[i].floor);
        bb_floor_free(&floor);
        free(entries);
        bb_history_close(history);
    }
}

/* ---- several processes ---- */

static void append_many(const char *path, int runs, uint64_t seed)
{
    for (int i = 0; i < runs; i++)
        history_add(path, "many", "north", "2024-01-01T00:00:00Z", nothing, seed + (uint64_t)i);
}

/* In a process of its own, which ends without cmocka. */
static pid_t start_writer(const char *path, int runs, uint64_t seed)
{
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        append_many(path, runs, seed);
        _exit(0);
    }
    return child;
}

static void two_writers_wait_for_each_other(void **state)
{
    (void)state;
    const char *path = history_path("writers");
    enum { WRITERS = 3, RUNS = 5 };
    pid_t children[WRITERS];
    for (int i = 0; i < WRITERS; i++)
        children[i] = start_writer(path, RUNS, (uint64_t)i * 100);
    for (int i = 0; i < WRITERS; i++) {
        int status;
        assert_int_equal(waitpid(children[i], &status, 0), children[i]);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    assert_string_equal(ask(path, "SELECT count(*) FROM runs"), "15");
    assert_string_equal(ask(path, "PRAGMA integrity_check"), "ok");
}

/* Killed at any moment, a writer leaves whole runs. */
static void killed_writers_leave_whole_runs(void **state)
{
    (void)state;
    const char *path = history_path("killed");
    bb_random random = bb_random_make(seed_or(31), 0);
    append_many(path, 1, 0);
    const char *given = getenv("BVHBENCH_TEST_KILLS");
    const int kills = given != NULL ? atoi(given) : 8;
    for (int i = 0; i < kills; i++) {
        int status;
        pid_t child = start_writer(path, 1000, (uint64_t)i);
        usleep(bb_random_below(&random, 60000));
        kill(child, SIGKILL);
        waitpid(child, &status, 0);
        assert_true(WIFSIGNALED(status));
        assert_string_equal(ask(path, "PRAGMA integrity_check"), "ok");
        assert_string_equal(ask(path, "SELECT count(DISTINCT n) FROM (SELECT count(*) AS n FROM"
                                      " measurements GROUP BY run)"),
                            "1");
        assert_string_equal(ask(path, "SELECT (SELECT count(*) FROM runs) ="
                                      " (SELECT count(DISTINCT run) FROM measurements)"),
                            "1");
    }
    append_many(path, 1, 1);
}

/* `--write FOLDER`: a history and its page, for check.sh. */
static int write_sample(const char *folder)
{
    char path[600], page[600];
    bb_history *history;
    bb_trend *trends;
    uint32_t count;
    snprintf(path, sizeof path, "%s/bench.db", folder);
    snprintf(page, sizeof page, "%s/history.html", folder);
    unlink(path);
    history_fill(path);
    if (bb_history_open(path, false, &history) != BB_OK ||
        bb_history_trends(history, &trends, &count) != BB_OK ||
        bb_report_history(trends, count, page) != BB_OK ||
        bb_report_history_text(trends, count, stdout) != BB_OK) {
        fprintf(stderr, "%s\n", bb_message());
        return 1;
    }
    bb_trends_free(trends, count);
    bb_history_close(history);
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0)
        return write_sample(argv[2]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_appended_comes_back),
        cmocka_unit_test(empty_files_become_histories),
        cmocka_unit_test(what_is_no_history_is_refused),
        cmocka_unit_test(a_history_of_other_parts_is_refused),
        cmocka_unit_test(damage_anywhere_is_found_at_once),
        cmocka_unit_test(what_was_appended_is_read_back),
        cmocka_unit_test(damaged_files_are_refused),
        cmocka_unit_test(revisions_are_found_by_their_beginnings),
        cmocka_unit_test(trends_mark_what_moved),
        cmocka_unit_test(devices_are_told_apart),
        cmocka_unit_test(an_entry_is_its_latest_run),
        cmocka_unit_test(spellings_of_a_key_are_one_cell),
        cmocka_unit_test(unclear_revisions_make_no_floor),
        cmocka_unit_test(two_writers_wait_for_each_other),
        cmocka_unit_test(killed_writers_leave_whole_runs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
