/* Directions by Malley's method: a uniform point of the unit disc, lifted to the hemisphere. */
#include "framework/workload/hemisphere.h"

#include "framework/workload/surface.h"

#include <math.h>

typedef struct hemisphere {
    uint32_t per_hit;
    float tmin, tmax;
} hemisphere;

static bool cosine_direction(const double normal[3], bb_random *random, bb_ray *ray)
{
    double x, y, square;
    do {
        x = bb_random_range(random, -1.0, 1.0);
        y = bb_random_range(random, -1.0, 1.0);
        square = x * x + y * y;
    } while (square >= 1.0);
    double z = sqrt(1.0 - square);
    /* u = normal cross (the axis in which it is smallest), w = normal cross u. */
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) < fabs(normal[axis]))
            axis = k;
    int j = (axis + 1) % 3, k = (axis + 2) % 3;
    double flat = hypot(normal[j], normal[k]), u[3], d[3];
    u[axis] = 0.0;
    u[j] = normal[k] / flat;
    u[k] = -normal[j] / flat;
    for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        double w = normal[a] * u[b] - normal[b] * u[a];
        d[i] = x * u[i] + y * w + z * normal[i];
    }
    return bb_ray_set_direction(ray, d);
}

static bb_status make_hemisphere(void *context, const bb_surface_point *point, bb_random *random,
                                 bb_ray *rays)
{
    const hemisphere *over = context;
    for (uint32_t i = 0; i < over->per_hit; i++) {
        for (int k = 0; k < 3; k++)
            rays[i].o[k] = (float)point->o[k];
        rays[i].tmin = over->tmin;
        rays[i].tmax = over->tmax;
        while (!cosine_direction(point->normal, random, &rays[i]))
            ;
    }
    return BB_OK;
}

bb_status bb_hemisphere_rays(bb_rays_job *job, float tmax)
{
    uint64_t per_hit;
    BB_TRY(bb_spec_u64(job->request->spec, job->options, "per_hit", 1, 1u << 20, &per_hit));
    hemisphere over = {(uint32_t)per_hit, job->tmin, tmax};
    return bb_surface_rays(job, (uint32_t)per_hit, make_hemisphere, &over);
}

bb_status bb_hemisphere_paths(bb_rays_job *job, uint32_t bounces)
{
    hemisphere over = {1, job->tmin, INFINITY};
    bb_status status = bb_surface_rays(job, 1, make_hemisphere, &over);
    for (uint32_t bounce = 2; bounce <= bounces && status == BB_OK; bounce++)
        status = bb_surface_go_on(job, bounce, make_hemisphere, &over);
    return status;
}
