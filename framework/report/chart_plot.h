/* Shared by all pictures: series with their looks and keys, axes and marks, written in gnuplot's
 * language. */
#ifndef BB_CHART_PLOT_H
#define BB_CHART_PLOT_H

#include "framework/report/chart.h"

#include <stdio.h>

enum { BB_PLOT_KEY = 64, BB_PLOT_STEM = 160, BB_PLOT_CROSS = 2, BB_PLOT_BLACK = 0x1b1e23 };

/* ---- series ---- */

typedef bool bb_same_fn(const bb_chart_cell *a, const bb_chart_cell *b);
bool bb_same_builder(const bb_chart_cell *a,
                     const bb_chart_cell *b); /* same builder of the same run */
bool bb_same_kernel(const bb_chart_cell *a, const bb_chart_cell *b);
bool bb_same_intersector(const bb_chart_cell *a, const bb_chart_cell *b);

/* The first cell of each series, in the order of the results: a series keeps its colour, shape and
 * key in all pictures. */
typedef struct bb_series {
    bb_same_fn *same;
    bool references; /* the series are references, else cells of our kernels */
    uint32_t count;
    const bb_chart_cell **cells;
} bb_series;

/* Returns the index of the cell's series; `count` if there is none. */
uint32_t bb_series_find(const bb_series *list, const bb_chart_cell *cell);
/* Adds the cell's series if it is new; `cells` must have room. */
void bb_series_add(bb_series *list, const bb_chart_cell *cell);

/* A cell on a chart; NAN: there is no such interval or range. */
typedef struct bb_mark {
    const bb_chart_cell *cell;
    double x, x_low, x_high, y;
    double y_low, y_high;   /* 95 % interval */
    double y_least, y_most; /* range of too few rounds for an interval; NAN if there is one */
    unsigned colour;
    int shape;
    bool at_most; /* gets an arrow to the left: the value is an upper bound */
    int key_side; /* 1: the key is to the right of the mark; -1: to the left; 0: left out */
    char key[BB_PLOT_KEY];
} bb_mark;

/* The series of all pictures, and the picture being written. */
typedef struct bb_plot {
    FILE *out; /* `script` while a wanted picture is written, else `nowhere` */
    FILE *script, *nowhere;
    const bb_chart_print *figure; /* NULL: all pictures for the screen */
    bb_series kernels, builders, intersectors, references;
    bool several_runs;
    const bb_chart_set *set;
    char stem[BB_PLOT_STEM]; /* file name of the set's pictures, without kind and extension */
    uint32_t pictures;
    char sets[512], kinds[256]; /* what a figure's name may be made of: for a message */
    /* buffers with room for the cells of a set */
    bb_mark *marks; /* three per cell */
    bb_chart_point *points;
    uint32_t *front;
    bb_time_line *lines;
    bb_winner *winners;
    const bb_chart_cell **cells;
} bb_plot;

/* In print there are three greys, and `looks` series that differ otherwise have the same. */
unsigned bb_plot_colour(const bb_plot *p, uint32_t series, uint32_t looks);
/* Kernels A, B ... Z, AA ...; builders 1, 2 ...; references R1, R2 ...; in print their names. */
void bb_plot_kernel_key(const bb_plot *p, const bb_chart_cell *cell, char key[BB_PLOT_KEY]);
void bb_plot_builder_key(const bb_plot *p, const bb_chart_cell *cell, char key[BB_PLOT_KEY]);

/* ---- text ---- */

/* Writes text for use between single quotes, in which gnuplot expands nothing. */
void bb_plot_quoted(FILE *out, const char *text);
/* Writes three digits and a unit: "12.3 M". */
void bb_plot_brief(double value, char text[32]);

/* Adds a name to a list for a message unless it is there, or the sign that there are more. */
#define bb_plot_list(list, name) bb_plot_list_in(list, sizeof(list), name)
void bb_plot_list_in(char *list, size_t capacity, const char *name);

/* ---- axes ---- */

typedef struct bb_chart_axis {
    double low, high; /* low > high: nothing was added */
    bool log;
} bb_chart_axis;

bb_chart_axis bb_axis_make(bool log);
/* Extends the axis to the value, unless the axis cannot show it. */
void bb_axis_add(bb_chart_axis *axis, double value);
/* Rounds a logarithmic axis to whole decades. Gives a linear axis some room on both sides, but not
 * below 0. */
void bb_axis_round(bb_chart_axis *axis);

/* Titles and axes of a chart. None of the texts comes from a file. */
typedef struct bb_chart_frame {
    const char *kind; /* part of the file's name */
    const char *title, *subtitle, *x_title, *y_title;
    const char
        *marks; /* what they mean, if the legend's other entries do not say it; NULL: they do */
    bb_chart_axis x, y; /* rounded */
    uint32_t entries;   /* approximate number of legend entries */
    uint32_t left_out;  /* number of cells that are not drawn; the picture shows it */
} bb_chart_frame;

/* Writes titles, axes and style of the SVG, which bb_plot_end() repeats as PNG, or of the figure.
 * To be called before anything else is written to p->out, which goes nowhere if the picture is not
 * wanted. */
void bb_plot_begin(bb_plot *p, const bb_chart_frame *frame);
void bb_plot_end(bb_plot *p, const bb_chart_frame *frame);

/* ---- marks ---- */

/* Sets colour and shape of a mark: its colour is that of its series in `list`, its shape that of
 * its intersector, or in print, where there is but one intersector, of its series; filled, or
 * hollow if none of the cell's rays was wrong. References are crosses. */
void bb_plot_look(const bb_plot *p, const bb_series *list, bb_mark *mark);
/* Sets the mark's y to the cell's speed, with its interval or else its range, and extends the axis
 * to them. */
void bb_plot_speed(bb_mark *mark, bb_chart_axis *y);
/* Labels as many marks as there is room for, in their order. */
void bb_plot_place_keys(const bb_plot *p, bb_mark *marks, uint32_t count, const bb_chart_axis *x,
                        const bb_chart_axis *y);
/* Writes text as a column of a data block. */
void bb_plot_column(FILE *out, const char *text);
/* Writes the data block $marks and the plot command for it; legend entries may follow. */
void bb_plot_marks(FILE *out, const bb_mark *marks, uint32_t count, bool front);
/* Writes legend entries for the series of `list` that one of p's first `marks` marks belongs to.
 * References have a cross. Unless `coloured`, an entry shows only the key. */
void bb_plot_legend_series(const bb_plot *p, const bb_series *list, uint32_t marks, bool coloured);
/* Writes the legend entry for the vertical lines of p's first `marks` marks: intervals or ranges.
 */
void bb_plot_legend_spread(const bb_plot *p, uint32_t marks);
/* Writes the legend entries of the shapes, one for each intersector. */
void bb_plot_legend_shapes(const bb_plot *p);

/* ---- the pictures ---- */

enum { BB_DRAWINGS_MAX = 2 }; /* most pictures of one file */

/* The pictures that a file draw_NAME.c, which CMake finds, draws of p->set. A function draws
 * nothing if there is nothing to show. */
typedef struct bb_drawing {
    void (*draw[BB_DRAWINGS_MAX])(bb_plot *p); /* NULL for none */
} bb_drawing;

extern const bb_drawing *const bb_drawings[]; /* generated; ends with NULL */

#endif
