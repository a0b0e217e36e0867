/* Picture of the time to n rays, to show which builder wins for how many rays. */
#include "framework/report/chart_plot.h"

#include <math.h>

enum { SAMPLES = 200, DASHES = 5 };

/* Collects the cells of one builder (NULL: of all but references) that are within the limit of
 * wrong answers and whose times are known, with their lines. */
static uint32_t lines_of(bb_plot *p, const bb_chart_cell *builder)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->set->cell_count; i++) {
        const bb_chart_cell *cell = &p->set->cells[i];
        bool wanted = builder == NULL
                          ? !cell->reference
                          : cell->reference == builder->reference && bb_same_builder(cell, builder);
        if (!wanted || !cell->usable || !isfinite(cell->fixed_ms))
            continue;
        p->cells[count] = cell;
        p->lines[count++] = (bb_time_line){cell->fixed_ms, cell->ms / cell->count};
    }
    return count;
}

static double envelope_ms(const bb_plot *p, uint32_t lines, double n)
{
    double best = INFINITY;
    for (uint32_t i = 0; i < lines; i++)
        best = fmin(best, p->lines[i].fixed_ms + n * p->lines[i].ms_per_ray);
    return best;
}

/* Writes the data block $tN, the time of a builder over n, and puts the builder's key at both ends
 * into `keys`. */
static void print_curve(bb_plot *p, const bb_chart_cell *builder, uint32_t block,
                        const bb_chart_axis *n, bb_mark keys[2])
{
    uint32_t lines = lines_of(p, builder);
    fprintf(p->out, "$t%u << EOD\n", block);
    for (int i = 0; i <= SAMPLES; i++) {
        double rays = n->low * pow(n->high / n->low, (double)i / SAMPLES);
        fprintf(p->out, "%.9g %.9g\n", rays, envelope_ms(p, lines, rays));
    }
    fputs("EOD\n", p->out);
    for (int end = 0; end < 2; end++) {
        keys[end] = (bb_mark){.x = end == 0 ? n->low : n->high};
        keys[end].y = envelope_ms(p, lines, keys[end].x);
        bb_plot_builder_key(p, builder, keys[end].key);
    }
}

/* Puts marks where another builder overtakes, and returns their number. */
static uint32_t mark_crossings(bb_plot *p, uint32_t lines, uint32_t winners, bb_mark *marks)
{
    uint32_t count = 0;
    for (uint32_t i = 1; i < winners; i++) {
        const bb_chart_cell *now = p->cells[p->winners[i].line];
        const double from = p->winners[i].from;
        if (bb_same_builder(now, p->cells[p->winners[i - 1].line]) || !(from > 0))
            continue;
        char key[BB_PLOT_KEY], n[32], label[BB_PLOT_KEY + 48];
        bb_plot_builder_key(p, now, key);
        bb_plot_brief(from, n);
        marks[count] = (bb_mark){.x = from, .y = envelope_ms(p, lines, from)};
        snprintf(label, sizeof label, "%s from %s rays", key, n);
        snprintf(marks[count++].key, BB_PLOT_KEY, "%.*s", BB_PLOT_KEY - 1, label);
    }
    return count;
}

/* Sets the axes: n from 1 to 10^9 rays, and well beyond the last crossing. */
static void time_axes(const bb_plot *p, uint32_t lines, uint32_t winners, bb_chart_axis *n,
                      bb_chart_axis *ms)
{
    double most = fmin(fmax(1e9, p->winners[winners - 1].from * 30), 1e13);
    *n = (bb_chart_axis){1, pow(10, ceil(log10(most) - 1e-9)), true};
    *ms = bb_axis_make(true);
    bb_axis_add(ms, envelope_ms(p, lines, n->low));
    for (uint32_t i = 0; i < p->set->cell_count; i++) {
        const bb_chart_cell *cell = &p->set->cells[i];
        if (cell->usable)
            bb_axis_add(ms, cell->fixed_ms + n->high * cell->ms / cell->count);
    }
    bb_axis_round(ms);
}

/* Writes a data block of labels. */
static void print_keys(FILE *out, const char *name, const bb_mark *marks, uint32_t count)
{
    fprintf(out, "$%s << EOD\n", name);
    for (uint32_t i = 0; i < count; i++) {
        fprintf(out, "%.9g %.9g", marks[i].x, marks[i].y);
        bb_plot_column(out, marks[i].key_side > 0 ? marks[i].key : "");
        bb_plot_column(out, marks[i].key_side < 0 ? marks[i].key : "");
        fputc('\n', out);
    }
    fputs("EOD\n", out);
}

/* Returns builder i: first our builders, then the references. */
static const bb_chart_cell *builder_at(const bb_plot *p, uint32_t i)
{
    return i < p->builders.count ? p->builders.cells[i]
                                 : p->references.cells[i - p->builders.count];
}

static void plot_curve(const bb_plot *p, const bb_chart_cell *builder, uint32_t block)
{
    char key[BB_PLOT_KEY], name[600] = "";
    bb_plot_builder_key(p, builder, key);
    if (p->figure == NULL)
        bb_chart_builder_name(builder, p->several_runs, name, sizeof name);
    fprintf(p->out, ", \\\n $t%u using 1:2 with lines lw %d dt %u lc rgb '#%06x' title '", block,
            builder->reference ? 1 : 2, block % DASHES + 1,
            builder->reference ? BB_PLOT_BLACK : bb_plot_colour(p, block, DASHES));
    bb_plot_quoted(p->out, key);
    fputs(p->figure == NULL ? "  " : "", p->out);
    bb_plot_quoted(p->out, name);
    fputc('\'', p->out);
}

static void draw_time(bb_plot *p)
{
    bb_chart_frame f = {.kind = "time",
                        .title = "time to n rays",
                        .subtitle =
                            "boxes + build + transfer + layout + n / rate, with the best kernel "
                            "of each builder at each n",
                        .x_title = "n, rays traced (log scale)",
                        .y_title = "ms (log scale)",
                        .left_out = p->set->incomplete};
    uint32_t builders = f.entries = p->builders.count + p->references.count;
    uint32_t lines = lines_of(p, NULL);
    uint32_t winners = bb_time_winners(p->lines, lines, p->winners);
    if (winners == 0)
        return;
    time_axes(p, lines, winners, &f.x, &f.y);
    bb_plot_begin(p, &f);
    /* the crossings first: they have room before the ends of curves */
    const uint32_t crossings = mark_crossings(p, lines, winners, p->marks);
    bb_mark *ends = p->marks + crossings;
    uint32_t curves = 0;
    for (uint32_t i = 0; i < builders; i++)
        if (lines_of(p, builder_at(p, i)) > 0)
            print_curve(p, builder_at(p, i), i, &f.x, ends + 2 * curves++);
    bb_plot_place_keys(p, p->marks, crossings + 2 * curves, &f.x, &f.y);
    for (uint32_t i = 0; i < crossings && p->figure == NULL; i++)
        p->marks[i].key_side = 1; /* all are named */
    print_keys(p->out, "cross", p->marks, crossings);
    print_keys(p->out, "keys", ends, 2 * curves);
    fputs("plot $keys using 1:2:3 with labels left offset char 0.3,0.5 notitle, \\\n $keys using "
          "1:2:4 with labels right offset char -0.3,0.5 notitle",
          p->out);
    for (uint32_t i = 0; i < builders; i++)
        if (lines_of(p, builder_at(p, i)) > 0)
            plot_curve(p, builder_at(p, i), i);
    const double lift = p->figure == NULL ? -0.7 : 0.5; /* below the curve; in print as all keys */
    if (crossings > 0)
        fprintf(p->out,
                ", \\\n $cross using 1:2 with points pt 7 lc rgb '#1b1e23' notitle, \\\n $cross "
                "using 1:2:3 with labels left offset char 0.8,%g notitle, \\\n $cross using 1:2:4 "
                "with labels right offset char -0.8,%g notitle",
                lift, lift);
    bb_plot_end(p, &f);
}

extern const bb_drawing bb_drawing_time;
const bb_drawing bb_drawing_time = {{draw_time}};
