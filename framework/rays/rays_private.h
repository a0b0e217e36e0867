/* What the files that make rays share. */
#ifndef BB_RAYS_PRIVATE_H
#define BB_RAYS_PRIVATE_H

#include "framework/base/random.h"
#include "framework/rays/rays.h"

/* One request on its way. */
typedef struct bb_rays_job {
    const bb_scene *scene;
    struct bb_oracle *oracle;
    const bb_rays_request *request;
    const bb_option *options;
    bb_rays *rays;
    double diagonal; /* of the scene's box */
    float tmin;
} bb_rays_job;

/* Room for `count` rays; sets rays->count. */
bb_status bb_rays_reserve(bb_rays *rays, uint32_t count);

/* Sets the direction to `d`, rounded once; false if it is 0 or not finite in floats. */
bool bb_ray_set_direction(bb_ray *ray, const double d[3]);

/* rays_surface.c: ao, diffuse and shadow. */
bb_status bb_rays_ao(bb_rays_job *job);
bb_status bb_rays_diffuse(bb_rays_job *job);
bb_status bb_rays_shadow(bb_rays_job *job);

/* rays_edges.c */
bb_status bb_rays_edges(bb_rays_job *job);
bool bb_rays_edges_must_hit(const bb_scene *scene, const bb_spec *spec);

#endif
