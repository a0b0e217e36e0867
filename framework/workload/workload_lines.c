/* Lines that are uniform in position and direction through a ball around the scene's box, as in
 * integral geometry. The probability that such a line meets a convex body is proportional to its
 * area (Crofton; Santalo 1976, Integral Geometry and Geometric Probability, section II.12.7), which
 * is the assumption of the surface area heuristic about rays. Its other assumption, that nothing
 * stops them (MacDonald and Booth 1990), corresponds to the query `interval`.
 *
 * A direction uniform on the sphere, then a point uniform in the disc across it through the ball's
 * centre; the ray starts on the ball and ends on it.
 */
#include "framework/base/random.h"
#include "framework/workload/workload.h"

#include "framework/judge/queries.h"

#include <math.h>
#include <string.h>

static const bb_option options_table[] = {
    BB_COUNT_OPTION,
    {"query", "closest", "closest|any|interval",
     "what is asked of them; nothing stops them: interval"},
    BB_TMIN_OPTION,
    BB_END_OPTION,
};

/* Two unit vectors perpendicular to the unit vector d and to each other. */
static void make_frame(const double d[3], double u[3], double v[3])
{
    int least = fabs(d[0]) <= fabs(d[1]) && fabs(d[0]) <= fabs(d[2]) ? 0
                : fabs(d[1]) <= fabs(d[2])                           ? 1
                                                                     : 2;
    int j = (least + 1) % 3, k = (least + 2) % 3;
    double flat = sqrt(d[j] * d[j] + d[k] * d[k]);
    u[least] = 0.0;
    u[j] = d[k] / flat;
    u[k] = -d[j] / flat;
    for (int i = 0; i < 3; i++)
        v[i] = d[(i + 1) % 3] * u[(i + 2) % 3] - d[(i + 2) % 3] * u[(i + 1) % 3];
}

/* Returns false if floats leave nothing of the line. */
static bool make_line(const bb_rays_job *job, bb_random *random, bb_ray *ray)
{
    const bb_box *bounds = &job->scene->bounds;
    double radius = 0.5 * job->diagonal, d[3], u[3], v[3], x, y;
    bb_random_direction(random, d);
    do { /* without sine and cosine, whose last bit differs between machines */
        x = bb_random_range(random, -1, 1);
        y = bb_random_range(random, -1, 1);
    } while (x * x + y * y > 1);
    make_frame(d, u, v);
    double half = sqrt(1.0 - x * x - y * y);
    for (int k = 0; k < 3; k++) {
        double centre = 0.5 * ((double)bounds->lo[k] + (double)bounds->hi[k]);
        ray->o[k] = (float)(centre + radius * (x * u[k] + y * v[k] - half * d[k]));
    }
    ray->tmin = job->tmin;
    ray->tmax = (float)(2.0 * half * radius);
    return ray->tmax > ray->tmin && bb_ray_set_direction(ray, d);
}

static bb_status make_lines(bb_rays_job *job)
{
    const bb_spec *spec = job->request->spec;
    uint64_t count;
    BB_TRY(bb_job_count(job, &count));
    if (!(job->diagonal > 0.0))
        return bb_fail(BB_UNSUPPORTED, "rays lines: scene '%s' is a single point",
                       job->scene->name);
    job->rays->query = bb_query_find(bb_spec_value(spec, job->options, "query"));
    if ((job->scene->kinds & ~job->rays->query->kinds) != 0)
        return bb_fail(
            BB_UNSUPPORTED,
            "rays lines: scene '%s' has primitives other than triangles, which the query "
            "interval is not for: take query=closest or query=any",
            job->scene->name);
    BB_TRY(bb_rays_reserve(job->rays, (uint32_t)count));
    bb_random random = bb_random_make(job->request->seed, 0x6c696e65);
    uint32_t tries = 0;
    for (uint32_t i = 0; i < job->rays->count; i++)
        while (!make_line(job, &random, &job->rays->rays[i]))
            if (++tries > 1000 + job->rays->count)
                return bb_fail(BB_UNSUPPORTED,
                               "rays lines: tmin leaves nothing of lines through scene '%s'",
                               job->scene->name);
    return BB_OK;
}

extern const bb_workload bb_workload_lines;
const bb_workload bb_workload_lines = {
    .name = "lines",
    .summary =
        "uniform lines through a ball around the scene, as the surface area heuristic assumes",
    .query = &bb_query_closest,
    .options = options_table,
    .make = make_lines,
};
