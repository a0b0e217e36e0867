/* Canvas, text and legend. Letters of stb_easy_font are rectangles. They are enlarged by whole
 * numbers, so that strokes stay sharp. */
#include "framework/picture/canvas.h"

#include "framework/base/memory.h"

#include <stb/stb_easy_font.h>

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum {
    TEXT_MAX = 96,
    QUADS_MAX = 64 * TEXT_MAX, /* at most 64 for a letter */
    LINE = 10,                 /* rows of a line of text, in pixels of the font */
    GAP = 5,                   /* around text */
    PATCH = 8,
};

static const float ink[3] = {0.02f, 0.02f, 0.02f};

bb_status bb_canvas_create(uint32_t width, uint32_t height, bb_canvas *canvas)
{
    size_t values = 3 * (size_t)width * height;
    BB_TRY(bb_host_alloc(NULL, values * sizeof(float), "picture", &canvas->rgb));
    canvas->width = width;
    canvas->height = height;
    for (size_t i = 0; i < values; i++)
        canvas->rgb[i] = 1;
    return BB_OK;
}

void bb_canvas_free(bb_canvas *canvas)
{
    bb_host_free(canvas->rgb);
    *canvas = (bb_canvas){0};
}

static int64_t clamp(int64_t value, int64_t high)
{
    return value < 0 ? 0 : value > high ? high : value;
}

void bb_canvas_fill(bb_canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                    const float rgb[3])
{
    int64_t right = clamp(x + width, canvas->width), bottom = clamp(y + height, canvas->height);
    for (int64_t v = clamp(y, canvas->height); v < bottom; v++)
        for (int64_t u = clamp(x, canvas->width); u < right; u++)
            memcpy(canvas->rgb + 3 * (size_t)(v * canvas->width + u), rgb, 3 * sizeof *rgb);
}

/* ---- text ---- */

uint32_t bb_text_scale(uint32_t width, uint32_t height)
{
    uint32_t side = width < height ? width : height;
    return side < 400 ? 1 : 1 + side / 512;
}

uint32_t bb_text_width(const char *text, uint32_t scale)
{
    char line[TEXT_MAX];
    snprintf(line, sizeof line, "%s", text);
    return (uint32_t)stb_easy_font_width(line) * scale;
}

uint32_t bb_text_height(uint32_t scale)
{
    return LINE * scale;
}

void bb_canvas_text(bb_canvas *canvas, int64_t x, int64_t y, uint32_t scale, const char *text)
{
    typedef struct corner {
        float x, y, z;
        unsigned char colour[4];
    } corner;
    corner quads[QUADS_MAX][4];
    char line[TEXT_MAX];
    snprintf(line, sizeof line, "%s", text);
    int count = stb_easy_font_print(0, 0, line, NULL, quads, (int)sizeof quads);
    for (int i = 0; i < count; i++) {
        const corner *low = &quads[i][0], *high = &quads[i][2];
        bb_canvas_fill(canvas, x + (int64_t)low->x * scale, y + (int64_t)low->y * scale,
                       (int64_t)(high->x - low->x) * scale, (int64_t)(high->y - low->y) * scale,
                       ink);
    }
}

/* ---- legend ---- */

static uint32_t item_width(const bb_legend_item *item, uint32_t scale)
{
    uint32_t patch = item->rgb != NULL ? (PATCH + GAP) * scale : 0;
    return patch + bb_text_width(item->text, scale);
}

uint32_t bb_legend_width(const bb_legend_item *items, uint32_t count, uint32_t scale)
{
    uint32_t widest = 0;
    for (uint32_t i = 0; i < count; i++)
        if (item_width(&items[i], scale) > widest)
            widest = item_width(&items[i], scale);
    return widest + 2 * GAP * scale;
}

/* Places the items in lines of at most `width`. Draws them unless `canvas` is NULL. Returns the
 * height. */
static uint32_t lay_out(bb_canvas *canvas, uint32_t y, const bb_legend_item *items, uint32_t count,
                        uint32_t scale, uint32_t width)
{
    uint32_t gap = GAP * scale, line = bb_text_height(scale) + gap, x = gap, top = gap;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t wide = item_width(&items[i], scale);
        if (x > gap && x + wide + gap > width) {
            x = gap;
            top += line;
        }
        uint32_t text = x;
        if (items[i].rgb != NULL)
            text += (PATCH + GAP) * scale;
        if (canvas != NULL && items[i].rgb != NULL)
            bb_canvas_fill(canvas, x, y + top, PATCH * scale, PATCH * scale, items[i].rgb);
        if (canvas != NULL)
            bb_canvas_text(canvas, text, y + top, scale, items[i].text);
        x += wide + 3 * gap;
    }
    return top + line;
}

uint32_t bb_legend_height(const bb_legend_item *items, uint32_t count, uint32_t scale,
                          uint32_t width)
{
    return lay_out(NULL, 0, items, count, scale, width);
}

void bb_canvas_legend(bb_canvas *canvas, uint32_t y, const bb_legend_item *items, uint32_t count,
                      uint32_t scale)
{
    lay_out(canvas, y, items, count, scale, canvas->width);
}
