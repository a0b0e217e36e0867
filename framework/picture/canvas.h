/* A canvas for labelled pictures: rectangles, text in a small font, a legend. */
#ifndef BB_CANVAS_H
#define BB_CANVAS_H

#include "framework/base/status.h"

#include <stdint.h>

/* Linear RGB, row by row from the top, as bb_image_write() takes it. */
typedef struct bb_canvas {
    float *rgb; /* from bb_host_alloc */
    uint32_t width, height;
} bb_canvas;

/* Makes a white canvas. *canvas must be zeroed; bb_canvas_free() frees it. */
bb_status bb_canvas_create(uint32_t width, uint32_t height, bb_canvas *canvas);
void bb_canvas_free(bb_canvas *canvas);

/* Fills a rectangle, clipped to the canvas. */
void bb_canvas_fill(bb_canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                    const float rgb[3]);

/* Returns the font's scale for a picture of this size: a line of text is about 1/30 of the shorter
 * side. */
uint32_t bb_text_scale(uint32_t width, uint32_t height);
/* Return the size of one line of ASCII text in pixels. */
uint32_t bb_text_width(const char *text, uint32_t scale);
uint32_t bb_text_height(uint32_t scale);
/* Draws one line of dark ASCII text with its upper left corner at x, y. */
void bb_canvas_text(bb_canvas *canvas, int64_t x, int64_t y, uint32_t scale, const char *text);

/* A text with a patch of colour before it. */
typedef struct bb_legend_item {
    char text[64];
    const float *rgb; /* NULL: no patch */
} bb_legend_item;

/* Return the width of the widest item, and the height of all items in lines of `width`. */
uint32_t bb_legend_width(const bb_legend_item *items, uint32_t count, uint32_t scale);
uint32_t bb_legend_height(const bb_legend_item *items, uint32_t count, uint32_t scale,
                          uint32_t width);
/* Draws the legend from row y on, as wide as the canvas. */
void bb_canvas_legend(bb_canvas *canvas, uint32_t y, const bb_legend_item *items, uint32_t count,
                      uint32_t scale);

#endif
