/* Pictures of speed against each metric of trees, to show whether it predicts trace speed. */
#include "framework/report/chart_plot.h"

#include <math.h>
#include <stdio.h>

/* "1A": builder and kernel. */
static void builder_and_kernel_key(const bb_plot *p, const bb_chart_cell *cell,
                                   char key[BB_PLOT_KEY])
{
    char builder[BB_PLOT_KEY], kernel[BB_PLOT_KEY];
    bb_plot_builder_key(p, cell, builder);
    bb_plot_kernel_key(bb_series_find(&p->kernels, cell), kernel);
    snprintf(key, BB_PLOT_KEY, "%.8s%.7s", builder, kernel);
}

static void draw_metric(bb_plot *p, bb_chart_frame *f, uint32_t metric)
{
    uint32_t count = 0;
    f->x = f->y = bb_axis_make(false);
    f->y_title = "Mrays/s";
    f->entries = p->builders.count + p->kernels.count + 2;
    f->left_out = p->set->incomplete;
    bb_axis_add(&f->y, 0);
    for (uint32_t i = 0; i < p->set->cell_count; i++) {
        const bb_chart_cell *cell = &p->set->cells[i];
        if (cell->reference || !isfinite(cell->metrics[metric]))
            continue;
        bb_mark *mark = &p->marks[count++];
        *mark = (bb_mark){.cell = cell,
                          .x = cell->metrics[metric],
                          .x_low = NAN,
                          .x_high = NAN,
                          .colour = bb_plot_colour(bb_series_find(&p->builders, cell)),
                          .shape = bb_plot_shape(p, cell)};
        builder_and_kernel_key(p, cell, mark->key);
        bb_axis_add(&f->x, mark->x);
        bb_plot_speed(mark, &f->y);
    }
    if (count == 0)
        return;
    bb_axis_round(&f->x);
    bb_axis_round(&f->y);
    bb_plot_begin(p, f);
    bb_plot_place_keys(p->marks, count, &f->x, &f->y);
    bb_plot_marks(p->out, p->marks, count, false);
    bb_plot_legend_series(p, &p->builders, count, true);
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
        draw_metric(p, &f, i);
    }
}

extern const bb_drawing bb_drawing_quality;
const bb_drawing bb_drawing_quality = {{draw_metrics}};
