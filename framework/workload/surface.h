/* Samples of the surfaces that the scene's views see, for rays that start there. */
#ifndef BB_SURFACE_H
#define BB_SURFACE_H

#include "framework/base/random.h"
#include "framework/workload/job.h"

/* The start of secondary rays. */
typedef struct bb_surface_point {
    double o[3]; /* moved off the surface, rounded to float */
    double normal[3];
} bb_surface_point;

/* Makes the rays of one point, with its own random numbers. */
typedef bb_status bb_surface_maker(void *context, const bb_surface_point *point, bb_random *random,
                                   bb_ray *rays);

/* Makes `per_hit` rays for each of as many primary hits as the request allows. BB_UNSUPPORTED if
 * there are none. */
bb_status bb_surface_rays(bb_rays_job *job, uint32_t per_hit, bb_surface_maker *make,
                          void *context);

/* Replaces each ray of job->rays by the next ray of its path, number `bounce` (2 or more), which
 * starts where the earlier one hits. Paths that hit nothing end. BB_UNSUPPORTED if all of them do.
 */
bb_status bb_surface_go_on(bb_rays_job *job, uint32_t bounce, bb_surface_maker *make,
                           void *context);

#endif
