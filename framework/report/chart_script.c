/* The script that draws all pictures, and the names of their files.
 *
 * The script contains all figures. Texts from the records stand between single quotes, in which
 * gnuplot expands nothing.
 */
#include "framework/report/chart_script.h"
#include "framework/report/chart_plot.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

typedef char stem[BB_PLOT_STEM];

/* Makes a file name from the letters, digits and '.' of scene and rays, with a number if it is not
 * unique. */
static void name_pictures(bb_plot *p, stem *stems, uint32_t *count)
{
    char base[BB_PLOT_STEM - 16];
    int length = snprintf(base, sizeof base, "%.72s_%.48s", p->set->scene, p->set->rays);
    for (int i = 0; i < length; i++)
        if (!isalnum((unsigned char)base[i]) && base[i] != '.' && base[i] != '_')
            base[i] = '-';
    if (base[0] == '.')
        base[0] = '-'; /* no hidden files */
    snprintf(p->stem, sizeof p->stem, "%s", base);
    for (uint32_t k = 0, number = 2; k < *count; k++) {
        if (strcmp(stems[k], p->stem) != 0)
            continue;
        snprintf(p->stem, sizeof p->stem, "%s-%u", base, number++);
        k = UINT32_MAX; /* compare with all names again */
    }
    memcpy(stems[(*count)++], p->stem, sizeof(stem));
}

static void add_series(bb_plot *p, const bb_chart_set *set)
{
    for (uint32_t k = 0; k < set->cell_count; k++) {
        const bb_chart_cell *cell = &set->cells[k];
        bb_series_add(&p->builders, cell);
        bb_series_add(&p->references, cell);
        bb_series_add(&p->kernels, cell);
        bb_series_add(&p->intersectors, cell);
    }
    for (uint32_t i = 0; i < p->builders.count; i++)
        if (bb_chart_run(p->builders.cells[i]) != bb_chart_run(p->builders.cells[0]))
            p->several_runs = true;
}

/* A figure has only what its set has. */
static void collect_series(bb_plot *p, const bb_charts *charts, const bb_chart_set *only)
{
    p->kernels.count = p->builders.count = p->intersectors.count = p->references.count = 0;
    p->several_runs = false;
    for (uint32_t i = 0; i < charts->set_count; i++)
        if (only == NULL || only == &charts->sets[i])
            add_series(p, &charts->sets[i]);
}

static bool reserve(bb_plot *p, size_t cells)
{
    bb_series *series[] = {&p->kernels, &p->builders, &p->intersectors, &p->references};
    bool ok = true;
    for (size_t i = 0; i < sizeof series / sizeof series[0]; i++) {
        series[i]->cells = calloc(cells, sizeof *series[i]->cells);
        ok = ok && series[i]->cells != NULL;
    }
    p->marks = calloc(3 * cells, sizeof *p->marks);
    p->points = calloc(cells, sizeof *p->points);
    p->front = calloc(cells, sizeof *p->front);
    p->lines = calloc(cells, sizeof *p->lines);
    p->winners = calloc(cells, sizeof *p->winners);
    p->cells = calloc(cells, sizeof *p->cells);
    return ok && p->marks != NULL && p->points != NULL && p->front != NULL && p->lines != NULL &&
           p->winners != NULL && p->cells != NULL;
}

static void release(bb_plot *p)
{
    free(p->kernels.cells);
    free(p->builders.cells);
    free(p->intersectors.cells);
    free(p->references.cells);
    free(p->marks);
    free(p->points);
    free(p->front);
    free(p->lines);
    free(p->winners);
    free(p->cells);
}

static bb_status no_such_figure(const bb_plot *p)
{
    return bb_fail(BB_INVALID,
                   "report: there is no figure '%.160s': figures are SET_KIND, SET one of %s, and "
                   "KIND one of %s",
                   p->figure->name, p->sets, p->kinds);
}

bb_status bb_charts_script(const bb_charts *charts, const bb_chart_print *figure, FILE *out,
                           uint32_t *pictures)
{
    bb_plot plot = {.out = out,
                    .script = out,
                    .nowhere = figure != NULL ? fopen("/dev/null", "w") : NULL,
                    .figure = figure,
                    .kernels = {.same = bb_same_kernel},
                    .builders = {.same = bb_same_builder},
                    .intersectors = {.same = bb_same_intersector},
                    .references = {.same = bb_same_builder, .references = true}};
    bb_status status = BB_OK;
    uint32_t stem_count = 0;
    size_t cells = 1;
    for (uint32_t i = 0; i < charts->set_count; i++)
        cells += charts->sets[i].cell_count;
    stem *stems = calloc((size_t)charts->set_count + 1, sizeof *stems);
    *pictures = 0;
    if (!reserve(&plot, cells) || stems == NULL || (figure != NULL && plot.nowhere == NULL)) {
        status = bb_fail(BB_FAILED, "charts: no memory");
        goto out;
    }
    collect_series(&plot, charts, NULL);
    fputs("# Charts of a bvhbench report: `gnuplot charts.gp` in this folder draws them again.\n",
          out);
    for (uint32_t i = 0; i < charts->set_count; i++) {
        if (charts->sets[i].view != NULL)
            continue;
        plot.set = &charts->sets[i];
        if (figure != NULL)
            collect_series(&plot, charts, plot.set);
        name_pictures(&plot, stems, &stem_count);
        bb_plot_list(plot.sets, plot.stem);
        for (const bb_drawing *const *d = bb_drawings; *d != NULL; d++)
            for (uint32_t k = 0; k < BB_DRAWINGS_MAX; k++)
                if ((*d)->draw[k] != NULL)
                    (*d)->draw[k](&plot);
    }
    *pictures = plot.pictures;
    if (figure != NULL && plot.pictures == 0)
        status = no_such_figure(&plot);
out:
    if (plot.nowhere != NULL)
        fclose(plot.nowhere);
    free(stems);
    release(&plot);
    return status;
}
