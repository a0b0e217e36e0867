/* Tables of papers, filled with figures. */
#include "framework/papers/reproduce.h"

#include <math.h>
#include <stdlib.h>

enum { COLUMNS_MAX = 64, SCENES_SHOWN = 23 };

typedef struct filling {
    const bb_paper_table *table;
    const bb_findings *f;
    bb_reproduction *out;
} filling;

static size_t scenes_shown(const filling *t)
{
    return t->f->scene_count < SCENES_SHOWN ? t->f->scene_count : SCENES_SHOWN;
}

/* ---- cells ---- */

static const bb_figure *figure_of(const filling *t, const bb_paper_column *column)
{
    return column->figure != NULL ? column->figure : t->table->figure;
}

static void put_figure(const filling *t, const bb_paper_column *column, bb_paper_place at)
{
    bool timed;
    const bb_estimate e = bb_figure_at(at, figure_of(t, column), &timed);
    bb_paper_number(t->out,
                    column->shown == BB_SHOW_LOW    ? e.low
                    : column->shown == BB_SHOW_HIGH ? e.high
                                                    : e.value,
                    column->decimals);
}

static void put_range(const filling *t, const bb_paper_column *column, bb_paper_place at)
{
    const bb_paper_series s = bb_figure_series(at, figure_of(t, column));
    bb_paper_number(t->out,
                    column->shown == BB_SHOW_LEAST ? bb_series_least(&s) : bb_series_most(&s),
                    column->decimals);
}

static void put_scenes(const filling *t, const bb_paper_column *column, bb_paper_place at)
{
    for (size_t s = 0; s < scenes_shown(t); s++) {
        at.scene = t->f->scenes[s];
        put_figure(t, column, at);
    }
}

static void put_row(const filling *t, const bb_paper_column *column, bb_paper_place at)
{
    bb_words words = {0};
    bb_say(&words, "%s", at.row->name);
    if (column->shown == BB_SHOW_MISSING)
        bb_say_missing(at.row->builder, &words);
    bb_paper_text(t->out, words.text);
}

static void put_builder(const filling *t, const bb_paper_column *column, bb_paper_place at)
{
    static const bb_figure none = {.of = 0};
    char name[256], chosen[32];
    const bb_figure *figure = column->figure != NULL ? column->figure : &none;
    bb_figure_builder(&at, figure, figure->builder, NULL, name, chosen);
    bb_paper_text(t->out, name);
}

static void put_best(const filling *t, const bb_paper_column *column, bb_paper_place at)
{
    char name[256], chosen[32];
    bb_figure_builder(&at, column->figure, column->figure->builder, NULL, name, chosen);
    bb_paper_number(t->out, atof(chosen), 0);
}

static void put_words(const filling *t, const bb_paper_column *column, bb_paper_place at)
{
    bb_words words = {0};
    column->words(at, figure_of(t, column), &words);
    bb_paper_text(t->out, words.text);
}

static double paper_number(const bb_paper_numbers *row, const bb_paper_column *column)
{
    const double own = row->numbers[column->paper > 0 ? column->paper - 1 : 0];
    const double over = column->paper_over > 0 ? row->numbers[column->paper_over - 1] : 1;
    return column->paper > 0 && own != 0 && over != 0 ? own / over : (double)NAN;
}

static void put_cell(const filling *t, const bb_paper_column *column, bb_paper_place at)
{
    switch (column->shown) {
    case BB_SHOW_FIGURE:
    case BB_SHOW_LOW:
    case BB_SHOW_HIGH:
        put_figure(t, column, at);
        break;
    case BB_SHOW_LEAST:
    case BB_SHOW_MOST:
        put_range(t, column, at);
        break;
    case BB_SHOW_SCENES:
        put_scenes(t, column, at);
        break;
    case BB_SHOW_SCENE:
        bb_paper_text(t->out, at.scene != NULL ? at.scene : t->table->average);
        break;
    case BB_SHOW_VIEW:
        bb_paper_text(t->out, bb_view_name(t->f, at.scene, at.view));
        break;
    case BB_SHOW_ROW:
    case BB_SHOW_MISSING:
        put_row(t, column, at);
        break;
    case BB_SHOW_BUILDER:
        put_builder(t, column, at);
        break;
    case BB_SHOW_KERNEL:
        bb_paper_text(t->out, at.row->kernel);
        break;
    case BB_SHOW_NOTE:
        bb_paper_text(t->out, at.row != NULL && at.row->note != NULL ? at.row->note : "");
        break;
    case BB_SHOW_TEXT:
        bb_paper_text(t->out, bb_found_text(t->f, at.scene, at.row != NULL ? at.row->builder : NULL,
                                            column->note));
        break;
    case BB_SHOW_PAPER:
        bb_paper_number(t->out,
                        at.row->paper != NULL ? paper_number(at.row->paper, column) : (double)NAN,
                        column->decimals);
        break;
    case BB_SHOW_BEST:
        put_best(t, column, at);
        break;
    case BB_SHOW_NUMBER:
        bb_paper_number(t->out, column->number(at, column->figure), column->decimals);
        break;
    case BB_SHOW_WORDS:
        put_words(t, column, at);
        break;
    }
}

/* ---- rows ---- */

/* Of the row of means there are ratios alone. */
static bool has_mean(const bb_paper_column *column)
{
    return column->figure == NULL || column->figure->base != NULL ||
           column->shown == BB_SHOW_BUILDER;
}

static void add_row(const filling *t, bb_paper_place at)
{
    const bb_paper_table *table = t->table;
    if (at.row != NULL && at.row->optional && isnan(bb_value_at(at, table->needs)))
        return;
    bb_paper_row(t->out);
    for (const bb_paper_column *c = table->columns; c->heading != NULL; c++)
        if (table->by_scene && at.scene == NULL && !has_mean(c))
            bb_paper_number(t->out, NAN, 0);
        else
            put_cell(t, c, at);
}

static void add_views(const filling *t, bb_paper_place at)
{
    for (int v = 0; v < t->table->views || v == 0; v++) {
        at.view = t->table->views > 0 ? v : -1;
        if (v > 0 && at.scene != NULL && bb_view_name(t->f, at.scene, v)[0] == '\0')
            return; /* it has fewer */
        add_row(t, at);
    }
}

static void add_entrants(const filling *t, bb_paper_place at)
{
    if (t->table->rows == NULL || t->table->rows_first)
        add_views(t, at);
    else
        for (at.row = t->table->rows; at.row->name != NULL; at.row++)
            add_views(t, at);
}

static void add_scenes(const filling *t, bb_paper_place at)
{
    if (!t->table->by_scene) {
        add_entrants(t, at);
        return;
    }
    for (size_t s = 0; s < t->f->scene_count; s++) {
        at.scene = t->f->scenes[s];
        add_entrants(t, at);
    }
}

/* ---- the paper's rows ---- */

/* A mean that the paper does not have is that of its rows. */
static double paper_mean(const bb_paper_table *table, const bb_paper_column *column)
{
    double sum = 0;
    uint32_t count = 0;
    const double own = paper_number(table->paper_average, column);
    if (!isnan(own) || column->paper_over == 0)
        return own;
    for (const bb_paper_numbers *row = table->paper; row->name != NULL; row++, count++)
        sum += paper_number(row, column);
    return sum / count;
}

static void add_paper_row(const filling *t, const bb_paper_numbers *row)
{
    const bb_paper_table *table = t->table;
    bb_words name = {0};
    bb_say(&name, "%s (paper)", row->name);
    bb_paper_row(t->out);
    for (const bb_paper_column *c = table->columns; c->heading != NULL; c++)
        if (c->shown == BB_SHOW_SCENE)
            bb_paper_text(t->out, name.text);
        else if (c->shown == BB_SHOW_NOTE || c->shown == BB_SHOW_WORDS)
            bb_paper_text(t->out, row == table->paper_average ? c->note : "");
        else
            bb_paper_number(
                t->out, row == table->paper_average ? paper_mean(table, c) : paper_number(row, c),
                c->decimals);
}

static void add_paper_words(const filling *t)
{
    const char *const *text = t->table->paper_words;
    bb_paper_row(t->out);
    for (const bb_paper_column *c = t->table->columns; c->heading != NULL; c++, text++)
        if (*text != NULL)
            bb_paper_text(t->out, *text);
        else
            bb_paper_number(t->out, NAN, 0);
}

/* ---- tables ---- */

static void begin(const filling *t)
{
    const char *columns[COLUMNS_MAX + 1] = {NULL};
    size_t count = 0;
    bb_words title = {0};
    bb_say(&title, "%s", t->table->title);
    if (t->table->title_words != NULL)
        t->table->title_words((bb_paper_place){.all = t->f, .view = -1}, &title);
    for (const bb_paper_column *c = t->table->columns; c->heading != NULL; c++)
        if (c->shown != BB_SHOW_SCENES) {
            columns[count++] = c->heading;
        } else {
            for (size_t s = 0; s < scenes_shown(t); s++)
                columns[count++] = t->f->scenes[s];
            if (t->f->scene_count > SCENES_SHOWN)
                bb_say(&title, " (columns: the first %d of %zu scenes)", SCENES_SHOWN,
                       t->f->scene_count);
        }
    bb_paper_table_begin(t->out, title.text, columns);
}

static void add_table(const filling *t)
{
    const bb_paper_table *table = t->table;
    bb_paper_place at = {.all = t->f, .view = -1};
    if (table->title[0] != '\0')
        begin(t);
    for (const bb_paper_numbers *row = table->paper; row != NULL && row->name != NULL; row++)
        if (!table->paper_last)
            add_paper_row(t, row);
    for (at.row = table->rows; table->rows_first && at.row->name != NULL; at.row++) {
        add_scenes(t, at);
        add_row(t, at);
    }
    at.row = NULL;
    if (!table->rows_first)
        add_scenes(t, at);
    if (table->paper_average != NULL)
        add_paper_row(t, table->paper_average);
    if (table->average != NULL && !table->rows_first)
        add_row(t, at);
    for (const bb_paper_numbers *row = table->paper; row != NULL && row->name != NULL; row++)
        if (table->paper_last)
            add_paper_row(t, row);
    if (table->paper_words != NULL)
        add_paper_words(t);
}

void bb_paper_add_tables(const bb_paper_table *tables, const bb_findings *all, bb_reproduction *r)
{
    for (const bb_paper_table *table = tables; table->title != NULL; table++) {
        const filling t = {table, &all[table->of], r};
        add_table(&t);
    }
}
