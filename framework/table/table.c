/* The table in memory: interned names, rows found by their cells, values by columns. */
#include "framework/table/table_private.h"

#include "framework/base/steering.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

const char *const bb_dimension_names[BB_DIMENSIONS] = {
    "run", "scene", "frame", "question", "view", "builder", "kernel", "maker", "intersector"};

/* ---- names ---- */

static uint64_t hash_of(const char *text)
{
    return XXH3_64bits(text, strlen(text));
}

bool bb_is_table_word(const char *text)
{
    const size_t length = strlen(text);
    return text[0] >= 'a' && text[0] <= 'z' && length <= 64 &&
           strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_-") == length;
}

int bb_dimension_of(const char *name)
{
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if (strcmp(bb_dimension_names[d], name) == 0)
            return d;
    return -1;
}

static const char *find_name(const bb_table *table, const char *text)
{
    const uint64_t hash = hash_of(text);
    for (uint32_t at = (uint32_t)hash, item;
         (item = bb_index_next(&table->name_index, hash, &at)) != UINT32_MAX;)
        if (strcmp(table->names[item], text) == 0)
            return table->names[item];
    return NULL;
}

static void run_out(bb_table *table)
{
    table->status = BB_REFUSED;
}

/* The text that stands for `text`, whose copy with valid UTF-8 *name gets if there is none. */
static const char *find_text(const bb_table *table, const char *text, char **name)
{
    const char *known = find_name(table, text);
    *name = known == NULL ? bb_utf8_text(text) : NULL;
    if (*name != NULL && (known = find_name(table, *name)) != NULL) {
        free(*name);
        *name = NULL;
    }
    return known;
}

const char *bb_table_intern(bb_table *table, const char *text)
{
    char *name;
    if (text == NULL || text[0] == '\0' || table->status != BB_OK)
        return NULL;
    const char *known = find_text(table, text, &name);
    if (known != NULL)
        return known;
    if (name == NULL ||
        !bb_index_reserve(&table->names, &table->name_index, sizeof *table->names) ||
        !bb_index_add(&table->name_index, hash_of(name))) {
        free(name);
        run_out(table);
        return NULL;
    }
    return table->names[table->name_index.count - 1] = name;
}

/* ---- tables ---- */

bb_status bb_table_create(const char *command, bb_table **out)
{
    *out = NULL;
    if (!bb_is_table_word(command))
        return bb_fail(BB_INVALID, "a table's command is no lower-case word: '%.64s'", command);
    bb_table *table = calloc(1, sizeof *table);
    if (table != NULL)
        table->command = bb_table_intern(table, command);
    if (table == NULL || table->command == NULL) {
        bb_table_free(table);
        return bb_fail(BB_REFUSED, "no memory for a table");
    }
    *out = table;
    return BB_OK;
}

static void free_column(bb_stored_column *column)
{
    for (uint32_t i = 0; column->column->kind == BB_COLUMN_ROUNDS && i < column->count; i++)
        free(column->values[i].rounds);
    free(column->values);
    free(column->own);
}

void bb_table_free(bb_table *table)
{
    if (table == NULL)
        return;
    for (uint32_t i = 0; i < table->column_index.count; i++)
        free_column(&table->columns[i]);
    for (uint32_t i = 0; i < table->name_index.count; i++)
        free(table->names[i]);
    free(table->columns);
    free(table->rows);
    free(table->names);
    free(table->name_index.slots);
    free(table->row_index.slots);
    free(table->column_index.slots);
    free(table);
}

const char *bb_table_command(const bb_table *table)
{
    return table->command;
}

bb_status bb_table_status(const bb_table *table)
{
    if (table->status == BB_INVALID)
        return bb_fail(BB_INVALID, "column '%.64s' of a table: %s", table->column, table->fault);
    return table->status == BB_OK ? BB_OK : bb_fail(table->status, "no memory for a table");
}

/* ---- rows ---- */

static uint32_t find_row(const bb_table *table, const bb_cell *interned)
{
    const uint64_t hash = XXH3_64bits(interned, sizeof *interned);
    for (uint32_t at = (uint32_t)hash, row;
         (row = bb_index_next(&table->row_index, hash, &at)) != UINT32_MAX;)
        if (memcmp(&table->rows[row], interned, sizeof *interned) == 0)
            return row;
    return BB_NO_ROW;
}

uint32_t bb_table_row(bb_table *table, bb_cell cell)
{
    for (int d = 0; d < BB_DIMENSIONS; d++)
        cell.names[d] = bb_table_intern(table, cell.names[d]);
    if (table->status != BB_OK)
        return BB_NO_ROW;
    const uint32_t known = find_row(table, &cell);
    if (known != BB_NO_ROW)
        return known;
    if (!bb_index_reserve(&table->rows, &table->row_index, sizeof *table->rows) ||
        !bb_index_add(&table->row_index, XXH3_64bits(&cell, sizeof cell))) {
        run_out(table);
        return BB_NO_ROW;
    }
    table->rows[table->row_index.count - 1] = cell;
    return table->row_index.count - 1;
}

uint32_t bb_table_row_count(const bb_table *table)
{
    return table->row_index.count;
}

uint32_t bb_table_find(const bb_table *table, bb_cell cell)
{
    for (int d = 0; d < BB_DIMENSIONS; d++) {
        char *own;
        const char *name = cell.names[d];
        cell.names[d] = NULL;
        if (name == NULL || name[0] == '\0')
            continue;
        cell.names[d] = find_text(table, name, &own);
        free(own);
        if (cell.names[d] == NULL)
            return BB_NO_ROW;
    }
    return find_row(table, &cell);
}

const char *bb_table_name(const bb_table *table, uint32_t row, bb_dimension dimension)
{
    const char *name = row < table->row_index.count ? table->rows[row].names[dimension] : NULL;
    return name != NULL ? name : "";
}

bb_cell bb_table_cell(const bb_table *table, uint32_t row)
{
    return row < table->row_index.count ? table->rows[row] : (bb_cell){{NULL}};
}

/* ---- columns ---- */

uint32_t bb_table_column_index(const bb_table *table, const char *name)
{
    const uint64_t hash = hash_of(name);
    for (uint32_t at = (uint32_t)hash, item;
         (item = bb_index_next(&table->column_index, hash, &at)) != UINT32_MAX;)
        if (strcmp(table->columns[item].column->name, name) == 0)
            return item;
    return UINT32_MAX;
}

uint32_t bb_table_column_count(const bb_table *table)
{
    return table->column_index.count;
}

const bb_column *bb_table_column(const bb_table *table, uint32_t index)
{
    return table->columns[index].column;
}

const bb_column *bb_table_column_named(const bb_table *table, const char *name)
{
    const uint32_t index = bb_table_column_index(table, name);
    return index != UINT32_MAX ? table->columns[index].column : NULL;
}

const char *bb_column_fault(const bb_column *column)
{
    if (column->name == NULL || !bb_is_table_word(column->name))
        return "its name is no lower-case word";
    if (bb_dimension_of(column->name) >= 0)
        return "its name is that of a cell's dimension";
    if (column->heading == NULL || column->unit == NULL || column->help == NULL)
        return "heading, unit or help is missing";
    return column->decimals < -1 || column->decimals > 15 ? "decimals are not -1 to 15" : NULL;
}

static void blame(bb_table *table, const bb_column *column, const char *fault)
{
    table->status = BB_INVALID;
    table->column = column->name != NULL ? column->name : "";
    table->fault = fault;
}

static bb_stored_column *take_over(bb_table *table, const bb_column *column)
{
    if (!bb_index_reserve(&table->columns, &table->column_index, sizeof *table->columns) ||
        !bb_index_add(&table->column_index, hash_of(column->name))) {
        run_out(table);
        return NULL;
    }
    bb_stored_column *taken = &table->columns[table->column_index.count - 1];
    *taken = (bb_stored_column){.column = column};
    return taken;
}

void bb_table_add_column(bb_table *table, bb_column column)
{
    static const char empty[] = "";
    if (bb_table_column_named(table, column.name) != NULL)
        return;
    const char **const texts[] = {&column.name, &column.heading, &column.unit, &column.help};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        const char *text = bb_table_intern(table, *texts[i]);
        *texts[i] = text != NULL ? text : empty;
    }
    bb_column *own = malloc(sizeof *own);
    if (own != NULL)
        *own = column;
    else
        run_out(table);
    bb_stored_column *taken = table->status == BB_OK ? take_over(table, own) : NULL;
    if (taken == NULL) {
        free(own);
        return;
    }
    taken->own = own;
}

/* ---- values ---- */

static bb_value none_of(bb_column_kind kind)
{
    return kind == BB_COLUMN_NUMBER ? (bb_value){.number = (double)NAN}
           : kind == BB_COLUMN_TEXT ? (bb_value){.text = NULL}
                                    : (bb_value){.rounds = NULL};
}

static bool reach(bb_stored_column *column, uint32_t row)
{
    if (row < column->count)
        return true;
    const uint32_t half = row - row / 2, count = row + 1 + (column->count > 0 ? half : 0);
    bb_value *larger = realloc(column->values, count * sizeof *larger);
    if (larger == NULL)
        return false;
    for (uint32_t i = column->count; i < count; i++)
        larger[i] = none_of(column->column->kind);
    column->values = larger;
    column->count = count;
    return true;
}

/* Where a value is put; NULL where none can be. A column without a value is not taken over. */
static bb_value *place_of(bb_table *table, uint32_t row, const bb_column *column, bool any)
{
    if (row == BB_NO_ROW || table->status != BB_OK)
        return NULL;
    const char *name = column->name != NULL ? column->name : "";
    const uint32_t index = bb_table_column_index(table, name);
    bb_stored_column *known = index != UINT32_MAX ? &table->columns[index] : NULL;
    if (known == NULL && !any)
        return NULL;
    const char *fault = known == NULL ? bb_column_fault(column) : NULL;
    if (known != NULL && known->column != column &&
        (known->own == NULL || known->column->kind != column->kind))
        fault = "there are two of that name";
    if (fault != NULL) {
        blame(table, column, fault);
        return NULL;
    }
    if (known == NULL)
        known = take_over(table, column);
    if (known != NULL && !reach(known, row))
        run_out(table);
    return table->status == BB_OK ? &known->values[row] : NULL;
}

void bb_table_set_number(bb_table *table, uint32_t row, const bb_column *column, double value)
{
    assert(column->kind == BB_COLUMN_NUMBER);
    bb_value *place = place_of(table, row, column, isfinite(value));
    if (place != NULL)
        place->number = isfinite(value) ? value : (double)NAN;
}

void bb_table_set_text(bb_table *table, uint32_t row, const bb_column *column, const char *value)
{
    assert(column->kind == BB_COLUMN_TEXT);
    const char *text = bb_table_intern(table, value);
    bb_value *place = place_of(table, row, column, text != NULL);
    if (place != NULL)
        place->text = text;
}

static bool all_finite(const bb_samples *samples)
{
    for (uint32_t i = 0; i < samples->count; i++)
        if (!isfinite(samples->values[i]))
            return false;
    return samples->count > 0;
}

void bb_table_set_rounds(bb_table *table, uint32_t row, const bb_column *column,
                         const bb_samples *samples)
{
    assert(column->kind == BB_COLUMN_ROUNDS);
    const size_t size = offsetof(bb_samples, values) + samples->count * sizeof(double);
    const bool any = all_finite(samples);
    bb_value *place = place_of(table, row, column, any);
    if (place == NULL)
        return;
    bb_samples *copy = any ? malloc(size) : NULL;
    if (copy != NULL)
        memcpy(copy, samples, size);
    else if (any)
        run_out(table);
    free(place->rounds); /* which `samples` may be */
    place->rounds = copy;
}

/* In what two columns of one name are not the same figure; NULL: in nothing. */
static const char *difference(const bb_column *a, const bb_column *b)
{
    return a->kind != b->kind ? "it is of two kinds in the tables that are put together"
           : strcmp(a->unit, b->unit) != 0 ? "it has two units in the tables that are put together"
           : a->sense != b->sense ? "it is exact in one of the tables that are put together alone"
           : a->better != b->better
               ? "it has two senses of better in the tables that are put together"
               : NULL;
}

/* The column of that name, which is added if there is none; NULL after a fault. */
static const bb_column *column_like(bb_table *table, const bb_stored_column *like)
{
    const bb_column *known = bb_table_column_named(table, like->column->name);
    if (known == NULL && like->own == NULL)
        return like->column;
    if (known == NULL) {
        bb_table_add_column(table, *like->column);
        known = bb_table_column_named(table, like->column->name);
    }
    const char *fault = known != NULL ? difference(known, like->column) : NULL;
    if (fault == NULL)
        return known;
    blame(table, known, fault);
    return NULL;
}

void bb_table_copy(bb_table *table, uint32_t row, const bb_table *from, uint32_t from_row)
{
    for (uint32_t i = 0; i < from->column_index.count && table->status == BB_OK; i++) {
        const bb_stored_column *of = &from->columns[i];
        const bb_value value =
            from_row < of->count ? of->values[from_row] : none_of(of->column->kind);
        const bool none = of->column->kind == BB_COLUMN_NUMBER ? isnan(value.number)
                          : of->column->kind == BB_COLUMN_TEXT ? value.text == NULL
                                                               : value.rounds == NULL;
        const bb_column *column = none ? NULL : column_like(table, of);
        if (column == NULL)
            continue;
        if (column->kind == BB_COLUMN_NUMBER)
            bb_table_set_number(table, row, column, value.number);
        else if (column->kind == BB_COLUMN_TEXT)
            bb_table_set_text(table, row, column, value.text);
        else
            bb_table_set_rounds(table, row, column, value.rounds);
    }
}

static bb_value value_at(const bb_table *table, uint32_t row, const char *name, bb_column_kind kind)
{
    const uint32_t index = bb_table_column_index(table, name);
    const bb_stored_column *column = index != UINT32_MAX ? &table->columns[index] : NULL;
    return column != NULL && row < column->count && column->column->kind == kind
               ? column->values[row]
               : none_of(kind);
}

double bb_table_get_number(const bb_table *table, uint32_t row, const char *column)
{
    const bb_samples *rounds = bb_table_get_rounds(table, row, column);
    return rounds != NULL ? bb_samples_median(rounds)
                          : value_at(table, row, column, BB_COLUMN_NUMBER).number;
}

const char *bb_table_get_text(const bb_table *table, uint32_t row, const char *column)
{
    const char *text = value_at(table, row, column, BB_COLUMN_TEXT).text;
    return text != NULL ? text : "";
}

const bb_samples *bb_table_get_rounds(const bb_table *table, uint32_t row, const char *column)
{
    return value_at(table, row, column, BB_COLUMN_ROUNDS).rounds;
}
