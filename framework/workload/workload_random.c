/* Random rays: from a uniform point of the scene's box through another; or from near one primitive
 * to near another, so that a far outlier does not hide the rest. */
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "framework/workload/workload.h"

#include <float.h>
#include <math.h>

static const bb_option options_table[] = {
    BB_COUNT_OPTION,
    {"near", "0", NULL, "share of rays from close to one primitive to close to another"},
    BB_TMIN_OPTION,
    BB_END_OPTION,
};

/* Returns the box of a random primitive, grown by its longest side: it is where the scene has
 * something, even if everything is in one corner. */
static bb_box box_near(const bb_scene *scene, bb_random *random)
{
    bb_box box = scene->boxes[bb_random_below(random, scene->prim_count)];
    double side = 0;
    for (int k = 0; k < 3; k++)
        side = fmax(side, (double)box.hi[k] - box.lo[k]);
    for (int k = 0; k < 3; k++) {
        box.lo[k] = (float)fmax(-FLT_MAX, box.lo[k] - side);
        box.hi[k] = (float)fmin(FLT_MAX, box.hi[k] + side);
    }
    return box;
}

/* Makes a ray from a point of one box through a point of the other. */
static bool random_ray(const bb_box *from, const bb_box *to, bb_random *random, bb_ray *ray)
{
    double d[3], length = 0.0;
    for (int k = 0; k < 3; k++) {
        ray->o[k] = (float)bb_random_range(random, from->lo[k], from->hi[k]);
        d[k] = bb_random_range(random, to->lo[k], to->hi[k]) - (double)ray->o[k];
        length = hypot(length, d[k]);
    }
    if (length == 0.0)
        return false;
    for (int k = 0; k < 3; k++)
        d[k] /= length;
    return bb_ray_set_direction(ray, d);
}

/* Two points coincide only if a box has almost no floats inside, or is that of a primitive which is
 * a point. */
static bb_status make_random_ray(const bb_rays_job *job, double near, bb_random *random,
                                 bb_ray *ray)
{
    for (uint32_t tries = 0; tries < 1000; tries++) {
        bb_box from = job->scene->bounds, to = from;
        if (near > 0 && bb_random_unit(random) < near) {
            from = box_near(job->scene, random);
            to = box_near(job->scene, random);
        }
        if (random_ray(&from, &to, random, ray))
            return BB_OK;
    }
    return bb_fail(BB_UNSUPPORTED, "rays random: the box of scene '%s' is too small",
                   job->scene->name);
}

static bb_status make_random(bb_rays_job *job)
{
    uint64_t count;
    BB_TRY(bb_job_count(job, &count));
    double near;
    BB_TRY(bb_spec_double(job->request->spec, job->options, "near", 0, 1, &near));
    if (!(job->diagonal > 0.0))
        return bb_fail(BB_UNSUPPORTED, "rays random: scene '%s' is a single point",
                       job->scene->name);
    BB_TRY(bb_rays_reserve(job->rays, (uint32_t)count));
    bb_random random = bb_random_make(job->request->seed, 0x72616e64);
    for (uint32_t i = 0; i < job->rays->count; i++) {
        bb_ray *ray = &job->rays->rays[i];
        ray->tmin = job->tmin;
        ray->tmax = INFINITY;
        BB_TRY(make_random_ray(job, near, &random, ray));
    }
    return BB_OK;
}

extern const bb_workload bb_workload_random;
const bb_workload bb_workload_random = {
    .name = "random",
    .summary = "from a uniform point of the scene's box through another, closest hit",
    .query = &bb_query_closest,
    .options = options_table,
    .make = make_random,
};
