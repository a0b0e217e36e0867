/* Pictures of speed against measures of the tree: what do they foretell? */
#include "framework/chart/chart_plot.h"

#include <math.h>

static double sah_of(const bb_chart_cell *cell)
{
    return cell->sah;
}

static double epo_of(const bb_chart_cell *cell)
{
    return cell->epo;
}

/* "1A": builder and kernel. */
static void builder_and_kernel_key(const bb_plot *p, const bb_chart_cell *cell,
                                   char key[BB_PLOT_KEY])
{
    char builder[BB_PLOT_KEY], kernel[BB_PLOT_KEY];
    bb_plot_builder_key(p, cell, builder);
    bb_plot_kernel_key(bb_series_find(&p->kernels, cell), kernel);
    snprintf(key, BB_PLOT_KEY, "%.8s%.7s", builder, kernel);
}

static void draw_quality(bb_plot *p, bb_frame *f, double (*quality)(const bb_chart_cell *))
{
    uint32_t count = 0;
    f->x = f->y = bb_axis_make(false);
    f->y_title = "Mrays/s";
    f->entries = p->builders.count + p->kernels.count + 2;
    f->left_out = p->set->incomplete;
    bb_axis_add(&f->y, 0);
    for (uint32_t i = 0; i < p->set->cell_count; i++) {
        const bb_chart_cell *cell = &p->set->cells[i];
        if (cell->reference || !isfinite(quality(cell)))
            continue;
        bb_mark *mark = &p->marks[count++];
        *mark = (bb_mark){.cell = cell,
                          .x = quality(cell),
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

static void draw_sah(bb_plot *p)
{
    bb_frame f = {.kind = "sah",
                  .title = "speed against SAH",
                  .subtitle = "of the layout as traced; hollow: no wrong answer found",
                  .x_title = "surface area heuristic"};
    draw_quality(p, &f, sah_of);
}

static void draw_epo(bb_plot *p)
{
    bb_frame f = {.kind = "epo",
                  .title = "speed against EPO",
                  .subtitle = "of the tree; hollow: no wrong answer found",
                  .x_title = "end-point overlap"};
    draw_quality(p, &f, epo_of);
}

extern const bb_drawing bb_drawing_quality;
const bb_drawing bb_drawing_quality = {{draw_sah, draw_epo}};
