/* Makes pictures of a scene from primary rays and their hits. */
#ifndef BB_PICTURE_H
#define BB_PICTURE_H

#include "framework/judge/accuracy.h"
#include "framework/judge/oracle.h"
#include "framework/judge/rays.h"
#include "framework/picture/canvas.h"
#include "framework/record/record.h"
#include "framework/scene/scene.h"

/* Shades hits into rgb (3 linear floats per pixel) by the direction of the normal and by its angle
 * to the ray. Misses are light grey. */
void bb_picture_normals(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits, float *rgb);

/* Shades hits by their distance to the eye: near is light, far is dark. The nearest and farthest 1
 * % share the end shades. */
bb_status bb_picture_depth(const bb_rays *rays, const bb_hit *hits, float *rgb);

/* Fill numbers for bb_exr_write(), one pixel per ray. Normals: the geometric unit normal by the
 * order of corners, 0 for a miss. Depth: the hit's t, `miss` for a miss. Tests: the sum of box and
 * primitive tests, exact up to 2^24. */
void bb_values_normals(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits, float *xyz);
void bb_values_depth(const bb_rays *rays, const bb_hit *hits, float miss, float *z);
void bb_values_tests(const bb_rays *rays, const bb_count *counts, float *y);

/* Figures of a picture of tests per ray. */
typedef struct bb_heat_map {
    double boxes, prims; /* mean tests per ray */
    double most;         /* the most tests of one ray, boxes and primitives together */
    double top;          /* the last colour's value; more than 99.9 % of rays are not above it */
} bb_heat_map;

/* What a picture of counts calls them: "tests per ray", "boxes", "primitives". */
typedef struct bb_heat_words {
    const char *all, *boxes, *prims;
} bb_heat_words;

/* Draws box and primitive tests of each ray with bb_colour_map(), from 0 to heat->top, a labelled
 * colour bar on the right and the means below. The rays' picture is the upper left part of the
 * canvas, which must be zeroed; bb_canvas_free() frees it. */
bb_status bb_picture_heat(const bb_rays *rays, const bb_count *counts, const bb_heat_words *words,
                          bb_canvas *canvas, bb_heat_map *heat);

/* Draws classes (bb_class) over the scene in faint grey: missed dark red, false amber, wrong t
 * violet, ties light blue. Wrong pixels are enlarged so that single rays are visible. A legend
 * below has the counts. The canvas is used as in bb_picture_heat(). */
bb_status bb_picture_diff(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits,
                          const uint8_t *classes, const bb_accuracy *accuracy, bb_canvas *canvas);

/* Traces one view with the oracle and shades it by normals into rgb (3 linear floats per pixel). */
bb_status bb_picture_trace(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                           uint32_t width, uint32_t height, float *rgb);

/* Does the same and writes the file `path`. */
bb_status bb_picture_write(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                           uint32_t width, uint32_t height, const char *path);

/* Does the same, writes FOLDER/SCENE-VIEW.png, and adds the picture to the results. */
bb_status bb_picture_of_view(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                             uint32_t width, uint32_t height, const char *folder,
                             bb_results *results);

#endif
