/* Views: which rows and columns of a table make a grid or a plot, as constant data. */
#ifndef BB_VIEW_H
#define BB_VIEW_H

#include "framework/table/page.h"
#include "framework/table/table.h"

enum { BB_VIEW_COLUMNS = 20, BB_VIEW_PARTS = 4 };

/* A set of dimensions: BB_SET(BB_SCENE) | BB_SET(BB_BUILDER). */
#define BB_SET(dimension) (1u << (dimension))

/* Columns of the table, by name, added up round by round; those that a row lacks are left out.
 * Columns of the grid without a value in any row are left out, and rows without one in any column.
 */
typedef struct bb_view_column {
    const char *parts[BB_VIEW_PARTS];
    const char *heading; /* NULL: that of the first part; "": names of `across` alone */
    bool ratio; /* to the base: the first row of the same scene, frame and question that has this
                 * figure; rounds are paired, and the interval is that of the ratios' median */
} bb_view_column;

typedef struct bb_table_view {
    const char *caption;    /* with `each`, names follow */
    unsigned with, without; /* sets of dimensions which rows of the table have, or do not have */
    const char *question;   /* that rows of the table must have; NULL: any */
    const char *having;     /* a column of texts that rows must have a value in; NULL: any row */
    /* rows of the grid: which dimensions tell them apart, and are its first columns; of several
     * rows of the table in one of the grid, figures are geometric means, texts the first's */
    unsigned rows;
    unsigned across; /* columns are repeated for each combination of these names: a curve for each
                      * builder, say */
    unsigned each;   /* so is the grid or plot; `with` has these */
    bb_view_column columns[BB_VIEW_COLUMNS]; /* ended by one without parts */
    const char *order;   /* a column of the table: rows by its value, the best first; NULL: as they
                          * are. Rows without it are last. */
    uint32_t most;       /* rows that are shown; a sentence says how many more there are; 0: all */
    const bb_axes *axes; /* a plot; NULL: a grid */
} bb_table_view;

/* Appends the grid or plot to the page; nothing, if there are no rows. `within`: names that rows
 * must have. The best of a column are marked, if it says which are: the best value, and those whose
 * interval includes it; between frames, or parts of one thing, there is no best. x of curves is the
 * number with which the rows' names begin, or else the first column. */
void bb_view_show(const bb_table_view *view, const bb_table *table, bb_cell within, bb_page *page);

/* All values of one row, by their headings, as a paragraph. */
void bb_view_say(const bb_table *table, bb_cell cell, bb_page *page);

#endif
