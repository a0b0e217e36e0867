/* Rays along the axes, exactly in the planes of the primitives' boxes: the direction has zeros, the
 * origin shares two coordinates with a box's corner, and a slab test multiplies 0 by infinity.
 * Zeros have both signs. With `tilt` random numbers of up to that size
 * replace the zeros.
 *
 * A random corner of a random primitive's box, and a random axis and sense; the ray starts outside
 * of the scene's box and passes through the corner.
 */
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "framework/workload/workload.h"

#include <math.h>

static const bb_option options_table[] = {
    BB_COUNT_OPTION,
    {"tilt", "0", NULL, "off the axis by up to this in both other components, 0 to 1"},
    BB_TMIN_OPTION,
    BB_END_OPTION,
};

static void make_ray(const bb_rays_job *job, double tilt, bb_random *random, bb_ray *ray)
{
    const bb_scene *scene = job->scene;
    const bb_box *box = &scene->boxes[bb_random_below(random, scene->prim_count)];
    uint32_t bits = bb_random_below(random, 64), axis = bb_random_below(random, 3);
    double d[3], corner[3], way = (bits & 1) != 0 ? 1 : -1;
    for (uint32_t k = 0; k < 3; k++) {
        double off = tilt > 0 ? bb_random_range(random, -tilt, tilt) : 0;
        corner[k] = (double)((bits >> (1 + k) & 1) != 0 ? box->hi[k] : box->lo[k]);
        d[k] = k == axis ? way : (bits >> (4 + k % 2) & 1) != 0 ? -off : off;
    }
    double side = (double)scene->bounds.hi[axis] - (double)scene->bounds.lo[axis];
    double from = way > 0 ? (double)scene->bounds.lo[axis] : (double)scene->bounds.hi[axis];
    double back = fabs(corner[axis] - from) + 0.1 * side + 0.01 * job->diagonal;
    for (uint32_t k = 0; k < 3; k++)
        ray->o[k] = (float)(corner[k] - back * d[k]);
    bb_ray_set_direction(ray, d); /* one component is 1 or -1 */
}

static bb_status make_axial(bb_rays_job *job)
{
    const bb_spec *spec = job->request->spec;
    uint64_t count;
    double tilt;
    BB_TRY(bb_job_count(job, &count));
    BB_TRY(bb_spec_double(spec, job->options, "tilt", 0, 1, &tilt));
    BB_TRY(bb_rays_reserve(job->rays, (uint32_t)count));
    bb_random random = bb_random_make(job->request->seed, 0x61786961);
    for (uint32_t i = 0; i < job->rays->count; i++) {
        bb_ray *ray = &job->rays->rays[i];
        ray->tmin = job->tmin;
        ray->tmax = INFINITY;
        make_ray(job, tilt, &random, ray);
    }
    return BB_OK;
}

extern const bb_workload bb_workload_axial;
const bb_workload bb_workload_axial = {
    .name = "axial",
    .summary = "along the axes, in the planes of the primitives' boxes, closest hit",
    .query = &bb_query_closest,
    .options = options_table,
    .make = make_axial,
};
