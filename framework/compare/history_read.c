/* Reads revisions, cells and floors from the history. */
#include "framework/compare/history.h"

#include "framework/compare/history_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MACHINE "host = ?1 AND cpu = ?2 AND device = ?3 AND driver = ?4"
#define COLUMNS                                                                                    \
    "date, revision, host, cpu, device, driver, embree, seed, shard, interrupted, device_type, "   \
    "governor, smt, boost, processors"

static void copy(char *to, size_t capacity, sqlite3_stmt *row, int column)
{
    snprintf(to, capacity, "%s", bb_history_text(row, column));
}

/* Reads the columns of COLUMNS. */
static void read_origin(sqlite3_stmt *row, bb_origin *o)
{
    copy(o->what, sizeof o->what, row, 1);
    copy(o->date, sizeof o->date, row, 0);
    copy(o->revision, sizeof o->revision, row, 1);
    copy(o->host, sizeof o->host, row, 2);
    copy(o->cpu, sizeof o->cpu, row, 3);
    copy(o->device, sizeof o->device, row, 4);
    copy(o->driver, sizeof o->driver, row, 5);
    copy(o->embree, sizeof o->embree, row, 6);
    copy(o->seed, sizeof o->seed, row, 7);
    copy(o->shard, sizeof o->shard, row, 8);
    o->interrupted = sqlite3_column_int(row, 9) != 0;
    o->has_reduced_to = false;
    copy(o->device_type, sizeof o->device_type, row, 10);
    copy(o->governor, sizeof o->governor, row, 11);
    copy(o->smt, sizeof o->smt, row, 12);
    copy(o->boost, sizeof o->boost, row, 13);
    copy(o->processors, sizeof o->processors, row, 14);
}

static bb_status end(bb_history *history, sqlite3_stmt *statement, bb_status status, int code)
{
    if (status == BB_OK && code != SQLITE_DONE)
        status = bb_history_fail(history, "read it");
    sqlite3_finalize(statement);
    return status;
}

/* ---- revisions ---- */

bb_status bb_history_list(bb_history *history, bb_history_entry **entries, uint32_t *count)
{
    static const char sql[] =
        "SELECT " COLUMNS ", busiest, last, runs FROM runs JOIN (SELECT min(id) AS first,"
        " max(id) AS last, max(busy) AS busiest, count(*) AS runs FROM runs GROUP BY revision, "
        "host, cpu, device, driver) ON id = last"
        " ORDER BY first";
    sqlite3_stmt *statement = NULL;
    bb_status status = BB_OK;
    uint32_t capacity = 0;
    int code;
    *entries = NULL;
    *count = 0;
    BB_TRY(bb_history_prepare(history, sql, &statement));
    while ((code = sqlite3_step(statement)) == SQLITE_ROW) {
        if (*count == capacity) {
            capacity = 2 * capacity + 16;
            bb_history_entry *grown = realloc(*entries, capacity * sizeof *grown);
            if (grown == NULL) {
                status = bb_fail(BB_FAILED, "history %s: no memory", history->path);
                break;
            }
            *entries = grown;
        }
        bb_history_entry *entry = &(*entries)[(*count)++];
        read_origin(statement, &entry->origin);
        entry->origin.busy = sqlite3_column_double(statement, 15);
        entry->last = sqlite3_column_int64(statement, 16);
        entry->runs = (uint32_t)sqlite3_column_int(statement, 17);
    }
    return end(history, statement, status, code);
}

/* Returns whether one begins with the other: the database keeps abbreviated names of commits, and a
 * user may give whole ones. */
static bool begins(const char *revision, const char *text)
{
    size_t kept = strlen(revision);
    return strncmp(revision, text, strlen(text)) == 0 ||
           (kept >= 7 && strncmp(revision, text, kept) == 0);
}

/* Finds the one revision that `text` means. */
static bb_status resolve(const bb_history *history, const bb_history_entry *entries, uint32_t count,
                         const char *text, const char **revision)
{
    *revision = NULL;
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(entries[i].origin.revision, text) == 0) {
            *revision = entries[i].origin.revision;
            return BB_OK;
        }
    for (uint32_t i = 0; i < count; i++) {
        const char *found = entries[i].origin.revision;
        if (!begins(found, text) || (*revision != NULL && strcmp(*revision, found) == 0))
            continue;
        if (*revision != NULL)
            return bb_fail(BB_INVALID, "history %s: '%s' is %s or %s: write more of it",
                           history->path, text, *revision, found);
        *revision = found;
    }
    if (*revision != NULL)
        return BB_OK;
    return count == 0 ? bb_fail(BB_INVALID, "history %s has no runs yet: bvhbench run --history %s",
                                history->path, history->path)
                      : bb_fail(BB_INVALID, "history %s has no revision '%.80s': its latest is %s",
                                history->path, text, entries[count - 1].origin.revision);
}

static bool same_place(const bb_origin *a, const bb_origin *b)
{
    bool host;
    return bb_same_machine(a, b, &host) && host;
}

bb_status bb_history_find(bb_history *history, const char *text, const bb_origin *like,
                          bb_history_entry *entry, uint32_t *others)
{
    bb_history_entry *entries;
    uint32_t count;
    const char *revision;
    const bb_history_entry *best = NULL;
    *others = 0;
    bb_status status = text[0] != '\0' ? BB_OK : bb_fail(BB_INVALID, "an empty revision");
    if (status != BB_OK)
        return status;
    status = bb_history_list(history, &entries, &count);
    if (status == BB_OK)
        status = resolve(history, entries, count, text, &revision);
    for (uint32_t i = 0; i < count && status == BB_OK; i++) {
        if (strcmp(entries[i].origin.revision, revision) != 0)
            continue;
        bool alike = like != NULL && same_place(&entries[i].origin, like);
        bool best_alike = best != NULL && like != NULL && same_place(&best->origin, like);
        *others += 1;
        if (best == NULL || alike || (!best_alike && entries[i].last > best->last))
            best = &entries[i];
    }
    if (status == BB_OK) {
        *entry = *best;
        *others -= 1;
    }
    free(entries);
    return status;
}

/* ---- cells ---- */

static bb_status read_samples(const bb_history *history, const char *text, bb_measured *cell)
{
    if (text[0] == '\0')
        return BB_OK;
    const char *at = text;
    for (char before = '['; *at == before && cell->ms.count < BB_SAMPLES_MAX; before = ',') {
        char *rest;
        double value = strtod(at + 1, &rest);
        if (rest == at + 1 || !isfinite(value) || value < 0)
            break;
        bb_samples_add(&cell->ms, value);
        at = rest;
    }
    return strcmp(at, "]") == 0
               ? BB_OK
               : bb_fail(BB_INVALID, "history %s: the samples of %.200s are no list of times",
                         history->path, cell->key);
}

static bb_status read_figures(bb_history *history, sqlite3_stmt *figures, int64_t measurement,
                              bb_measured *cell)
{
    int code;
    bb_history_bind(figures, "i", measurement);
    bb_status status = BB_OK;
    while (status == BB_OK && (code = sqlite3_step(figures)) == SQLITE_ROW)
        status = bb_measured_add_figure(cell, bb_history_text(figures, 0),
                                        (bb_better)sqlite3_column_int(figures, 1),
                                        sqlite3_column_double(figures, 2));
    if (status == BB_OK && code != SQLITE_DONE)
        status = bb_history_fail(history, "read it");
    sqlite3_reset(figures);
    return status;
}

/* Adds cells from rows of id, key, time, reference, status, scene_hash, rays_hash, samples. Of rows
 * of one cell the first counts. */
static bb_status read_cells(bb_history *history, sqlite3_stmt *rows, bb_cell_set *set)
{
    sqlite3_stmt *figures = NULL;
    BB_TRY(bb_history_prepare(
        history, "SELECT name, better, value FROM figures WHERE measurement = ?", &figures));
    bb_status status = BB_OK;
    int code = SQLITE_DONE;
    while (status == BB_OK && (code = sqlite3_step(rows)) == SQLITE_ROW) {
        const char *key = bb_history_text(rows, 1);
        bb_measured *cell;
        status = bb_cell_set_add(set, key, &cell);
        if (status != BB_OK)
            break;
        copy(cell->time, sizeof cell->time, rows, 2);
        cell->reference = sqlite3_column_int(rows, 3) != 0;
        copy(cell->status, sizeof cell->status, rows, 4);
        copy(cell->scene_hash, sizeof cell->scene_hash, rows, 5);
        copy(cell->rays_hash, sizeof cell->rays_hash, rows, 6);
        status = read_samples(history, bb_history_text(rows, 7), cell);
        if (status == BB_OK)
            status = read_figures(history, figures, sqlite3_column_int64(rows, 0), cell);
    }
    sqlite3_finalize(figures);
    if (status == BB_OK && code != SQLITE_DONE)
        status = bb_history_fail(history, "read it");
    bb_cell_set_sort(set);
    set->duplicates = 0; /* nothing is left out: the first rows are those asked for */
    return status;
}

#define CELLS                                                                                      \
    "SELECT m.id, c.key, m.time, m.reference, m.status, m.scene_hash, m.rays_hash, m.samples"      \
    " FROM measurements m JOIN cells c ON c.id = m.cell "

bb_status bb_history_set(bb_history *history, const bb_history_entry *entry, bb_cell_set *set)
{
    const bb_origin *o = &entry->origin;
    sqlite3_stmt *rows = NULL;
    memset(set, 0, sizeof *set);
    set->origin = *o;
    BB_TRY(bb_history_prepare(history,
                              CELLS
                              "WHERE (m.cell, m.run) IN (SELECT cell, max(run)"
                              " FROM measurements WHERE run IN (SELECT id FROM runs WHERE " MACHINE
                              " AND revision = ?5) GROUP BY cell)"
                              " ORDER BY m.run DESC",
                              &rows));
    bb_history_bind(rows, "ttttt", o->host, o->cpu, o->device, o->driver, o->revision);
    bb_status status = read_cells(history, rows, set);
    sqlite3_finalize(rows);
    return status;
}

static bb_status read_run(bb_history *history, int64_t run, bb_cell_set *set)
{
    sqlite3_stmt *rows = NULL;
    memset(set, 0, sizeof *set);
    BB_TRY(bb_history_prepare(history, CELLS "WHERE m.run = ?", &rows));
    bb_history_bind(rows, "i", run);
    bb_status status = read_cells(history, rows, set);
    sqlite3_finalize(rows);
    return status;
}

/* ---- floors ---- */

enum { PAIRS_MAX = 20 }; /* pairs of runs that are compared for a floor: the latest ones */

/* Finds pairs of successive runs of one revision on the machine. A revision that is unknown, or has
 * uncommitted changes, may be two programs and is left out, as are merged runs of several ones. */
static bb_status find_pairs(bb_history *history, const bb_origin *o, int64_t pairs[PAIRS_MAX][2],
                            uint32_t *count)
{
    static const char sql[] =
        "SELECT a, b FROM (SELECT id AS b, lag(id) OVER (PARTITION BY revision ORDER BY id) AS a"
        " FROM runs WHERE " MACHINE " AND interrupted = 0 AND revision <> ''"
        " AND revision <> '" BB_SEVERAL "' AND revision NOT LIKE '%-dirty') WHERE a IS NOT NULL"
        " ORDER BY b DESC LIMIT 20";
    sqlite3_stmt *statement = NULL;
    int code;
    *count = 0;
    BB_TRY(bb_history_prepare(history, sql, &statement));
    bb_history_bind(statement, "tttt", o->host, o->cpu, o->device, o->driver);
    while ((code = sqlite3_step(statement)) == SQLITE_ROW && *count < PAIRS_MAX) {
        pairs[*count][0] = sqlite3_column_int64(statement, 0);
        pairs[(*count)++][1] = sqlite3_column_int64(statement, 1);
    }
    return end(history, statement, BB_OK, code);
}

/* Reads the floor that `compare --run A A` kept. */
static bb_status kept_floor(bb_history *history, const bb_origin *o, bb_floor *floor)
{
    sqlite3_stmt *statement = NULL;
    BB_TRY(bb_history_prepare(
        history,
        "SELECT max(share), count(*) FROM (SELECT share FROM floors WHERE " MACHINE
        " ORDER BY id DESC LIMIT 5)",
        &statement));
    bb_history_bind(statement, "tttt", o->host, o->cpu, o->device, o->driver);
    int code = sqlite3_step(statement);
    if (code == SQLITE_ROW && sqlite3_column_int(statement, 1) > 0) {
        floor->share = sqlite3_column_double(statement, 0);
        snprintf(floor->from, sizeof floor->from,
                 "what 90 %% of the cells do not exceed of one program against itself (compare "
                 "--run), the most of %d times",
                 sqlite3_column_int(statement, 1));
    }
    sqlite3_finalize(statement);
    return code == SQLITE_ROW ? BB_OK : bb_history_fail(history, "read it");
}

/* Takes the effects between two runs into `floor`. */
static bb_status take_pair(bb_history *history, const int64_t runs[2], bb_floor *floor)
{
    bb_cell_set sets[2] = {{.count = 0}, {.count = 0}};
    bb_status status = read_run(history, runs[0], &sets[0]);
    if (status == BB_OK)
        status = read_run(history, runs[1], &sets[1]);
    if (status == BB_OK)
        status = bb_floor_take_runs(floor, &(bb_side){sets, 2}, 0);
    bb_cell_set_free(&sets[0]);
    bb_cell_set_free(&sets[1]);
    return status;
}

bb_status bb_history_floor(bb_history *history, const bb_origin *machine, bb_floor *floor)
{
    int64_t pairs[PAIRS_MAX][2];
    uint32_t count, useful = 0;
    bb_floor kept = BB_NO_FLOOR;
    *floor = BB_NO_FLOOR;
    BB_TRY(kept_floor(history, machine, &kept));
    BB_TRY(find_pairs(history, machine, pairs, &count));
    for (uint32_t i = 0; i < count; i++) {
        uint32_t cells = floor->cells;
        BB_TRY(take_pair(history, pairs[i], floor));
        useful += floor->cells > cells;
    }
    bb_floor_finish_runs(floor);
    if (isfinite(floor->share) && !(floor->share <= kept.share)) {
        snprintf(floor->from, sizeof floor->from,
                 "what 90 %% of the cells do not exceed between runs of one revision in the "
                 "history, %u times; each cell's own counts too",
                 useful);
        return BB_OK;
    }
    floor->share = kept.share; /* the cells keep their own floors */
    memcpy(floor->from, kept.from, sizeof floor->from);
    return BB_OK;
}
