#include "framework/cli/report_table.h"

#include "framework/advise/advise.h"
#include "framework/base/file.h"
#include "framework/base/steering.h"
#include "framework/cli/inputs.h"
#include "framework/report/report.h"
#include "framework/stress/stress.h"
#include "framework/tasks/animate.h"
#include "framework/tasks/dvr.h"
#include "framework/tasks/overlap_contest.h"
#include "framework/tasks/slice_contest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_page_outline *const outlines[] = {
    &bb_animate_outline, &bb_dvr_outline,    &bb_slice_outline,
    &bb_overlap_outline, &bb_advise_outline, &bb_stress_outline,
};

static const bb_page_outline *outline_of(const bb_table *table)
{
    for (size_t i = 0; i < sizeof outlines / sizeof outlines[0]; i++)
        if (strcmp(outlines[i]->command, bb_table_command(table)) == 0)
            return outlines[i];
    return NULL;
}

static bb_status print_text(char *text)
{
    if (text == NULL)
        return bb_fail(BB_REFUSED, "report: no memory");
    bb_print_calm_lines(text, stdout); /* a terminal, too, may show it */
    free(text);
    return BB_OK;
}

static bb_status make_page(const bb_table *table, bb_page **page)
{
    const bb_page_outline *outline = outline_of(table);
    return outline != NULL ? bb_outline_page(outline, table, page)
                           : bb_fail(BB_UNSUPPORTED,
                                     "report: tables of `%s` are shown as CSV alone: give --csv",
                                     bb_table_command(table));
}

bb_status bb_report_table_page(const bb_table *table, const char *folder, const char *path)
{
    bb_page *page;
    if (outline_of(table) == &bb_stress_outline && bb_table_runs(table) == 1)
        return bb_report_atlas(table, folder, path);
    BB_TRY(make_page(table, &page));
    bb_status status = bb_page_html(page, table, folder, path);
    bb_page_free(page);
    return status;
}

/* Writes the page to `out`, or to COMMAND.html in the folder if `out` is NULL. */
static bb_status write_page(const bb_table *table, const char *folder, const char *out, bool said)
{
    char beside[PATH_MAX], name[80];
    snprintf(name, sizeof name, "%s.html", bb_table_command(table));
    BB_TRY(bb_join_path(beside, folder, name));
    out = out != NULL ? out : beside;
    BB_TRY(bb_report_table_page(table, folder, out));
    if (said)
        printf(" report  %s\n", out);
    return BB_OK;
}

static bb_status print(const bb_table *table, bb_table_form form)
{
    bb_page *page;
    if (form == BB_TABLE_CSV)
        return print_text(bb_table_csv(table));
    if (form == BB_TABLE_SAMPLES)
        return print_text(bb_table_samples(table));
    BB_TRY(make_page(table, &page));
    if (form == BB_TABLE_MARKDOWN)
        bb_page_markdown(page, stdout);
    else
        bb_page_print(page, stdout);
    bb_page_free(page);
    return BB_OK;
}

static bb_status show(const bb_table *table, const char *folder, bb_table_form form,
                      const char *out)
{
    BB_TRY(print(table, form));
    return out != NULL || form == BB_TABLE_PAGE
               ? write_page(table, folder, out, form == BB_TABLE_PAGE)
               : BB_OK;
}

bb_status bb_report_table_file(const char *path, bb_table_form form, const char *out)
{
    bb_table *table;
    char *folder = bb_file_folder(path);
    if (folder == NULL)
        return bb_fail(BB_REFUSED, "report: no memory");
    bb_status status = bb_table_read(path, &table);
    if (status == BB_OK) {
        status = show(table, folder, form, out);
        bb_table_free(table);
    }
    free(folder);
    return status;
}
