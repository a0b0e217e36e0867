/* The table of workloads; primary and random rays; what all workloads share.
 *
 * Rays are made in doubles and rounded to float once. They depend on scene, view, picture size,
 * options and seed only, secondary ones also on Embree's primary hits.
 */
#include "framework/rays/rays.h"

#include "framework/rays/rays_private.h"
#include "framework/scene/camera.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#define TMIN_OPTION                                                                                \
    {                                                                                              \
        "tmin", "0", NULL, "hits count beyond this t"                                              \
    }
#define OFFSET_OPTION                                                                              \
    {                                                                                              \
        "offset", "1e-5", NULL,                                                                    \
            "origins are moved off the surface by this, in scene diagonals (but by 2^-20 of "      \
            "their largest coordinate at least)"                                                   \
    }
#define END_OPTION                                                                                 \
    {                                                                                              \
        NULL, NULL, NULL, NULL                                                                     \
    }

static const bb_option primary_options[] = {TMIN_OPTION, END_OPTION};

static const bb_option ao_options[] = {
    {"per_hit", "32", NULL, "rays per hit"},
    {"length", "0.1", NULL, "length of the rays in scene diagonals"},
    OFFSET_OPTION,
    TMIN_OPTION,
    END_OPTION,
};

static const bb_option diffuse_options[] = {
    {"per_hit", "32", NULL, "rays per hit"},
    OFFSET_OPTION,
    TMIN_OPTION,
    END_OPTION,
};

static const bb_option shadow_options[] = {
    {"size", "0.25", NULL, "side of the square light in shares of the box's shorter side"},
    {"drop", "0.01", NULL, "how far the light hangs under the box's top, in shares of its height"},
    OFFSET_OPTION,
    TMIN_OPTION,
    END_OPTION,
};

static const bb_option random_options[] = {
    {"count", NULL, NULL, "number of rays (as many as the run allows)"},
    {"near", "0", NULL, "share that goes from close to a primitive to close to another"},
    TMIN_OPTION,
    END_OPTION,
};

static const bb_option edges_options[] = {
    {"count", NULL, NULL, "number of rays, also beyond what the run allows (which is the default)"},
    {"from", NULL, "inside|eyes|around",
     "origins: inside a closed mesh, where each ray must hit; near the eyes of the views; in the "
     "scene's box and around it (inside where the mesh is known to be closed, else eyes)"},
    {"jitter", "0", NULL,
     "the aim is off by up to this many 2^-24 of the triangle's extent from the origin, 0 to 64"},
    END_OPTION,
};

const bb_workload bb_workloads[] = {
    {"primary", "one ray per pixel, closest hit", BB_CLOSEST_HIT, true, primary_options, NULL},
    {"ao", "ambient occlusion: short cosine-weighted rays from primary hits, any hit", BB_ANY_HIT,
     false, ao_options, NULL},
    {"diffuse", "unbounded cosine-weighted rays from primary hits, closest hit", BB_CLOSEST_HIT,
     false, diffuse_options, NULL},
    {"shadow", "one ray per primary hit to a point of a square light, any hit", BB_ANY_HIT, false,
     shadow_options, NULL},
    {"random", "from a uniform point of the scene's box through another, closest hit",
     BB_CLOSEST_HIT, false, random_options, NULL},
    {"edges", "at edges and vertices; from inside a closed mesh each must hit; closest hit",
     BB_CLOSEST_HIT, false, edges_options, bb_rays_edges_must_hit},
    {NULL, NULL, BB_CLOSEST_HIT, false, NULL, NULL},
};

const char *bb_query_name(bb_query query)
{
    return query == BB_ANY_HIT ? "any" : "closest";
}

const bb_workload *bb_workload_find(const char *name)
{
    for (const bb_workload *workload = bb_workloads; workload->name != NULL; workload++)
        if (strcmp(workload->name, name) == 0)
            return workload;
    return NULL;
}

bool bb_rays_must_hit(const bb_scene *scene, const bb_spec *spec, const bb_workload *workload)
{
    return workload->must_hit != NULL && workload->must_hit(scene, spec);
}

/* ---- shared ---- */

bb_status bb_rays_reserve(bb_rays *rays, uint32_t count)
{
    BB_TRY(bb_host_alloc(NULL, count * sizeof(bb_ray), "rays", &rays->rays));
    rays->count = count;
    return BB_OK;
}

bool bb_ray_set_direction(bb_ray *ray, const double d[3])
{
    bool usable = false;
    for (int k = 0; k < 3; k++) {
        ray->d[k] = (float)d[k];
        if (!isfinite(ray->d[k]))
            return false;
        usable |= ray->d[k] != 0.0f;
    }
    return usable;
}

/* ---- primary ---- */

static bb_status make_primary(bb_rays_job *job)
{
    const bb_rays_request *request = job->request;
    if (request->view == NULL)
        return bb_fail(BB_INVALID, "rays primary: need a view");
    bb_camera camera;
    BB_TRY(bb_camera_make(request->view, request->width, request->height, &camera));
    BB_TRY(bb_rays_reserve(job->rays, request->width * request->height));
    job->rays->width = request->width;
    job->rays->height = request->height;
    for (uint32_t y = 0, i = 0; y < request->height; y++)
        for (uint32_t x = 0; x < request->width; x++, i++) {
            bb_camera_ray(&camera, x, y, &job->rays->rays[i]);
            job->rays->rays[i].tmin = job->tmin;
        }
    return BB_OK;
}

/* ---- random ---- */

/* The box of a random primitive, grown by its longest side: where a scene has something, even if that is all in one corner. */
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

/* From a point of one box through a point of the other. */
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

/* Two points fall together at most where a box has next to no floats inside, or is that of a primitive
 * which is a point. */
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
    uint64_t count = job->request->max_rays;
    if (bb_spec_value(job->request->spec, job->options, "count") != NULL) {
        BB_TRY(bb_spec_u64(job->request->spec, job->options, "count", 1, INT32_MAX, &count));
        count = count < job->request->max_rays ? count : job->request->max_rays;
    }
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

/* ---- the door ---- */

static bb_status (*const makers[])(bb_rays_job *job) = {
    make_primary, bb_rays_ao, bb_rays_diffuse, bb_rays_shadow, make_random, bb_rays_edges};
_Static_assert(sizeof makers / sizeof makers[0] == sizeof bb_workloads / sizeof bb_workloads[0] - 1,
               "one maker per workload");

bb_status bb_rays_check(const bb_scene *scene, const bb_rays *rays)
{
    float farthest = 0x1p92f / scene->scale; /* 2^34 times the scene's largest coordinate or more */
    for (uint32_t i = 0; i < rays->count; i++) {
        const bb_ray *ray = &rays->rays[i];
        bool finite = ray->tmin >= 0.0f && ray->tmax > ray->tmin;
        float out = 0.0f, length = 0.0f;
        for (int k = 0; k < 3; k++) {
            finite = finite && isfinite(ray->o[k]) && isfinite(ray->d[k]);
            out = fmaxf(out, fabsf(ray->o[k]));
            length = fmaxf(length, fabsf(ray->d[k]));
        }
        if (!finite || length == 0.0f)
            return bb_fail(BB_INVALID,
                           "rays %s: ray %u is not finite or has no length: move the view closer, "
                           "or check length and tmin",
                           rays->name, i);
        if (length < 0x1p-120f || length > 0x1p120f || out > farthest)
            return bb_fail(
                BB_INVALID,
                "rays %s: ray %u starts %g from the origin with a direction of %g, beyond "
                "what floats serve in scene '%s': move the view closer",
                rays->name, i, (double)out, (double)length, scene->name);
    }
    return BB_OK;
}

static bb_status begin_job(const bb_scene *scene, const bb_rays_request *request, bb_rays_job *job)
{
    const bb_spec *spec = request->spec;
    const bb_workload *workload = bb_workload_find(spec->name);
    if (workload == NULL)
        return bb_fail(BB_INVALID, "no rays '%s': `bvhbench list rays` shows what there is",
                       spec->name);
    char what[64];
    snprintf(what, sizeof what, "rays %s", workload->name);
    BB_TRY(bb_spec_validate(spec, workload->options, what));
    if (strlen(spec->text) >= sizeof job->rays->name)
        return bb_fail(BB_INVALID, "rays '%s': longer than %zu characters", spec->text,
                       sizeof job->rays->name - 1);
    if (request->max_rays == 0)
        return bb_fail(BB_INVALID, "rays '%s': allow at least one", spec->text);
    double tmin = 0.0, diagonal = 0.0;
    if (bb_spec_value(spec, workload->options, "tmin") != NULL)
        BB_TRY(bb_spec_double(spec, workload->options, "tmin", 0.0, 1e30, &tmin));
    for (int k = 0; k < 3; k++)
        diagonal = hypot(diagonal, (double)scene->bounds.hi[k] - (double)scene->bounds.lo[k]);
    job->options = workload->options;
    job->diagonal = diagonal;
    job->tmin = (float)tmin;
    job->rays->workload = workload;
    job->rays->query = workload->query;
    job->rays->must_hit = bb_rays_must_hit(scene, spec, workload);
    job->rays->seed = request->seed;
    job->rays->primary_width = request->width;
    job->rays->primary_height = request->height;
    job->rays->max_rays = request->max_rays;
    snprintf(job->rays->name, sizeof job->rays->name, "%s", spec->text);
    BB_TRY(bb_spec_parse(spec->text, &job->rays->spec));
    if (request->view != NULL)
        snprintf(job->rays->view, sizeof job->rays->view, "%s", request->view->name);
    return BB_OK;
}

bb_status bb_rays_make(const bb_scene *scene, struct bb_oracle *oracle,
                       const bb_rays_request *request, bb_rays **out)
{
    *out = NULL;
    bb_rays *rays = calloc(1, sizeof *rays);
    if (rays == NULL)
        return bb_fail(BB_REFUSED, "the host refused the memory of a ray set");
    bb_rays_job job = {.scene = scene, .oracle = oracle, .request = request, .rays = rays};
    bb_status status = begin_job(scene, request, &job);
    if (status == BB_OK)
        status = makers[rays->workload - bb_workloads](&job);
    if (status == BB_OK)
        status = bb_rays_check(scene, rays);
    if (status != BB_OK) {
        bb_rays_free(rays);
        return status;
    }
    rays->hash = bb_rays_hash(rays);
    *out = rays;
    return BB_OK;
}

uint64_t bb_rays_hash(const bb_rays *rays)
{
    return XXH3_64bits(rays->rays, rays->count * sizeof(bb_ray));
}

bb_status bb_rays_upload(bb_rays *rays, bb_device *device)
{
    size_t bytes = rays->count * sizeof(bb_ray);
    if (rays->on_device.mem != NULL && rays->on_device.device == device)
        return BB_OK;
    bb_buffer_release(&rays->on_device);
    BB_TRY(bb_buffer_reserve(device, NULL, bytes, "rays", &rays->on_device));
    bb_status status = bb_buffer_write(&rays->on_device, 0, bytes, rays->rays);
    if (status != BB_OK)
        bb_buffer_release(&rays->on_device);
    return status;
}

void bb_rays_free(bb_rays *rays)
{
    if (rays == NULL)
        return;
    bb_buffer_release(&rays->on_device);
    bb_host_free(rays->rays);
    free(rays);
}
