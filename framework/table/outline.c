/* Tables as pages, scene by scene. */
#include "framework/table/outline.h"

#include "framework/table/figure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bb_dimension section_of(const bb_page_outline *outline)
{
    return outline->by_question ? BB_QUESTION : BB_SCENE;
}

static void add_pictures(const bb_table *table, bb_dimension section, const char *name,
                         bb_page *page)
{
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        const char *picture = bb_table_get_text(table, row, "picture");
        const char *question = bb_table_name(table, row, BB_QUESTION);
        if (picture[0] != '\0' && strcmp(bb_table_name(table, row, section), name) == 0)
            bb_page_picture(page, picture, question[0] != '\0' ? question : picture);
    }
}

void bb_outline_scene(const bb_page_outline *outline, const bb_table *table, const char *scene,
                      bb_page *page)
{
    bb_cell cell = {{NULL}};
    cell.names[section_of(outline)] = scene;
    bb_page_heading(page, scene);
    bb_view_say(table, cell, page);
    if (outline->say != NULL)
        outline->say(table, scene, page);
    for (uint32_t i = 0; i < outline->view_count; i++) {
        bb_table_view view = outline->views[i];
        view.most = outline->most;
        bb_view_show(&view, table, cell, page);
    }
    if (outline->note != NULL)
        bb_page_say(page, "%s", outline->note);
    add_pictures(table, section_of(outline), scene, page);
}

static double count_wrong(const bb_page_outline *outline, const bb_table *table)
{
    double wrong = 0;
    for (uint32_t row = 0; outline->wrong != NULL && row < bb_table_row_count(table); row++) {
        const double own = bb_table_get_number(table, row, outline->wrong);
        wrong += isnan(own) ? 0 : fabs(own);
    }
    return wrong;
}

static bool failed(const bb_table *table, uint32_t row)
{
    return strcmp(bb_table_get_text(table, row, "status"), "failed") == 0;
}

/* The first row that failed; BB_NO_ROW if none did. */
static uint32_t first_failed(const bb_table *table)
{
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        if (failed(table, row))
            return row;
    return BB_NO_ROW;
}

bool bb_outline_is_wrong(const bb_page_outline *outline, const bb_table *table)
{
    return outline->wrong != NULL &&
           (count_wrong(outline, table) > 0 || first_failed(table) != BB_NO_ROW);
}

static void add_verdict(const bb_page_outline *outline, const bb_table *table, bb_page *page)
{
    char count[BB_FIGURE_MAX];
    const double wrong = count_wrong(outline, table);
    if (outline->wrong == NULL)
        return;
    for (uint32_t row = first_failed(table); row < bb_table_row_count(table); row++)
        if (failed(table, row))
            bb_page_verdict(page, false, "%s failed: %s", bb_table_name(table, row, BB_BUILDER),
                            bb_table_get_text(table, row, "refused"));
    if (bb_table_column_named(table, outline->wrong) == NULL)
        bb_page_verdict(page, false, "No answer was compared.");
    else if (wrong > 0)
        bb_page_verdict(page, false, "%s %s", bb_figure(count, wrong, 0), outline->ill);
    else if (first_failed(table) == BB_NO_ROW)
        bb_page_verdict(page, true, "%s", outline->well);
}

static bool is_new(const bb_table *table, uint32_t row, bb_dimension section)
{
    const char *name = bb_table_name(table, row, section);
    for (uint32_t i = 0; i < row; i++)
        if (strcmp(bb_table_name(table, i, section), name) == 0)
            return false;
    return name[0] != '\0';
}

/* A table of one run. */
static void add_run(const bb_page_outline *outline, const bb_table *table, bb_page *page)
{
    bb_view_say(table, (bb_cell){{NULL}}, page);
    add_verdict(outline, table, page);
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        if (is_new(table, row, section_of(outline)))
            bb_outline_scene(outline, table, bb_table_name(table, row, section_of(outline)), page);
}

static bb_status add_numbered(const bb_page_outline *outline, const bb_table *table, uint32_t run,
                              bb_page *page)
{
    bb_table *one;
    char text[32];
    snprintf(text, sizeof text, "Run %u", run + 1);
    if (bb_table_runs(table) > 1)
        bb_page_heading(page, text);
    bb_status status = bb_table_of_run(table, run, &one);
    if (status == BB_OK)
        add_run(outline, one, page);
    bb_table_free(one);
    return status;
}

/* The runs of a merged table that have rows, one after the other. Without rows there is one run. */
static bb_status add_runs(const bb_page_outline *outline, const bb_table *table, bb_page *page)
{
    BB_TRY(bb_table_check_runs(table));
    const uint32_t count = bb_table_runs(table);
    bool *there = calloc(count, sizeof *there);
    bb_status status = there != NULL ? BB_OK : bb_fail(BB_REFUSED, "no memory for a page");
    for (uint32_t row = 0; there != NULL && row < bb_table_row_count(table); row++)
        there[bb_table_run_of(table, row)] = true;
    for (uint32_t run = 0; run < count && status == BB_OK; run++)
        if (there[run] || count == 1)
            status = add_numbered(outline, table, run, page);
    free(there);
    return status == BB_OK ? bb_page_status(page) : status;
}

bb_status bb_outline_page(const bb_page_outline *outline, const bb_table *table, bb_page **out)
{
    BB_TRY(bb_page_create(outline->title, out));
    bb_status status = add_runs(outline, table, *out);
    if (status == BB_OK)
        return BB_OK;
    bb_page_free(*out);
    *out = NULL;
    return status;
}
