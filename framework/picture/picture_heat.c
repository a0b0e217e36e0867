/* Draws tests per ray, with a colour bar. */
#include "framework/base/memory.h"
#include "framework/picture/image.h"
#include "framework/picture/picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BAR = 12, TICK = 3, GAP = 5 }; /* in pixels of the font */

static const float ink[3] = {0.02f, 0.02f, 0.02f};

static int compare_tests(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Colours end at a high percentile, so that a few expensive rays do not make all others look alike.
 */
static bb_status find_scale(const bb_count *counts, uint32_t count, bb_heat_map *heat)
{
    uint64_t *tests = malloc(count * sizeof *tests);
    if (tests == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *heat = (bb_heat_map){0};
    for (uint32_t i = 0; i < count; i++) {
        tests[i] = (uint64_t)counts[i].nodes + counts[i].prims;
        heat->boxes += counts[i].nodes;
        heat->prims += counts[i].prims;
    }
    heat->boxes /= count;
    heat->prims /= count;
    qsort(tests, count, sizeof *tests, compare_tests);
    heat->most = (double)tests[count - 1];
    heat->top = (double)tests[count - 1 - count / 1000];
    if (heat->top < 1 || heat->most <= 1.25 * heat->top)
        heat->top = fmax(heat->most, 1);
    free(tests);
    return BB_OK;
}

/* Returns the smallest whole 1, 2 or 5 times a power of ten of which at most `most` reach `top`. */
static double nice_step(double top, double most)
{
    double step = pow(10, floor(log10(fmax(top / most, 1))));
    static const double factors[] = {1, 2, 5, 10};
    for (int i = 0; i < 4; i++)
        if (top / (step * factors[i]) <= most)
            return step * factors[i];
    return step * 10;
}

/* The bar's place on the canvas. */
typedef struct bar {
    uint32_t scale, x, y, width, height;
    char top[24]; /* label of the upper end; a + means that some rays have more tests */
} bar;

static bar place_bar(const bb_rays *rays, const bb_heat_map *heat)
{
    uint32_t scale = bb_text_scale(rays->width, rays->height);
    uint32_t margin = bb_text_height(scale);
    bar b = {.scale = scale, .x = rays->width + GAP * scale, .y = margin, .width = BAR * scale};
    b.height = rays->height > 2 * margin + 20 * scale ? rays->height - 2 * margin : 20 * scale;
    snprintf(b.top, sizeof b.top, "%.0f%s", heat->top, heat->top < heat->most ? "+" : "");
    return b;
}

static void draw_label(bb_canvas *canvas, const bar *b, double share, const char *text)
{
    int64_t y = b->y + (int64_t)lround((1 - share) * b->height);
    int64_t x = b->x + b->width;
    bb_canvas_fill(canvas, x, y - b->scale / 2, TICK * b->scale, b->scale, ink);
    /* a letter's middle is 3.5 pixels of the font below its upper edge */
    bb_canvas_text(canvas, x + (TICK + 2) * b->scale, y - (int64_t)(7 * b->scale / 2), b->scale,
                   text);
}

static void draw_bar(bb_canvas *canvas, const bar *b, const bb_heat_map *heat)
{
    for (uint32_t row = 0; row < b->height; row++) {
        float rgb[3];
        bb_colour_map(1 - ((float)row + 0.5f) / (float)b->height, rgb);
        bb_canvas_fill(canvas, b->x, b->y + row, b->width, 1, rgb);
    }
    uint32_t apart = 2 * bb_text_height(b->scale);
    double step = nice_step(heat->top, fmax(1, fmin(8, b->height / apart)));
    draw_label(canvas, b, 1, b->top);
    for (double value = 0; value < heat->top; value += step) {
        char text[24];
        if ((1 - value / heat->top) * b->height < bb_text_height(b->scale))
            break; /* too near the uppermost label */
        snprintf(text, sizeof text, "%.0f", value);
        draw_label(canvas, b, value / heat->top, text);
    }
}

static void draw_rays(bb_canvas *canvas, const bb_rays *rays, const bb_count *counts, double top)
{
    for (uint32_t i = 0; i < rays->count; i++) {
        size_t x = i % rays->width, y = i / rays->width;
        double tests = (double)counts[i].nodes + counts[i].prims;
        bb_colour_map((float)(tests / top), canvas->rgb + 3 * (y * canvas->width + x));
    }
}

bb_status bb_picture_heat(const bb_rays *rays, const bb_count *counts, const bb_heat_words *called,
                          bb_canvas *canvas, bb_heat_map *heat)
{
    BB_TRY(find_scale(counts, rays->count, heat));
    bar b = place_bar(rays, heat);
    bb_legend_item words[5];
    memset(words, 0, sizeof words);
    snprintf(words[0].text, sizeof words[0].text, "%s", called->all);
    snprintf(words[1].text, sizeof words[1].text, "mean %.1f", heat->boxes + heat->prims);
    snprintf(words[2].text, sizeof words[2].text, "%s %.1f", called->boxes, heat->boxes);
    snprintf(words[3].text, sizeof words[3].text, "%s %.1f", called->prims, heat->prims);
    snprintf(words[4].text, sizeof words[4].text, "most %.0f", heat->most);
    uint32_t width = b.x + b.width + (TICK + 2 + GAP) * b.scale + bb_text_width(b.top, b.scale);
    uint32_t least = bb_legend_width(words, 5, b.scale);
    width = width > least ? width : least;
    uint32_t under = b.y + b.height + bb_text_height(b.scale);
    under = under > rays->height ? under : rays->height;
    BB_TRY(bb_canvas_create(width, under + bb_legend_height(words, 5, b.scale, width), canvas));
    draw_rays(canvas, rays, counts, heat->top);
    draw_bar(canvas, &b, heat);
    bb_canvas_legend(canvas, under, words, 5, b.scale);
    return BB_OK;
}
