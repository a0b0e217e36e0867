/* Axes, titles and style of a picture, for screens or for print, and where its keys have room. */
#include "framework/report/chart_plot.h"

#include <math.h>
#include <string.h>

/* In print, letters are this high. */
enum { PRINT_POINTS = 7 };
#define POINTS_PER_MM (72 / 25.4)
#define LETTER 0.6 /* width of a letter, of its height: DejaVu Sans is the widest */

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

static bool is_as_given(const bb_plot *p)
{
    return p->set->cell_count > 0 &&
           strcmp(bb_get_text(p->set->cells[0].trace, BB_F_TRACE_RAYS_SOURCE), "as given") == 0;
}

/* Writes the terminal and the title for the screen. */
static void begin_on_screen(bb_plot *p, const bb_chart_frame *f)
{
    FILE *out = p->out;
    /* the legend adds to the height and does not shrink the plot */
    fprintf(out, "height = %u\nset output '%s_%s.svg'\n", 560 + 19 * (f->entries + 1), p->stem,
            f->kind);
    fputs("set terminal svg noenhanced size 960,height dynamic font 'sans-serif,13' background "
          "'#ffffff'\nset title '",
          out);
    bb_plot_quoted(out, p->set->scene);
    fputs(", ", out);
    bb_plot_quoted(out, p->set->rays);
    if (is_as_given(p))
        fputs(" (rays as given)", out);
    /* only the line break is in double quotes, which would expand names */
    fprintf(out, ": %s'.\"\\n%s%s%s", f->title, f->subtitle, f->marks != NULL ? "\\n" : "",
            f->marks != NULL ? f->marks : "");
    if (f->left_out > 0)
        fprintf(out, "\\nnot drawn, since not checked or without a result in a view: %u cells",
                f->left_out);
    fputs("\"\nset key below left Left reverse vertical samplen 2 title ' '\nset grid back lc rgb "
          "'#d3d7dc' lt 1\nset border lc rgb '#565d67'\nset pointsize 1.1\n"
          "set rmargin 4\n",
          out);
}

static double width_of(const bb_plot *p)
{
    return p->figure->width_mm * POINTS_PER_MM;
}

/* The plot's own height in points; the legend comes below it. */
static double height_of(const bb_plot *p)
{
    return 0.7 * width_of(p);
}

/* Columns of the legend that fit beside each other. */
static uint32_t columns_of(const bb_plot *p)
{
    const bb_series *const lists[] = {&p->kernels, &p->builders, &p->references};
    char key[BB_PLOT_KEY];
    size_t longest = 12; /* "Pareto front" */
    for (size_t l = 0; l < 3; l++)
        for (uint32_t i = 0; i < lists[l]->count; i++) {
            if (lists[l] == &p->kernels)
                bb_plot_kernel_key(p, lists[l]->cells[i], key);
            else
                bb_plot_builder_key(p, lists[l]->cells[i], key);
            longest = strlen(key) > longest ? strlen(key) : longest;
        }
    const double fit = width_of(p) / ((LETTER * longest + 5) * PRINT_POINTS);
    return fit < 1 ? 1 : (uint32_t)fit;
}

/* Writes the terminal for print, by the extension of the file's name. */
static void begin_in_print(bb_plot *p, const bb_chart_frame *f)
{
    enum { SVG_PER_INCH = 96, PNG_PER_INCH = 600 };
    const uint32_t columns = columns_of(p);
    const double rows = ceil((f->entries + 3.0) / columns);
    const double wide = width_of(p), high = height_of(p) + 1.5 * PRINT_POINTS * rows;
    const char *file = p->figure->file, *format = strrchr(file, '.');
    FILE *out = p->out;
    if (strcmp(format, ".pdf") == 0)
        fprintf(out,
                "set terminal pdfcairo noenhanced size %.4fin,%.4fin font 'sans-serif,%d' "
                "fontscale 0.75 linewidth 0.75 pointscale 0.5\n",
                wide / 72, high / 72, PRINT_POINTS);
    else if (strcmp(format, ".svg") == 0)
        fprintf(
            out,
            "set terminal svg noenhanced size %.0f,%.0f font 'sans-serif,%.2f' linewidth 0.75\n",
            wide / 72 * SVG_PER_INCH, high / 72 * SVG_PER_INCH, PRINT_POINTS / 72.0 * SVG_PER_INCH);
    else
        fprintf(out,
                "set terminal pngcairo noenhanced size %.0f,%.0f font 'sans-serif,%d' fontscale "
                "%.4f linewidth %.4f pointscale %.4f\n",
                wide / 72 * PNG_PER_INCH, high / 72 * PNG_PER_INCH, PRINT_POINTS,
                PNG_PER_INCH / 96.0, PNG_PER_INCH / 128.0, 0.5 * PNG_PER_INCH / 96.0);
    fprintf(out,
            "set output '%s'\nset key below left Left reverse vertical samplen 1.5 maxcols %u\n",
            file, columns);
    fputs("set grid back lc rgb '#c8c8c8' lt 1 lw 0.5\nset border 3\nset tics nomirror\n"
          "set xlabel offset 0,1\nset xtics offset 0,0.4\nset pointsize 0.6\n",
          out);
}

void bb_plot_begin(bb_plot *p, const bb_chart_frame *f)
{
    char name[BB_PLOT_STEM + 64];
    snprintf(name, sizeof name, "%s_%s", p->stem, f->kind);
    const bool wanted = p->figure == NULL || strcmp(p->figure->name, name) == 0;
    bb_plot_list(p->kinds, f->kind);
    p->out = wanted ? p->script : p->nowhere;
    fputs("\nreset\nset encoding utf8\n", p->out);
    if (p->figure == NULL)
        begin_on_screen(p, f);
    else
        begin_in_print(p, f);
    fprintf(p->out, "set xlabel '%s'\nset ylabel '%s'\nset errorbars small\n", f->x_title,
            f->y_title);
    fprintf(p->out, "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n", f->x.low, f->x.high,
            f->y.low, f->y.high);
    fprintf(p->out, "%s%s", f->x.log ? "set logscale x\nset format x '%.0s%c'\n" : "",
            f->y.log ? "set logscale y\nset format y '%.0s%c'\n" : "");
}

/* Writes what titles say on the screen as entries of the legend. */
static void end_in_print(const bb_plot *p, const bb_chart_frame *f)
{
    if (f->marks != NULL)
        fprintf(p->out, ", \\\n NaN with points pt 0 title '%s'", f->marks);
    if (f->left_out > 0)
        fprintf(p->out, ", \\\n NaN with points pt 0 title 'not drawn: %u cells'", f->left_out);
    if (is_as_given(p))
        fputs(", \\\n NaN with points pt 0 title 'rays as given'", p->out);
    fputs("\nunset output\n", p->out);
}

void bb_plot_end(bb_plot *p, const bb_chart_frame *f)
{
    p->pictures += p->out == p->script;
    if (p->figure != NULL) {
        end_in_print(p, f);
        return;
    }
    fputc('\n', p->out);
    fprintf(p->out,
            "set terminal pngcairo noenhanced size 1440,1.5*height fontscale 1.5 linewidth 1.5 "
            "pointscale 2.4 font 'sans-serif,13' background '#ffffff'\nset output "
            "'%s_%s.png'\nreplot\n",
            p->stem, f->kind);
}

/* ---- room for keys ---- */

/* Where a key lies, from 0 to 1 on both axes. */
typedef struct place {
    double left, right, low, high;
} place;

static bool meet(place a, place b)
{
    return a.left < b.right && b.left < a.right && a.low < b.high && b.low < a.high;
}

/* `side` is 1 to the right of the mark, -1 to the left. */
static place place_of(const bb_plot *p, const bb_mark *mark, int side, const bb_chart_axis *x,
                      const bb_chart_axis *y)
{
    const double at = along(x, mark->x), up = along(y, mark->y);
    if (p->figure == NULL) /* keys of a few letters */
        return (place){at, at + 0.035, up, up + 0.04};
    /* the axes' own labels leave less than all to the plot */
    const double wide = (strlen(mark->key) + 1.5) * LETTER * PRINT_POINTS / (width_of(p) - 40);
    const double high = 1.1 * PRINT_POINTS / (height_of(p) - 30);
    const double left = side > 0 ? at + 0.01 : at - 0.01 - wide;
    return (place){left, left + wide, up + 0.2 * high, up + 1.2 * high};
}

void bb_plot_place_keys(const bb_plot *p, bb_mark *marks, uint32_t count, const bb_chart_axis *x,
                        const bb_chart_axis *y)
{
    for (uint32_t i = 0; i < count; i++) {
        marks[i].key_side = 0;
        for (int side = 1; side >= (p->figure != NULL ? -1 : 1); side -= 2) {
            const place own = place_of(p, &marks[i], side, x, y);
            bool free = p->figure == NULL || (own.left >= 0 && own.right <= 1.02);
            for (uint32_t k = 0; k < count && free; k++) {
                if (k < i && marks[k].key_side != 0)
                    free = !meet(own, place_of(p, &marks[k], marks[k].key_side, x, y));
                const double at = along(x, marks[k].x), up = along(y, marks[k].y);
                if (p->figure != NULL && k != i && free)
                    free = !meet(own, (place){at - 0.01, at + 0.01, up - 0.015, up + 0.015});
            }
            if (!free)
                continue;
            marks[i].key_side = side;
            break;
        }
    }
}
