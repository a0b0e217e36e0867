/* Embree (3 or 4) as oracle and as reference: its own scene over our triangles and spheres.
 *
 * Spheres are RTC_GEOMETRY_TYPE_SPHERE_POINT: the nearest root in the interval counts, so a ray
 * from inside hits the far side. Kinds that Embree does not have are user geometries, intersected
 * in exact arithmetic. Embree counts hits in the closed interval [tmin, tmax], bb_ray's is open;
 * the difference is a single t, within the margin of the arbiter.
 */
#include "framework/judge/embree_private.h"

#include "framework/base/interrupt.h"
#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "framework/scene/prim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const bb_option bb_embree_options[] = {
    {"quality", "medium", "low|medium|high",
     "build quality of Embree's own tree (in robust mode Embree builds high as medium)"},
    {"mode", "robust", "fast|robust", "robust: watertight edges (RTC_SCENE_FLAG_ROBUST)"},
    {"query", "single", "single|packet4|packet8|packet16|stream",
     "rays of a call: one (rtcIntersect1), a packet (rtcIntersect4, 8, 16), or a stream "
     "(rtcIntersect1M, in Embree 3 only)"},
    {"coherent", "no", "no|yes",
     "yes: tells Embree that the rays of a call are near each other, for which it has other code"},
    {NULL, NULL, NULL, NULL},
};

/* ---- Embree's errors and version ---- */

static bool count_bytes(void *user, ssize_t bytes, bool post)
{
    bb_embree *embree = user;
    if (!bb_host_follow(bytes, post, "Embree"))
        return false;
    atomic_fetch_add_explicit(&embree->bytes, bytes, memory_order_relaxed);
    return true;
}

/* Ends a build that nobody waits for any more. Not one at quality low: Embree 3.13's Morton builder
 * of triangles crashes when it is ended, and takes less than a second for 10^7. */
static bool goes_on(void *user, double share)
{
    (void)user, (void)share;
    return !bb_interrupted();
}

static void keep_error(void *user, enum RTCError code, const char *text)
{
    bb_embree *embree = user;
    int none = RTC_ERROR_NONE;
    if (atomic_compare_exchange_strong(&embree->error, &none, (int)code))
        snprintf(embree->text, sizeof embree->text, "%s", text != NULL ? text : "no text");
}

static bb_status no_device(void)
{
    return bb_fail(BB_FAILED, "Embree gives no device (error %d): check the installation of Embree",
                   (int)rtcGetDeviceError(NULL));
}

bb_status bb_embree_version(char *text, size_t capacity)
{
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    if (device == NULL)
        return no_device();
    snprintf(text, capacity, "%d.%d.%d",
             (int)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR),
             (int)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MINOR),
             (int)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_PATCH));
    rtcReleaseDevice(device);
    return BB_OK;
}

static bb_status check(bb_embree *embree, const char *what)
{
    const bb_scene *of = embree->of;
    int code = atomic_exchange(&embree->error, RTC_ERROR_NONE);
    if (code == RTC_ERROR_NONE)
        return BB_OK;
    if (code == RTC_ERROR_OUT_OF_MEMORY)
        return bb_fail(BB_REFUSED,
                       "Embree has no room for the %s of scene '%s' (%u primitives) beside %llu "
                       "bytes in use; %s is %llu: take a smaller scene or fewer builders",
                       what, of->name, of->prim_count, (unsigned long long)bb_host_account()->bytes,
                       bb_memory_limit_by(), (unsigned long long)bb_memory_limit());
    return bb_fail(BB_FAILED, "Embree, %s of scene '%s' (%u primitives): %s (error %d)", what,
                   of->name, of->prim_count, embree->text, code);
}

/* ---- building ---- */

static void attach(bb_embree *embree, RTCGeometry geometry, unsigned int id, uint32_t first_prim,
                   enum RTCBuildQuality quality)
{
    rtcSetGeometryBuildQuality(geometry, quality);
    rtcAttachGeometryByID(embree->scene, geometry, id);
    rtcReleaseGeometry(geometry);
    embree->first_prim[id] = first_prim;
    embree->geometries = id + 1;
}

/* Shares all arrays: bb_host_alloc() lets Embree read 16 bytes at the last vertex. */
static RTCGeometry triangles_of(bb_embree *embree, const bb_scene *scene)
{
    RTCGeometry triangles = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               scene->vertices, 0, 3 * sizeof(float), scene->vertex_count);
    rtcSetSharedGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               bb_scene_indices(scene), 0, 3 * sizeof(uint32_t),
                               scene->prims[BB_TRIANGLE].count);
    return triangles;
}

static RTCGeometry spheres_of(bb_embree *embree, const bb_scene *scene)
{
    RTCGeometry spheres = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetSharedGeometryBuffer(spheres, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                               scene->prims[BB_SPHERE].data, 0, 4 * sizeof(float),
                               scene->prims[BB_SPHERE].count);
    return spheres;
}

/* ---- user geometries: kinds that Embree does not have ---- */

/* Enlarges the box by a few units in the last place: Embree's traversal of such boxes rounds. */
static void user_bounds(const struct RTCBoundsFunctionArguments *arguments)
{
    const user_kind *user = arguments->geometryUserPtr;
    const bb_scene *scene = user->scene;
    const bb_box *box = &scene->boxes[scene->prims[user->kind].first + arguments->primID];
    float lo[3], hi[3];
    for (int k = 0; k < 3; k++) {
        float pad = 0x1p-20f * fmaxf(fabsf(box->lo[k]), fabsf(box->hi[k]));
        lo[k] = box->lo[k] - pad;
        hi[k] = box->hi[k] + pad;
    }
    *arguments->bounds_o = (struct RTCBounds){lo[0], lo[1], lo[2], 0, hi[0], hi[1], hi[2], 0};
}

/* Returns the first t in the ray's interval at which it meets the primitive; INFINITY if it does
 * not. */
static float user_t(const user_kind *user, const struct RTCRay *ray, uint32_t prim)
{
    const double o[3] = {ray->org_x, ray->org_y, ray->org_z};
    const float d[3] = {ray->dir_x, ray->dir_y, ray->dir_z};
    double t[2];
    int count = bb_prim_kinds[user->kind]->hits(user->scene, prim, o, d, t);
    for (int root = 0; root < count; root++)
        if (t[root] > ray->tnear && t[root] < ray->tfar)
            return (float)t[root];
    return INFINITY;
}

/* What user_t() needs of a ray of a packet. */
static struct RTCRay ray_of(const void *rays, unsigned int n, unsigned int i)
{
    return (struct RTCRay){.org_x = BB_RAY_MEMBER(const float, rays, n, i, BB_RAY_ORG),
                           .org_y = BB_RAY_MEMBER(const float, rays, n, i, BB_RAY_ORG + 1),
                           .org_z = BB_RAY_MEMBER(const float, rays, n, i, BB_RAY_ORG + 2),
                           .tnear = BB_RAY_MEMBER(const float, rays, n, i, BB_RAY_TNEAR),
                           .dir_x = BB_RAY_MEMBER(const float, rays, n, i, BB_RAY_DIR),
                           .dir_y = BB_RAY_MEMBER(const float, rays, n, i, BB_RAY_DIR + 1),
                           .dir_z = BB_RAY_MEMBER(const float, rays, n, i, BB_RAY_DIR + 2),
                           .tfar = BB_RAY_MEMBER(const float, rays, n, i, BB_RAY_TFAR)};
}

static void user_intersect(const struct RTCIntersectFunctionNArguments *arguments)
{
    const unsigned int n = arguments->N;
    void *rays = arguments->rayhit;
    for (unsigned int i = 0; i < n; i++) {
        if (arguments->valid[i] == 0)
            continue;
        const struct RTCRay ray = ray_of(rays, n, i);
        const float t = user_t(arguments->geometryUserPtr, &ray, arguments->primID);
        if (!(t < ray.tfar))
            continue;
        BB_RAY_MEMBER(float, rays, n, i, BB_RAY_TFAR) = t;
        BB_RAY_MEMBER(unsigned int, rays, n, i, BB_HIT_PRIM) = arguments->primID;
        BB_RAY_MEMBER(unsigned int, rays, n, i, BB_HIT_GEOMETRY) = arguments->geomID;
        BB_RAY_MEMBER(unsigned int, rays, n, i, BB_HIT_INSTANCE) = RTC_INVALID_GEOMETRY_ID;
    }
}

static void user_occluded(const struct RTCOccludedFunctionNArguments *arguments)
{
    const unsigned int n = arguments->N;
    for (unsigned int i = 0; i < n; i++) {
        if (arguments->valid[i] == 0)
            continue;
        const struct RTCRay ray = ray_of(arguments->ray, n, i);
        if (user_t(arguments->geometryUserPtr, &ray, arguments->primID) < ray.tfar)
            BB_RAY_MEMBER(float, arguments->ray, n, i, BB_RAY_TFAR) = -INFINITY;
    }
}

static RTCGeometry user_of(bb_embree *embree, const bb_scene *scene, uint32_t kind)
{
    RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_USER);
    embree->users[kind] = (user_kind){scene, kind};
    rtcSetGeometryUserPrimitiveCount(geometry, scene->prims[kind].count);
    rtcSetGeometryUserData(geometry, &embree->users[kind]);
    rtcSetGeometryBoundsFunction(geometry, user_bounds, NULL);
    rtcSetGeometryIntersectFunction(geometry, user_intersect);
    rtcSetGeometryOccludedFunction(geometry, user_occluded);
    return geometry;
}

static void add_geometry(bb_embree *embree, const bb_scene *scene, enum RTCBuildQuality quality)
{
    unsigned int id = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        if (scene->prims[kind].count == 0)
            continue;
        RTCGeometry geometry = kind == BB_TRIANGLE ? triangles_of(embree, scene)
                               : kind == BB_SPHERE ? spheres_of(embree, scene)
                                                   : user_of(embree, scene, kind);
        attach(embree, geometry, id++, scene->prims[kind].first, quality);
    }
}

static enum RTCBuildQuality quality_of(const bb_spec *spec)
{
    if (spec != NULL && bb_spec_is(spec, bb_embree_options, "quality", "low"))
        return RTC_BUILD_QUALITY_LOW;
    if (spec != NULL && bb_spec_is(spec, bb_embree_options, "quality", "high"))
        return RTC_BUILD_QUALITY_HIGH;
    return RTC_BUILD_QUALITY_MEDIUM;
}

static bb_status start(bb_embree *embree, const bb_scene *scene, const bb_spec *spec)
{
    enum RTCBuildQuality quality = quality_of(spec);
    const bool oracle = spec == NULL, /* which saves memory, not time */
        fast = !oracle && bb_spec_is(spec, bb_embree_options, "mode", "fast");
    embree->scene = rtcNewScene(embree->device);
    BB_TRY(check(embree, "creation"));
    rtcSetSceneFlags(embree->scene, (fast ? RTC_SCENE_FLAG_NONE : RTC_SCENE_FLAG_ROBUST) |
                                        (oracle ? RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_NONE));
    rtcSetSceneBuildQuality(embree->scene, quality);
    if (quality != RTC_BUILD_QUALITY_LOW)
        rtcSetSceneProgressMonitorFunction(embree->scene, goes_on, NULL);
    add_geometry(embree, scene, quality);
    return check(embree, "geometry");
}

bb_status bb_embree_build(bb_embree *embree)
{
    for (uint32_t id = 0; id < embree->geometries; id++) {
        RTCGeometry geometry = rtcGetGeometry(embree->scene, id);
        if (embree->built) /* Embree does not rebuild geometries that are not marked as changed */
            rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry);
    }
    rtcCommitScene(embree->scene);
    embree->built = true;
    return check(embree, "build");
}

uint64_t bb_embree_bytes(const bb_embree *embree)
{
    return (uint64_t)atomic_load(&embree->bytes);
}

bb_status bb_embree_create(const bb_scene *scene, const bb_spec *spec, uint32_t threads,
                           bb_embree **out)
{
    *out = NULL;
    bb_embree *embree = calloc(1, sizeof *embree);
    if (embree == NULL)
        return bb_fail(BB_REFUSED, "the host refused the memory of an Embree device");
    embree->of = scene;
    /* Embree's own threads (TBB) only build, and sleep between builds. */
    char config[64];
    snprintf(config, sizeof config, "threads=%u,set_affinity=0", threads);
    embree->device = rtcNewDevice(config);
    bb_status status = embree->device != NULL ? BB_OK : no_device();
    if (status == BB_OK) {
        rtcSetDeviceErrorFunction(embree->device, keep_error, embree);
        rtcSetDeviceMemoryMonitorFunction(embree->device, count_bytes, embree);
        status = start(embree, scene, spec);
    }
    if (status == BB_OK)
        *out = embree;
    else
        bb_embree_destroy(embree);
    return status;
}

void bb_embree_destroy(bb_embree *embree)
{
    if (embree == NULL)
        return;
    if (embree->scene != NULL)
        rtcReleaseScene(embree->scene);
    if (embree->device != NULL)
        rtcReleaseDevice(embree->device);
    free(embree);
}
