/* Workloads: ray sets, made once per scene and view, hashed, and replayed for every cell. */
#ifndef BB_RAYS_H
#define BB_RAYS_H

#include "framework/base/options.h"
#include "framework/device/device.h"
#include "framework/scene/scene.h"
#include "kernels/bb_shared.h"

typedef enum bb_query {
    BB_CLOSEST_HIT,
    BB_ANY_HIT,
} bb_query;

const char *bb_query_name(bb_query query); /* "closest" or "any" */

/* A workload that can be asked for. */
typedef struct bb_workload {
    const char *name; /* primary, ao, diffuse, random, shadow, edges */
    const char *summary;
    bb_query query;
    bool per_view;            /* once per view; else once per scene */
    const bb_option *options; /* length, count, offset, tmin ... with their defaults */
    /* With these parameters in this scene, must each ray hit something? NULL: none must. */
    bool (*must_hit)(const bb_scene *scene, const bb_spec *spec);
} bb_workload;

/* Whether each of these rays must hit something: they are aimed at a closed mesh from inside. */
bool bb_rays_must_hit(const bb_scene *scene, const bb_spec *spec, const bb_workload *workload);

extern const bb_workload bb_workloads[]; /* ends with name NULL */
const bb_workload *bb_workload_find(const char *name);

typedef struct bb_rays {
    char name[128];              /* the specification as given */
    char view[48];               /* name of the view; "" if the set is per scene */
    const bb_workload *workload; /* NULL: made by hand, read from a file */
    bb_spec spec;                /* the specification, parsed */
    bb_query query;
    uint32_t count;
    bb_ray *rays;   /* from bb_host_alloc */
    uint64_t hash;  /* XXH3 of the rays */
    bool must_hit;  /* each ray must hit something (`edges` from inside a closed mesh): no margin */
    uint32_t width; /* of the picture that the rays make, row by row; 0: none */
    uint32_t height;
    uint64_t seed; /* what they were made by, as in the request */
    uint32_t primary_width, primary_height, max_rays;
    bb_buffer on_device; /* bb_ray[count] */
} bb_rays;

typedef struct bb_rays_request {
    const bb_spec *spec; /* workload and parameters */
    const bb_view *view; /* NULL for sets per scene: the primary hits of all views are sampled */
    uint32_t width, height;
    uint32_t max_rays; /* ao, diffuse, shadow, random: at most this many */
    uint64_t seed;
} bb_rays_request;

struct bb_oracle;

/* Makes the rays of `request`. Secondary rays start at primary hits of the oracle, so that they do not depend on any
 * builder. BB_UNSUPPORTED if the scene has no such rays (no primary hit; `edges` without triangles). Owned by the caller. */
bb_status bb_rays_make(const bb_scene *scene, struct bb_oracle *oracle,
                       const bb_rays_request *request, bb_rays **rays);
/* Whether all rays are ones that kernels can trace in this scene: finite, 0 <= tmin < tmax, the largest
 * component of the direction between 2^-120 and 2^120, the origin's coordinates at most 2^92 in the
 * layouts' units (kernels/ERROR_BUDGET.md, "Domain"). bb_rays_make() has made sure.
 * BB_INVALID names the first that is not. */
bb_status bb_rays_check(const bb_scene *scene, const bb_rays *rays);
/* What rays->hash is. */
uint64_t bb_rays_hash(const bb_rays *rays);
bb_status bb_rays_upload(bb_rays *rays, bb_device *device);
void bb_rays_free(bb_rays *rays); /* NULL is allowed */

#endif
