/* Writes series and marks of the pictures in gnuplot's language. */
#include "framework/report/chart_plot.h"
#include "framework/record/record.h"

#include <math.h>
#include <string.h>

enum { COLOURS = 12, GREYS = 3, SHAPES = 6 };

/* Colours of the page on white, and gnuplot's numbers of marks: circle, triangle, square, diamond,
 * triangle on its head, pentagon. */
static const unsigned colours[COLOURS] = {0x0b62b0, 0xb8420f, 0x17734a, 0x8a3a9b,
                                          0x7a5a00, 0x00727a, 0xb0103e, 0x5a5f66,
                                          0x4b6b00, 0x4f46c4, 0x9c4668, 0x2b2b2b};
static const unsigned greys[GREYS] = {0x000000, 0x707070, 0xa8a8a8};
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

unsigned bb_plot_colour(const bb_plot *p, uint32_t series, uint32_t looks)
{
    return p->figure == NULL ? colours[series % COLOURS] : greys[series / looks % GREYS];
}

enum { NAME_BYTES = 600 };

/* Writes a specification, such as "lbvh:bits=63+rotate", without options, or with their values
 * alone: "lbvh:63+rotate". */
static void shorten(const char *text, bool values, char name[NAME_BYTES])
{
    size_t used = 0;
    bool in_options = false, in_key = false;
    for (; *text != '\0' && used + 1 < NAME_BYTES; text++) {
        in_options = *text == ':' || (in_options && *text != '+');
        in_key = in_options && (*text == ':' || *text == ',' || (in_key && *text != '='));
        const bool kept = *text == ':' || *text == ',' || (!in_key && *text != '=');
        if (!in_options || (values && kept))
            name[used++] = *text;
    }
    name[used] = '\0';
}

/* Writes what a series is called in print: without options, or if another series has the same name
 * then, with their values. */
static void series_name(const bb_plot *p, const bb_series *list, const bb_chart_cell *cell,
                        char key[BB_PLOT_KEY])
{
    const bb_field_id field = list == &p->kernels ? BB_F_TRACE_KERNEL : BB_F_TRACE_BUILDER;
    char name[NAME_BYTES], other[NAME_BYTES], run[24] = "";
    bool alone = true;
    shorten(bb_get_text(cell->trace, field), false, name);
    for (uint32_t i = 0; i < list->count && alone; i++) {
        shorten(bb_get_text(list->cells[i]->trace, field), false, other);
        alone = list->same(list->cells[i], cell) || strcmp(name, other) != 0;
    }
    if (!alone)
        shorten(bb_get_text(cell->trace, field), true, name);
    if (p->several_runs && list != &p->kernels)
        snprintf(run, sizeof run, " (run %.0f)", bb_chart_run(cell) + 1);
    const int room = (int)(BB_PLOT_KEY - 1 - strlen(run));
    const bool fits = (int)strlen(name) <= room;
    snprintf(key, BB_PLOT_KEY, "%.*s%s%s", fits ? room : room - 3, name, fits ? "" : "...", run);
}

void bb_plot_kernel_key(const bb_plot *p, const bb_chart_cell *cell, char key[BB_PLOT_KEY])
{
    if (p->figure != NULL) {
        series_name(p, &p->kernels, cell, key);
        return;
    }
    char reversed[BB_PLOT_KEY];
    int length = 0, at = 0;
    for (uint32_t rest = bb_series_find(&p->kernels, cell) + 1; rest > 0; rest = (rest - 1) / 26)
        reversed[length++] = (char)('A' + (rest - 1) % 26);
    while (length > 0)
        key[at++] = reversed[--length];
    key[at] = '\0';
}

void bb_plot_builder_key(const bb_plot *p, const bb_chart_cell *cell, char key[BB_PLOT_KEY])
{
    const bb_series *list = cell->reference ? &p->references : &p->builders;
    if (p->figure != NULL)
        series_name(p, list, cell, key);
    else
        snprintf(key, BB_PLOT_KEY, "%s%u", cell->reference ? "R" : "",
                 bb_series_find(list, cell) + 1);
}

/* In print, where names stand beside the marks, shapes tell series apart if they can. */
static bool shapes_are_series(const bb_plot *p)
{
    return p->figure != NULL && p->intersectors.count <= 1;
}

static unsigned colour_of(const bb_plot *p, uint32_t series)
{
    return bb_plot_colour(p, series, shapes_are_series(p) ? SHAPES : 1);
}

void bb_plot_look(const bb_plot *p, const bb_series *list, bb_mark *mark)
{
    const bb_chart_cell *cell = mark->cell;
    const uint32_t series = bb_series_find(list, cell);
    mark->colour = cell->reference ? BB_PLOT_BLACK : colour_of(p, series);
    if (cell->reference) {
        mark->shape = BB_PLOT_CROSS;
        return;
    }
    const uint32_t shape =
        (shapes_are_series(p) ? series : bb_series_find(&p->intersectors, cell)) % SHAPES;
    mark->shape = cell->wrong_rays > 0 ? filled[shape] : hollow[shape];
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

void bb_plot_list_in(char *list, size_t capacity, const char *name)
{
    const size_t used = strlen(list), length = strlen(name);
    for (const char *at = list; (at = strstr(at, name)) != NULL; at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ',' || at[length] == '\0'))
            return;
    if (used >= 3 && strcmp(list + used - 3, "...") == 0)
        return;
    const char *more = used + length + 8 < capacity ? name : "...";
    snprintf(list + used, capacity - used, "%s%s", used > 0 ? ", " : "", more);
}

/* ---- marks ---- */

static double or_else(double value, double fallback)
{
    return isfinite(value) ? value : fallback;
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

void bb_plot_column(FILE *out, const char *text)
{
    fputs(" \"", out);
    for (; *text != '\0'; text++)
        fputc((unsigned char)*text < 0x20 || *text == '"' || *text == '\\' ? '?' : *text, out);
    fputc('"', out);
}

/* Writes the data: x y, both intervals, colour, mark, length of the arrow for "at most", least and
 * length of the range, key to the right or to the left. */
static void print_marks(FILE *out, const bb_mark *marks, uint32_t count)
{
    fputs("$marks << EOD\n", out);
    for (uint32_t i = 0; i < count; i++) {
        const bb_mark *m = &marks[i];
        double least = or_else(m->y_least, m->y), most = or_else(m->y_most, m->y);
        fprintf(out, "%.9g %.9g %.9g %.9g %.9g %.9g %u %d %.9g %.9g %.9g", m->x, m->y,
                m->at_most ? m->x : or_else(m->x_low, m->x), or_else(m->x_high, m->x),
                or_else(m->y_low, m->y), or_else(m->y_high, m->y), m->colour, m->shape,
                m->at_most ? m->x / 1.35 - m->x : 0.0, least, most - least);
        bb_plot_column(out, m->key_side > 0 ? m->key : "");
        bb_plot_column(out, m->key_side < 0 ? m->key : "");
        fputc('\n', out);
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
        "rgb '#1b1e23' notitle, \\\n $marks using 1:2:13 with labels right offset char -0.8,0.5 "
        "tc rgb '#1b1e23' notitle",
        front ? "$front using 1:2 with lines lw 1.2 lc rgb '#565d67' title 'Pareto front', "
                "\\\n "
              : "");
}

static void legend_entry(FILE *out, unsigned colour, int shape, const char *key, const char *name)
{
    fprintf(out, ", \\\n NaN with points pt %d lc rgb '#%06x' title '", shape, colour);
    bb_plot_quoted(out, key);
    fputs(key[0] != '\0' && name[0] != '\0' ? "  " : "", out);
    bb_plot_quoted(out, name);
    fputc('\'', out);
}

static void legend_series(const bb_plot *p, const bb_series *list, uint32_t series, bool coloured)
{
    const bb_chart_cell *cell = list->cells[series];
    char key[BB_PLOT_KEY], name[600];
    if (list == &p->kernels)
        bb_plot_kernel_key(p, cell, key);
    else
        bb_plot_builder_key(p, cell, key);
    if (p->figure != NULL)
        name[0] = '\0'; /* the key is the name */
    else if (list == &p->kernels)
        snprintf(name, sizeof name, "%s", bb_get_text(cell->trace, BB_F_TRACE_KERNEL));
    else
        bb_chart_builder_name(cell, p->several_runs, name, sizeof name);
    const int shape = list->references                   ? BB_PLOT_CROSS
                      : !coloured && list == &p->kernels ? 0
                      : shapes_are_series(p)             ? filled[series % SHAPES]
                                                         : 5;
    legend_entry(p->out, coloured ? colour_of(p, series) : BB_PLOT_BLACK, shape, key, name);
}

void bb_plot_legend_series(const bb_plot *p, const bb_series *list, uint32_t marks, bool coloured)
{
    for (uint32_t i = 0; i < list->count; i++) {
        uint32_t k = 0;
        while (k < marks && (p->marks[k].cell->reference != list->references ||
                             !list->same(p->marks[k].cell, list->cells[i])))
            k++;
        if (k < marks)
            legend_series(p, list, i, coloured);
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
    if (shapes_are_series(p))
        return;
    for (uint32_t i = 0; i < p->intersectors.count; i++)
        legend_entry(p->out, BB_PLOT_BLACK, filled[i % SHAPES], "",
                     bb_get_text(p->intersectors.cells[i]->trace, BB_F_TRACE_INTERSECTOR));
}
