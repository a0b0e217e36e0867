/* Views of tables: rows are chosen, gathered and compared. */
#include "framework/show/view.h"

#include "framework/table/figure.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct shown {
    const bb_table_view *view;
    const bb_table *table;
    bb_cell within;
    uint32_t *rows, row_count;     /* of the table, in order; rows of one group follow each other */
    uint32_t *groups, group_count; /* where in `rows` a row of the grid begins; one more: the end */
} shown;

/* ---- rows ---- */

static bool same_names(const bb_table *table, uint32_t a, uint32_t b, unsigned dimensions)
{
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if ((dimensions & BB_SET(d)) != 0 && strcmp(bb_table_name(table, a, (bb_dimension)d),
                                                    bb_table_name(table, b, (bb_dimension)d)) != 0)
            return false;
    return true;
}

static bool is_in(const shown *s, uint32_t row)
{
    for (int d = 0; d < BB_DIMENSIONS; d++) {
        const char *name = bb_table_name(s->table, row, (bb_dimension)d);
        const char *wanted = s->within.names[d];
        const unsigned set = BB_SET(d);
        if ((name[0] == '\0' && (s->view->with & set) != 0) ||
            (name[0] != '\0' && (s->view->without & set) != 0) ||
            (wanted != NULL && wanted[0] != '\0' && strcmp(wanted, name) != 0))
            return false;
    }
    return (s->view->question == NULL ||
            strcmp(bb_table_name(s->table, row, BB_QUESTION), s->view->question) == 0) &&
           (s->view->having == NULL ||
            bb_table_get_text(s->table, row, s->view->having)[0] != '\0');
}

/* Each row joins the group of the first one like it. */
static void gather(shown *s)
{
    const uint32_t count = bb_table_row_count(s->table);
    bool *taken = calloc(count + 1, sizeof *taken);
    s->rows = calloc(count + 1, sizeof *s->rows);
    s->groups = calloc(count + 1, sizeof *s->groups);
    if (taken == NULL || s->rows == NULL || s->groups == NULL)
        s->view = NULL;
    for (uint32_t i = 0; s->view != NULL && i < count; i++) {
        if (taken[i] || !is_in(s, i))
            continue;
        s->groups[s->group_count++] = s->row_count;
        for (uint32_t k = i; k < count; k++)
            if (!taken[k] && is_in(s, k) && same_names(s->table, i, k, s->view->rows)) {
                taken[k] = true;
                s->rows[s->row_count++] = k;
            }
        s->groups[s->group_count] = s->row_count;
    }
    free(taken);
}

/* ---- figures ---- */

/* A value of one row, and of each round, if there are rounds. */
typedef struct value {
    double number; /* NAN: none */
    bb_samples rounds;
} value;

static void add_part(value *sum, const bb_table *table, uint32_t row, const char *part)
{
    const double number = bb_table_get_number(table, row, part);
    const bb_samples *rounds = bb_table_get_rounds(table, row, part);
    if (isnan(number))
        return;
    const bool first = isnan(sum->number);
    if (rounds == NULL || (!first && rounds->count != sum->rounds.count)) {
        sum->rounds.count = 0;
    } else {
        for (uint32_t i = 0; i < rounds->count; i++)
            sum->rounds.values[i] = (first ? 0 : sum->rounds.values[i]) + rounds->values[i];
        sum->rounds.count = rounds->count;
    }
    sum->number = first ? number : sum->number + number;
    if (!first && sum->rounds.count > 0)
        sum->number = bb_samples_median(&sum->rounds);
}

static void take_sum(value *sum, const bb_table *table, uint32_t row, const bb_view_column *column)
{
    sum->number = NAN;
    sum->rounds.count = 0;
    for (int i = 0; i < BB_VIEW_PARTS && column->parts[i] != NULL; i++)
        add_part(sum, table, row, column->parts[i]);
}

/* Divides by the base's figure, round by round. */
static void divide(value *sum, const shown *s, uint32_t row, const bb_view_column *column)
{
    const unsigned task = BB_SET(BB_SCENE) | BB_SET(BB_FRAME) | BB_SET(BB_QUESTION);
    value base = {.number = NAN};
    for (uint32_t i = 0; i < bb_table_row_count(s->table) && isnan(base.number); i++)
        if (is_in(s, i) && same_names(s->table, i, row, task))
            take_sum(&base, s->table, i, column);
    sum->rounds = bb_samples_ratio(&sum->rounds, &base.rounds);
    sum->number =
        sum->rounds.count > 0 ? bb_samples_median(&sum->rounds) : sum->number / base.number;
}

/* Over the rows of a group: the figure of one, or the geometric mean of all. */
static bb_estimate figure_of(const shown *s, uint32_t group, const bb_view_column *column)
{
    const uint32_t begin = s->groups[group], end = s->groups[group + 1];
    bb_samples logs = {0};
    double log_sum = 0;
    bb_estimate e = bb_not_measured;
    for (uint32_t i = begin; i < end; i++) {
        value one;
        take_sum(&one, s->table, s->rows[i], column);
        if (column->ratio)
            divide(&one, s, s->rows[i], column);
        if (end - begin == 1 && one.rounds.count > 0)
            return bb_samples_estimate(&one.rounds);
        if (end - begin == 1) {
            e.value = one.number;
            return e;
        }
        if (i == begin)
            logs.count = one.rounds.count;
        if (logs.count != one.rounds.count)
            logs.count = 0;
        for (uint32_t k = 0; k < logs.count; k++)
            logs.values[k] += log(one.rounds.values[k]);
        log_sum += log(one.number);
    }
    const double count = end - begin;
    for (uint32_t k = 0; k < logs.count; k++)
        logs.values[k] = exp(logs.values[k] / count);
    if (logs.count > 0)
        e = bb_samples_estimate(&logs);
    else
        e.value = exp(log_sum / count);
    return e;
}

/* ---- columns ---- */

static const bb_column *declared(const shown *s, const bb_view_column *column)
{
    for (int i = 0; i < BB_VIEW_PARTS && column->parts[i] != NULL; i++) {
        const bb_column *found = bb_table_column_named(s->table, column->parts[i]);
        if (found != NULL)
            return found;
    }
    return NULL;
}

static const char *text_of(const shown *s, uint32_t group, const bb_view_column *column)
{
    return bb_table_get_text(s->table, s->rows[s->groups[group]], column->parts[0]);
}

static bool has_value(const shown *s, uint32_t group, const bb_view_column *column)
{
    const bb_column *of = declared(s, column);
    return of != NULL && (of->kind == BB_COLUMN_TEXT ? text_of(s, group, column)[0] != '\0'
                                                     : !isnan(figure_of(s, group, column).value));
}

static bool any_value(const shown *s, const bb_view_column *column)
{
    for (uint32_t g = 0; g < s->group_count; g++)
        if (has_value(s, g, column))
            return true;
    return false;
}

static bool any_name(const shown *s, bb_dimension dimension)
{
    for (uint32_t i = 0; i < s->row_count; i++)
        if (bb_table_name(s->table, s->rows[i], dimension)[0] != '\0')
            return true;
    return false;
}

static void add_column(const shown *s, const bb_view_column *column, bb_page *page)
{
    const bb_column *of = declared(s, column);
    const char *heading = column->heading != NULL ? column->heading : of->heading;
    bb_page_column(page, heading, column->ratio ? "" : of->unit, of->help,
                   column->ratio ? 3 : of->decimals);
}

/* The best value of a column; NAN where none is better than others. */
static double best_of(const shown *s, const bb_view_column *column, bb_better better)
{
    double best = NAN;
    uint32_t count = 0;
    for (uint32_t g = 0; g < s->group_count; g++) {
        const double value = figure_of(s, g, column).value;
        count += !isnan(value);
        best = better == BB_BETTER_LESS ? fmin(best, value) : fmax(best, value);
    }
    return better != BB_BETTER_NEITHER && count > 1 ? best : NAN;
}

static void add_entry(const shown *s, uint32_t group, const bb_view_column *column, double best,
                      bb_page *page)
{
    if (declared(s, column)->kind == BB_COLUMN_TEXT) {
        bb_page_put_text(page, text_of(s, group, column));
        return;
    }
    const bb_estimate e = figure_of(s, group, column);
    bb_page_put_figure(page, e, e.value == best || (e.low <= best && best <= e.high));
}

/* ---- all of it ---- */

/* Groups are few: each is compared with each. */
static bool comes_before(const shown *s, uint32_t a, uint32_t b)
{
    const bb_column *of = bb_table_column_named(s->table, s->view->order);
    const bb_view_column column = {.parts = {s->view->order}};
    const double x = figure_of(s, a, &column).value, y = figure_of(s, b, &column).value;
    if (isnan(x) || isnan(y) || x == y)
        return isnan(x) == isnan(y) ? a < b : isnan(y);
    return of->better == BB_BETTER_MORE ? x > y : x < y;
}

static uint32_t group_at(const shown *s, uint32_t place)
{
    if (s->view->order == NULL || bb_table_column_named(s->table, s->view->order) == NULL)
        return place;
    for (uint32_t g = 0; g < s->group_count; g++) {
        uint32_t before = 0;
        for (uint32_t k = 0; k < s->group_count; k++)
            before += k != g && comes_before(s, k, g);
        if (before == place)
            return g;
    }
    return place;
}

static void add_rows(const shown *s, const bb_view_column *const *columns, uint32_t count,
                     bb_page *page)
{
    double best[BB_VIEW_COLUMNS];
    uint32_t rows = 0;
    for (uint32_t i = 0; i < count; i++)
        best[i] = best_of(s, columns[i], declared(s, columns[i])->better);
    for (uint32_t place = 0; place < s->group_count; place++) {
        const uint32_t g = group_at(s, place);
        uint32_t known = 0;
        while (known < count && !has_value(s, g, columns[known]))
            known++;
        if (known == count || (rows++ >= s->view->most && s->view->most > 0))
            continue;
        for (int d = 0; d < BB_DIMENSIONS; d++)
            if ((s->view->rows & BB_SET(d)) != 0 && any_name(s, (bb_dimension)d))
                bb_page_put_text(page,
                                 bb_table_name(s->table, s->rows[s->groups[g]], (bb_dimension)d));
        for (uint32_t i = 0; i < count; i++)
            add_entry(s, g, columns[i], best[i], page);
    }
    if (s->view->most > 0 && rows > s->view->most)
        bb_page_say(page, "and %u more", rows - s->view->most);
}

static void show(const shown *s, bb_page *page)
{
    const bb_view_column *columns[BB_VIEW_COLUMNS];
    uint32_t count = 0;
    for (uint32_t i = 0; i < BB_VIEW_COLUMNS && s->view->columns[i].parts[0] != NULL; i++)
        if (any_value(s, &s->view->columns[i]))
            columns[count++] = &s->view->columns[i];
    const bool has_x = s->view->axes == NULL || s->view->axes->drawing == BB_DRAW_BARS ||
                       columns[0] == &s->view->columns[0];
    if (count == 0 || !has_x)
        return;
    if (s->view->axes != NULL)
        bb_page_plot(page, s->view->caption, s->view->axes);
    else
        bb_page_grid(page, s->view->caption);
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if ((s->view->rows & BB_SET(d)) != 0 && any_name(s, (bb_dimension)d))
            bb_page_column(page, bb_dimension_names[d], "", "", 0);
    for (uint32_t i = 0; i < count; i++)
        add_column(s, columns[i], page);
    add_rows(s, columns, count, page);
}

void bb_view_show(const bb_table_view *view, const bb_table *table, bb_cell within, bb_page *page)
{
    shown s = {.view = view, .table = table, .within = within};
    gather(&s);
    if (s.view != NULL)
        show(&s, page);
    else
        bb_page_lose(page);
    free(s.rows);
    free(s.groups);
}

void bb_view_say(const bb_table *table, bb_cell cell, bb_page *page)
{
    const uint32_t row = bb_table_find(table, cell);
    char *text = NULL;
    size_t size;
    FILE *out = row != BB_NO_ROW ? open_memstream(&text, &size) : NULL;
    if (row == BB_NO_ROW)
        return;
    for (uint32_t c = 0; out != NULL && c < bb_table_column_count(table); c++) {
        const bb_column *column = bb_table_column(table, c);
        const char *value = bb_table_get_text(table, row, column->name);
        const double number = bb_table_get_number(table, row, column->name);
        char figure[BB_FIGURE_MAX];
        if (value[0] == '\0' && isnan(number))
            continue;
        if (value[0] == '\0')
            value = bb_figure(figure, number, column->decimals);
        fprintf(out, "%s%s %s%s%s", ftell(out) > 0 ? "; " : "", column->heading, value,
                column->unit[0] != '\0' ? " " : "", column->unit);
    }
    if (out == NULL || fclose(out) != 0)
        bb_page_lose(page);
    else if (text[0] != '\0')
        bb_page_say(page, "%s", text);
    free(text);
}
