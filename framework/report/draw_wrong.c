/* Pictures of speed and of time against wrong answers. */
#include "framework/report/chart_plot.h"

#include <math.h>

/* Returns the milliseconds for build, layout and all rays of the set. */
static double total_ms(const bb_chart_cell *cell)
{
    return cell->fixed_ms + cell->ms * cell->rays / cell->count;
}

static double speed(const bb_chart_cell *cell)
{
    return cell->mrays_s;
}

static double haste(const bb_chart_cell *cell)
{
    return -total_ms(cell);
}

static bool same_kernel_and_intersector(const bb_chart_cell *a, const bb_chart_cell *b)
{
    return bb_same_kernel(a, b) && bb_same_intersector(a, b);
}

static bool same_builder_and_intersector(const bb_chart_cell *a, const bb_chart_cell *b)
{
    return bb_same_builder(a, b) && bb_same_intersector(a, b);
}

static bool same_cell(const bb_chart_cell *a, const bb_chart_cell *b)
{
    return a == b;
}

/* Picks, from each group of cells that `same` finds equal, the one with the largest `gain` into
 * p->cells. References come last, each on its own. Cells that were not checked, or have no gain,
 * are left out and counted. */
static uint32_t pick(bb_plot *p, bb_same_fn *same, double (*gain)(const bb_chart_cell *),
                     uint32_t *left_out)
{
    uint32_t count = 0;
    *left_out = p->set->incomplete;
    for (int reference = 0; reference < 2; reference++) {
        for (uint32_t i = 0; i < p->set->cell_count; i++) {
            const bb_chart_cell *cell = &p->set->cells[i];
            if (cell->reference != (reference != 0))
                continue;
            if (!isfinite(cell->wrong.ppm) || !isfinite(gain(cell))) {
                ++*left_out;
                continue;
            }
            uint32_t k = 0;
            while (k < count && !(reference ? same_cell : same)(p->cells[k], cell))
                k++;
            if (k == count)
                p->cells[count++] = cell;
            else if (gain(cell) > gain(p->cells[k]))
                p->cells[k] = cell;
        }
    }
    return count;
}

/* Writes the data block $front: stairs along the Pareto front of the picked cells. They begin at
 * `worst`, an end of the y axis. */
static bool print_front(bb_plot *p, uint32_t count, double (*gain)(const bb_chart_cell *),
                        const bb_chart_axis *x, double worst)
{
    FILE *out = p->out;
    uint32_t ours = 0;
    while (ours < count && !p->cells[ours]->reference)
        ours++;
    for (uint32_t i = 0; i < ours; i++)
        p->points[i] = (bb_chart_point){p->cells[i]->wrong.high, gain(p->cells[i])};
    uint32_t found = bb_pareto_front(p->points, ours, p->front);
    if (found == 0)
        return false;
    double at = 0, y = worst;
    fputs("$front << EOD\n", out);
    for (uint32_t i = 0; i < found; i++) {
        /* by upper bounds, 0 of n beats 1 of n, whose mark is further left */
        at = fmax(at, p->cells[p->front[i]]->wrong.ppm);
        fprintf(out, "%.9g %.9g\n", at, y);
        y = fabs(gain(p->cells[p->front[i]]));
        fprintf(out, "%.9g %.9g\n", at, y);
    }
    fprintf(out, "%.9g %.9g\nEOD\n", x->high, y);
    return true;
}

static void set_mark(bb_mark *mark, const bb_chart_cell *cell)
{
    *mark = (bb_mark){.cell = cell,
                      .x = cell->wrong.ppm,
                      .x_low = cell->wrong.low,
                      .x_high = cell->wrong.high,
                      .y_low = NAN,
                      .y_high = NAN,
                      .y_least = NAN,
                      .y_most = NAN,
                      .at_most = cell->wrong_rays == 0};
}

static const char wrong_title[] = "wrong rays per million (log scale)";
#define WRONG_MARKS "lines across: 95 %; hollow with arrow: none found of n, at most 3/n"

/* Colours the marks by builder or kernel, and sets the x axis. */
static void finish_marks(bb_plot *p, uint32_t count, bb_series *series, bb_chart_axis *x)
{
    *x = bb_axis_make(true);
    for (uint32_t i = 0; i < count; i++) {
        bb_mark *mark = &p->marks[i];
        bb_plot_look(p, series, mark);
        if (mark->cell->reference || series == &p->builders)
            bb_plot_builder_key(p, mark->cell, mark->key);
        else
            bb_plot_kernel_key(p, mark->cell, mark->key);
        bb_axis_add(x, mark->x);
        bb_axis_add(x, mark->at_most ? mark->x / 1.35 : mark->x_high);
    }
    bb_axis_round(x);
}

/* Draws the frame, the front by `gain` from the end `worst` of the y axis, marks, and the legend,
 * to which entries may be added. */
static void draw_marks(bb_plot *p, bb_chart_frame *f, uint32_t count, bb_series *series,
                       double (*gain)(const bb_chart_cell *), double worst)
{
    finish_marks(p, count, series, &f->x);
    bb_plot_begin(p, f);
    bool front = print_front(p, count, gain, &f->x, worst);
    bb_plot_place_keys(p, p->marks, count, &f->x, &f->y);
    bb_plot_marks(p->out, p->marks, count, front);
    bb_plot_legend_series(p, series, count, true);
    bb_plot_legend_shapes(p);
    bb_plot_legend_series(p, &p->references, count, false);
}

static void draw_accuracy(bb_plot *p)
{
    bb_chart_frame f = {
        .kind = "accuracy",
        .title = "speed against wrong answers",
        .subtitle = "each kernel and intersector on the tree that it traces fastest",
        .marks = WRONG_MARKS,
        .x_title = wrong_title,
        .y_title = "Mrays/s",
        .y = bb_axis_make(false),
        .entries = p->kernels.count + p->intersectors.count + p->references.count + 3};
    uint32_t count = pick(p, same_kernel_and_intersector, speed, &f.left_out);
    if (count == 0)
        return;
    bb_axis_add(&f.y, 0);
    for (uint32_t i = 0; i < count; i++) {
        set_mark(&p->marks[i], p->cells[i]);
        bb_plot_speed(&p->marks[i], &f.y);
    }
    bb_axis_round(&f.y);
    draw_marks(p, &f, count, &p->kernels, speed, f.y.low);
    bb_plot_legend_spread(p, count);
    bb_plot_end(p, &f);
}

static void draw_builders(bb_plot *p)
{
    bb_chart_frame f = {
        .kind = "builders",
        .title = "time against wrong answers",
        .subtitle = "build, layout and all rays once, with the kernel fastest in this",
        .marks = WRONG_MARKS,
        .x_title = wrong_title,
        .y_title = "ms (log scale)",
        .y = bb_axis_make(true),
        .entries = p->builders.count + p->intersectors.count + p->references.count + 1};
    uint32_t count = pick(p, same_builder_and_intersector, haste, &f.left_out);
    if (count == 0)
        return;
    for (uint32_t i = 0; i < count; i++) {
        set_mark(&p->marks[i], p->cells[i]);
        p->marks[i].y = total_ms(p->cells[i]);
        bb_axis_add(&f.y, p->marks[i].y);
    }
    bb_axis_round(&f.y);
    draw_marks(p, &f, count, &p->builders, haste, f.y.high);
    bb_plot_end(p, &f);
}

extern const bb_drawing bb_drawing_wrong;
const bb_drawing bb_drawing_wrong = {{draw_accuracy, draw_builders}};
