/* Rays that start on surfaces.
 *
 *   for each view: trace its primary rays with the oracle, keep the hits; if more rays are
 *                  requested than they give, trace another picture, and so on
 *   share the hits that fit among the views, equally
 *   for each view: take its share by selection sampling (Knuth, The Art of Computer Programming
 *                  3.4.2, algorithm S), which keeps the order of the pixels
 *   for each hit:  move off the surface, make its rays one after the other
 *   a path goes on: trace its last ray with the oracle, move off the surface that it hits, make
 *                  the next one; paths that leave the scene end
 *
 * The point of a hit is recomputed in doubles from the exact t, so that it lies on the surface even
 * where Embree's t is rough. It is moved along the geometric normal that faces the incoming ray, by
 * the larger of `offset` scene diagonals and 2^-20 of the point's largest coordinate: nine times
 * the distance that rounding to float can move it back.
 */
#include "framework/workload/surface.h"
#include "framework/judge/queries.h"

#include "framework/base/memory.h"
#include "framework/judge/arbiter.h"
#include "framework/scene/prim.h"
#include "framework/workload/pixels.h"

#include <math.h>
#include <string.h>

enum {
    BATCH = 1 << 18,    /* primary rays traced at once */
    PICTURES_MAX = 256, /* per view: one that sees almost nothing gives fewer rays than requested */
};

/* A primary hit. */
typedef struct first_hit {
    uint64_t index; /* of its ray in the view's pictures */
    bb_hit hit;
} first_hit;

typedef struct sampled_view {
    bb_camera camera;
    first_hit *hits;
    uint32_t count; /* number of hits */
    uint32_t room;  /* capacity */
    uint32_t share; /* number of hits taken */
} sampled_view;

typedef struct sampler {
    bb_rays_job *job;
    double offset; /* in scene units */
    uint32_t per_hit;
    bool counts; /* a number of rays was requested: hits without a point are not even collected */
    uint32_t view_count;
    sampled_view views[BB_VIEWS_MAX];
    bb_ray *rays; /* one batch */
    bb_hit *hits;
} sampler;

/* ---- points on surfaces ---- */

static bb_status read_offset(const bb_rays_job *job, double *offset)
{
    BB_TRY(bb_spec_double(job->request->spec, job->options, "offset", 0.0, 1.0, offset));
    *offset *= job->diagonal;
    return BB_OK;
}

/* Moves the point off the surface by `least` or more. Returns false where the surface has no
 * normal, or no exact hit where Embree has one. */
static bool find_point(const bb_scene *scene, double least, const bb_ray *ray, const bb_hit *hit,
                       bb_surface_point *point)
{
    double t, length = 0.0, facing = 0.0, largest = 0.0, on[3];
    if (!bb_exact_t(scene, ray, hit->prim, hit->t, &t) ||
        fabs(t - (double)hit->t) > bb_margin(scene, ray, hit->prim)) /* |d| is 1 */
        return false;
    for (int k = 0; k < 3; k++) {
        on[k] = (double)ray->o[k] + t * (double)ray->d[k];
        largest = fmax(largest, fabs(on[k]));
    }
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, hit->prim, &i);
    kind->normal(scene, i, on, point->normal);
    for (int k = 0; k < 3; k++) {
        length = hypot(length, point->normal[k]);
        facing += point->normal[k] * (double)ray->d[k];
    }
    if (!(length > 0.0) || !isfinite(length))
        return false;
    double away = facing > 0.0 ? -1.0 / length : 1.0 / length;
    double offset = fmax(least, 0x1p-20 * largest);
    for (int k = 0; k < 3; k++) {
        point->normal[k] *= away;
        point->o[k] = (float)(on[k] + offset * point->normal[k]);
        if (!isfinite(point->o[k]))
            return false;
    }
    return true;
}

/* ---- primary hits ---- */

/* Appends the hits of rays [begin, end) of the view's pictures. */
static bb_status collect_batch(sampler *sampler, sampled_view *view, uint64_t begin, uint64_t end)
{
    const uint32_t count = (uint32_t)(end - begin);
    for (uint32_t i = 0; i < count; i++)
        bb_picture_ray(sampler->job->request, &view->camera, begin + i, &sampler->rays[i]);
    BB_TRY(bb_oracle_trace(sampler->job->oracle, sampler->rays, count, &bb_query_closest,
                           sampler->hits));
    for (uint32_t i = 0; i < count; i++) {
        const bb_hit *hit = &sampler->hits[i];
        bb_surface_point point;
        if (hit->prim != BB_NONE &&
            (!sampler->counts ||
             find_point(sampler->job->scene, sampler->offset, &sampler->rays[i], hit, &point)))
            view->hits[view->count++] = (first_hit){begin + i, *hit};
    }
    return BB_OK;
}

/* Makes room for the hits of one more picture. */
static bb_status make_room(sampled_view *view, uint32_t pixels)
{
    if (view->room - view->count >= pixels)
        return BB_OK;
    first_hit *more = NULL;
    const uint32_t room =
        2 * view->room > view->count + pixels ? 2 * view->room : view->count + pixels;
    BB_TRY(bb_host_alloc(NULL, room * sizeof *more, "primary hits", &more));
    if (view->count > 0)
        memcpy(more, view->hits, view->count * sizeof *more);
    bb_host_free(view->hits);
    view->hits = more;
    view->room = room;
    return BB_OK;
}

static bb_status collect_picture(sampler *sampler, sampled_view *view, uint32_t picture)
{
    const bb_rays_request *request = sampler->job->request;
    const uint32_t pixels = request->width * request->height;
    const uint64_t first = (uint64_t)picture * pixels, end = first + pixels;
    BB_TRY(make_room(view, pixels));
    for (uint64_t begin = first; begin < end; begin += BATCH)
        BB_TRY(collect_batch(sampler, view, begin, end - begin < BATCH ? end : begin + BATCH));
    return BB_OK;
}

/* Collects the hits of as many pictures as give `wanted` samples, at most PICTURES_MAX. */
static bb_status collect_views(sampler *sampler, uint64_t wanted, uint64_t *hits)
{
    *hits = 0;
    for (uint32_t picture = 0; picture < PICTURES_MAX; picture++) {
        for (uint32_t v = 0; v < sampler->view_count; v++) {
            sampled_view *view = &sampler->views[v];
            const uint32_t before = view->count;
            BB_TRY(collect_picture(sampler, view, picture));
            *hits += view->count - before;
        }
        if (*hits == 0 || *hits >= wanted)
            break;
    }
    return BB_OK;
}

/* Distributes `wanted` samples equally; views with few hits leave theirs to the others. */
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
    BB_TRY(read_offset(job, &sampler->offset));
    if (request->max_rays < per_hit)
        return bb_fail(BB_INVALID, "rays %s: %u per hit, but only %u are allowed: take fewer",
                       job->rays->name, per_hit, request->max_rays);
    BB_TRY(bb_host_alloc(NULL, BATCH * sizeof *sampler->rays, "primary rays", &sampler->rays));
    BB_TRY(bb_host_alloc(NULL, BATCH * sizeof *sampler->hits, "primary hits", &sampler->hits));

    const bb_view *views = request->view != NULL ? request->view : job->scene->views;
    sampler->view_count = request->view != NULL ? 1 : job->scene->view_count;
    uint64_t hits, least;
    const uint64_t most = request->max_rays / per_hit;
    BB_TRY(bb_job_least(job, &least));
    least = least < request->max_rays ? least : request->max_rays;
    for (uint32_t v = 0; v < sampler->view_count; v++)
        BB_TRY(
            bb_camera_make(&views[v], request->width, request->height, &sampler->views[v].camera));
    sampler->counts = least > 0;
    BB_TRY(collect_views(sampler, (least + per_hit - 1) / per_hit, &hits));
    if (hits == 0)
        return bb_fail(BB_UNSUPPORTED, "rays %s: no primary ray of scene '%s' hits anything",
                       job->rays->name, job->scene->name);
    const uint64_t taken = hits < most ? hits : most;
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

/* Skips the few hits without a point on the surface. */
static bb_status for_each_sample(sampler *sampler, bb_surface_maker *make, void *context)
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
            bb_surface_point point;
            bb_picture_ray(job->request, &view->camera, view->hits[i].index, &ray);
            if (!find_point(job->scene, sampler->offset, &ray, &view->hits[i].hit, &point))
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

bb_status bb_surface_rays(bb_rays_job *job, uint32_t per_hit, bb_surface_maker *make, void *context)
{
    sampler sampler;
    bb_status status = begin_sampling(job, per_hit, &sampler);
    if (status == BB_OK)
        status = for_each_sample(&sampler, make, context);
    end_sampling(&sampler);
    return status;
}

/* Returns the random numbers' stream of the ray after this one. It follows from the ray alone: if
 * another version of Embree loses a hit, the other paths stay the same. */
static uint64_t stream_of(const bb_ray *ray)
{
    uint32_t bits[3];
    memcpy(bits, ray->d, sizeof bits);
    return ((uint64_t)bits[0] << 32 | bits[1]) ^ bits[2] * UINT64_C(0x9E3779B97F4A7C15);
}

bb_status bb_surface_go_on(bb_rays_job *job, uint32_t bounce, bb_surface_maker *make, void *context)
{
    double offset;
    bb_hit *hits = NULL;
    bb_ray *rays = job->rays->rays;
    uint32_t kept = 0;
    BB_TRY(read_offset(job, &offset));
    BB_TRY(bb_host_alloc(NULL, BATCH * sizeof *hits, "hits of paths", &hits));
    bb_status status = BB_OK;
    for (uint32_t begin = 0, end; begin < job->rays->count && status == BB_OK; begin = end) {
        end = job->rays->count - begin < BATCH ? job->rays->count : begin + BATCH;
        status = bb_oracle_trace(job->oracle, rays + begin, end - begin, &bb_query_closest, hits);
        for (uint32_t i = begin; i < end && status == BB_OK; i++) {
            bb_surface_point point;
            if (hits[i - begin].prim == BB_NONE ||
                !find_point(job->scene, offset, &rays[i], &hits[i - begin], &point))
                continue;
            bb_random random = bb_random_make(job->request->seed, stream_of(&rays[i]));
            status = make(context, &point, &random, &rays[kept++]);
        }
    }
    bb_host_free(hits);
    job->rays->count = kept;
    return status != BB_OK || kept > 0
               ? status
               : bb_fail(BB_UNSUPPORTED, "rays %s: no path in scene '%s' has %u bounces",
                         job->rays->name, job->scene->name, bounce);
}
