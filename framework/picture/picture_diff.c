/* Draws the classes of rays as colours over the scene in faint grey, with a legend of their counts.
 */
#include "framework/base/memory.h"
#include "framework/picture/picture.h"

#include <stdio.h>
#include <string.h>

/* Linear RGB. Light and dark alternate, so that classes differ even without hue. */
static const float missed_rgb[3] = {0.56f, 0.0f, 0.0f};
static const float false_rgb[3] = {0.90f, 0.36f, 0.0f};
static const float wrong_t_rgb[3] = {0.22f, 0.02f, 0.55f};
static const float tie_rgb[3] = {0.06f, 0.48f, 0.85f};

static const float *colour_of(uint8_t class)
{
    switch ((bb_class) class) {
    case BB_RIGHT:
        return NULL;
    case BB_TIE:
        return tie_rgb;
    case BB_MISSED:
    case BB_UNWRITTEN:
        return missed_rgb;
    case BB_FALSE_HIT:
        return false_rgb;
    case BB_WRONG_T:
        return wrong_t_rgb;
    }
    return NULL;
}

static void draw_scene(bb_canvas *canvas, const bb_rays *rays, const float *normals)
{
    for (size_t i = 0; i < rays->count; i++) {
        float *pixel = canvas->rgb + 3 * (i / rays->width * canvas->width + i % rays->width);
        const float *n = normals + 3 * i;
        pixel[0] = pixel[1] = pixel[2] = 0.45f + 0.55f / 3 * (n[0] + n[1] + n[2]);
    }
}

/* Wrong pixels are drawn with their neighbours, so that single ones are visible: first ties, then
 * wrong ones, then each pixel in its own colour, so that no neighbour covers it. */
static void draw_classes(bb_canvas *canvas, const bb_rays *rays, const uint8_t *classes,
                         uint32_t scale)
{
    for (int pass = 0; pass < 3; pass++)
        for (uint32_t i = 0; i < rays->count; i++) {
            const float *colour = colour_of(classes[i]);
            bool tie = classes[i] == BB_TIE;
            if (colour == NULL || (pass < 2 && tie != (pass == 0)))
                continue;
            uint32_t x = i % rays->width, y = i / rays->width;
            uint32_t reach = pass == 2 ? 0 : tie ? scale / 4 : (scale + 1) / 2;
            uint32_t right = x + reach < rays->width ? x + reach : rays->width - 1;
            uint32_t bottom = y + reach < rays->height ? y + reach : rays->height - 1;
            uint32_t left = x > reach ? x - reach : 0, top = y > reach ? y - reach : 0;
            bb_canvas_fill(canvas, left, top, right - left + 1, bottom - top + 1, colour);
        }
}

bb_status bb_picture_diff(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits,
                          const uint8_t *classes, const bb_accuracy *accuracy, bb_canvas *canvas)
{
    uint32_t scale = bb_text_scale(rays->width, rays->height);
    bb_legend_item words[5] = {
        {.rgb = missed_rgb}, {.rgb = false_rgb}, {.rgb = wrong_t_rgb}, {.rgb = tie_rgb}};
    const struct {
        const char *format;
        uint64_t count;
    } lines[5] = {{"missed %llu", accuracy->missed},
                  {"false %llu", accuracy->false_hits},
                  {"wrong t %llu", accuracy->wrong_t},
                  {"tie (right) %llu", accuracy->ties},
                  {"of %llu rays", accuracy->checked}};
    for (int i = 0; i < 5; i++)
        snprintf(words[i].text, sizeof words[i].text, lines[i].format,
                 (unsigned long long)lines[i].count);
    uint32_t least = bb_legend_width(words, 5, scale);
    uint32_t width = rays->width > least ? rays->width : least;
    float *normals = NULL;
    bb_status status =
        bb_host_alloc(NULL, 3 * (size_t)rays->count * sizeof *normals, "picture", &normals);
    if (status == BB_OK)
        status = bb_canvas_create(width, rays->height + bb_legend_height(words, 5, scale, width),
                                  canvas);
    if (status == BB_OK) {
        bb_picture_normals(scene, rays, hits, normals);
        draw_scene(canvas, rays, normals);
        draw_classes(canvas, rays, classes, scale);
        bb_canvas_legend(canvas, rays->height, words, 5, scale);
    }
    bb_host_free(normals);
    return status;
}
