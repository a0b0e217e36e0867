/* Rays from inside a closed mesh, aimed at its edges and vertices. Whatever their rounding does to
 * the aim, each must hit.
 *
 * Half of the origins are the scene's inside point, half are uniform in a ball around it of half
 * the distance to the nearest plane of a triangle: such a ball is inside. (Triangles of zero area
 * have no plane; in a closed mesh they lie on the edges of others.) A quarter of the targets are
 * vertices, the others points of edges. The direction is the difference in doubles, rounded to
 * float once, so t is about 1 at the target.
 */
#include "framework/rays_private.h"

#include <math.h>

/* Distance from p to the plane of the triangle; INFINITY if it has none. */
static double distance_to_plane(const bb_scene *scene, uint32_t triangle, const double p[3])
{
    const float *a = bb_scene_vertex(scene, triangle, 0), *b = bb_scene_vertex(scene, triangle, 1),
                *c = bb_scene_vertex(scene, triangle, 2);
    double along = 0.0, length = 0.0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double n = ((double)b[j] - a[j]) * ((double)c[k] - a[k]) -
                   ((double)b[k] - a[k]) * ((double)c[j] - a[j]);
        along += n * (p[i] - (double)a[i]);
        length = hypot(length, n);
    }
    return length > 0.0 ? fabs(along) / length : INFINITY;
}

/* Radius of the ball of origins. */
static bb_status find_radius(const bb_scene *scene, double *radius)
{
    double nearest = INFINITY, largest = 0.0;
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        nearest = fmin(nearest, distance_to_plane(scene, i, scene->inside_point));
    for (int k = 0; k < 3; k++)
        largest = fmax(largest, fabs(scene->inside_point[k]));
    *radius = 0.5 * nearest;
    /* Rounding the origin to float must not carry it out. */
    if (!isfinite(nearest) || 0x1p-22 * largest >= 0.5 * nearest)
        return bb_fail(BB_UNSUPPORTED,
                       "rays edges: floats do not resolve the inside of scene '%s': scale it up or "
                       "move it to the origin",
                       scene->name);
    return BB_OK;
}

static void choose_origin(const bb_scene *scene, double radius, bool centre, bb_random *random,
                          bb_ray *ray)
{
    double move[3] = {0.0, 0.0, 0.0}, square = 0.0;
    if (!centre)
        do {
            square = 0.0;
            for (int k = 0; k < 3; k++) {
                move[k] = bb_random_range(random, -1.0, 1.0);
                square += move[k] * move[k];
            }
        } while (square > 1.0);
    for (int k = 0; k < 3; k++)
        ray->o[k] = (float)(scene->inside_point[k] + radius * move[k]);
}

/* False if the direction has no length. */
static bool aim(const bb_scene *scene, bool at_vertex, bb_random *random, bb_ray *ray)
{
    uint32_t triangle = bb_random_below(random, scene->triangle_count);
    uint32_t corner = bb_random_below(random, 3);
    const float *p = bb_scene_vertex(scene, triangle, corner),
                *q = bb_scene_vertex(scene, triangle, (corner + 1) % 3);
    double s = at_vertex ? 0.0 : bb_random_unit(random), d[3];
    for (int k = 0; k < 3; k++)
        d[k] = (double)p[k] + s * ((double)q[k] - (double)p[k]) - (double)ray->o[k];
    return bb_ray_set_direction(ray, d);
}

bb_status bb_rays_edges(bb_rays_job *job)
{
    const bb_scene *scene = job->scene;
    uint64_t count = job->request->max_rays;
    double radius;
    if (bb_spec_value(job->request->spec, job->options, "count") != NULL)
        BB_TRY(bb_spec_u64(job->request->spec, job->options, "count", 1, INT32_MAX, &count));
    if (!scene->closed_from_inside || scene->triangle_count == 0)
        return bb_fail(BB_UNSUPPORTED,
                       "rays edges: scene '%s' is not known to be a closed mesh seen from inside",
                       scene->name);
    BB_TRY(find_radius(scene, &radius));
    BB_TRY(bb_rays_reserve(job->rays, (uint32_t)count));
    bb_random random = bb_random_make(job->request->seed, 0x65646765);
    for (uint32_t i = 0; i < job->rays->count; i++) {
        bb_ray *ray = &job->rays->rays[i];
        ray->tmin = 0.0f;
        ray->tmax = INFINITY;
        choose_origin(scene, radius, i % 2 == 0, &random, ray);
        int tries = 0;
        while (!aim(scene, i / 2 % 4 == 0, &random, ray))
            if (++tries == 1000)
                return bb_fail(BB_UNSUPPORTED,
                               "rays edges: scene '%s' is too small for floats: scale it up",
                               scene->name);
    }
    return BB_OK;
}
