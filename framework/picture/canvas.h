/* A picture with room for words: a canvas, text in a small font, a legend. For labels of pictures,
 * not for typesetting. */
#ifndef BB_CANVAS_H
#define BB_CANVAS_H

#include "framework/base/status.h"

#include <stdint.h>

/* Linear RGB, row by row from the top, as bb_image_write() takes it. */
typedef struct bb_canvas {
    float *rgb; /* from bb_host_alloc */
    uint32_t width, height;
} bb_canvas;

/* White. *canvas must be zeroed; bb_canvas_free() frees it. */
bb_status bb_canvas_create(uint32_t width, uint32_t height, bb_canvas *canvas);
void bb_canvas_free(bb_canvas *canvas);

/* Fills a rectangle; what lies outside of the canvas is left out. */
void bb_canvas_fill(bb_canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                    const float rgb[3]);

/* Pixels per pixel of the font for a picture of that size: its lines are then about 1/30 of the
 * shorter side. */
uint32_t bb_text_scale(uint32_t width, uint32_t height);
/* Size of one line of ASCII text, in pixels. */
uint32_t bb_text_width(const char *text, uint32_t scale);
uint32_t bb_text_height(uint32_t scale);
/* One line of ASCII text, dark, its upper left corner at x, y. */
void bb_canvas_text(bb_canvas *canvas, int64_t x, int64_t y, uint32_t scale, const char *text);

/* Words with a patch of colour before them. */
typedef struct bb_legend_item {
    char text[64];
    const float *rgb; /* NULL: no patch */
} bb_legend_item;

/* The width that the widest item needs, and the height of all, side by side where they fit into
 * `width`. */
uint32_t bb_legend_width(const bb_legend_item *items, uint32_t count, uint32_t scale);
uint32_t bb_legend_height(const bb_legend_item *items, uint32_t count, uint32_t scale,
                          uint32_t width);
/* From row y on, over the canvas's whole width. */
void bb_canvas_legend(bb_canvas *canvas, uint32_t y, const bb_legend_item *items, uint32_t count,
                      uint32_t scale);

#endif
