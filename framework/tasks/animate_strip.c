/* A strip of pictures of a sequence: some of its frames side by side, as the oracle sees them. */
#include "framework/tasks/animate_private.h"

#include <stdio.h>
#include <string.h>

enum { TILES_MAX = 8, SIDE = 192, GAP = 4, SCALE = 1 };

static uint32_t tiles_of(const bb_animate *a)
{
    return a->frames < TILES_MAX ? a->frames : TILES_MAX;
}

/* The frame of a tile: evenly spaced, with the first and the last. */
static uint32_t frame_of_tile(const bb_animate *a, uint32_t tile)
{
    return (uint32_t)((uint64_t)tile * (a->frames - 1) / (tiles_of(a) - 1));
}

static bb_status draw_tile(bb_animate *a, uint32_t index, uint32_t tile)
{
    bb_canvas *strip = &a->result->strip;
    float *rgb = NULL;
    char label[32];
    uint32_t left = tile * (SIDE + GAP), top = bb_text_height(SCALE);
    BB_TRY(bb_host_alloc(NULL, (size_t)3 * SIDE * SIDE * sizeof *rgb, "a picture", &rgb));
    bb_status status = bb_picture_trace(a->scene, a->oracle, a->view, SIDE, SIDE, rgb);
    for (uint32_t row = 0; row < SIDE && status == BB_OK; row++)
        memcpy(strip->rgb + 3 * ((size_t)(top + row) * strip->width + left),
               rgb + (size_t)3 * SIDE * row, (size_t)3 * SIDE * sizeof *rgb);
    bb_host_free(rgb);
    snprintf(label, sizeof label, "frame %u", a->result->states[index].frame);
    bb_canvas_text(strip, left, 0, SCALE, label);
    return status;
}

bb_status bb_animate_draw_frame(bb_animate *a, uint32_t index)
{
    uint32_t tiles = tiles_of(a);
    if (!a->request->strip)
        return BB_OK;
    if (a->result->strip.rgb == NULL)
        BB_TRY(bb_canvas_create(tiles * (SIDE + GAP) - GAP, SIDE + bb_text_height(SCALE),
                                &a->result->strip));
    for (uint32_t tile = 0; tile < tiles; tile++)
        if (frame_of_tile(a, tile) == index)
            BB_TRY(draw_tile(a, index, tile));
    return BB_OK;
}
