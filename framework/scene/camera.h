/* Cameras: one ray per pixel from a view and the size of a picture. */
#ifndef BB_CAMERA_H
#define BB_CAMERA_H

#include "framework/scene/scene.h"

enum { BB_PIXELS_MAX = 1 << 27 }; /* most pixels of a picture */

/* A prepared view: pixel (x, y) looks along `corner` + x * `right` + y * `down` (pinhole), or
 * starts there (parallel). */
typedef struct bb_camera {
    bool parallel;
    double eye[3];
    double forward[3]; /* of length 1 */
    double right[3];   /* one pixel wide; pinhole: at distance 1 */
    double down[3];
    double corner[3]; /* centre of the top left pixel, relative to the eye */
} bb_camera;

/* BB_INVALID for an empty picture, a view without a direction or along its up vector, or an
 * impossible angle of view. */
bb_status bb_camera_make(const bb_view *view, uint32_t width, uint32_t height, bb_camera *camera);

/* Makes the ray through (x, y), in pixels, with whole numbers at pixel centres and y from the top.
 * Its direction has length 1 before rounding; tmin = 0, tmax = inf. */
void bb_camera_ray(const bb_camera *camera, double x, double y, bb_ray *ray);

#endif
