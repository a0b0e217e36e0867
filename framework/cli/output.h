/* Runs a comparison and writes its folder: results.json, report.html and pictures. */
#ifndef BB_OUTPUT_H
#define BB_OUTPUT_H

#include "framework/bench/bench.h"
#include "framework/cli/choice.h"

#include <stdio.h>

typedef struct bb_comparison {
    const char *command; /* the command line */
    const bb_device_choice *device;
    const char *folder;
    const char *history;    /* database to which the run is appended; NULL: none */
    const char *shard;      /* "2/8"; NULL: all cells */
    uint64_t shard_of;      /* hash of the request, which all shards of the run share */
    const char *reduced_to; /* to keep a time, in words; "" or NULL: not */
    uint64_t seed;
    uint32_t charts; /* after bb_charts_decide() */
    bool quiet;      /* do not report what was written */
    /* Does the work of `request` on the device. */
    bb_status (*compare)(void *request, bb_device *device, bb_results *results,
                         bb_bench_outcome *outcome);
    void *request;
    bb_status (*print)(const bb_results *results, FILE *out); /* prints the answer */
} bb_comparison;

/* Makes the folder, tries to write the history, opens the device, compares, writes results.json and
 * report.html, draws the charts, appends to the history, prints, and says on standard error what is
 * wrong; *exit_status is BB_EXIT_WRONG then. If the comparison fails, what was measured is kept,
 * and the message says where. A chart that cannot be drawn is reported when all else is done. */
bb_status bb_output_compare(const bb_comparison *comparison, int *exit_status);

/* Appends a table to the database, which is made if there is none. NULL stands for no database, and
 * a table that is NULL only finds out whether the database can be written. */
bb_status bb_output_append(const char *database, const bb_table *table);
/* Does so with several tables, all or none, each as a run of its own. */
bb_status bb_output_append_all(const char *database, const bb_table *const *tables, uint32_t count);

#define BB_HISTORY_OPTION(type, member)                                                            \
    {                                                                                              \
        "history", "DB", "append the run to this database (SQLite; made if there is none)",        \
            BB_INTO(type, member)                                                                  \
    }

#endif
