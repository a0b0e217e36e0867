/* All traces as comma-separated values: one line each, with what its build took. */
#include "framework/base/steering.h"
#include "framework/report/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of a trace's build. */
static const bb_field_id of_build[] = {BB_F_BUILD_MS_MEDIAN, BB_F_BUILD_RATE, BB_F_BUILD_HANDOVER,
                                       BB_F_TREE_NODES,      BB_F_TREE_DEPTH, BB_F_TREE_BYTES,
                                       BB_F_TREE_BYTES_PEAK};
enum { OF_BUILD = sizeof of_build / sizeof of_build[0] };

/* A row of the table; without one, columns alone are added. */
typedef struct line {
    bb_table *table;
    uint32_t row;
} line;

/* Puts a text, or a number if that is NULL, into the column of prefix and name. */
static void put(const line *l, const char *prefix, const char *name, const char *text,
                double number)
{
    char whole[128];
    snprintf(whole, sizeof whole, "%s%s", prefix, name);
    bb_table_add_column(l->table, (bb_column){whole, whole, "", "",
                                              text != NULL ? BB_COLUMN_TEXT : BB_COLUMN_NUMBER,
                                              BB_SENSE_EXACT, BB_BETTER_NEITHER, -1});
    const bb_column *column = bb_table_column_named(l->table, whole);
    if (column == NULL || l->row == BB_NO_ROW)
        return;
    if (text != NULL)
        bb_table_set_text(l->table, l->row, column, text);
    else
        bb_table_set_number(l->table, l->row, column, number);
}

static void put_field(const line *l, const char *prefix, const bb_entry *entry, bb_field_id field)
{
    const bool text = (bb_fields[field].kind & (BB_FIELD_TEXT | BB_FIELD_FLAG)) != 0;
    put(l, prefix, bb_fields[field].name, text ? bb_get_text(entry, field) : NULL,
        bb_get_number(entry, field));
}

static bool is_column(const bb_field *field)
{
    const bool trace = field->part == BB_IN_TRACE || field->part == BB_IN_ACCURACY;
    const bool all_rounds = (field->kind & BB_FIELD_ROUNDS) != 0 && field->heading == NULL;
    return trace && !all_rounds && (field->kind & (BB_FIELD_PARTS | BB_FIELD_NAME)) == 0;
}

static void put_trace(const line *l, const bb_entry *trace)
{
    const bb_entry *build = trace != NULL ? bb_build_of(trace) : NULL;
    const char *layout = bb_get_text(trace, BB_F_TRACE_LAYOUT);
    for (size_t i = 0; i < BB_FIELDS; i++)
        if (is_column(&bb_fields[i]))
            put_field(l, "", trace, (bb_field_id)i);
    for (size_t i = 0; i < OF_BUILD; i++)
        put_field(l, bb_fields[of_build[i]].part == BB_IN_TREE ? "tree_" : "", build, of_build[i]);
    put(l, "", "layout_ms", NULL, bb_get_named(build, BB_F_BUILD_LAYOUTS_MS, layout));
    put(l, "", "first_ray_ms", NULL, bb_first_ray_ms(build, layout));
    put(l, "", "first_ray_floor_ms", NULL, bb_get_named(build, BB_F_BUILD_LAYOUTS_FLOOR, layout));
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        put(l, "tree_", bb_metrics[i]->name, NULL, bb_get_metric(build, bb_metrics[i]));
}

/* `text` is from malloc, or NULL for lack of memory. */
static bb_status print(char *text, FILE *out)
{
    if (text == NULL)
        return bb_fail(BB_REFUSED, "report: no memory");
    bb_print_calm_lines(text, out); /* a terminal, too, may show it */
    free(text);
    return ferror(out) ? bb_fail(BB_FAILED, "cannot write the table") : BB_OK;
}

bb_status bb_report_samples(const bb_results *results, FILE *out)
{
    return print(bb_table_samples(bb_results_table(results)), out);
}

bb_status bb_report_csv(const bb_results *results, FILE *out)
{
    const bb_table *from = bb_results_table(results);
    line l = {NULL, BB_NO_ROW};
    char *text = NULL;
    BB_TRY(bb_table_create("run", &l.table));
    put_trace(&l, NULL);
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        l.row = bb_table_row(l.table, bb_table_cell(from, bb_place_of(trace)));
        put_trace(&l, trace);
    }
    if (bb_table_status(l.table) == BB_OK)
        text = bb_table_csv(l.table);
    bb_table_free(l.table);
    return print(text, out);
}
