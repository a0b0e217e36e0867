/* The figures of the charts, computed from the records: cells over all views of a ray set, bounds
 * of their wrong rates, Pareto fronts, and winners by number of rays. The report's page and the
 * pictures draw the same figures.
 */
#ifndef BB_CHART_H
#define BB_CHART_H

#include "framework/record/record.h"

/* A cell (framework/record/cell.h), or the sum of cells that differ only in their view. NAN: not
 * measured. */
typedef struct bb_chart_cell {
    const bb_entry *trace, *build; /* the records; of several views, the first one's trace */
    uint32_t trace_index;          /* index of `trace` in the results */
    uint32_t views;
    double count; /* rays traced */
    double rays;  /* rays of the set, of which brute force traces only the first */
    double ms;    /* time of `count` rays: the sum of the views' medians */
    double mrays_s;
    double mrays_s_lo,
        mrays_s_hi; /* 95 % interval; of several views, from the sums of their ends */
    double mrays_s_least, mrays_s_most; /* range of the rounds, summed in the same way */
    double checked, wrong_rays, missed, false_hits, wrong_t; /* rays */
    bb_wrong_rate wrong;
    double fixed_ms; /* time before the first ray: boxes, build, transfer, layout, and
                      * what is left out of the build (bb_left_out_ms()) */
    double metrics[BB_METRICS_MAX]; /* as bb_metrics; of the layout as traced, if known */
    double work;                    /* counted, per ray */
    double simulated[BB_SIMT_MAX];  /* as bb_charts.simulations: bounds, Mrays/s */
    bool reference;
    bool usable; /* a reference, or within the run's limit of wrong rays */
} bb_chart_cell;

typedef struct bb_chart_set {
    const char *scene, *rays;
    const char *view; /* NULL: all views together, or the only view */
    uint32_t views;
    uint32_t cell_count;
    uint32_t incomplete; /* cells that were left out because they lack a view */
    bb_chart_cell *cells;
} bb_chart_set;

typedef struct bb_charts {
    const char *simulations[BB_SIMT_MAX]; /* their names, in the results */
    uint32_t simulation_count;
    uint32_t set_count;
    bb_chart_set *sets; /* for each scene and rays, first all views together, then each view */
    bb_chart_cell *cells;
} bb_charts;

/* A chart for print: letters of 7 points, no title and no background, names instead of keys, and
 * marks and lines that are distinct in grey. */
typedef struct bb_chart_print {
    const char *name; /* of the chart: that of its SVG, without the extension */
    double width_mm;
    const char *file; /* to be written into gnuplot's current folder; ends with .pdf, .svg, .png */
} bb_chart_print;

/* Makes the cells of all measured traces. They point into `results`, which must outlive them
 * unchanged. */
bb_status bb_charts_make(bb_results *results, bb_charts *out);
void bb_charts_free(bb_charts *charts);
/* Returns the sets as JSON for the page, with members as in bb_chart_cell; NAN becomes null. Free
 * it with free(). NULL without memory. */
char *bb_charts_json(const bb_charts *charts);

/* Returns the number of the cell's run in a merged document; 0 is the first. */
double bb_chart_run(const bb_chart_cell *cell);
/* Writes the builder as given, then what traced if that was not the run's device, and with `runs`
 * the number of the run, from 1 as on the page. */
void bb_chart_builder_name(const bb_chart_cell *cell, bool runs, char *name, size_t capacity);

/* ---- Pareto front ---- */

typedef struct bb_chart_point {
    double cost, gain; /* less cost and more gain are better; both finite */
} bb_chart_point;

/* Writes the indices of the Pareto front to `front`, by rising cost, and returns their number. A
 * point beats another if cost and gain are no worse and one is better. Of equal points, the first
 * is taken. */
uint32_t bb_pareto_front(const bb_chart_point *points, uint32_t count, uint32_t *front);

/* ---- time to n rays ---- */

/* ms = fixed_ms + n * ms_per_ray */
typedef struct bb_time_line {
    double fixed_ms, ms_per_ray;
} bb_time_line;

/* `line` is the fastest from `from` rays on, up to the next winner's `from`. */
typedef struct bb_winner {
    double from;
    uint32_t line;
} bb_winner;

/* Writes the lower envelope of the lines over n >= 0 to `winners`, which has room for `count`, and
 * returns the number of winners. It is 0 only if there is no line. */
uint32_t bb_time_winners(const bb_time_line *lines, uint32_t count, bb_winner *winners);

#endif
