/* Rays that graze triangles: through a point of one, almost in its plane. The smaller the angle,
 * the smaller the determinant that tests divide by.
 *
 * A uniform point of a random triangle; a direction in its plane; the normal times the sine of an
 * angle of up to `angle` is added. The ray starts a quarter to a half of the scene's diagonal
 * before the point. In doubles, rounded once.
 */
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "framework/workload/workload.h"

#include <math.h>

static const bb_option options_table[] = {
    BB_COUNT_OPTION,
    {"angle", "1e-3", NULL, "largest sine of the angle to the plane, 0 to 1"},
    BB_TMIN_OPTION,
    BB_END_OPTION,
};

static double normalise(double v[3])
{
    double length = hypot(hypot(v[0], v[1]), v[2]);
    for (int k = 0; k < 3 && length > 0; k++)
        v[k] /= length;
    return length;
}

/* Returns false for a triangle without a plane. */
static bool make_ray(const bb_rays_job *job, double angle, bb_random *random, bb_ray *ray)
{
    const bb_scene *scene = job->scene;
    uint32_t triangle = bb_random_below(random, scene->prims[BB_TRIANGLE].count);
    const float *a = bb_scene_vertex(scene, triangle, 0);
    double e[3], f[3], n[3], d[3], point[3], s = bb_random_unit(random), t = bb_random_unit(random);
    double turn = bb_random_range(random, -1, 1), other = bb_random_range(random, -1, 1);
    double sine = bb_random_range(random, -angle, angle);
    if (s + t > 1) {
        s = 1 - s;
        t = 1 - t;
    }
    for (int k = 0; k < 3; k++) {
        e[k] = (double)bb_scene_vertex(scene, triangle, 1)[k] - (double)a[k];
        f[k] = (double)bb_scene_vertex(scene, triangle, 2)[k] - (double)a[k];
        point[k] = (double)a[k] + s * e[k] + t * f[k];
    }
    normalise(e);
    normalise(f);
    for (int k = 0; k < 3; k++)
        n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        d[k] = turn * e[k] + other * f[k];
    if (!(normalise(n) > 0) || !(normalise(d) > 0))
        return false;
    double back = job->diagonal * bb_random_range(random, 0.25, 0.5);
    for (int k = 0; k < 3; k++) {
        d[k] += sine * n[k];
        ray->o[k] = (float)(point[k] - back * d[k]);
    }
    for (int k = 0; k < 3; k++)
        d[k] = point[k] - (double)ray->o[k]; /* to the point from the origin as rounded to float */
    return normalise(d) > 0 && bb_ray_set_direction(ray, d);
}

static bb_status make_grazing(bb_rays_job *job)
{
    const bb_spec *spec = job->request->spec;
    uint64_t count, tries = 0;
    double angle;
    BB_TRY(bb_job_count(job, &count));
    BB_TRY(bb_spec_double(spec, job->options, "angle", 0, 1, &angle));
    if (job->scene->prims[BB_TRIANGLE].count == 0)
        return bb_fail(BB_UNSUPPORTED, "rays grazing: scene '%s' has no triangles",
                       job->scene->name);
    BB_TRY(bb_rays_reserve(job->rays, (uint32_t)count));
    bb_random random = bb_random_make(job->request->seed, 0x6772617a);
    for (uint32_t i = 0; i < job->rays->count; i++) {
        bb_ray *ray = &job->rays->rays[i];
        ray->tmin = job->tmin;
        ray->tmax = INFINITY;
        while (!make_ray(job, angle, &random, ray))
            if (++tries > 1000 + 10 * count)
                return bb_fail(BB_UNSUPPORTED,
                               "rays grazing: the triangles of scene '%s' have no "
                               "planes to graze",
                               job->scene->name);
    }
    return BB_OK;
}

extern const bb_workload bb_workload_grazing;
const bb_workload bb_workload_grazing = {
    .name = "grazing",
    .summary = "almost in the planes of triangles, through a point of each, closest hit",
    .query = &bb_query_closest,
    .options = options_table,
    .make = make_grazing,
};
