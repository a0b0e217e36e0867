/* Puts figures into rows of a table and reads them back, for the atlas and for files of points. */
#include "framework/stress/point_private.h"
#include "framework/stress/stress.h"

#include "framework/device/run_row.h"
#include "framework/simulate/simulated_table.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

BB_TEXT(outcome, "outcome", "outcome", "How the measurement ended: ok, refused, crashed ...");
BB_TEXT(reason, "reason", "reason", "Why it ended so.");

#define FIGURE(name, heading, unit, help, sense, better, member)                                   \
    {                                                                                              \
        BB_NUMBER_COLUMN(sense, name, heading, unit, help, better, -1),                            \
            offsetof(bb_point_figures, member)                                                     \
    }
static const struct {
    bb_column column;
    size_t offset;
} figures[] = {
    FIGURE("prims", "primitives", "", "Of the scene.", EXACT, NEITHER, prims),
    FIGURE("build_ms", "build", "ms", "The least of the rounds.", TIMED, LESS, build_ms),
    FIGURE("ray_sets", "ray sets", "", "Those that were traced, as bits in the axis's order.",
           EXACT, NEITHER, ray_sets),
    FIGURE("trace_ms", "trace", "ms", "The least of the rounds, summed over the sets.", TIMED, LESS,
           trace_ms),
    FIGURE("rays", "rays", "", "Of all these sets.", EXACT, NEITHER, rays),
    FIGURE("tests_per_ray", "tests", "per ray", "Of boxes and primitives.", EXACT, LESS, tests),
    FIGURE("metric", "cost", "", "The tree's cost; the row of the run names the metric.", EXACT,
           LESS, metric),
    FIGURE("bytes", "memory", "bytes", "The tree with all scratch, at the peak.", EXACT, LESS,
           bytes),
    FIGURE("wrong", "wrong", "rays", "Wrong answers.", EXACT, LESS, wrong),
    FIGURE("checked", "checked", "rays", "Answers that were judged.", EXACT, NEITHER, checked),
    FIGURE("unlike", "unlike", "rays", "Answers unlike those of another exact cell.", EXACT, LESS,
           unlike),
    FIGURE("overflowed", "overflowed", "rays", "Counted rays whose stack was too small.", EXACT,
           LESS, overflowed),
    FIGURE("rebuilt", "rebuilt", "", "Share of frames in which the tree was built again.", EXACT,
           LESS, rebuilt),
};

enum { FIGURES = sizeof figures / sizeof figures[0] };

uint32_t bb_figures_put(bb_table *table, bb_cell cell, const bb_points *points,
                        const bb_point_figures *f)
{
    const uint32_t row = bb_table_row(table, cell);
    bb_table_set_text(table, row, &outcome, bb_outcome_word(f->outcome));
    bb_table_set_text(table, row, &reason, f->outcome != BB_MEASURED ? f->reason : NULL);
    for (size_t i = 0; i < FIGURES; i++)
        bb_table_set_number(table, row, &figures[i].column,
                            *(const double *)(const void *)((const char *)f + figures[i].offset));
    for (uint32_t i = 0; i < points->simt_count; i++)
        if (isfinite(f->simulated[i].mrays_s)) {
            cell.names[BB_MAKER] = points->simts[i].name;
            bb_simulated_put(table, bb_table_row(table, cell), &f->simulated[i]);
        }
    return row;
}

/* Returns false if the cell has no outcome. */
static bool get_figures(const bb_table *table, bb_cell cell, const bb_points *points,
                        bb_point_figures *f)
{
    const uint32_t row = bb_table_find(table, cell);
    const char *word = bb_table_get_text(table, row, outcome.name);
    *f = bb_no_figures(BB_NOT_MEASURED);
    for (uint32_t i = 0; i < BB_OUTCOMES; i++)
        if (strcmp(word, bb_outcome_word((bb_outcome)i)) == 0)
            f->outcome = (bb_outcome)i;
    snprintf(f->reason, sizeof f->reason, "%s", bb_table_get_text(table, row, reason.name));
    for (size_t i = 0; i < FIGURES; i++)
        *(double *)(void *)((char *)f + figures[i].offset) =
            bb_table_get_number(table, row, figures[i].column.name);
    for (uint32_t i = 0; i < points->simt_count; i++) {
        cell.names[BB_MAKER] = points->simts[i].name;
        bb_simulated_get(table, bb_table_find(table, cell), &f->simulated[i]);
    }
    return f->outcome != BB_NOT_MEASURED;
}

bb_cell bb_method_row(const bb_method *method, const char *axis, const char *value)
{
    const bb_dimension part = method->part == BB_A_BUILDER ? BB_BUILDER : BB_INTERSECTOR;
    bb_cell cell = {.names = {[BB_QUESTION] = axis, [BB_FRAME] = value}};
    cell.names[part] = method->text;
    return cell;
}

bb_status bb_point_write(const bb_point_work *work, const bb_device *device)
{
    const bb_points *p = work->points;
    bb_table *table;
    BB_TRY(bb_table_create("stress", &table));
    if (device != NULL) {
        const uint32_t run = bb_table_row(table, (bb_cell){{NULL}});
        bb_table_set_text(table, run, &bb_run_columns[BB_RUN_DEVICE], device->name);
        bb_table_set_text(table, run, &bb_run_columns[BB_RUN_DRIVER], device->driver);
    }
    for (uint32_t i = 0; i < work->count; i++) {
        char value[BB_AXIS_VALUE];
        bb_axis_value(work->wishes[i].x, value);
        for (uint32_t m = 0; m < p->method_count; m++)
            if (work->wishes[i].wanted[m])
                bb_figures_put(table, bb_method_row(&p->methods[m], p->axis->name, value), p,
                               &work->wishes[i].figures[m]);
    }
    bb_status status = bb_table_write(table, work->path);
    bb_table_free(table);
    return status;
}

static bool read_values(const bb_point_work *work, const bb_table *table)
{
    const bb_points *p = work->points;
    for (uint32_t i = 0; i < work->count; i++) {
        char value[BB_AXIS_VALUE];
        bb_axis_value(work->wishes[i].x, value);
        for (uint32_t m = 0; m < p->method_count; m++) {
            const bb_cell cell = bb_method_row(&p->methods[m], p->axis->name, value);
            if (work->wishes[i].wanted[m] &&
                !get_figures(table, cell, p, &work->wishes[i].figures[m]))
                return false;
        }
    }
    return true;
}

bb_status bb_point_read(const bb_point_work *work)
{
    bb_points *p = work->points;
    bb_table *table;
    BB_TRY(bb_table_read(work->path, &table));
    const uint32_t run = bb_table_find(table, (bb_cell){{NULL}});
    const char *device = bb_table_get_text(table, run, bb_run_columns[BB_RUN_DEVICE].name);
    const bool whole = read_values(work, table);
    if (whole && device[0] != '\0') {
        snprintf(p->device, sizeof p->device, "%s", device);
        snprintf(p->driver, sizeof p->driver, "%s",
                 bb_table_get_text(table, run, bb_run_columns[BB_RUN_DRIVER].name));
    }
    bb_table_free(table);
    return whole ? BB_OK
                 : bb_fail(BB_INVALID, "point %s: it is damaged: remove it, or its folder",
                           work->path);
}
