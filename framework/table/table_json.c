/* A table as JSON: README.md has the schema. Each column and each row is one line. */
#include "framework/base/file.h"
#include "framework/base/json.h"
#include "framework/table/table_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const bb_kind_words[] = {"number", "text", "rounds", NULL};
const char *const bb_sense_words[] = {"exact", "timed", NULL};
const char *const bb_better_words[] = {"neither", "less", "more", NULL};

static void add_column(bb_json *json, const bb_column *column)
{
    bb_json_line(json);
    bb_json_object(json, NULL);
    bb_json_add_text(json, "name", column->name);
    bb_json_add_text(json, "heading", column->heading);
    bb_json_add_text(json, "unit", column->unit);
    bb_json_add_text(json, "help", column->help);
    bb_json_add_text(json, "kind", bb_kind_words[column->kind]);
    bb_json_add_text(json, "sense", bb_sense_words[column->sense]);
    bb_json_add_text(json, "better", bb_better_words[column->better]);
    bb_json_add_number(json, "decimals", column->decimals);
    bb_json_end_object(json);
}

static void add_rounds(bb_json *json, const char *name, const bb_samples *rounds)
{
    bb_json_array(json, name);
    for (uint32_t i = 0; i < rounds->count; i++)
        bb_json_add_number(json, NULL, rounds->values[i]);
    bb_json_end_array(json);
}

static void add_value(bb_json *json, const bb_table *table, uint32_t row, const char *name)
{
    const bb_samples *rounds = bb_table_get_rounds(table, row, name);
    const char *text = bb_table_get_text(table, row, name);
    const double number = bb_table_get_number(table, row, name);
    if (rounds != NULL)
        add_rounds(json, name, rounds);
    else if (text[0] != '\0')
        bb_json_add_text(json, name, text);
    else if (!isnan(number))
        bb_json_add_number(json, name, number);
}

static void add_row(bb_json *json, const bb_table *table, uint32_t row)
{
    bb_json_line(json);
    bb_json_object(json, NULL);
    for (int d = 0; d < BB_DIMENSIONS; d++) {
        const char *name = bb_table_name(table, row, (bb_dimension)d);
        if (name[0] != '\0')
            bb_json_add_text(json, bb_dimension_names[d], name);
    }
    for (uint32_t c = 0; c < bb_table_column_count(table); c++)
        add_value(json, table, row, bb_table_column(table, c)->name);
    bb_json_end_object(json);
}

char *bb_table_json(const bb_table *table)
{
    bb_json json = {0};
    bb_json_object(&json, NULL);
    bb_json_add_text(&json, "schema", BB_TABLE_SCHEMA);
    bb_json_add_text(&json, "command", table->command);
    bb_json_line(&json);
    bb_json_array(&json, "columns");
    for (uint32_t c = 0; c < bb_table_column_count(table); c++)
        add_column(&json, bb_table_column(table, c));
    bb_json_end_array(&json);
    bb_json_line(&json);
    bb_json_array(&json, "rows");
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        add_row(&json, table, row);
    bb_json_end_array(&json);
    bb_json_end_object(&json);
    return bb_json_take(&json);
}

bb_status bb_table_write(const bb_table *table, const char *path)
{
    char *text = bb_table_json(table);
    if (text == NULL)
        return bb_fail(BB_REFUSED, "table %s: no memory", path);
    const bb_file_part parts[] = {{text, strlen(text)}, {"\n", 1}};
    bb_status status = bb_file_write_parts(path, parts, 2, "table");
    free(text);
    return status;
}
