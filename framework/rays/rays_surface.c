/* Rays that start on surfaces: ambient occlusion, diffuse and shadow.
 *
 *   for each view: trace its primary rays with the oracle, keep the hits
 *   share the hits that fit among the views, equally
 *   for each view: take its share by selection sampling (Knuth, The Art of Computer
 * Programming 3.4.2, algorithm S), which keeps the order of the pixels for each hit: move off the
 * surface, make its rays one after the other
 *
 * The point of a hit is computed anew in doubles from the exact t, so that it lies on the surface
 * also where Embree's t is rough. It is moved along the geometric normal that faces the incoming
 * ray, by the larger of `offset` scene diagonals and 2^-20 of the point's largest coordinate: nine
 * times what rounding to float can move it back.
 *
 * Cosine-weighted directions by Malley's method: a uniform point of the unit disc, lifted to the
 * hemisphere.
 */
#include "framework/rays/rays_private.h"

#include "framework/judge/arbiter.h"
#include "framework/judge/oracle.h"
#include "framework/scene/camera.h"

#include <math.h>

enum { BATCH = 1 << 18 }; /* primary rays traced at once */

/* A primary hit. */
typedef struct first_hit {
    uint32_t pixel;
    bb_hit hit;
} first_hit;

/* Where secondary rays start. */
typedef struct surface_point {
    double o[3]; /* moved off the surface, rounded to float */
    double normal[3];
} surface_point;

typedef struct sampled_view {
    bb_camera camera;
    first_hit *hits;
    uint32_t count; /* of the hits */
    uint32_t share; /* how many of them are taken */
} sampled_view;

typedef struct sampler {
    bb_rays_job *job;
    double offset; /* in scene units */
    uint32_t per_hit;
    uint32_t view_count;
    sampled_view views[BB_VIEWS_MAX];
    bb_ray *rays; /* one batch */
    bb_hit *hits;
} sampler;

/* ---- points on surfaces ---- */

static void triangle_normal(const bb_scene *scene, uint32_t triangle, double normal[3])
{
    const float *a = bb_scene_vertex(scene, triangle, 0), *b = bb_scene_vertex(scene, triangle, 1),
                *c = bb_scene_vertex(scene, triangle, 2);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = ((double)b[j] - a[j]) * ((double)c[k] - a[k]) -
                    ((double)b[k] - a[k]) * ((double)c[j] - a[j]);
    }
}

/* False where the surface has no normal, or no exact hit where Embree has one. */
static bool find_point(const sampler *sampler, const bb_ray *ray, const bb_hit *hit,
                       surface_point *point)
{
    const bb_scene *scene = sampler->job->scene;
    double t, length = 0.0, facing = 0.0, largest = 0.0, on[3];
    if (!bb_exact_t(scene, ray, hit->prim, hit->t, &t) ||
        fabs(t - (double)hit->t) > bb_margin(scene, ray, hit->prim)) /* |d| is 1 */
        return false;
    for (int k = 0; k < 3; k++) {
        on[k] = (double)ray->o[k] + t * (double)ray->d[k];
        largest = fmax(largest, fabs(on[k]));
    }
    if (hit->prim < scene->triangle_count) {
        triangle_normal(scene, hit->prim, point->normal);
    } else {
        const float *s = scene->spheres + 4 * (size_t)(hit->prim - scene->triangle_count);
        for (int k = 0; k < 3; k++)
            point->normal[k] = on[k] - (double)s[k];
    }
    for (int k = 0; k < 3; k++) {
        length = hypot(length, point->normal[k]);
        facing += point->normal[k] * (double)ray->d[k];
    }
    if (!(length > 0.0) || !isfinite(length))
        return false;
    double away = facing > 0.0 ? -1.0 / length : 1.0 / length;
    double offset = fmax(sampler->offset, 0x1p-20 * largest);
    for (int k = 0; k < 3; k++) {
        point->normal[k] *= away;
        point->o[k] = (float)(on[k] + offset * point->normal[k]);
        if (!isfinite(point->o[k]))
            return false;
    }
    return true;
}

/* ---- primary hits ---- */

static void pixel_ray(const sampler *sampler, const sampled_view *view, uint32_t pixel, bb_ray *ray)
{
    uint32_t width = sampler->job->request->width;
    bb_camera_ray(&view->camera, pixel % width, pixel / width, ray);
}

/* Appends the hits of pixels [begin, end). */
static bb_status collect_batch(sampler *sampler, sampled_view *view, uint32_t begin, uint32_t end)
{
    for (uint32_t i = begin; i < end; i++)
        pixel_ray(sampler, view, i, &sampler->rays[i - begin]);
    BB_TRY(bb_oracle_trace(sampler->job->oracle, sampler->rays, end - begin, BB_CLOSEST_HIT,
                           sampler->hits));
    for (uint32_t i = begin; i < end; i++) {
        const bb_hit *hit = &sampler->hits[i - begin];
        if (hit->prim != BB_NONE)
            view->hits[view->count++] = (first_hit){i, *hit};
    }
    return BB_OK;
}

static bb_status collect_view(sampler *sampler, const bb_view *from, sampled_view *view)
{
    const bb_rays_request *request = sampler->job->request;
    BB_TRY(bb_camera_make(from, request->width, request->height, &view->camera));
    uint32_t pixels = request->width * request->height;
    BB_TRY(bb_host_alloc(NULL, pixels * sizeof *view->hits, "primary hits", &view->hits));
    for (uint32_t begin = 0; begin < pixels; begin += BATCH)
        BB_TRY(
            collect_batch(sampler, view, begin, pixels - begin < BATCH ? pixels : begin + BATCH));
    return BB_OK;
}

/* Deals `wanted` samples out equally; what a view with few hits leaves goes to the others. */
static void deal(sampler *sampler, uint32_t wanted)
{
    while (wanted > 0) {
        uint32_t open = 0;
        for (uint32_t v = 0; v < sampler->view_count; v++)
            open += sampler->views[v].share < sampler->views[v].count;
        if (open == 0)
            return;
        uint32_t each = wanted / open > 0 ? wanted / open : 1;
        for (uint32_t v = 0; v < sampler->view_count && wanted > 0; v++) {
            sampled_view *view = &sampler->views[v];
            uint32_t room = view->count - view->share;
            uint32_t more = each < room ? each : room;
            more = more < wanted ? more : wanted;
            view->share += more;
            wanted -= more;
        }
    }
}

static bb_status begin_sampling(bb_rays_job *job, uint32_t per_hit, sampler *sampler)
{
    const bb_rays_request *request = job->request;
    *sampler = (struct sampler){.job = job, .per_hit = per_hit};
    BB_TRY(bb_spec_double(request->spec, job->options, "offset", 0.0, 1.0, &sampler->offset));
    sampler->offset *= job->diagonal;
    if (request->max_rays < per_hit)
        return bb_fail(BB_INVALID, "rays %s: %u per hit, but only %u are allowed: take fewer",
                       job->rays->name, per_hit, request->max_rays);
    BB_TRY(bb_host_alloc(NULL, BATCH * sizeof *sampler->rays, "primary rays", &sampler->rays));
    BB_TRY(bb_host_alloc(NULL, BATCH * sizeof *sampler->hits, "primary hits", &sampler->hits));

    const bb_view *views = request->view != NULL ? request->view : job->scene->views;
    sampler->view_count = request->view != NULL ? 1 : job->scene->view_count;
    uint64_t hits = 0;
    for (uint32_t v = 0; v < sampler->view_count; v++) {
        BB_TRY(collect_view(sampler, &views[v], &sampler->views[v]));
        hits += sampler->views[v].count;
    }
    if (hits == 0)
        return bb_fail(BB_UNSUPPORTED, "rays %s: no primary ray of scene '%s' hits anything",
                       job->rays->name, job->scene->name);
    uint64_t most = request->max_rays / per_hit, taken = hits < most ? hits : most;
    deal(sampler, (uint32_t)taken);
    return bb_rays_reserve(job->rays, (uint32_t)taken * per_hit);
}

static void end_sampling(sampler *sampler)
{
    for (uint32_t v = 0; v < sampler->view_count; v++)
        bb_host_free(sampler->views[v].hits);
    bb_host_free(sampler->rays);
    bb_host_free(sampler->hits);
}

/* Calls make() for every sampled hit, with room for its rays and random numbers of its own. The few
 * hits without a point on the surface are left out. */
static bb_status for_each_sample(sampler *sampler,
                                 bb_status (*make)(void *context, const surface_point *point,
                                                   bb_random *random, bb_ray *rays),
                                 void *context)
{
    bb_rays_job *job = sampler->job;
    bb_random select = bb_random_make(job->request->seed, 0x73656c65);
    uint64_t sample = 0;
    for (uint32_t v = 0; v < sampler->view_count; v++) {
        const sampled_view *view = &sampler->views[v];
        uint32_t wanted = view->share;
        for (uint32_t i = 0; i < view->count && wanted > 0; i++) {
            if (bb_random_unit(&select) * (view->count - i) >= wanted)
                continue;
            wanted--;
            bb_ray ray;
            surface_point point;
            pixel_ray(sampler, view, view->hits[i].pixel, &ray);
            if (!find_point(sampler, &ray, &view->hits[i].hit, &point))
                continue;
            bb_random random = bb_random_make(job->request->seed, sample + 1);
            BB_TRY(make(context, &point, &random, job->rays->rays + sample * sampler->per_hit));
            sample++;
        }
    }
    if (sample == 0)
        return bb_fail(BB_UNSUPPORTED, "rays %s: no primary hit of scene '%s' has a normal",
                       job->rays->name, job->scene->name);
    job->rays->count = (uint32_t)sample * sampler->per_hit;
    return BB_OK;
}

static void set_origin(const surface_point *point, bb_ray *ray)
{
    for (int k = 0; k < 3; k++)
        ray->o[k] = (float)point->o[k];
}

/* ---- ambient occlusion and diffuse ---- */

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

static bb_status make_hemisphere(void *context, const surface_point *point, bb_random *random,
                                 bb_ray *rays)
{
    const hemisphere *over = context;
    for (uint32_t i = 0; i < over->per_hit; i++) {
        set_origin(point, &rays[i]);
        rays[i].tmin = over->tmin;
        rays[i].tmax = over->tmax;
        while (!cosine_direction(point->normal, random, &rays[i]))
            ;
    }
    return BB_OK;
}

static bb_status make_hemispheres(bb_rays_job *job, float tmax)
{
    uint64_t per_hit;
    BB_TRY(bb_spec_u64(job->request->spec, job->options, "per_hit", 1, 1u << 20, &per_hit));
    sampler sampler;
    hemisphere over = {(uint32_t)per_hit, job->tmin, tmax};
    bb_status status = begin_sampling(job, (uint32_t)per_hit, &sampler);
    if (status == BB_OK)
        status = for_each_sample(&sampler, make_hemisphere, &over);
    end_sampling(&sampler);
    return status;
}

bb_status bb_rays_ao(bb_rays_job *job)
{
    double length;
    BB_TRY(bb_spec_double(job->request->spec, job->options, "length", 1e-12, 1e12, &length));
    return make_hemispheres(job, (float)(length * job->diagonal));
}

bb_status bb_rays_diffuse(bb_rays_job *job)
{
    return make_hemispheres(job, INFINITY);
}

/* ---- shadow ---- */

/* A square, perpendicular to the axis that points up in the first view. */
typedef struct light {
    int axis;
    double centre[3];
    double half; /* of its side */
    float tmin;
} light;

static bb_status place_light(const bb_rays_job *job, light *light)
{
    double size, drop, side = INFINITY, widest = 0.0;
    BB_TRY(bb_spec_double(job->request->spec, job->options, "size", 0.0, 100.0, &size));
    BB_TRY(bb_spec_double(job->request->spec, job->options, "drop", 0.0, 1.0, &drop));
    const bb_view *view = job->request->view != NULL ? job->request->view : &job->scene->views[0];
    const bb_box *box = &job->scene->bounds;
    light->axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(view->up[k]) > fabs(view->up[light->axis]))
            light->axis = k;
    for (int k = 0; k < 3; k++) {
        double extent = (double)box->hi[k] - (double)box->lo[k];
        light->centre[k] = 0.5 * box->lo[k] + 0.5 * box->hi[k];
        if (k == light->axis)
            light->centre[k] =
                view->up[k] < 0.0 ? box->lo[k] + drop * extent : box->hi[k] - drop * extent;
        else {
            side = fmin(side, extent);
            widest = fmax(widest, extent);
        }
    }
    light->half = 0.5 * size * (side > 0.0 ? side : widest);
    light->tmin = job->tmin;
    return BB_OK;
}

/* From the surface (t = 0) to the light (t = 1). */
static bb_status make_shadow(void *context, const surface_point *point, bb_random *random,
                             bb_ray *ray)
{
    const light *light = context;
    set_origin(point, ray);
    ray->tmin = light->tmin;
    ray->tmax = 1.0f;
    for (int tries = 0; tries < 1000; tries++) {
        double d[3];
        for (int k = 0; k < 3; k++) {
            double at = light->centre[k];
            if (k != light->axis)
                at += light->half * bb_random_range(random, -1.0, 1.0);
            d[k] = at - point->o[k];
        }
        if (bb_ray_set_direction(ray, d))
            return BB_OK;
    }
    return bb_fail(BB_UNSUPPORTED, "rays shadow: a surface lies in the light, which is a point: "
                                   "give drop or size");
}

bb_status bb_rays_shadow(bb_rays_job *job)
{
    light light;
    if (job->request->view == NULL && job->scene->view_count == 0)
        return bb_fail(BB_UNSUPPORTED, "rays shadow: scene '%s' has no view", job->scene->name);
    BB_TRY(place_light(job, &light));
    sampler sampler;
    bb_status status = begin_sampling(job, 1, &sampler);
    if (status == BB_OK)
        status = for_each_sample(&sampler, make_shadow, &light);
    end_sampling(&sampler);
    return status;
}
