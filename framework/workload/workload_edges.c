/* Rays aimed at the edges and vertices of triangles, where tests lose hits.
 *
 * Origins. from=inside: half of them are the inside point of a closed mesh, half are uniform in
 * a ball around it that is inside. Whatever rounding does to the aim, each ray must hit.
 * from=eyes: half are the eyes of the scene's views, half are uniform in balls around them of a
 * hundredth of the distance from eye to target. from=around: uniform in the scene's box, grown
 * on all sides by a tenth of its longest side. Such rays may miss; exact arithmetic says which.
 *
 * Targets. From inside and without jitter, edges are chosen uniformly among the triangles; a
 * quarter of the targets are vertices, the others uniform on their edge. Otherwise half of the
 * edges are chosen in proportion to their length, so that long triangles among many small ones
 * are hunted too; and a quarter of the targets are vertices, a quarter uniform on their edge,
 * half uniform in the angle in which the origin sees the edge, most of them close to the origin.
 *
 * jitter=J moves the target in a random direction by up to J * 2^-24 * max|v - o| over the
 * coordinates of the triangle's corners v and the origin o: the size of the errors of tests in
 * floats. The direction is the difference in doubles, rounded to float once, so t is about 1 at
 * the target. */
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "framework/workload/workload.h"

#include <float.h>
#include <math.h>

enum { TRIES = 1000 };

static const bb_option options_table[] = {
    {"count", NULL, NULL, "number of rays, even beyond the run's limit; default: that limit"},
    {"from", NULL, "inside|eyes|around",
     "origins: inside a closed mesh, where each ray must hit; near the eyes of the views; in the "
     "scene's box and around it (inside where the mesh is known to be closed, else eyes)"},
    {"jitter", "0", NULL,
     "the aim is off by up to this many 2^-24 of the triangle's extent from the origin, 0 to 64"},
    BB_END_OPTION,
};

/* The kind of target. */
typedef enum target {
    VERTEX,
    ALONG, /* uniform on an edge */
    SEEN,  /* uniform in the angle at which the origin sees the edge */
} target;

typedef enum from {
    FROM_INSIDE,
    FROM_EYES,
    FROM_AROUND,
} from;

typedef struct aimer {
    const bb_scene *scene;
    from from;
    bb_random random;
    double radius; /* inside: radius of the ball of origins */
    double lo[3];  /* around: the box of origins */
    double hi[3];
    double jitter;   /* in 2^-24 of the triangle's extent from the origin */
    double *lengths; /* [i]: total length of the edges of triangles 0 .. i; NULL: all edges are
                      * equally likely */
} aimer;

/* ---- origins ---- */

/* Returns the distance from p to the plane of the triangle; INFINITY if it has none. */
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

/* Sets *radius to half the distance from the inside point to the nearest plane of a triangle: a
 * ball of this radius is inside. (Triangles of zero area have no plane; in a closed mesh they lie
 * on the edges of others.) */
static bb_status find_inner_radius(const bb_scene *scene, double *radius)
{
    double nearest = INFINITY, largest = 0.0;
    for (uint32_t i = 0; i < scene->prims[BB_TRIANGLE].count; i++)
        nearest = fmin(nearest, distance_to_plane(scene, i, scene->inside_point));
    for (int k = 0; k < 3; k++)
        largest = fmax(largest, fabs(scene->inside_point[k]));
    *radius = 0.5 * nearest;
    /* Rounding the origin to float must not move it outside. */
    if (!isfinite(nearest) || 0x1p-22 * largest >= 0.5 * nearest)
        return bb_fail(BB_UNSUPPORTED,
                       "rays edges: floats do not resolve the inside of scene '%s': scale it up or "
                       "move it to the origin",
                       scene->name);
    return BB_OK;
}

static void find_box(aimer *aimer)
{
    const bb_box *bounds = &aimer->scene->bounds;
    double side = 0.0;
    for (int k = 0; k < 3; k++)
        side = fmax(side, (double)bounds->hi[k] - (double)bounds->lo[k]);
    for (int k = 0; k < 3; k++) {
        aimer->lo[k] = fmax(-FLT_MAX, (double)bounds->lo[k] - 0.1 * side);
        aimer->hi[k] = fmin(FLT_MAX, (double)bounds->hi[k] + 0.1 * side);
    }
}

static void choose_in_ball(const double centre[3], double radius, bool at_centre, bb_random *random,
                           bb_ray *ray)
{
    double move[3] = {0.0, 0.0, 0.0}, square = 0.0;
    if (!at_centre)
        do {
            square = 0.0;
            for (int k = 0; k < 3; k++) {
                move[k] = bb_random_range(random, -1.0, 1.0);
                square += move[k] * move[k];
            }
        } while (square > 1.0);
    for (int k = 0; k < 3; k++)
        ray->o[k] = (float)(centre[k] + radius * move[k]);
}

static void choose_origin(aimer *aimer, bool at_centre, bb_ray *ray)
{
    const bb_scene *scene = aimer->scene;
    if (aimer->from == FROM_INSIDE) {
        choose_in_ball(scene->inside_point, aimer->radius, at_centre, &aimer->random, ray);
    } else if (aimer->from == FROM_EYES) {
        const bb_view *view = &scene->views[bb_random_below(&aimer->random, scene->view_count)];
        double distance = 0.0;
        for (int k = 0; k < 3; k++)
            distance = hypot(distance, view->target[k] - view->eye[k]);
        choose_in_ball(view->eye, 0.01 * distance, at_centre, &aimer->random, ray);
    } else {
        for (int k = 0; k < 3; k++)
            ray->o[k] = (float)bb_random_range(&aimer->random, aimer->lo[k], aimer->hi[k]);
    }
}

/* ---- targets ---- */

static double edge_length(const bb_scene *scene, uint32_t triangle, uint32_t corner)
{
    const float *p = bb_scene_vertex(scene, triangle, corner),
                *q = bb_scene_vertex(scene, triangle, (corner + 1) % 3);
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += ((double)q[k] - (double)p[k]) * ((double)q[k] - (double)p[k]);
    return sqrt(square);
}

static bb_status measure_edges(aimer *aimer)
{
    const bb_scene *scene = aimer->scene;
    BB_TRY(bb_host_alloc(NULL, scene->prims[BB_TRIANGLE].count * sizeof *aimer->lengths,
                         "the lengths of edges", &aimer->lengths));
    double sum = 0.0;
    for (uint32_t i = 0; i < scene->prims[BB_TRIANGLE].count; i++) {
        for (uint32_t corner = 0; corner < 3; corner++)
            sum += edge_length(scene, i, corner);
        aimer->lengths[i] = sum;
    }
    if (!(sum > 0.0))
        return bb_fail(BB_UNSUPPORTED, "rays edges: no edge of scene '%s' has a length",
                       scene->name);
    return BB_OK;
}

/* Chooses an edge with a probability proportional to its length: the triangle by bisection, then
 * the side. */
static void choose_long(aimer *aimer, uint32_t *triangle, uint32_t *corner)
{
    const bb_scene *scene = aimer->scene;
    uint32_t low = 0, high = scene->prims[BB_TRIANGLE].count - 1;
    double at = bb_random_unit(&aimer->random) * aimer->lengths[high];
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (aimer->lengths[middle] > at)
            high = middle;
        else
            low = middle + 1;
    }
    double sides[3], left = 0.0;
    for (uint32_t k = 0; k < 3; k++)
        left += sides[k] = edge_length(scene, low, k);
    left *= bb_random_unit(&aimer->random);
    *triangle = low;
    for (*corner = 0; *corner < 2 && left >= sides[*corner]; ++*corner)
        left -= sides[*corner];
}

/* Returns a position on the edge from p to q, 0..1, uniform in the angle seen from the origin. */
static double choose_seen(const float p[3], const float q[3], const float o[3], double unit)
{
    double to_p[3], edge[3], square = 0.0, along = 0.0, height = 0.0;
    for (int k = 0; k < 3; k++) {
        to_p[k] = (double)p[k] - (double)o[k];
        edge[k] = (double)q[k] - (double)p[k];
        square += edge[k] * edge[k];
        along += to_p[k] * edge[k];
    }
    double foot = -along / square; /* foot of the origin's perpendicular: 0 at p, 1 at q */
    for (int k = 0; k < 3; k++)
        height = hypot(height, to_p[k] + foot * edge[k]);
    height /= sqrt(square);
    if (!(height > 0.0) || !isfinite(height)) /* on the edge's own line, or an edge of no length */
        return unit;
    double low = atan(-foot / height), high = atan((1.0 - foot) / height);
    double s = foot + height * tan(low + unit * (high - low));
    return fmin(fmax(s, 0.0), 1.0);
}

/* Moves the target, given relative to the ray's origin. */
static void move_target(aimer *aimer, uint32_t triangle, const bb_ray *ray, double d[3])
{
    double extent = 0.0, direction[3];
    for (uint32_t corner = 0; corner < 3; corner++)
        for (int k = 0; k < 3; k++)
            extent = fmax(extent, fabs((double)bb_scene_vertex(aimer->scene, triangle, corner)[k] -
                                       (double)ray->o[k]));
    bb_random_direction(&aimer->random, direction);
    double by = bb_random_unit(&aimer->random) * aimer->jitter * 0x1p-24 * extent;
    for (int k = 0; k < 3; k++)
        d[k] += by * direction[k];
}

/* Returns false if the direction has no length. */
static bool aim(aimer *aimer, target target, bool at_long, bb_ray *ray)
{
    const bb_scene *scene = aimer->scene;
    uint32_t triangle, corner;
    if (at_long) {
        choose_long(aimer, &triangle, &corner);
    } else {
        triangle = bb_random_below(&aimer->random, scene->prims[BB_TRIANGLE].count);
        corner = bb_random_below(&aimer->random, 3);
    }
    const float *p = bb_scene_vertex(scene, triangle, corner),
                *q = bb_scene_vertex(scene, triangle, (corner + 1) % 3);
    double s = target == VERTEX ? 0.0 : bb_random_unit(&aimer->random), d[3];
    if (target == SEEN)
        s = choose_seen(p, q, ray->o, s);
    for (int k = 0; k < 3; k++)
        d[k] = (double)p[k] + s * ((double)q[k] - (double)p[k]) - (double)ray->o[k];
    if (aimer->jitter > 0.0)
        move_target(aimer, triangle, ray, d);
    return bb_ray_set_direction(ray, d);
}

static bb_status aim_all(aimer *aimer, bb_rays *rays)
{
    static const target targets[4] = {VERTEX, ALONG, SEEN, SEEN};
    bool hunting = aimer->lengths != NULL;
    for (uint32_t i = 0; i < rays->count; i++) {
        bb_ray *ray = &rays->rays[i];
        target target = targets[i / 2 % 4];
        if (target == SEEN && !hunting)
            target = ALONG;
        ray->tmin = 0.0f;
        ray->tmax = INFINITY;
        choose_origin(aimer, i % 2 == 0, ray);
        int tries = 0;
        while (!aim(aimer, target, hunting && i / 8 % 2 == 0, ray))
            if (++tries == TRIES)
                return bb_fail(BB_UNSUPPORTED,
                               "rays edges: scene '%s' is too small for floats: scale it up",
                               aimer->scene->name);
    }
    return BB_OK;
}

/* ---- the workload ---- */

static from choose_from(const bb_scene *scene, const bb_spec *spec)
{
    if (bb_spec_value(spec, NULL, "from") == NULL)
        return scene->closed_from_inside ? FROM_INSIDE : FROM_EYES;
    return bb_spec_is(spec, NULL, "from", "inside") ? FROM_INSIDE
           : bb_spec_is(spec, NULL, "from", "eyes") ? FROM_EYES
                                                    : FROM_AROUND;
}

static bool must_hit(const bb_scene *scene, const bb_spec *spec)
{
    return choose_from(scene, spec) == FROM_INSIDE;
}

static bb_status prepare(aimer *aimer)
{
    const bb_scene *scene = aimer->scene;
    if (scene->prims[BB_TRIANGLE].count == 0)
        return bb_fail(BB_UNSUPPORTED, "rays edges: scene '%s' has no triangles, and so no edges",
                       scene->name);
    if (aimer->from == FROM_INSIDE && !scene->closed_from_inside)
        return bb_fail(BB_UNSUPPORTED,
                       "rays edges: scene '%s' is not known to be a closed mesh seen from inside: "
                       "take from=eyes or from=around",
                       scene->name);
    if (aimer->from == FROM_EYES && scene->view_count == 0)
        return bb_fail(BB_UNSUPPORTED, "rays edges: scene '%s' has no views: take from=around",
                       scene->name);
    if (aimer->from == FROM_INSIDE)
        BB_TRY(find_inner_radius(scene, &aimer->radius));
    if (aimer->from == FROM_AROUND)
        find_box(aimer);
    if (aimer->from != FROM_INSIDE || aimer->jitter > 0.0)
        BB_TRY(measure_edges(aimer));
    return BB_OK;
}

static bb_status make_edges(bb_rays_job *job)
{
    const bb_spec *spec = job->request->spec;
    uint64_t count = job->request->max_rays;
    aimer aimer = {.scene = job->scene,
                   .from = choose_from(job->scene, spec),
                   .random = bb_random_make(job->request->seed, 0x65646765)};
    if (bb_spec_value(spec, job->options, "count") != NULL)
        BB_TRY(bb_spec_u64(spec, job->options, "count", 1, INT32_MAX, &count));
    BB_TRY(bb_spec_double(spec, job->options, "jitter", 0, 64, &aimer.jitter));
    BB_TRY(bb_rays_reserve(job->rays, (uint32_t)count));
    bb_status status = prepare(&aimer);
    if (status == BB_OK)
        status = aim_all(&aimer, job->rays);
    bb_host_free(aimer.lengths);
    return status;
}

extern const bb_workload bb_workload_edges;
const bb_workload bb_workload_edges = {
    .name = "edges",
    .summary = "at edges and vertices; from inside a closed mesh each must hit; closest hit",
    .query = &bb_query_closest,
    .beyond_limit = true,
    .options = options_table,
    .make = make_edges,
    .must_hit = must_hit,
};
