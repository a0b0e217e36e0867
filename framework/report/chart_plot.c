/* Writes series, axes and marks of the pictures in gnuplot's language. */
#include "framework/report/chart_plot.h"
#include "framework/record/record.h"

#include <math.h>
#include <string.h>

enum { COLOURS = 12, SHAPES = 6 };

/* Colours of the page on white, and gnuplot's numbers of marks: circle, triangle, square, diamond,
 * triangle on its head, pentagon. */
static const unsigned colours[COLOURS] = {0x0b62b0, 0xb8420f, 0x17734a, 0x8a3a9b,
                                          0x7a5a00, 0x00727a, 0xb0103e, 0x5a5f66,
                                          0x4b6b00, 0x4f46c4, 0x9c4668, 0x2b2b2b};
static const int filled[SHAPES] = {7, 9, 5, 13, 11, 15}, hollow[SHAPES] = {6, 8, 4, 12, 10, 14};

/* ---- series ---- */

bool bb_same_builder(const bb_chart_cell *a, const bb_chart_cell *b)
{
    return bb_same_text(a->trace, b->trace, BB_F_TRACE_BUILDER) &&
           bb_chart_run(a) == bb_chart_run(b);
}

bool bb_same_kernel(const bb_chart_cell *a, const bb_chart_cell *b)
{
    return bb_same_text(a->trace, b->trace, BB_F_TRACE_KERNEL);
}

bool bb_same_intersector(const bb_chart_cell *a, const bb_chart_cell *b)
{
    return bb_same_text(a->trace, b->trace, BB_F_TRACE_INTERSECTOR);
}

uint32_t bb_series_find(const bb_series *list, const bb_chart_cell *cell)
{
    uint32_t i = 0;
    while (i < list->count && !list->same(list->cells[i], cell))
        i++;
    return i;
}

void bb_series_add(bb_series *list, const bb_chart_cell *cell)
{
    if (cell->reference == list->references && bb_series_find(list, cell) == list->count)
        list->cells[list->count++] = cell;
}

unsigned bb_plot_colour(uint32_t series)
{
    return colours[series % COLOURS];
}

void bb_plot_kernel_key(uint32_t series, char key[BB_PLOT_KEY])
{
    char reversed[BB_PLOT_KEY];
    int length = 0, at = 0;
    for (uint32_t rest = series + 1; rest > 0; rest = (rest - 1) / 26)
        reversed[length++] = (char)('A' + (rest - 1) % 26);
    while (length > 0)
        key[at++] = reversed[--length];
    key[at] = '\0';
}

void bb_plot_builder_key(const bb_plot *p, const bb_chart_cell *cell, char key[BB_PLOT_KEY])
{
    uint32_t index = bb_series_find(cell->reference ? &p->references : &p->builders, cell);
    snprintf(key, BB_PLOT_KEY, "%s%u", cell->reference ? "R" : "", index + 1);
}

int bb_plot_shape(const bb_plot *p, const bb_chart_cell *cell)
{
    if (cell->reference)
        return BB_PLOT_CROSS;
    uint32_t index = bb_series_find(&p->intersectors, cell) % SHAPES;
    return cell->wrong_rays > 0 ? filled[index] : hollow[index];
}

/* ---- text ---- */

/* Doubles quotes and drops control characters. */
void bb_plot_quoted(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '\'')
            fputc('\'', out);
        fputc(c < 0x20 || c == 0x7F ? '?' : c, out);
    }
}

void bb_plot_brief(double value, char text[32])
{
    static const struct {
        double size;
        const char *unit;
    } units[] = {{1e12, " T"}, {1e9, " G"}, {1e6, " M"}, {1e3, " k"}, {0, ""}};
    size_t i = 0;
    while (value < units[i].size)
        i++;
    snprintf(text, 32, "%.3g%s", units[i].size > 0 ? value / units[i].size : value, units[i].unit);
}

/* ---- axes ---- */

bb_chart_axis bb_axis_make(bool log)
{
    return (bb_chart_axis){INFINITY, -INFINITY, log};
}

void bb_axis_add(bb_chart_axis *a, double value)
{
    if (!isfinite(value) || (a->log && !(value > 0)))
        return;
    a->low = fmin(a->low, value);
    a->high = fmax(a->high, value);
}

void bb_axis_round(bb_chart_axis *a)
{
    if (a->log) {
        a->low = pow(10, floor(log10(a->low) - 1e-9));
        a->high = pow(10, ceil(log10(a->high) + 1e-9));
        return;
    }
    double room = a->high > a->low ? 0.08 * (a->high - a->low) : 0.1 * fabs(a->high) + 1e-9;
    a->low = a->low >= 0 ? fmax(0, a->low - room) : a->low - room;
    a->high += room;
}

/* Returns the position along the axis, from 0 to 1. */
static double along(const bb_chart_axis *a, double value)
{
    return a->log ? log10(value / a->low) / log10(a->high / a->low)
                  : (value - a->low) / (a->high - a->low);
}

void bb_plot_begin(bb_plot *p, const bb_chart_frame *f)
{
    FILE *out = p->out;
    /* the legend adds to the height and does not shrink the plot */
    fprintf(out, "\nreset\nset encoding utf8\nheight = %u\nset output '%s_%s.svg'\n",
            560 + 19 * (f->entries + 1), p->stem, f->kind);
    fputs("set terminal svg noenhanced size 960,height dynamic font 'sans-serif,13' background "
          "'#ffffff'\nset title '",
          out);
    bb_plot_quoted(out, p->set->scene);
    fputs(", ", out);
    bb_plot_quoted(out, p->set->rays);
    if (p->set->cell_count > 0 &&
        strcmp(bb_get_text(p->set->cells[0].trace, BB_F_TRACE_RAYS_SOURCE), "as given") == 0)
        fputs(" (rays as given)", out);
    /* only the line break is in double quotes, which would expand names */
    fprintf(out, ": %s'.\"\\n%s", f->title, f->subtitle);
    if (f->left_out > 0)
        fprintf(out, "\\nnot drawn, since not checked or without a result in a view: %u cells",
                f->left_out);
    fprintf(out, "\"\nset xlabel '%s'\nset ylabel '%s'\n", f->x_title, f->y_title);
    fputs("set key below left Left reverse vertical samplen 2 title ' '\nset grid back lc rgb "
          "'#d3d7dc' lt 1\nset border lc rgb '#565d67'\nset errorbars small\nset pointsize 1.1\n"
          "set rmargin 4\n",
          out);
    fprintf(out, "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n", f->x.low, f->x.high, f->y.low,
            f->y.high);
    fprintf(out, "%s%s", f->x.log ? "set logscale x\nset format x '%.0s%c'\n" : "",
            f->y.log ? "set logscale y\nset format y '%.0s%c'\n" : "");
}

void bb_plot_end(bb_plot *p, const bb_chart_frame *f)
{
    fprintf(p->out,
            "\nset terminal pngcairo noenhanced size 1440,1.5*height fontscale 1.5 linewidth 1.5 "
            "pointscale 2.4 font 'sans-serif,13' background '#ffffff'\nset output '%s_%s.png'\n"
            "replot\n",
            p->stem, f->kind);
    p->pictures++;
}

/* ---- marks ---- */

static double or_else(double value, double fallback)
{
    return isfinite(value) ? value : fallback;
}

void bb_plot_place_keys(bb_mark *marks, uint32_t count, const bb_chart_axis *x,
                        const bb_chart_axis *y)
{
    for (uint32_t i = 0; i < count; i++) {
        marks[i].labelled = true;
        for (uint32_t k = 0; k < i && marks[i].labelled; k++)
            if (marks[k].labelled && fabs(along(x, marks[i].x) - along(x, marks[k].x)) < 0.035 &&
                fabs(along(y, marks[i].y) - along(y, marks[k].y)) < 0.04)
                marks[i].labelled = false;
    }
}

void bb_plot_speed(bb_mark *mark, bb_chart_axis *y)
{
    const bb_chart_cell *cell = mark->cell;
    bool sure = isfinite(cell->mrays_s_lo) && isfinite(cell->mrays_s_hi);
    mark->y = cell->mrays_s;
    mark->y_low = sure ? cell->mrays_s_lo : (double)NAN;
    mark->y_high = sure ? cell->mrays_s_hi : (double)NAN;
    mark->y_least = sure ? (double)NAN : cell->mrays_s_least;
    mark->y_most = sure ? (double)NAN : cell->mrays_s_most;
    bb_axis_add(y, mark->y);
    bb_axis_add(y, mark->y_high);
    bb_axis_add(y, mark->y_most);
}

/* Writes the data: x y, both intervals, colour, mark, length of the arrow for "at most", least and
 * length of the range, key. */
static void print_marks(FILE *out, const bb_mark *marks, uint32_t count)
{
    fputs("$marks << EOD\n", out);
    for (uint32_t i = 0; i < count; i++) {
        const bb_mark *m = &marks[i];
        double least = or_else(m->y_least, m->y), most = or_else(m->y_most, m->y);
        fprintf(out, "%.9g %.9g %.9g %.9g %.9g %.9g %u %d %.9g %.9g %.9g %s\n", m->x, m->y,
                m->at_most ? m->x : or_else(m->x_low, m->x), or_else(m->x_high, m->x),
                or_else(m->y_low, m->y), or_else(m->y_high, m->y), m->colour, m->shape,
                m->at_most ? m->x / 1.35 - m->x : 0.0, least, most - least,
                m->labelled ? m->key : "");
    }
    fputs("EOD\n", out);
}

void bb_plot_marks(FILE *out, const bb_mark *marks, uint32_t count, bool front)
{
    print_marks(out, marks, count);
    fprintf(
        out,
        "plot %s$marks using 1:2:3:4:5:6:7 with xyerrorbars pt 0 ps 0 lw 0.6 lc rgb variable "
        "notitle, \\\n $marks using 1:10:(0):11:7 with vectors nohead dt 3 lw 1.2 lc rgb variable "
        "notitle, \\\n $marks using 1:2:9:(0) with vectors head filled size screen 0.008,20 lc "
        "rgb '#565d67' notitle, \\\n $marks using 1:2:8:7 with points pt variable lc rgb "
        "variable notitle, \\\n $marks using 1:2:12 with labels left offset char 0.8,0.5 tc "
        "rgb '#1b1e23' notitle",
        front ? "$front using 1:2 with lines lw 1.2 lc rgb '#565d67' title 'Pareto front', "
                "\\\n "
              : "");
}

static void legend_entry(FILE *out, unsigned colour, int shape, const char *key, const char *name)
{
    fprintf(out, ", \\\n NaN with points pt %d lc rgb '#%06x' title '%s%s", shape, colour, key,
            key[0] != '\0' ? "  " : "");
    bb_plot_quoted(out, name);
    fputc('\'', out);
}

static void legend_builder(const bb_plot *p, const bb_chart_cell *cell, unsigned colour, int shape)
{
    char key[BB_PLOT_KEY], name[600];
    bb_plot_builder_key(p, cell, key);
    bb_chart_builder_name(cell, p->several_runs, name, sizeof name);
    legend_entry(p->out, colour, shape, key, name);
}

void bb_plot_legend_series(const bb_plot *p, const bb_series *list, uint32_t marks, bool coloured)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const bb_chart_cell *cell = list->cells[i];
        uint32_t k = 0;
        while (k < marks && (p->marks[k].cell->reference != list->references ||
                             !list->same(p->marks[k].cell, cell)))
            k++;
        char key[BB_PLOT_KEY];
        bb_plot_kernel_key(i, key);
        if (k == marks)
            continue;
        if (list == &p->kernels)
            legend_entry(p->out, coloured ? bb_plot_colour(i) : BB_PLOT_BLACK, coloured ? 5 : 0,
                         key, bb_get_text(cell->trace, BB_F_TRACE_KERNEL));
        else
            legend_builder(p, cell, coloured ? bb_plot_colour(i) : BB_PLOT_BLACK,
                           list->references ? BB_PLOT_CROSS : 5);
    }
}

void bb_plot_legend_spread(const bb_plot *p, uint32_t marks)
{
    bool interval = false, range = false;
    for (uint32_t i = 0; i < marks; i++) {
        interval = interval || isfinite(p->marks[i].y_low);
        range = range || isfinite(p->marks[i].y_least);
    }
    if (interval)
        fputs(", \\\n NaN with lines lw 0.6 lc rgb '#565d67' title 'upright: 95 % interval of the "
              "median'",
              p->out);
    if (range)
        fputs(", \\\n NaN with lines lw 1.2 dt 3 lc rgb '#565d67' title 'upright, dotted: range of "
              "the rounds, too few for a 95 % interval'",
              p->out);
}

void bb_plot_legend_shapes(const bb_plot *p)
{
    for (uint32_t i = 0; i < p->intersectors.count; i++)
        legend_entry(p->out, BB_PLOT_BLACK, filled[i % SHAPES], "",
                     bb_get_text(p->intersectors.cells[i]->trace, BB_F_TRACE_INTERSECTOR));
}
