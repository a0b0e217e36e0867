/* Views of tables: rows are chosen, gathered and compared. */
#include "framework/table/view.h"

#include "framework/table/figure.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES_MAX = 400 };

typedef struct shown {
    const bb_table_view *view;
    const bb_table *table;
    bb_cell within;
    uint32_t *rows, row_count;     /* of the table; rows of one group follow each other */
    uint32_t *groups, group_count; /* where in `rows` a row of the grid begins; one more: the end */
    uint32_t *lanes, lane_count;   /* the first row of each combination of names `across` */
} shown;

/* A column of the view, of the rows that have the names of row `lane` across. */
typedef struct column {
    const bb_view_column *of;
    uint32_t lane;
} column;

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

/* The first row of each combination of names; returns their number. */
static uint32_t find_distinct(const shown *s, unsigned dimensions, uint32_t *distinct)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->row_count; i++) {
        uint32_t k = 0;
        while (k < count && !same_names(s->table, distinct[k], s->rows[i], dimensions))
            k++;
        if (k == count)
            distinct[count++] = s->rows[i];
    }
    return count;
}

static void order_by_group(shown *s, uint32_t *ordered)
{
    uint32_t count = 0;
    s->group_count = find_distinct(s, s->view->rows, s->groups);
    for (uint32_t g = 0; g < s->group_count; g++) {
        const uint32_t first = s->groups[g];
        s->groups[g] = count;
        for (uint32_t i = 0; i < s->row_count; i++)
            if (same_names(s->table, first, s->rows[i], s->view->rows))
                ordered[count++] = s->rows[i];
    }
    s->groups[s->group_count] = count;
    memcpy(s->rows, ordered, count * sizeof *ordered);
}

static void release(shown *s)
{
    free(s->rows);
    free(s->groups);
    free(s->lanes);
}

/* Returns false without memory. */
static bool gather(shown *s)
{
    const uint32_t count = bb_table_row_count(s->table) + 1;
    uint32_t *ordered = calloc(count, sizeof *ordered);
    s->rows = calloc(count, sizeof *s->rows);
    s->groups = calloc(count, sizeof *s->groups);
    s->lanes = calloc(count, sizeof *s->lanes);
    const bool ok = ordered != NULL && s->rows != NULL && s->groups != NULL && s->lanes != NULL;
    for (uint32_t i = 0; i + 1 < count && ok; i++)
        if (is_in(s, i))
            s->rows[s->row_count++] = i;
    if (ok) {
        s->lane_count = find_distinct(s, s->view->across, s->lanes);
        order_by_group(s, ordered);
    }
    free(ordered);
    return ok;
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

static bool is_in_lane(const shown *s, uint32_t row, const column *column)
{
    return same_names(s->table, row, column->lane, s->view->across);
}

/* Over the rows of a group: the figure of one, or the geometric mean of all. */
static bb_estimate figure_of(const shown *s, uint32_t group, const column *column)
{
    bb_samples logs = {0};
    double log_sum = 0;
    uint32_t count = 0;
    value one = {.number = NAN};
    for (uint32_t i = s->groups[group]; i < s->groups[group + 1]; i++) {
        if (!is_in_lane(s, s->rows[i], column))
            continue;
        take_sum(&one, s->table, s->rows[i], column->of);
        if (column->of->ratio)
            divide(&one, s, s->rows[i], column->of);
        if (count++ == 0)
            logs.count = one.rounds.count;
        if (logs.count != one.rounds.count)
            logs.count = 0;
        for (uint32_t k = 0; k < logs.count; k++)
            logs.values[k] += log(one.rounds.values[k]);
        log_sum += log(one.number);
    }
    for (uint32_t k = 0; k < logs.count; k++)
        logs.values[k] = exp(logs.values[k] / count);
    if (logs.count > 0)
        return bb_samples_estimate(count == 1 ? &one.rounds : &logs);
    bb_estimate e = bb_not_measured;
    e.value = count == 1 ? one.number : exp(log_sum / count);
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

/* The first row's. */
static const char *text_of(const shown *s, uint32_t group, const column *column)
{
    for (uint32_t i = s->groups[group]; i < s->groups[group + 1]; i++)
        if (is_in_lane(s, s->rows[i], column))
            return bb_table_get_text(s->table, s->rows[i], column->of->parts[0]);
    return "";
}

static bool has_value(const shown *s, uint32_t group, const column *column)
{
    const bb_column *of = declared(s, column->of);
    return of != NULL && (of->kind == BB_COLUMN_TEXT ? text_of(s, group, column)[0] != '\0'
                                                     : !isnan(figure_of(s, group, column).value));
}

static bool any_value(const shown *s, const column *column)
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

static bool starts_with_number(const char *name)
{
    char *end;
    strtod(name, &end);
    return end != name;
}

/* Whether the numbers of these names are x of curves. */
static bool is_x(const shown *s, bb_dimension dimension)
{
    if (s->view->axes == NULL || s->view->axes->drawing == BB_DRAW_BARS)
        return false;
    for (uint32_t i = 0; i < s->row_count; i++)
        if (!starts_with_number(bb_table_name(s->table, s->rows[i], dimension)))
            return false;
    return true;
}

/* The names of a row, between commas. */
static void join_names(const bb_table *table, uint32_t row, unsigned dimensions,
                       char out[NAMES_MAX])
{
    size_t used = 0;
    out[0] = '\0';
    for (int d = 0; d < BB_DIMENSIONS; d++) {
        const char *name = bb_table_name(table, row, (bb_dimension)d);
        if ((dimensions & BB_SET(d)) != 0 && name[0] != '\0' && used < NAMES_MAX)
            used +=
                (size_t)snprintf(out + used, NAMES_MAX - used, "%s%s", used > 0 ? ", " : "", name);
    }
}

static void add_column(const shown *s, const column *column, bb_page *page)
{
    const bb_column *of = declared(s, column->of);
    const bool bare = column->of->heading != NULL && column->of->heading[0] == '\0';
    const char *own = column->of->heading != NULL ? column->of->heading : of->heading;
    char names[NAMES_MAX], heading[NAMES_MAX + 80];
    join_names(s->table, column->lane, s->view->across, names);
    snprintf(heading, sizeof heading, "%s%s%.70s", names, names[0] != '\0' && !bare ? " " : "",
             own);
    bb_page_column(page, heading, column->of->ratio || bare ? "" : of->unit, of->help,
                   column->of->ratio ? 3 : of->decimals);
}

/* The best value of a column; NAN where none is better than others. */
static double best_of(const shown *s, const column *column)
{
    const bb_better better = declared(s, column->of)->better;
    double best = NAN;
    uint32_t count = 0;
    for (uint32_t g = 0; g < s->group_count; g++) {
        const double value = figure_of(s, g, column).value;
        count += !isnan(value);
        best = better == BB_BETTER_LESS ? fmin(best, value) : fmax(best, value);
    }
    const bool alike = (s->view->rows & (BB_SET(BB_FRAME) | BB_SET(BB_MAKER))) == 0;
    return better != BB_BETTER_NEITHER && count > 1 && alike ? best : NAN;
}

static void add_entry(const shown *s, uint32_t group, const column *column, double best,
                      bb_page *page)
{
    if (declared(s, column->of)->kind == BB_COLUMN_TEXT) {
        bb_page_put_text(page, text_of(s, group, column));
        return;
    }
    const bb_estimate e = figure_of(s, group, column);
    bb_page_put_figure(page, e, e.value == best || (e.low <= best && best <= e.high) ? '*' : 0);
}

/* ---- all of it ---- */

/* Groups are few: each is compared with each. */
static bool comes_before(const shown *s, uint32_t a, uint32_t b)
{
    const bb_column *of = bb_table_column_named(s->table, s->view->order);
    const bb_view_column by = {.parts = {s->view->order}};
    const column first = {&by, s->rows[s->groups[a]]}, second = {&by, s->rows[s->groups[b]]};
    const double x = figure_of(s, a, &first).value, y = figure_of(s, b, &second).value;
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

static void add_name(const shown *s, uint32_t group, bb_dimension dimension, bb_page *page)
{
    const uint32_t row = s->rows[s->groups[group]];
    char run[16];
    const char *name = dimension == BB_RUN /* people count from 1, as do the headings of runs */
                           ? bb_run_name(bb_table_run_of(s->table, row) + 1, run)
                           : bb_table_name(s->table, row, dimension);
    bb_estimate x = bb_not_measured;
    x.value = is_x(s, dimension) ? strtod(name, NULL) : NAN;
    if (is_x(s, dimension))
        bb_page_put_figure(page, x, 0);
    else
        bb_page_put_text(page, name);
}

static void add_rows(const shown *s, const column *columns, uint32_t count, bb_page *page)
{
    double best[BB_HEADS_MAX];
    uint32_t rows = 0;
    for (uint32_t i = 0; i < count; i++)
        best[i] = best_of(s, &columns[i]);
    for (uint32_t place = 0; place < s->group_count; place++) {
        const uint32_t g = group_at(s, place);
        uint32_t known = 0;
        while (known < count && !has_value(s, g, &columns[known]))
            known++;
        if (known == count || (rows++ >= s->view->most && s->view->most > 0))
            continue;
        for (int d = 0; d < BB_DIMENSIONS; d++)
            if ((s->view->rows & BB_SET(d)) != 0 && any_name(s, (bb_dimension)d))
                add_name(s, g, (bb_dimension)d, page);
        for (uint32_t i = 0; i < count; i++)
            add_entry(s, g, &columns[i], best[i], page);
    }
    if (s->view->most > 0 && rows > s->view->most)
        bb_page_say(page, "and %u more", rows - s->view->most);
}

static void show_columns(const shown *s, const char *caption, const column *columns, uint32_t count,
                         bb_page *page)
{
    if (s->view->axes != NULL)
        bb_page_plot(page, caption, s->view->axes);
    else
        bb_page_grid(page, caption);
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if ((s->view->rows & BB_SET(d)) != 0 && any_name(s, (bb_dimension)d))
            bb_page_column(page, bb_dimension_names[d], "", "", 0);
    for (uint32_t i = 0; i < count; i++)
        add_column(s, &columns[i], page);
    add_rows(s, columns, count, page);
}

/* Without its x a curve would show another column by it. */
static bool has_x(const shown *s, const column *columns)
{
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if ((s->view->rows & BB_SET(d)) != 0 && is_x(s, (bb_dimension)d))
            return true;
    return s->view->axes == NULL || s->view->axes->drawing == BB_DRAW_BARS ||
           columns[0].of == &s->view->columns[0];
}

/* A grid has at most so many columns: others make another one. */
static void show(const shown *s, const char *caption, bb_page *page)
{
    const uint32_t most = BB_HEADS_MAX - BB_DIMENSIONS;
    column *columns = calloc(BB_VIEW_COLUMNS * (size_t)s->lane_count, sizeof *columns);
    uint32_t count = 0;
    if (columns == NULL) {
        bb_page_lose(page);
        return;
    }
    for (uint32_t i = 0; i < BB_VIEW_COLUMNS && s->view->columns[i].parts[0] != NULL; i++)
        for (uint32_t lane = 0; lane < s->lane_count; lane++) {
            columns[count] = (column){&s->view->columns[i], s->lanes[lane]};
            count += any_value(s, &columns[count]);
        }
    for (uint32_t i = 0; i < count && has_x(s, columns); i += most)
        show_columns(s, caption, columns + i, count - i < most ? count - i : most, page);
    free(columns);
}

/* One of the grids or plots: that with the names `each` of a row. */
static void show_each(const shown *all, uint32_t row, bb_page *page)
{
    shown s = {.view = all->view, .table = all->table, .within = all->within};
    char names[NAMES_MAX], caption[NAMES_MAX + 128];
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if ((s.view->each & BB_SET(d)) != 0)
            s.within.names[d] = bb_table_name(s.table, row, (bb_dimension)d);
    join_names(s.table, row, s.view->each, names);
    snprintf(caption, sizeof caption, "%.120s%s%s", s.view->caption, names[0] != '\0' ? ", " : "",
             names);
    if (gather(&s))
        show(&s, caption, page);
    else
        bb_page_lose(page);
    release(&s);
}

void bb_view_show(const bb_table_view *view, const bb_table *table, bb_cell within, bb_page *page)
{
    shown s = {.view = view, .table = table, .within = within};
    uint32_t *each = calloc(bb_table_row_count(table) + 1, sizeof *each);
    const bool ok = gather(&s) && each != NULL;
    const uint32_t count = ok ? find_distinct(&s, view->each, each) : 0;
    if (!ok)
        bb_page_lose(page);
    for (uint32_t i = 0; i < count; i++)
        show_each(&s, each[i], page);
    free(each);
    release(&s);
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
