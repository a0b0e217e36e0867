/* Ray sets: made once per scene and view, hashed, and replayed for every cell. framework/workload/
 * makes them. */
#ifndef BB_RAYS_H
#define BB_RAYS_H

#include "framework/base/options.h"
#include "framework/device/device.h"
#include "framework/judge/query.h"
#include "framework/scene/scene.h"
#include "kernels/bb_shared.h"

typedef struct bb_rays {
    char name[128]; /* the specification as given */
    char view[48];  /* name of the view; "" if the set is per scene */
    const bb_option
        *options; /* options of the specification; NULL: made by hand, or read from a file */
    bb_spec spec; /* the specification, parsed */
    const bb_query *query;
    uint32_t count;
    bb_ray *rays;   /* from bb_host_alloc */
    uint64_t hash;  /* XXH3 of the rays */
    bool must_hit;  /* each ray must hit something (`edges` from inside a closed mesh): no
                     * tolerance */
    uint32_t width; /* width of the picture that the rays form, row by row; 0: none */
    uint32_t height;
    uint64_t seed; /* as in the request */
    uint32_t primary_width, primary_height, max_rays;
    bb_buffer on_device; /* bb_ray[count] */
} bb_rays;

/* Checks that kernels can trace all rays in this scene: finite, 0 <= tmin < tmax, the largest
 * component of the direction between 2^-120 and 2^120, the origin's coordinates at most 2^92 in the
 * layouts' units (kernels/ERROR_BUDGET.md, "Domain"). True for rays from bb_rays_make(). BB_INVALID
 * names the first ray that is not. */
bb_status bb_rays_check(const bb_scene *scene, const bb_rays *rays);
/* BB_REFUSED if the host has no room for `count` rays called `name`. */
bb_status bb_rays_check_room(const char *name, uint64_t count);
/* Reserves room for `count` rays; sets rays->count. */
bb_status bb_rays_reserve(bb_rays *rays, uint32_t count);
/* Sets the direction to `d`, rounded once; false if it is 0 or not finite in floats. */
bool bb_ray_set_direction(bb_ray *ray, const double d[3]);
/* Computes the hash for rays->hash. */
uint64_t bb_rays_hash(const bb_rays *rays);
bb_status bb_rays_upload(bb_rays *rays, bb_device *device);
void bb_rays_free(bb_rays *rays); /* NULL is allowed */

#endif
