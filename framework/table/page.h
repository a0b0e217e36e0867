/* A page of results: a list of blocks, which is shown on the terminal, as Markdown or as HTML. */
#ifndef BB_PAGE_H
#define BB_PAGE_H

#include "framework/base/statistics.h"
#include "framework/base/status.h"
#include "framework/table/table.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { BB_HEADS_MAX = 32 };

typedef enum bb_block_kind {
    BB_BLOCK_HEADING,
    BB_BLOCK_SAY,  /* a paragraph */
    BB_BLOCK_NOTE, /* an entry of a list */
    BB_BLOCK_VERDICT,
    BB_BLOCK_PICTURE,
    BB_BLOCK_GRID, /* a table */
    BB_BLOCK_PLOT, /* shown in HTML alone: its figures stand in a grid beside it */
} bb_block_kind;

/* A column of a grid or plot, which has at most BB_HEADS_MAX. Texts of a plot name its points, each
 * column of numbers is a series, and the first of them is x unless bars are drawn. */
typedef struct bb_head {
    const char *heading; /* with its unit: "build ms"; a newline makes a second line in text */
    const char *help;    /* "": none */
    int decimals;        /* see bb_figure() */
} bb_head;

/* An entry of a grid: a text, or a number with or without its interval. */
typedef struct bb_item {
    const char *text; /* NULL: it is a number */
    bb_estimate figure;
    char
        mark; /* '*': the best of its column; '~': not told from the best; '!': see the legend; 0 */
} bb_item;

typedef enum bb_plot_kind { BB_DRAW_BARS, BB_DRAW_LINES, BB_DRAW_SCATTER } bb_plot_kind;

/* How a plot is drawn. Bars lie one behind the other: their sum is the length. */
typedef struct bb_axes {
    bb_plot_kind drawing;
    const char *x, *y; /* titles, with units */
    bool x_log, y_log;
} bb_axes;

typedef struct bb_block {
    bb_block_kind kind;
    bool good;        /* of a verdict */
    const char *text; /* the caption of a grid, plot or picture; "": none */
    const char *path; /* of a picture, from the page's folder */
    bb_axes axes;
    bb_head *heads;
    bb_item *items; /* row after row */
    uint32_t head_count, item_count;
} bb_block;

typedef struct bb_page bb_page;

/* Owned by the caller. */
bb_status bb_page_create(const char *title, bb_page **out);
void bb_page_free(bb_page *page); /* NULL is allowed */

/* Texts are copied. Once memory has run out, these functions do nothing and bb_page_status() is
 * BB_REFUSED: callers ask once, at the end. */
void bb_page_heading(bb_page *page, const char *text);
void bb_page_say(bb_page *page, const char *format, ...) __attribute__((format(printf, 2, 3)));
void bb_page_note(bb_page *page, const char *format, ...) __attribute__((format(printf, 2, 3)));
void bb_page_verdict(bb_page *page, bool good, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* A PNG file beside the page. */
void bb_page_picture(bb_page *page, const char *path, const char *caption);

/* Begin a grid or a plot; then come all its columns, then its items, row after row. */
void bb_page_grid(bb_page *page, const char *caption);
void bb_page_plot(bb_page *page, const char *caption, const bb_axes *axes);
void bb_page_column(bb_page *page, const char *heading, const char *unit, const char *help,
                    int decimals);
void bb_page_put_text(bb_page *page, const char *text);
void bb_page_put_figure(bb_page *page, bb_estimate figure, char mark);

void bb_page_widen(bb_page *page); /* its grids may have 160 columns as text, in place of 100 */
void bb_page_lose(bb_page *page);  /* memory ran out elsewhere: as if it had here */
bb_status bb_page_status(const bb_page *page);

const char *bb_page_title(const bb_page *page);
bool bb_page_is_wide(const bb_page *page);
uint32_t bb_page_block_count(const bb_page *page);
const bb_block *bb_page_block(const bb_page *page, uint32_t index);

/* ---- what shows it ---- */

/* Columns are aligned, paragraphs have at most 100 columns. No text steers the terminal. */
void bb_page_print(const bb_page *page, FILE *out);
void bb_page_markdown(const bb_page *page, FILE *out);
/* Shows the page by one of these two and frees it. BB_FAILED: `out` cannot be written. */
bb_status bb_page_end(bb_page *page, void (*show)(const bb_page *, FILE *), FILE *out);
/* One HTML file that loads nothing: pictures from `folder` and the table (NULL: none) are in it. */
bb_status bb_page_html(const bb_page *page, const bb_table *table, const char *folder,
                       const char *path);

#endif
