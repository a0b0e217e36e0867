/* Shared by the files of the history: SQL statements and their errors. */
#ifndef BB_HISTORY_PRIVATE_H
#define BB_HISTORY_PRIVATE_H

#include "framework/compare/history.h"

#include <sqlite3.h>

struct bb_history {
    sqlite3 *db;
    char *path;
};

/* Fails with BB_INVALID or BB_FAILED and SQLite's message. */
bb_status bb_history_fail(const bb_history *history, const char *doing);
/* Runs statements without results. */
bb_status bb_history_exec(bb_history *history, const char *sql, const char *doing);
bb_status bb_history_prepare(bb_history *history, const char *sql, sqlite3_stmt **statement);
/* Binds texts and numbers to ?1, ?2 ...: 't' const char *, 'i' int64_t, 'd' double, 'n' nothing. */
void bb_history_bind(sqlite3_stmt *statement, const char *types, ...);
/* Runs a statement that returns no row, and resets it. */
bb_status bb_history_do(bb_history *history, sqlite3_stmt *statement, const char *doing);
/* Returns the text of a column; "" if it is NULL. */
const char *bb_history_text(sqlite3_stmt *statement, int column);

#endif
