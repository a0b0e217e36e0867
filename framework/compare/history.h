/* The history: an SQLite file to which runs are appended (README.md has the schema). */
#ifndef BB_HISTORY_H
#define BB_HISTORY_H

#include "framework/base/status.h"
#include "framework/compare/compare.h"
#include "framework/record/record.h"

typedef struct bb_history bb_history;

/* Opens the file. With `create`, a missing file is made, and a change that is rolled back tests
 * whether the file can be written. BB_INVALID if the file cannot be opened or written, is no
 * history or has another version. Close with bb_history_close(), which accepts NULL. */
bb_status bb_history_open(const char *path, bool create, bb_history **out);
void bb_history_close(bb_history *history);

/* Appends all cells of a table (bb_cell_set_of_table()) as one run, in one transaction. After a
 * failure (BB_INVALID, BB_FAILED) the file is as before. */
bb_status bb_history_append(bb_history *history, const bb_table *table);
/* Appends several tables, each as one run, in one transaction: all or none. */
bb_status bb_history_append_all(bb_history *history, const bb_table *const *tables, uint32_t count);

/* Keeps a floor of separate runs for the machine and revision of `origin`. */
bb_status bb_history_append_floor(bb_history *history, const bb_origin *origin,
                                  const bb_floor *floor);

/* ---- reading (history_read.c) ---- */

/* All runs of one revision on one machine. */
typedef struct bb_history_entry {
    bb_origin origin; /* that of the latest run; `what` is the revision */
    int64_t last;     /* id of the latest run */
    uint32_t runs;
} bb_history_entry;

/* Lists all entries, sorted by their first run, the oldest first. *entries is from malloc. */
bb_status bb_history_list(bb_history *history, bb_history_entry **entries, uint32_t *count);

/* Finds the entry of the revision `text`, or of the only one that begins with it. If several
 * machines measured the revision, the entry of `like`'s machine is taken, or the latest if there is
 * none or `like` is NULL. *others gets the number of other machines. BB_INVALID if no revision
 * begins so, or several do. */
bb_status bb_history_find(bb_history *history, const char *text, const bb_origin *like,
                          bb_history_entry *entry, uint32_t *others);

/* Reads the latest measurement of each cell of an entry. Release the set with bb_cell_set_free(),
 * also after a failure. */
bb_status bb_history_set(bb_history *history, const bb_history_entry *entry, bb_cell_set *set);

/* Finds the floor of separate runs on this machine: the largest that was kept or that runs of one
 * revision show. Each cell's own floor is from these runs. The share is NAN if there is no floor.
 * Release with bb_floor_free(), also after a failure. */
bb_status bb_history_floor(bb_history *history, const bb_origin *machine, bb_floor *floor);

#endif
