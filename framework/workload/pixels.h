/* The primary rays of a picture, and of as many more pictures as are asked for. */
#ifndef BB_PIXELS_H
#define BB_PIXELS_H

#include "framework/scene/camera.h"
#include "framework/workload/job.h"

/* How many rays there shall be at least: the option of BB_LEAST_OPTION; 0 if it is not
 * given, and one picture is enough. */
bb_status bb_job_least(const bb_rays_job *job, uint64_t *least);

/* Ray `index` of a view's pictures, row by row, one picture after the other. In the first picture
 * rays go through the centres of their pixels; in later ones each through a random place of its
 * pixel, which is its own. */
void bb_picture_ray(const bb_rays_request *request, const bb_camera *camera, uint64_t index,
                    bb_ray *ray);

#endif
