/* Pictures of a scene from a set of primary rays and their hits. */
#ifndef BB_PICTURE_H
#define BB_PICTURE_H

#include "framework/oracle.h"
#include "framework/rays.h"
#include "framework/record.h"
#include "framework/scene.h"

/* Shades hits[0 .. width * height) into rgb (linear, 3 floats per pixel): by the angle between ray and surface normal, and
 * by the direction of the normal. Misses are a light grey. */
void bb_picture_normals(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits, float *rgb);

/* Distance to the eye: near is light, far is dark, by the rank of the distances that there are. */
bb_status bb_picture_depth(const bb_rays *rays, const bb_hit *hits, float *rgb);

/* One value per pixel on the colour map, scaled to *most, the largest of them; a colour bar along the right edge. */
void bb_picture_heat(const bb_rays *rays, const double *values, float *rgb, double *most);

/* Classes (bb_class) over the normals in grey: missed red, false orange, wrong t violet, ties blue; each wrong pixel is drawn with its
 * neighbours so that a single one can be seen. `rgb` holds the normals already. */
void bb_picture_classes(const bb_rays *rays, const uint8_t *classes, float *rgb);

/* Renders one view with the oracle into FOLDER/SCENE-VIEW.png and adds it to the results. */
bb_status bb_picture_of_view(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                             uint32_t width, uint32_t height, const char *folder,
                             bb_results *results);

#endif
