/* What the charts show, computed from the records: cells over all views of a ray set, how wrong
 * they may be, who beats whom, and who wins for how many rays. The report's page and the pictures
 * draw the same figures.
 */
#ifndef BB_CHART_H
#define BB_CHART_H

#include "framework/record/record.h"

/* A cell (framework/record/cell.h), or those that differ in their view alone, rays and times added
 * up. NAN: not measured. */
typedef struct bb_chart_cell {
    const bb_entry *trace, *build; /* the records; of several views the first one's trace */
    uint32_t trace_index;          /* of `trace` in the document */
    uint32_t views;
    double count; /* rays traced */
    double rays;  /* rays of the set: brute force traces only the first of them */
    double ms;    /* sum of the views' medians, for `count` rays */
    double mrays_s;
    double mrays_s_lo,
        mrays_s_hi; /* 95 % interval; of several views, the ends of theirs together */
    double mrays_s_least, mrays_s_most;                      /* range of the rounds, likewise */
    double checked, wrong_rays, missed, false_hits, wrong_t; /* rays */
    bb_wrong_rate wrong;
    double fixed_ms;                /* before the first ray: boxes, build, transfer and layout */
    double metrics[BB_METRICS_MAX]; /* as bb_metrics; of the layout as traced where that is known */
    bool reference;
    bool usable; /* a reference, or right within the run's limit: may be recommended */
} bb_chart_cell;

typedef struct bb_chart_set {
    const char *scene, *rays;
    const char *view; /* NULL: all views together; the only set of a scene and rays with one view */
    uint32_t views;
    uint32_t cell_count;
    uint32_t incomplete; /* cells left out because they lack a view */
    bb_chart_cell *cells;
} bb_chart_set;

typedef struct bb_charts {
    uint32_t set_count;
    bb_chart_set *sets; /* per scene and rays: all views together first, then each view */
    bb_chart_cell *cells;
} bb_charts;

/* Reads the traces that were measured. What it holds points into `results`, which must outlive it
 * unchanged. */
bb_status bb_charts_make(bb_results *results, bb_charts *out);
void bb_charts_free(bb_charts *charts);
/* The sets as JSON for the page (members as in bb_chart_cell; NAN is null), for cJSON_free(); NULL
 * if there is no memory. */
char *bb_charts_json(const bb_charts *charts);

/* The number of the run in a merged document; 0 is the first. */
double bb_chart_run(const bb_chart_cell *cell);
/* The builder as given, what traced if that is not the run's device, and with `runs` its run,
 * counted from 1 as on the page. */
void bb_chart_builder_name(const bb_chart_cell *cell, bool runs, char *name, size_t capacity);

/* ---- Pareto front ---- */

typedef struct bb_chart_point {
    double cost, gain; /* less, more is better; finite */
} bb_chart_point;

/* Indices of the points that none beats (at most the cost and at least the gain, one of them
 * better), by rising cost, into `front`; equal points: the first. Returns how many. */
uint32_t bb_pareto_front(const bb_chart_point *points, uint32_t count, uint32_t *front);

/* ---- time to n rays ---- */

/* ms = fixed_ms + n * ms_per_ray */
typedef struct bb_time_line {
    double fixed_ms, ms_per_ray;
} bb_time_line;

/* `line` is the fastest from n rays on, until the next one's n. */
typedef struct bb_winner {
    double from;
    uint32_t line;
} bb_winner;

/* The lower envelope of the lines over n >= 0 into `winners` (room for `count`); returns how many,
 * 0 only if there is no line. */
uint32_t bb_time_winners(const bb_time_line *lines, uint32_t count, bb_winner *winners);

#endif
