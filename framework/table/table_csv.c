/* A table as comma-separated values (RFC 4180). */
#include "framework/base/json.h"
#include "framework/table/table_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Parts of a line are after each other. */
typedef struct line {
    FILE *out;
    bool begun;
} line;

static void put_text(line *l, const char *text)
{
    const bool quoted = strpbrk(text, ",\"\r\n") != NULL;
    fputs(l->begun ? "," : "", l->out);
    l->begun = true;
    fputs(quoted ? "\"" : "", l->out);
    for (; *text != '\0'; text++)
        fprintf(l->out, "%s%c", *text == '"' ? "\"" : "", *text);
    fputs(quoted ? "\"" : "", l->out);
}

static void put_number(line *l, double value)
{
    char digits[BB_JSON_DIGITS];
    put_text(l, isfinite(value) ? bb_json_digits(digits, value) : "");
}

static void end_line(line *l)
{
    fputs("\r\n", l->out);
    l->begun = false;
}

/* Whether any cell has such a name. */
static bool is_used(const bb_table *table, bb_dimension dimension)
{
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        if (bb_table_name(table, row, dimension)[0] != '\0')
            return true;
    return false;
}

static void put_heading(line *l, const bb_column *column)
{
    static const char *const endings[] = {"", ".low", ".high"};
    for (int i = 0; i < (column->kind == BB_COLUMN_ROUNDS ? 3 : 1); i++) {
        char name[80];
        snprintf(name, sizeof name, "%.64s%s", column->name, endings[i]);
        put_text(l, name);
    }
}

static void put_value(line *l, const bb_table *table, uint32_t row, const bb_column *column)
{
    if (column->kind == BB_COLUMN_TEXT) {
        put_text(l, bb_table_get_text(table, row, column->name));
        return;
    }
    put_number(l, bb_table_get_number(table, row, column->name));
    if (column->kind != BB_COLUMN_ROUNDS)
        return;
    const bb_samples *rounds = bb_table_get_rounds(table, row, column->name);
    const bb_estimate e = rounds != NULL ? bb_samples_estimate(rounds) : bb_not_measured;
    put_number(l, e.low);
    put_number(l, e.high);
}

/* A table on its way to a text: which names its cells have. */
typedef struct writer {
    const bb_table *table;
    bool used[BB_DIMENSIONS];
    line l;
    char *text;
    size_t size;
} writer;

static void put_dimensions(writer *w)
{
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if (w->used[d])
            put_text(&w->l, bb_dimension_names[d]);
}

static void put_names(writer *w, uint32_t row)
{
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if (w->used[d])
            put_text(&w->l, bb_table_name(w->table, row, (bb_dimension)d));
}

/* One line for each row. */
static void put_rows(writer *w)
{
    put_dimensions(w);
    for (uint32_t c = 0; c < bb_table_column_count(w->table); c++)
        put_heading(&w->l, bb_table_column(w->table, c));
    end_line(&w->l);
    for (uint32_t row = 0; row < bb_table_row_count(w->table); row++) {
        put_names(w, row);
        for (uint32_t c = 0; c < bb_table_column_count(w->table); c++)
            put_value(&w->l, w->table, row, bb_table_column(w->table, c));
        end_line(&w->l);
    }
}

static void put_rounds(writer *w, uint32_t row, const bb_column *column)
{
    const bb_samples *rounds =
        column->kind == BB_COLUMN_ROUNDS ? bb_table_get_rounds(w->table, row, column->name) : NULL;
    for (uint32_t i = 0; rounds != NULL && i < rounds->count; i++) {
        put_names(w, row);
        put_text(&w->l, column->name);
        put_text(&w->l, column->unit);
        put_number(&w->l, i);
        put_number(&w->l, rounds->values[i]);
        end_line(&w->l);
    }
}

/* One line for each round of each time. */
static void put_samples(writer *w)
{
    put_dimensions(w);
    for (size_t i = 0; i < 4; i++)
        put_text(&w->l, (const char *const[]){"figure", "unit", "round", "value"}[i]);
    end_line(&w->l);
    for (uint32_t row = 0; row < bb_table_row_count(w->table); row++)
        for (uint32_t c = 0; c < bb_table_column_count(w->table); c++)
            put_rounds(w, row, bb_table_column(w->table, c));
}

static char *write(const bb_table *table, void (*put)(writer *w))
{
    writer w = {.table = table};
    w.l.out = open_memstream(&w.text, &w.size);
    if (w.l.out == NULL)
        return NULL;
    for (int d = 0; d < BB_DIMENSIONS; d++)
        w.used[d] = is_used(table, (bb_dimension)d);
    put(&w);
    const bool ok = ferror(w.l.out) == 0;
    if (fclose(w.l.out) == 0 && ok)
        return w.text;
    free(w.text);
    return NULL;
}

char *bb_table_csv(const bb_table *table)
{
    return write(table, put_rows);
}

char *bb_table_samples(const bb_table *table)
{
    return write(table, put_samples);
}
