/* Cosine-weighted rays over the hemisphere at each point of the visible surfaces. */
#ifndef BB_HEMISPHERE_H
#define BB_HEMISPHERE_H

#include "framework/workload/job.h"

/* Makes as many rays per point as the option per_hit says, up to tmax. */
bb_status bb_hemisphere_rays(bb_rays_job *job, float tmax);

/* Makes the last rays of paths of so many bounces (1: one ray per point), without bound.
 * BB_UNSUPPORTED if no path is so long. */
bb_status bb_hemisphere_paths(bb_rays_job *job, uint32_t bounces);

#endif
