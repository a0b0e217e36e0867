/* The primary rays of a picture, and of further pictures. */
#ifndef BB_PIXELS_H
#define BB_PIXELS_H

#include "framework/scene/camera.h"
#include "framework/workload/job.h"

/* Gets the least number of rays, from BB_LEAST_OPTION; 0 if it is not given: one picture is
 * enough. */
bb_status bb_job_least(const bb_rays_job *job, uint64_t *least);

/* Makes ray `index` of a view's pictures, row by row, one picture after the other. In the first
 * picture rays go through the centres of their pixels; in later ones each through its own random
 * place in its pixel. */
void bb_picture_ray(const bb_rays_request *request, const bb_camera *camera, uint64_t index,
                    bb_ray *ray);

#endif
