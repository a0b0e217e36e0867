/* Tables from files, which may be truncated, hostile, or of an older program. */
#include "framework/base/file.h"
#include "framework/base/json.h"
#include "framework/base/steering.h"
#include "framework/table/table_private.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TABLE_BYTES_MAX = 256 << 20, NAME_MAX_SHOWN = 60, VALUES_MAX = 64 << 20 };

typedef struct reader {
    const char *name; /* of the file */
    bb_table *table;
    uint32_t *seen; /* per column: the last row, counted from 1, that has a value */
} reader;

/* ---- members ---- */

/* Fills found[i] with member i. Each name must be there once, and no other. */
static bb_status take_members(const reader *r, const char *place, const cJSON *object,
                              const char *const *names, size_t count, const cJSON **found)
{
    const cJSON *item;
    memset(found, 0, count * sizeof(const cJSON *));
    if (!cJSON_IsObject(object))
        return bb_fail(BB_INVALID, "table %s: %s is no object", r->name, place);
    cJSON_ArrayForEach(item, object)
    {
        size_t i = 0;
        while (i < count && strcmp(names[i], item->string) != 0)
            i++;
        if (i == count || found[i] != NULL)
            return bb_fail(BB_INVALID, "table %s: %s has %s member \"%.*s\"", r->name, place,
                           i == count ? "an unknown" : "twice a", NAME_MAX_SHOWN, item->string);
        found[i] = item;
    }
    for (size_t i = 0; i < count; i++)
        if (found[i] == NULL)
            return bb_fail(BB_INVALID, "table %s: %s has no \"%s\"", r->name, place, names[i]);
    return BB_OK;
}

static bb_status wrong_type(const reader *r, const char *place, const char *member)
{
    return bb_fail(BB_INVALID, "table %s: %s: \"%.*s\" has the wrong type", r->name, place,
                   NAME_MAX_SHOWN, member);
}

/* ---- columns ---- */

/* Number of a word in a list; -1: not in it. */
static int number_of(const cJSON *item, const char *const *words)
{
    for (int i = 0; cJSON_IsString(item) && words[i] != NULL; i++)
        if (strcmp(words[i], item->valuestring) == 0)
            return i;
    return -1;
}

static bb_status read_column(const reader *r, int number, const cJSON *object)
{
    enum { NAME, HEADING, UNIT, HELP, TEXTS, KIND = TEXTS, SENSE, BETTER, DECIMALS, MEMBERS };
    static const char *const names[MEMBERS] = {"name", "heading", "unit",   "help",
                                               "kind", "sense",   "better", "decimals"};
    const cJSON *found[MEMBERS];
    char place[32];
    snprintf(place, sizeof place, "columns[%d]", number);
    BB_TRY(take_members(r, place, object, names, MEMBERS, found));
    for (int i = 0; i < TEXTS; i++)
        if (!cJSON_IsString(found[i]))
            return wrong_type(r, place, names[i]);
    const int words[] = {number_of(found[KIND], bb_kind_words),
                         number_of(found[SENSE], bb_sense_words),
                         number_of(found[BETTER], bb_better_words)};
    for (int i = 0; i < 3; i++)
        if (words[i] < 0)
            return bb_fail(BB_INVALID, "table %s: %s: \"%s\" is none of its words", r->name, place,
                           names[KIND + i]);
    const double decimals = cJSON_IsNumber(found[DECIMALS]) ? found[DECIMALS]->valuedouble : NAN;
    const bool whole = decimals >= -1 && decimals <= INT8_MAX && decimals == floor(decimals);
    const bb_column column = {.name = found[NAME]->valuestring,
                              .heading = found[HEADING]->valuestring,
                              .unit = found[UNIT]->valuestring,
                              .help = found[HELP]->valuestring,
                              .kind = (bb_column_kind)words[0],
                              .sense = (bb_sense)words[1],
                              .better = (bb_better)words[2],
                              .decimals = whole ? (int)decimals : INT8_MAX};
    const char *fault = bb_column_fault(&column);
    if (bb_table_column_named(r->table, column.name) != NULL)
        fault = "there are two of that name";
    if (fault != NULL)
        return bb_fail(BB_INVALID, "table %s: %s: %s", r->name, place, fault);
    bb_table_add_column(r->table, column);
    return bb_table_status(r->table);
}

/* ---- rows ---- */

static bool read_rounds(const cJSON *item, bb_samples *samples)
{
    const cJSON *value;
    samples->count = 0;
    if (!cJSON_IsArray(item) || item->child == NULL)
        return false;
    cJSON_ArrayForEach(value, item)
    {
        if (!cJSON_IsNumber(value) || !isfinite(value->valuedouble) ||
            samples->count == BB_SAMPLES_MAX)
            return false;
        bb_samples_add(samples, value->valuedouble);
    }
    return true;
}

static bb_status read_value(const reader *r, const char *place, uint32_t row,
                            const bb_column *column, const cJSON *item)
{
    bb_samples samples;
    bool ok;
    switch (column->kind) {
    case BB_COLUMN_NUMBER:
        ok = cJSON_IsNumber(item) && isfinite(item->valuedouble);
        if (ok)
            bb_table_set_number(r->table, row, column, item->valuedouble);
        break;
    case BB_COLUMN_TEXT:
        ok = cJSON_IsString(item) && item->valuestring[0] != '\0';
        if (ok)
            bb_table_set_text(r->table, row, column, item->valuestring);
        break;
    default:
        ok = read_rounds(item, &samples);
        if (ok)
            bb_table_set_rounds(r->table, row, column, &samples);
    }
    if (!ok && column->kind == BB_COLUMN_ROUNDS)
        return bb_fail(BB_INVALID, "table %s: %s: \"%s\" is no list of 1 to %d numbers", r->name,
                       place, column->name, BB_SAMPLES_MAX);
    return ok ? BB_OK : wrong_type(r, place, column->name);
}

static bb_status read_cell(const reader *r, const char *place, const cJSON *object, bb_cell *cell)
{
    const cJSON *item;
    *cell = (bb_cell){{NULL}};
    cJSON_ArrayForEach(item, object)
    {
        const int d = bb_dimension_of(item->string);
        if (d < 0)
            continue;
        if (!cJSON_IsString(item) || item->valuestring[0] == '\0')
            return wrong_type(r, place, item->string);
        if (cell->names[d] != NULL)
            return bb_fail(BB_INVALID, "table %s: %s has twice a member \"%s\"", r->name, place,
                           item->string);
        cell->names[d] = item->valuestring;
    }
    return BB_OK;
}

static bb_status read_values(const reader *r, const char *place, const cJSON *object, uint32_t row)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, object)
    {
        if (bb_dimension_of(item->string) >= 0)
            continue;
        const uint32_t column = bb_table_column_index(r->table, item->string);
        if (column == UINT32_MAX || r->seen[column] == row + 1)
            return bb_fail(BB_INVALID, "table %s: %s has %s \"%.*s\"", r->name, place,
                           column == UINT32_MAX ? "no column for" : "twice a member",
                           NAME_MAX_SHOWN, item->string);
        r->seen[column] = row + 1;
        BB_TRY(read_value(r, place, row, bb_table_column(r->table, column), item));
    }
    return bb_table_status(r->table);
}

static bb_status read_row(const reader *r, uint32_t number, const cJSON *object)
{
    bb_cell cell;
    char place[32];
    snprintf(place, sizeof place, "rows[%u]", number);
    if (!cJSON_IsObject(object))
        return bb_fail(BB_INVALID, "table %s: %s is no object", r->name, place);
    BB_TRY(read_cell(r, place, object, &cell));
    const uint32_t row = bb_table_row(r->table, cell);
    BB_TRY(bb_table_status(r->table));
    if (row != number)
        return bb_fail(BB_INVALID, "table %s: %s is of the same cell as rows[%u]", r->name, place,
                       row);
    return read_values(r, place, object, row);
}

/* ---- files ---- */

static bb_status check_schema(const reader *r, const cJSON *root)
{
    const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
    if (!cJSON_IsString(schema))
        return bb_fail(BB_INVALID, "table %s: no \"schema\": it is not from bvhbench", r->name);
    if (strcmp(schema->valuestring, BB_TABLE_SCHEMA) != 0)
        return bb_fail(BB_INVALID,
                       "table %s: its schema is \"%.*s\", this program reads \"" BB_TABLE_SCHEMA
                       "\": measure again",
                       r->name, NAME_MAX_SHOWN, schema->valuestring);
    return BB_OK;
}

static bb_status read_lists(reader *r, const cJSON *columns, const cJSON *rows)
{
    const cJSON *item;
    int column = 0;
    uint32_t row = 0;
    if (!cJSON_IsArray(columns))
        return wrong_type(r, "it", "columns");
    if (!cJSON_IsArray(rows))
        return wrong_type(r, "it", "rows");
    const double values = (double)cJSON_GetArraySize(columns) * cJSON_GetArraySize(rows);
    if (values > VALUES_MAX)
        return bb_fail(BB_REFUSED,
                       "table %s: its rows and columns make %.0f values, at most %d are read",
                       r->name, values, VALUES_MAX);
    cJSON_ArrayForEach(item, columns) BB_TRY(read_column(r, column++, item));
    r->seen = calloc((size_t)column + 1, sizeof *r->seen);
    if (r->seen == NULL)
        return bb_fail(BB_REFUSED, "table %s: no memory", r->name);
    cJSON_ArrayForEach(item, rows) BB_TRY(read_row(r, row++, item));
    return BB_OK;
}

static bb_status read_document(reader *r, const cJSON *root)
{
    enum { SCHEMA, COMMAND, COLUMNS, ROWS, MEMBERS };
    static const char *const names[MEMBERS] = {"schema", "command", "columns", "rows"};
    const cJSON *found[MEMBERS];
    BB_TRY(check_schema(r, root));
    BB_TRY(take_members(r, "it", root, names, MEMBERS, found));
    if (!cJSON_IsString(found[COMMAND]) || !bb_is_table_word(found[COMMAND]->valuestring))
        return bb_fail(BB_INVALID, "table %s: \"command\" is no lower-case word", r->name);
    BB_TRY(bb_table_create(found[COMMAND]->valuestring, &r->table));
    return read_lists(r, found[COLUMNS], found[ROWS]);
}

/* cJSON ends strings at \u0000; the text would be cut off there. */
static bool has_zero(const char *json)
{
    for (const char *at = json; (at = strchr(at, '\\')) != NULL; at += at[1] != '\0' ? 2 : 1)
        if (strncmp(at + 1, "u0000", 5) == 0)
            return true;
    return false;
}

static bb_status check_text(const char *json, const char *name)
{
    char *valid = bb_utf8_text(json);
    if (valid == NULL)
        return bb_fail(BB_REFUSED, "table %s: no memory", name);
    const bool is_utf8 = strcmp(valid, json) == 0;
    free(valid);
    if (!is_utf8)
        return bb_fail(BB_INVALID, "table %s: is not UTF-8", name);
    return has_zero(json) ? bb_fail(BB_INVALID, "table %s: has the letter \\u0000", name) : BB_OK;
}

bb_status bb_table_parse(const char *json, const char *name, bb_table **out)
{
    reader r = {.name = name};
    const char *end = NULL;
    *out = NULL;
    BB_TRY(check_text(json, name));
    cJSON *root = cJSON_ParseWithOpts(json, &end, true);
    if (root != NULL && (end = bb_json_fault(json)) != NULL) {
        cJSON_Delete(root);
        root = NULL;
    }
    bb_status status =
        root != NULL ? read_document(&r, root)
                     : bb_fail(BB_INVALID,
                               "table %s is not JSON, is truncated, or is too large for the memory "
                               "left: error at byte %zu",
                               name, end != NULL ? (size_t)(end - json) : 0);
    cJSON_Delete(root);
    free(r.seen);
    if (status == BB_OK)
        *out = r.table;
    else
        bb_table_free(r.table);
    return status;
}

bb_status bb_table_read(const char *path, bb_table **out)
{
    char *text;
    size_t size;
    *out = NULL;
    BB_TRY(bb_file_read(path, TABLE_BYTES_MAX, "table", &text, &size));
    bb_status status =
        strlen(text) == size
            ? bb_table_parse(text, path, out)
            : bb_fail(BB_INVALID, "table %s: byte %zu is 0: it is no text", path, strlen(text));
    free(text);
    return status;
}

static const char *word_of(const cJSON *json, const char *member)
{
    const char *word = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, member));
    return word != NULL ? word : "";
}

bool bb_table_is_other(const char *path, const char *command)
{
    char *text;
    size_t size;
    if (bb_file_read(path, TABLE_BYTES_MAX, "table", &text, &size) != BB_OK)
        return false;
    cJSON *json = cJSON_Parse(text);
    const bool other = strncmp(word_of(json, "schema"), "bvhbench-table/", 15) == 0 &&
                       strcmp(word_of(json, "command"), command) != 0;
    cJSON_Delete(json);
    free(text);
    return other;
}
