/* What the pictures of the charts share: series with their colours and keys, axes, marks, and their
 * text in gnuplot's language. */
#ifndef BB_CHART_PLOT_H
#define BB_CHART_PLOT_H

#include "framework/chart/chart.h"

#include <stdio.h>

enum { BB_PLOT_KEY = 16, BB_PLOT_STEM = 160, BB_PLOT_CROSS = 2, BB_PLOT_BLACK = 0x1b1e23 };

/* ---- series ---- */

typedef bool bb_same_fn(const bb_chart_cell *a, const bb_chart_cell *b);
bool bb_same_builder(const bb_chart_cell *a, const bb_chart_cell *b); /* of one run */
bool bb_same_kernel(const bb_chart_cell *a, const bb_chart_cell *b);
bool bb_same_intersector(const bb_chart_cell *a, const bb_chart_cell *b);

/* The first cell of each series, in the order of the document: a series keeps its colour, shape and
 * key in all pictures. */
typedef struct bb_series {
    bb_same_fn *same;
    bool references; /* takes references rather than our cells */
    uint32_t count;
    const bb_chart_cell **cells;
} bb_series;

/* `count` if there is none. */
uint32_t bb_series_find(const bb_series *list, const bb_chart_cell *cell);
/* Adds the cell's series unless it is there; `cells` has room. */
void bb_series_add(bb_series *list, const bb_chart_cell *cell);

/* A cell on a chart; NAN: there is no such interval or range. */
typedef struct bb_mark {
    const bb_chart_cell *cell;
    double x, x_low, x_high, y;
    double y_low, y_high;   /* 95 % interval */
    double y_least, y_most; /* range of too few rounds for an interval; NAN if there is one */
    unsigned colour;
    int shape;
    bool at_most; /* gets an arrow to the left */
    bool labelled;
    char key[BB_PLOT_KEY];
} bb_mark;

/* The series of all pictures, and the picture being written. */
typedef struct bb_plot {
    FILE *out;
    bb_series kernels, builders, intersectors, references;
    bool several_runs;
    const bb_chart_set *set;
    char stem[BB_PLOT_STEM]; /* file name of the set's pictures, without kind and ending */
    uint32_t pictures;
    /* room for the cells of a set */
    bb_mark *marks; /* two per cell */
    bb_chart_point *points;
    uint32_t *front;
    bb_time_line *lines;
    bb_winner *winners;
    const bb_chart_cell **cells;
} bb_plot;

unsigned bb_plot_colour(uint32_t series);
/* Kernels A, B ... Z, AA ...; builders 1, 2 ...; references R1, R2 ... */
void bb_plot_kernel_key(uint32_t series, char key[BB_PLOT_KEY]);
void bb_plot_builder_key(const bb_plot *p, const bb_chart_cell *cell, char key[BB_PLOT_KEY]);

/* ---- text ---- */

/* For between single quotes, in which gnuplot expands nothing. */
void bb_plot_quoted(FILE *out, const char *text);
/* "12.3 M": three digits and a unit. */
void bb_plot_brief(double value, char text[32]);

/* ---- axes ---- */

typedef struct bb_chart_axis {
    double low, high; /* low > high: nothing was added */
    bool log;
} bb_chart_axis;

bb_chart_axis bb_axis_make(bool log);
/* What cannot stand on the axis is left out. */
void bb_axis_add(bb_chart_axis *axis, double value);
/* Whole decades; or some room on both sides, but none below 0. */
void bb_axis_round(bb_chart_axis *axis);

/* What stands around a chart; all text is our own. */
typedef struct bb_chart_frame {
    const char *kind; /* in the file's name */
    const char *title, *subtitle, *x_title, *y_title;
    bb_chart_axis x, y; /* rounded */
    uint32_t entries;   /* of the legend, about */
    uint32_t left_out;  /* cells that are not drawn, which the picture says */
} bb_chart_frame;

/* Titles, axes, style; the SVG comes first, the PNG with bb_plot_end(). */
void bb_plot_begin(bb_plot *p, const bb_chart_frame *frame);
void bb_plot_end(bb_plot *p, const bb_chart_frame *frame);

/* ---- marks ---- */

/* Filled, or hollow if none of the cell's rays was wrong; by intersector, a cross for
 * references. */
int bb_plot_shape(const bb_plot *p, const bb_chart_cell *cell);
/* The cell's speed as the mark's y, and either its interval or its range; both onto the axis. */
void bb_plot_speed(bb_mark *mark, bb_chart_axis *y);
/* Gives keys to as many marks as have room for theirs, the first ones first. */
void bb_plot_place_keys(bb_mark *marks, uint32_t count, const bb_chart_axis *x,
                        const bb_chart_axis *y);
/* Data block $marks, and the plot of it; legend entries may follow. */
void bb_plot_marks(FILE *out, const bb_mark *marks, uint32_t count, bool front);
/* The series of `list` that have one of p's first `marks` marks; references have a cross. Where
 * marks do not have the series' colours, the key alone stands for it. */
void bb_plot_legend_series(const bb_plot *p, const bb_series *list, uint32_t marks, bool coloured);
/* What the upright lines of p's first `marks` marks are: intervals or ranges. */
void bb_plot_legend_spread(const bb_plot *p, uint32_t marks);
/* What the shapes mean: each intersector. */
void bb_plot_legend_shapes(const bb_plot *p);

/* ---- the pictures ---- */

enum { BB_DRAWINGS_MAX = 2 }; /* of a file */

/* What a file draw_NAME.c, which CMake finds, draws of p->set: nothing where there is nothing to
 * draw. */
typedef struct bb_drawing {
    void (*draw[BB_DRAWINGS_MAX])(bb_plot *p); /* NULL for none */
} bb_drawing;

extern const bb_drawing *const bb_drawings[]; /* generated; ends with NULL */

#endif
