#include "framework/compare/history.h"

#include "framework/compare/history_private.h"
#include "framework/compare/schema.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WAIT_MS = 60 * 1000 };

/* ---- statements ---- */

bb_status bb_history_fail(const bb_history *history, const char *doing)
{
    int code = sqlite3_errcode(history->db) & 0xff;
    bool theirs = code == SQLITE_CANTOPEN || code == SQLITE_NOTADB || code == SQLITE_READONLY ||
                  code == SQLITE_CORRUPT || code == SQLITE_PERM || code == SQLITE_BUSY;
    const char *advice = code == SQLITE_BUSY      ? ": another program has held it for a minute"
                         : code == SQLITE_NOTADB  ? ": name another file"
                         : code == SQLITE_FULL    ? ": make room"
                         : code == SQLITE_CORRUPT ? ": move it away, or restore a copy"
                                                  : "";
    return bb_fail(theirs ? BB_INVALID : BB_FAILED, "history %s: cannot %s: %s%s", history->path,
                   doing, sqlite3_errmsg(history->db), advice);
}

bb_status bb_history_exec(bb_history *history, const char *sql, const char *doing)
{
    return sqlite3_exec(history->db, sql, NULL, NULL, NULL) == SQLITE_OK
               ? BB_OK
               : bb_history_fail(history, doing);
}

bb_status bb_history_prepare(bb_history *history, const char *sql, sqlite3_stmt **statement)
{
    return sqlite3_prepare_v2(history->db, sql, -1, statement, NULL) == SQLITE_OK
               ? BB_OK
               : bb_history_fail(history, "read it");
}

void bb_history_bind(sqlite3_stmt *statement, const char *types, ...)
{
    va_list values;
    va_start(values, types);
    for (int i = 1; types[i - 1] != '\0'; i++)
        switch (types[i - 1]) {
        case 't':
            sqlite3_bind_text(statement, i, va_arg(values, const char *), -1, SQLITE_TRANSIENT);
            break;
        case 'i':
            sqlite3_bind_int64(statement, i, va_arg(values, int64_t));
            break;
        case 'd':
            sqlite3_bind_double(statement, i, va_arg(values, double));
            break;
        default:
            sqlite3_bind_null(statement, i);
        }
    va_end(values);
}

bb_status bb_history_do(bb_history *history, sqlite3_stmt *statement, const char *doing)
{
    int code = sqlite3_step(statement);
    bb_status status = code == SQLITE_DONE ? BB_OK : bb_history_fail(history, doing);
    sqlite3_reset(statement);
    return status;
}

const char *bb_history_text(sqlite3_stmt *statement, int column)
{
    const unsigned char *text = sqlite3_column_text(statement, column);
    return text != NULL ? (const char *)text : "";
}

/* Stores the first number of a query's result. */
static bb_status ask(bb_history *history, const char *sql, int64_t *value)
{
    sqlite3_stmt *statement = NULL;
    BB_TRY(bb_history_prepare(history, sql, &statement));
    bb_status status =
        sqlite3_step(statement) == SQLITE_ROW ? BB_OK : bb_history_fail(history, "read it");
    *value = sqlite3_column_int64(statement, 0);
    sqlite3_finalize(statement);
    return status;
}

/* ---- opening ---- */

/* What a database consists of, but for what SQLite keeps of its own. */
static const char parts_of[] =
    "SELECT type, name, coalesce(sql, '') FROM sqlite_master"
    " WHERE NOT (type = 'table' AND name IN ('sqlite_stat1', 'sqlite_stat4')) ORDER BY type, name";

/* Steps through the parts of both; BB_OK if they are the same. */
static bb_status compare_parts(bb_history *history, sqlite3_stmt *ours, sqlite3_stmt *theirs)
{
    for (;;) {
        const int more[2] = {sqlite3_step(ours), sqlite3_step(theirs)};
        if (more[1] != SQLITE_ROW && more[1] != SQLITE_DONE)
            return bb_history_fail(history, "read it");
        if (more[0] != SQLITE_ROW && more[1] != SQLITE_ROW)
            return BB_OK;
        int order = (more[0] != SQLITE_ROW) - (more[1] != SQLITE_ROW); /* > 0: ours is later */
        for (int i = 0; i < 2 && order == 0; i++)
            order = strcmp(bb_history_text(ours, i), bb_history_text(theirs, i));
        if (order == 0 && strcmp(bb_history_text(ours, 2), bb_history_text(theirs, 2)) == 0)
            continue;
        const bool extra = order >= 0; /* or another of the same name */
        return bb_fail(BB_INVALID,
                       "history %s: its %.20s %.100s is %s this program's: name another file",
                       history->path, bb_history_text(extra ? theirs : ours, 0),
                       bb_history_text(extra ? theirs : ours, 1), extra ? "not" : "missing from");
    }
}

/* Refuses a file with other tables, or with triggers or views, which could change what is
 * appended. */
static bb_status check_parts(bb_history *history)
{
    bb_history fresh = {.path = history->path};
    sqlite3_stmt *statements[2] = {NULL, NULL};
    bb_status status = sqlite3_open(":memory:", &fresh.db) == SQLITE_OK
                           ? BB_OK
                           : bb_fail(BB_FAILED, "history %s: no memory", history->path);
    if (status == BB_OK)
        status = bb_history_exec(&fresh, bb_history_tables, "make its tables");
    if (status == BB_OK)
        status = bb_history_prepare(&fresh, parts_of, &statements[0]);
    if (status == BB_OK)
        status = bb_history_prepare(history, parts_of, &statements[1]);
    if (status == BB_OK)
        status = compare_parts(history, statements[0], statements[1]);
    sqlite3_finalize(statements[0]);
    sqlite3_finalize(statements[1]);
    sqlite3_close(fresh.db);
    return status;
}

/* Refuses a file that is neither empty nor a history, so that no other database is changed. */
static bb_status check_owner(bb_history *history, bool *empty)
{
    int64_t application, version, tables;
    BB_TRY(ask(history, "PRAGMA application_id", &application));
    BB_TRY(ask(history, "PRAGMA user_version", &version));
    BB_TRY(ask(history, "SELECT count(*) FROM sqlite_master", &tables));
    *empty = application == 0 && version == 0 && tables == 0;
    if (*empty)
        return BB_OK;
    if (application == 0 && version == 0 && check_parts(history) == BB_OK)
        return bb_fail(
            BB_INVALID,
            "history %s has the tables but not the marks, like what SQLite's .dump makes: "
            "take .backup, or set them, if all is of version %d: PRAGMA "
            "application_id=%d; PRAGMA user_version=%d",
            history->path, BB_HISTORY_VERSION, BB_HISTORY_APPLICATION, BB_HISTORY_VERSION);
    if (application != BB_HISTORY_APPLICATION)
        return bb_fail(BB_INVALID, "history %s is another program's database: name another file",
                       history->path);
    if (version != BB_HISTORY_VERSION)
        return bb_fail(BB_INVALID,
                       "history %s is of version %lld, this program reads %d: name another file",
                       history->path, (long long)version, BB_HISTORY_VERSION);
    return BB_OK;
}

/* Makes the tables in an empty file. Another process may have made them meanwhile, so the file is
 * checked again once it is locked. */
static bb_status make_tables(bb_history *history)
{
    char sql[128];
    bool empty;
    /* in one transaction: another process might make the tables meanwhile */
    BB_TRY(bb_history_exec(history, "BEGIN", "read it"));
    bb_status seen = check_owner(history, &empty);
    (void)sqlite3_exec(history->db, "COMMIT", NULL, NULL, NULL);
    if (seen != BB_OK || !empty)
        return seen;
    BB_TRY(bb_history_exec(history, "BEGIN IMMEDIATE", "write it"));
    bb_status status = check_owner(history, &empty);
    if (status == BB_OK && empty)
        status = bb_history_exec(history, bb_history_tables, "make its tables");
    snprintf(sql, sizeof sql, "PRAGMA application_id=%d; PRAGMA user_version=%d; COMMIT",
             BB_HISTORY_APPLICATION, BB_HISTORY_VERSION);
    if (status == BB_OK)
        status = bb_history_exec(history, sql, "make its tables");
    if (status != BB_OK)
        (void)sqlite3_exec(history->db, "ROLLBACK", NULL, NULL, NULL);
    return status;
}

/* Refuses a damaged file. */
static bb_status check_health(bb_history *history)
{
    sqlite3_stmt *statement = NULL;
    BB_TRY(bb_history_prepare(history, "PRAGMA quick_check(1)", &statement));
    bb_status status = BB_OK;
    if (sqlite3_step(statement) != SQLITE_ROW)
        status = bb_history_fail(history, "read it");
    else if (strcmp(bb_history_text(statement, 0), "ok") != 0)
        status =
            bb_fail(BB_INVALID, "history %s is damaged: %.200s: move it away, or restore a copy",
                    history->path, bb_history_text(statement, 0));
    sqlite3_finalize(statement);
    return status;
}

/* Tests whether the file can be written: changes a page in a transaction and rolls it back. */
static bb_status try_write(bb_history *history)
{
    bb_status status =
        bb_history_exec(history, "BEGIN IMMEDIATE; CREATE TABLE trial(x)", "write it");
    if (sqlite3_get_autocommit(history->db) == 0 &&
        sqlite3_exec(history->db, "ROLLBACK", NULL, NULL, NULL) != SQLITE_OK && status == BB_OK)
        status = bb_history_fail(history, "write it");
    return status;
}

bb_status bb_history_open(const char *path, bool create, bb_history **out)
{
    *out = NULL;
    /* what SQLite takes for memory, a file that it deletes, or options */
    if (path[0] == '\0' || strcmp(path, ":memory:") == 0 || strncmp(path, "file:", 5) == 0)
        return bb_fail(BB_INVALID, "history '%s' is not a file, which alone is kept: name one",
                       path);
    bb_history *history = calloc(1, sizeof *history);
    if (history == NULL || (history->path = strdup(path)) == NULL) {
        free(history);
        return bb_fail(BB_FAILED, "history %s: no memory", path);
    }
    int flags = SQLITE_OPEN_READWRITE | (create ? SQLITE_OPEN_CREATE : 0);
    bb_status status = BB_OK;
    if (sqlite3_open_v2(path, &history->db, flags, NULL) != SQLITE_OK)
        status = history->db != NULL ? bb_history_fail(history, "open it")
                                     : bb_fail(BB_FAILED, "history %s: no memory", path);
    if (status == BB_OK) {
        sqlite3_busy_timeout(history->db, WAIT_MS);
        status =
            bb_history_exec(history, "PRAGMA synchronous=FULL; PRAGMA foreign_keys=ON", "open it");
    }
    if (status == BB_OK)
        status = make_tables(history);
    if (status == BB_OK)
        status = check_parts(history);
    if (status == BB_OK)
        status = check_health(history);
    if (status == BB_OK && create)
        status = try_write(history);
    if (status != BB_OK) {
        bb_history_close(history);
        return status;
    }
    *out = history;
    return BB_OK;
}

void bb_history_close(bb_history *history)
{
    if (history == NULL)
        return;
    sqlite3_close(history->db);
    free(history->path);
    free(history);
}

/* ---- appending ---- */

/* Columns of a run that are not in its origin. */
typedef struct about {
    const char *version, *opencl, *flags, *kernels, *command;
} about;

static bb_status append_run(bb_history *history, const bb_origin *o, const about *a, int64_t *run)
{
    sqlite3_stmt *statement = NULL;
    BB_TRY(bb_history_prepare(history,
                              "INSERT INTO runs(date, revision, version, host, cpu, device, driver,"
                              " opencl, embree, build_flags, kernels, seed, command, interrupted,"
                              " shard, device_type, governor, smt, boost, processors, busy)"
                              " VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)",
                              &statement));
    bb_history_bind(statement, "tttttttttttttittttttd", o->date, o->revision, a->version, o->host,
                    o->cpu, o->device, o->driver, a->opencl, o->embree, a->flags, a->kernels,
                    o->seed, a->command, (int64_t)o->interrupted, o->shard, o->device_type,
                    o->governor, o->smt, o->boost, o->processors, o->busy);
    bb_status status = bb_history_do(history, statement, "append to it");
    sqlite3_finalize(statement);
    *run = sqlite3_last_insert_rowid(history->db);
    return status;
}

typedef struct inserts {
    sqlite3_stmt *cell, *measurement, *figure;
} inserts;

/* What was appended, to be read back. */
typedef struct appended {
    int64_t run, measurements, samples, figures; /* samples: bytes of their texts */
} appended;

/* Returns the samples as JSON, "[1.5,2]", with all digits; NULL if there are none, or no memory. */
static char *samples_text(const bb_samples *ms)
{
    if (ms->count == 0)
        return NULL;
    enum { DIGITS = 26 };
    char *text = malloc((size_t)ms->count * DIGITS + 3), *at = text;
    for (uint32_t i = 0; i < ms->count && text != NULL; i++)
        at += sprintf(at, "%c%.17g", i == 0 ? '[' : ',', ms->values[i]);
    if (text != NULL)
        strcpy(at, "]");
    return text;
}

static bb_status append_cell(bb_history *history, const inserts *in, appended *done,
                             const bb_measured *cell)
{
    char *samples = samples_text(&cell->ms);
    if (samples == NULL && cell->ms.count > 0)
        return bb_fail(BB_FAILED, "history %s: no memory", history->path);
    bb_history_bind(in->cell, "t", cell->key);
    bb_status status = bb_history_do(history, in->cell, "append to it");
    if (status == BB_OK) {
        bb_history_bind(in->measurement, samples != NULL ? "ittitttt" : "ittitttn", done->run,
                        cell->key, cell->time, (int64_t)cell->reference, cell->status,
                        cell->scene_hash, cell->rays_hash, samples);
        status = bb_history_do(history, in->measurement, "append to it");
    }
    done->measurements++;
    done->samples += samples != NULL ? (int64_t)strlen(samples) : 0;
    done->figures += cell->figure_count;
    free(samples);
    int64_t id = sqlite3_last_insert_rowid(history->db);
    for (uint32_t i = 0; i < cell->figure_count && status == BB_OK; i++) {
        const bb_exact_figure *f = &cell->figures[i];
        bb_history_bind(in->figure, "itid", id, f->name, (int64_t)f->better, f->value);
        status = bb_history_do(history, in->figure, "append to it");
    }
    return status;
}

static bb_status append_cells(bb_history *history, const bb_cell_set *set, appended *done)
{
    inserts in = {NULL, NULL, NULL};
    bb_status status = bb_history_prepare(
        history, "INSERT INTO cells(key) VALUES(?) ON CONFLICT(key) DO NOTHING", &in.cell);
    if (status == BB_OK)
        status =
            bb_history_prepare(history,
                               "INSERT INTO measurements(run, cell, time, reference, status,"
                               " scene_hash, rays_hash, samples) VALUES(?1,"
                               " (SELECT id FROM cells WHERE key = ?2), ?3, ?4, ?5, ?6, ?7, ?8)",
                               &in.measurement);
    if (status == BB_OK)
        status = bb_history_prepare(history, "INSERT INTO figures VALUES(?,?,?,?)", &in.figure);
    for (uint32_t i = 0; i < set->count && status == BB_OK; i++)
        status = append_cell(history, &in, done, &set->cells[i]);
    sqlite3_finalize(in.cell);
    sqlite3_finalize(in.measurement);
    sqlite3_finalize(in.figure);
    return status;
}

/* Reads back what was appended. */
static bb_status read_back(bb_history *history, const appended *done)
{
    static const char sql[] =
        "SELECT (SELECT count(*) FROM runs WHERE id = ?1),"
        " (SELECT count(*) FROM measurements WHERE run = ?1),"
        " (SELECT coalesce(sum(length(samples)), 0) FROM measurements WHERE run = ?1),"
        " (SELECT count(*) FROM figures, measurements WHERE run = ?1 AND id = measurement)";
    const int64_t expected[] = {1, done->measurements, done->samples, done->figures};
    sqlite3_stmt *statement = NULL;
    BB_TRY(bb_history_prepare(history, sql, &statement));
    bb_history_bind(statement, "i", done->run);
    bb_status status =
        sqlite3_step(statement) == SQLITE_ROW ? BB_OK : bb_history_fail(history, "read it");
    for (int i = 0; i < 4 && status == BB_OK; i++)
        if (sqlite3_column_int64(statement, i) != expected[i])
            status = bb_fail(BB_FAILED,
                             "history %s: what was appended does not read back as it was: move it "
                             "away, and append the result file with `bvhbench merge --history`",
                             history->path);
    sqlite3_finalize(statement);
    return status;
}

/* Commits, or rolls back what was done since BEGIN. */
static bb_status finish(bb_history *history, bb_status status)
{
    if (status == BB_OK)
        status = bb_history_exec(history, "COMMIT", "append to it");
    if (status != BB_OK && sqlite3_get_autocommit(history->db) == 0)
        (void)sqlite3_exec(history->db, "ROLLBACK", NULL, NULL, NULL);
    return status;
}

static bb_status append_table(bb_history *history, const bb_table *table)
{
    bb_cell_set set;
    appended done = {0};
    const uint32_t run = bb_table_find(table, (bb_cell){{NULL}});
    const about a = {.version = bb_table_get_text(table, run, "version"),
                     .opencl = bb_table_get_text(table, run, "opencl"),
                     .flags = bb_table_get_text(table, run, "build_flags"),
                     .kernels = bb_table_get_text(table, run, "kernels"),
                     .command = bb_table_get_text(table, run, "command")};
    bb_status status = bb_cell_set_of_table(table, "this run", &set);
    if (status == BB_OK)
        status = append_run(history, &set.origin, &a, &done.run);
    if (status == BB_OK)
        status = append_cells(history, &set, &done);
    if (status == BB_OK)
        status = read_back(history, &done);
    bb_cell_set_free(&set);
    return status;
}

bb_status bb_history_append_all(bb_history *history, const bb_table *const *tables, uint32_t count)
{
    bb_status status = bb_history_exec(history, "BEGIN IMMEDIATE", "append to it");
    if (status != BB_OK)
        return status;
    for (uint32_t i = 0; i < count && status == BB_OK; i++)
        status = append_table(history, tables[i]);
    return finish(history, status);
}

bb_status bb_history_append(bb_history *history, const bb_table *table)
{
    return bb_history_append_all(history, &table, 1);
}

bb_status bb_history_append_floor(bb_history *history, const bb_origin *o, const bb_floor *floor)
{
    sqlite3_stmt *statement = NULL;
    BB_TRY(bb_history_prepare(history,
                              "INSERT INTO floors(date, revision, host, cpu, device, driver, share,"
                              " cells) VALUES(?,?,?,?,?,?,?,?)",
                              &statement));
    bb_history_bind(statement, "ttttttdi", o->date, o->revision, o->host, o->cpu, o->device,
                    o->driver, floor->share, (int64_t)floor->cells);
    bb_status status = bb_history_do(history, statement, "append to it");
    sqlite3_finalize(statement);
    return status;
}
