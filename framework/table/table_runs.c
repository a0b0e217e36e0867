/* Runs in a merged table: rows of all but the first have the run's number as a name. */
#include "framework/base/number.h"
#include "framework/table/table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *bb_run_name(uint32_t run, char text[16])
{
    snprintf(text, 16, "%u", run);
    return run > 0 ? text : NULL;
}

uint32_t bb_table_run_of(const bb_table *table, uint32_t row)
{
    return (uint32_t)strtoul(bb_table_name(table, row, BB_RUN), NULL, 10);
}

uint32_t bb_table_runs(const bb_table *table)
{
    uint32_t last = 0;
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        last = bb_table_run_of(table, row) > last ? bb_table_run_of(table, row) : last;
    return last + 1;
}

bb_status bb_table_check_runs(const bb_table *table)
{
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        char canonical[16];
        uint64_t number;
        const char *run = bb_table_name(table, row, BB_RUN);
        const bool ok = bb_read_whole(run, &number) && number > 0 && number <= BB_RUNS_MAX &&
                        strcmp(run, bb_run_name((uint32_t)number, canonical)) == 0;
        if (run[0] != '\0' && !ok)
            return bb_fail(BB_INVALID, "rows[%u]: the run '%.40s' is no number from 1 to %d", row,
                           run, BB_RUNS_MAX);
    }
    return BB_OK;
}

bb_status bb_table_of_run(const bb_table *table, uint32_t run, bb_table **out)
{
    BB_TRY(bb_table_create(bb_table_command(table), out));
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        bb_cell cell = bb_table_cell(table, row);
        cell.names[BB_RUN] = NULL;
        if (bb_table_run_of(table, row) == run)
            bb_table_copy(*out, bb_table_row(*out, cell), table, row);
    }
    return bb_table_status(*out);
}
