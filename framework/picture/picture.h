/* Pictures of a scene from a set of primary rays and their hits. */
#ifndef BB_PICTURE_H
#define BB_PICTURE_H

#include "framework/judge/accuracy.h"
#include "framework/judge/oracle.h"
#include "framework/picture/canvas.h"
#include "framework/rays/rays.h"
#include "framework/record/record.h"
#include "framework/scene/scene.h"

/* Shades hits[0 .. width * height) into rgb (linear, 3 floats per pixel): by the angle between ray
 * and surface normal, and by the direction of the normal. Misses are a light grey. */
void bb_picture_normals(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits, float *rgb);

/* Distance to the eye: near is light, far is dark, by the rank of the distances that there are. */
bb_status bb_picture_depth(const bb_rays *rays, const bb_hit *hits, float *rgb);

/* The numbers behind the pictures, for bb_exr_write(), one pixel per ray: the geometric unit normal
 * as the corners' order gives it, 0 for a miss; the distance t, as the hit has it, `miss` for a
 * miss; box and primitive tests together (exact up to 2^24). */
void bb_values_normals(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits, float *xyz);
void bb_values_depth(const bb_rays *rays, const bb_hit *hits, float miss, float *z);
void bb_values_tests(const bb_rays *rays, const bb_count *counts, float *y);

/* What a picture of tests per ray shows. */
typedef struct bb_heat_map {
    double boxes, prims; /* tests per ray, means */
    double most;         /* boxes and primitives together, of one ray */
    double top; /* upper end of the colours; more than 99.9 % of the rays are not above it */
} bb_heat_map;

/* Box and primitive tests of each ray on bb_colour_map(), from 0 to heat->top; a labelled colour
 * bar on the right, the means below. The rays' picture is the upper left of the canvas, which must
 * be zeroed; bb_canvas_free() frees it. */
bb_status bb_picture_heat(const bb_rays *rays, const bb_count *counts, bb_canvas *canvas,
                          bb_heat_map *heat);

/* Classes (bb_class) over the scene in faint grey: missed dark red, false amber, wrong t violet,
 * ties light blue; what is wrong is drawn with its neighbours so that a single ray can be seen. A
 * legend with the counts lies below. The canvas as above. */
bb_status bb_picture_diff(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits,
                          const uint8_t *classes, const bb_accuracy *accuracy, bb_canvas *canvas);

/* Traces one view with the oracle and shades it by surface normals, into rgb (linear, 3 floats per
 * pixel). */
bb_status bb_picture_trace(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                           uint32_t width, uint32_t height, float *rgb);

/* The same into the file `path`. */
bb_status bb_picture_write(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                           uint32_t width, uint32_t height, const char *path);

/* The same into FOLDER/SCENE-VIEW.png, and adds it to the results. */
bb_status bb_picture_of_view(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                             uint32_t width, uint32_t height, const char *folder,
                             bb_results *results);

#endif
