/* Pictures of speed against each metric of trees, counted work and each simulation, to show whether
 * it predicts trace speed. */
#include "framework/report/chart_plot.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* "1A": builder and kernel. In print, where marks have looks by kernel, the builder. */
static void set_key(const bb_plot *p, bb_mark *mark)
{
    char builder[BB_PLOT_KEY], kernel[BB_PLOT_KEY];
    bb_plot_builder_key(p, mark->cell, builder);
    bb_plot_kernel_key(p, mark->cell, kernel);
    if (p->figure == NULL)
        snprintf(mark->key, BB_PLOT_KEY, "%.40s%.7s", builder, kernel);
    else
        memcpy(mark->key, builder, BB_PLOT_KEY);
}

/* `place`: offset of the figure in a cell. */
static void draw_against(bb_plot *p, bb_chart_frame *f, size_t place)
{
    const bb_series *coloured = p->figure == NULL ? &p->builders : &p->kernels;
    uint32_t count = 0;
    f->x = f->y = bb_axis_make(false);
    f->y_title = "Mrays/s";
    f->entries = p->kernels.count + 2 + (p->figure == NULL ? p->builders.count : 0);
    f->left_out = p->set->incomplete;
    bb_axis_add(&f->y, 0);
    for (uint32_t i = 0; i < p->set->cell_count; i++) {
        const bb_chart_cell *cell = &p->set->cells[i];
        const double x = *(const double *)((const char *)cell + place);
        if (cell->reference || !isfinite(x))
            continue;
        bb_mark *mark = &p->marks[count++];
        *mark = (bb_mark){.cell = cell, .x = x, .x_low = NAN, .x_high = NAN};
        bb_plot_look(p, coloured, mark);
        set_key(p, mark);
        bb_axis_add(&f->x, mark->x);
        bb_plot_speed(mark, &f->y);
    }
    if (count == 0)
        return;
    bb_axis_round(&f->x);
    bb_axis_round(&f->y);
    bb_plot_begin(p, f);
    bb_plot_place_keys(p, p->marks, count, &f->x, &f->y);
    bb_plot_marks(p->out, p->marks, count, false);
    bb_plot_legend_series(p, coloured, count, true);
    if (p->figure == NULL)
        bb_plot_legend_series(p, &p->kernels, count, false);
    bb_plot_legend_spread(p, count);
    bb_plot_end(p, f);
}

static void draw_metrics(bb_plot *p)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        const bb_metric *metric = bb_metrics[i];
        char title[64], axis[96];
        snprintf(title, sizeof title, "speed against %s", metric->title);
        snprintf(axis, sizeof axis, "%s%s%s", metric->full_title,
                 metric->unit[0] != '\0' ? ", " : "", metric->unit);
        bb_chart_frame f = {.kind = metric->name,
                            .title = title,
                            .subtitle =
                                metric->of_layouts
                                    ? "of the layout as traced; hollow: no wrong answer found"
                                    : "of the tree; hollow: no wrong answer found",
                            .x_title = axis};
        draw_against(p, &f, offsetof(bb_chart_cell, metrics) + i * sizeof(double));
    }
}

/* What was counted, only where it is asked for by name: one picture more for each ray set. */
static void draw_counted(bb_plot *p)
{
    bb_chart_frame work = {.kind = "work",
                           .title = "speed against counted work",
                           .subtitle = "1.2 for a pair of boxes, 1 for a primitive; hollow: no "
                                       "wrong answer found",
                           .x_title = "work per ray"};
    if (p->figure != NULL)
        draw_against(p, &work, offsetof(bb_chart_cell, work));
    for (uint32_t i = 0; i < BB_SIMT_MAX; i++) {
        char kind[24];
        snprintf(kind, sizeof kind, i > 0 ? "simulated%u" : "simulated", i + 1);
        bb_chart_frame f = {.kind = kind,
                            .title = "speed measured here against simulated speed",
                            .subtitle = "of a GPU on paper; hollow: no wrong answer found",
                            .x_title = "bound on Mrays/s, simulated"};
        draw_against(p, &f, offsetof(bb_chart_cell, simulated) + i * sizeof(double));
    }
}

extern const bb_drawing bb_drawing_quality;
const bb_drawing bb_drawing_quality = {{draw_metrics, draw_counted}};
