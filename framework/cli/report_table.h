/* Reports the table of a command as text, Markdown, CSV or a page, for `bvhbench report`. */
#ifndef BB_REPORT_TABLE_H
#define BB_REPORT_TABLE_H

#include "framework/table/table.h"

typedef enum bb_table_form {
    BB_TABLE_PAGE,
    BB_TABLE_TEXT,
    BB_TABLE_MARKDOWN,
    BB_TABLE_CSV,
    BB_TABLE_SAMPLES
} bb_table_form;

/* Prints the table at `path` in this form. Writes the page to `out`, if it is not NULL; for
 * BB_TABLE_PAGE it is COMMAND.html beside the table then. BB_UNSUPPORTED: the table's command has
 * no page; only CSV and samples work for all tables. */
bb_status bb_report_table_file(const char *path, bb_table_form form, const char *out);
/* Writes the page of a table whose pictures lie in `folder`, with all runs of a merged table. */
bb_status bb_report_table_page(const bb_table *table, const char *folder, const char *path);

#endif
