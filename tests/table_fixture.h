/* What tests share of the tables that programs wrote: see program_fixture.h. */
#ifndef BB_TEST_TABLE_FIXTURE_H
#define BB_TEST_TABLE_FIXTURE_H

#include "framework/table/table.h"
#include "tests/program_fixture.h"

#include <math.h>

static inline bb_table *read_table(const char *name)
{
    char path[512];
    bb_table *table;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    ASSERT_OK(bb_table_read(path, &table));
    return table;
}

static inline double number(const bb_table *table, bb_cell cell, const char *column)
{
    const uint32_t row = bb_table_find(table, cell);
    if (row == BB_NO_ROW || isnan(bb_table_get_number(table, row, column)))
        fail_msg("there is no number '%s'", column);
    return bb_table_get_number(table, row, column);
}

#endif
