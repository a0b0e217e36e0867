/* The history: an SQLite file to which runs are appended (README.md has the schema). */
#ifndef BB_HISTORY_H
#define BB_HISTORY_H

#include "framework/base/status.h"
#include "framework/compare/compare.h"
#include "framework/record/record.h"

typedef struct bb_history bb_history;

/* Opens the file. `create`: it is made if there is none, and a change that is taken back shows
 * whether it can be written. BB_INVALID, in one line, for a file that cannot be opened or written,
 * is no history, or is of another version. Close with bb_history_close(), which takes NULL. */
bb_status bb_history_open(const char *path, bool create, bb_history **out);
void bb_history_close(bb_history *history);

/* Appends all builds and traces of the document as one run, in one transaction. BB_INVALID or
 * BB_FAILED leave the file as it was. */
bb_status bb_history_append(bb_history *history, const bb_results *results);
/* The same of all rows of a table. */
bb_status bb_history_append_table(bb_history *history, const bb_table *table);

/* Keeps a floor of runs by themselves, of this machine and revision. */
bb_status bb_history_append_floor(bb_history *history, const bb_origin *origin,
                                  const bb_floor *floor);

/* ---- reading (history_read.c) ---- */

/* The runs that belong together: of one revision on one machine. */
typedef struct bb_history_entry {
    bb_origin origin; /* of the latest run; `what` is the revision */
    int64_t last;     /* its id */
    uint32_t runs;
} bb_history_entry;

/* All of them, the one whose first run is the oldest first; from malloc. */
bb_status bb_history_list(bb_history *history, bb_history_entry **entries, uint32_t *count);

/* The entry of a revision that `text` is, or begins, uniquely; where several machines measured it,
 * that of `like`'s machine if there is one (NULL: any), else the latest. *others: on how many other
 * machines it was measured. BB_INVALID if there is none, or several revisions begin so. */
bb_status bb_history_find(bb_history *history, const char *text, const bb_origin *like,
                          bb_history_entry *entry, uint32_t *others);

/* What an entry measured: of each cell the latest measurement. Release with bb_cell_set_free(),
 * also after a failure. */
bb_status bb_history_set(bb_history *history, const bb_history_entry *entry, bb_cell_set *set);

/* The floor of runs by themselves on this machine: the largest that was kept, or found between runs
 * of one revision in the history, with each cell's own from these. Its share is NAN if there is
 * none. Release with bb_floor_free(), also after a failure. */
bb_status bb_history_floor(bb_history *history, const bb_origin *machine, bb_floor *floor);

#endif
