/* Writes results, and reads them with all checks.
 *
 * A file may be truncated or hostile. The kind of each column and the names of each row are checked
 * here, once, so that no other code has to.
 */
#include "framework/record/record_private.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

bb_status bb_results_write(const bb_results *results, const char *path)
{
    BB_TRY(bb_table_status(results->table));
    return bb_table_write(results->table, path);
}

/* ---- columns ---- */

static bb_status check_column(const bb_table *table, const bb_column *expected)
{
    const bb_column *column = bb_table_column_named(table, expected->name);
    if (column != NULL && column->kind != expected->kind)
        return bb_fail(BB_INVALID, "the column \"%s\" is of the wrong kind", expected->name);
    const bool timed = expected->sense == BB_SENSE_TIMED && expected->unit[0] != '\0';
    return column == NULL || !timed ||
                   (column->sense == BB_SENSE_TIMED && strcmp(column->unit, expected->unit) == 0)
               ? BB_OK
               : bb_fail(BB_INVALID, "the column \"%s\" is not of times in %s", expected->name,
                         expected->unit);
}

static bb_status check_columns(const bb_table *table)
{
    for (int field = 0; field < BB_FIELDS; field++)
        if (bb_field_column((bb_field_id)field) != NULL)
            BB_TRY(check_column(table, bb_field_column((bb_field_id)field)));
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        BB_TRY(check_column(table, bb_metric_column(bb_metrics[i], false)));
        BB_TRY(check_column(table, bb_metric_column(bb_metrics[i], true)));
    }
    return BB_OK;
}

/* ---- values ---- */

/* Returns the most that a number of the field may be; all but rests of times are at least 0. */
static double most_of(const bb_field *field)
{
    const bool whole = field->format == BB_AS_WHOLE || field->format == BB_AS_BYTES;
    return strcmp(field->unit, "ppm") == 0 ? 1e6 : whole ? 0x1p53 : DBL_MAX;
}

/* What is wrong with a number; NULL: nothing. */
static const char *fault_of(const bb_field *field, double value)
{
    const bool any = (field->kind & BB_FIELD_SIGNED) != 0 ||
                     (field->format == BB_AS_FIGURE && field->unit[0] == '\0');
    return any || isnan(value)      ? NULL
           : value < 0              ? "negative"
           : value > most_of(field) ? "too large"
                                    : NULL;
}

static const char *fault_at(const bb_table *table, uint32_t row, const bb_field *field)
{
    const bb_samples *rounds = bb_table_get_rounds(table, row, field->name);
    const char *fault = fault_of(field, bb_table_get_number(table, row, field->name));
    for (uint32_t i = 0; rounds != NULL && i < rounds->count && fault == NULL; i++)
        fault = fault_of(field, rounds->values[i]);
    return fault;
}

static bool is_word(const bb_field *field, const char *text)
{
    static const bb_status words[] = {BB_OK, BB_REFUSED, BB_UNSUPPORTED, BB_FAILED};
    if ((field->kind & BB_FIELD_FLAG) != 0)
        return text[0] == '\0' || strcmp(text, "yes") == 0 || strcmp(text, "no") == 0;
    bool status = strcmp(field->name, bb_fields[BB_F_BUILD_STATUS].name) != 0 || text[0] == '\0';
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        status = status || strcmp(text, bb_status_word(words[i])) == 0;
    return status;
}

/* Checks the values of a column that the field describes. */
static bb_status check_values(const bb_table *table, const bb_field *field)
{
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        const char *fault = fault_at(table, row, field);
        const char *text = bb_table_get_text(table, row, field->name);
        if (fault != NULL)
            return bb_fail(BB_INVALID, "rows[%u]: \"%s\" is %s", row, field->name, fault);
        if (!is_word(field, text))
            return bb_fail(BB_INVALID, "rows[%u]: \"%s\" is '%.40s', which is none of its words",
                           row, field->name, text);
    }
    return BB_OK;
}

static bb_status check_all_values(const bb_table *table)
{
    for (int id = 0; id < BB_FIELDS; id++)
        if (bb_field_column((bb_field_id)id) != NULL &&
            bb_table_column_named(table, bb_fields[id].name) != NULL)
            BB_TRY(check_values(table, &bb_fields[id]));
    return BB_OK;
}

/* ---- rows ---- */

/* Checks that all entries of a section have the fields that each needs. */
static bb_status check_needed(const bb_section *section, bb_field_part part)
{
    for (int id = 0; id < BB_FIELDS; id++) {
        const bb_field *f = &bb_fields[id];
        if (f->part != part || (f->kind & BB_FIELD_NEEDED) == 0)
            continue;
        bb_each(entry, section)
        {
            const bool found = (f->kind & BB_FIELD_NUMBER) != 0
                                   ? isfinite(bb_get_number(entry, (bb_field_id)id))
                                   : bb_get_text(entry, (bb_field_id)id)[0] != '\0';
            if (!found)
                return bb_fail(BB_INVALID, "rows[%u]: \"%s\" is missing", bb_place_of(entry),
                               f->name);
        }
    }
    return BB_OK;
}

static bb_status check_rows(bb_results *results)
{
    BB_TRY(bb_table_check_runs(results->table));
    for (uint32_t row = 0; row < bb_table_row_count(results->table); row++)
        BB_TRY(bb_results_enter(results, row));
    if (results->context == NULL)
        return bb_fail(BB_INVALID, "there is no row without names, of the context");
    for (int s = 0; s < BB_SECTIONS; s++)
        BB_TRY(check_needed(&results->sections[s], bb_section_parts[s]));
    return check_all_values(results->table);
}

static bb_status take_table(bb_results *results, bb_table *table)
{
    bb_table_free(results->table);
    results->table = table;
    if (strcmp(bb_table_command(table), "run") != 0)
        return bb_fail(BB_INVALID, "it is a table of %.40s, not of a run", bb_table_command(table));
    BB_TRY(check_columns(table));
    return check_rows(results);
}

bb_status bb_results_read(const char *path, bb_results **out)
{
    bb_table *table;
    bb_results *results;
    *out = NULL;
    BB_TRY(bb_table_read(path, &table));
    bb_status status = bb_results_make(&results);
    if (status != BB_OK) {
        bb_table_free(table);
        return status;
    }
    status = take_table(results, table);
    if (status == BB_OK) {
        *out = results;
        return BB_OK;
    }
    char reason[512];
    snprintf(reason, sizeof reason, "%s", bb_message());
    bb_results_destroy(results);
    return bb_fail(status, "result file %s: %s", path, reason);
}
