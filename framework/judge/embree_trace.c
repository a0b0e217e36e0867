/* Traces with Embree: rays one by one, in packets, or in streams. */
#include "framework/judge/embree_private.h"

#include <math.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

enum { STREAM = 256 }; /* rays of a stream: 24 KiB, which stay in a core's cache */

typedef struct trace_job {
    bb_embree *embree;
    const bb_ray *rays;
    bb_hit *hits;
} trace_job;

/* ---- what the library has ---- */

bb_status bb_embree_pass(bb_embree *embree, const bb_spec *spec)
{
    static const struct {
        const char *name;
        int property; /* of a device that has it; -1: all have it, -2: none */
    } queries[] = {
        [BB_QUERY_SINGLE] = {"single", -1},
        [BB_QUERY_PACKET4] = {"packet4", RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED},
        [BB_QUERY_PACKET8] = {"packet8", RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED},
        [BB_QUERY_PACKET16] = {"packet16", RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED},
#if BB_EMBREE_MAJOR == 3
        [BB_QUERY_STREAM] = {"stream", RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED},
#else
        [BB_QUERY_STREAM] = {"stream", -2},
#endif
    };
    embree->coherent = spec != NULL && bb_spec_is(spec, bb_embree_options, "coherent", "yes");
    embree->query = BB_QUERY_SINGLE;
    for (size_t i = 0; spec != NULL && i < sizeof queries / sizeof queries[0]; i++)
        if (bb_spec_is(spec, bb_embree_options, "query", queries[i].name))
            embree->query = (bb_embree_query)i;
    const int property = queries[embree->query].property;
    if (property == -1 ||
        (property >= 0 &&
         rtcGetDeviceProperty(embree->device, (enum RTCDeviceProperty)property) != 0))
        return BB_OK;
    return bb_fail(BB_UNSUPPORTED,
                   "Embree %d.%d on this processor has no query=%s: take query=single or packet4",
                   (int)rtcGetDeviceProperty(embree->device, RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                   (int)rtcGetDeviceProperty(embree->device, RTC_DEVICE_PROPERTY_VERSION_MINOR),
                   queries[embree->query].name);
}

/* ---- rays to Embree, hits from it ---- */

static inline struct RTCRay convert(const bb_ray *ray)
{
    return (struct RTCRay){.org_x = ray->o[0],
                           .org_y = ray->o[1],
                           .org_z = ray->o[2],
                           .tnear = ray->tmin,
                           .dir_x = ray->d[0],
                           .dir_y = ray->d[1],
                           .dir_z = ray->d[2],
                           .tfar = ray->tmax,
                           .mask = 0xFFFFFFFFu};
}

/* Returns whether a number of the ray exceeds Embree's limit (FLT_LARGE in its source), beyond
 * which some builds of it abort. */
static bool is_too_large(const bb_ray *ray)
{
    float largest = 0.0f;
    for (int k = 0; k < 3; k++)
        largest = fmaxf(largest, fmaxf(fabsf(ray->o[k]), fabsf(ray->d[k])));
    return largest > 1.8e18f;
}

static inline bb_hit hit_of(const trace_job *job, float t, unsigned int geometry,
                            unsigned int primitive)
{
    if (geometry == RTC_INVALID_GEOMETRY_ID)
        return (bb_hit){INFINITY, BB_NONE};
    return (bb_hit){t, job->embree->first_prim[geometry] + primitive};
}

static inline bb_hit any_hit_of(float tfar)
{
    return tfar < 0.0f && isinf(tfar) ? (bb_hit){0.0f, BB_UNNAMED} : (bb_hit){INFINITY, BB_NONE};
}

static inline struct RTCRayHit start_hit(const bb_ray *ray)
{
    struct RTCRayHit hit = {.ray = convert(ray)};
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return hit;
}

/* ---- one by one ---- */

static void closest_single(trace_job *job, size_t begin, size_t end)
{
    bb_intersect_arguments arguments;
    bb_intersect_arguments_init(&arguments, job->embree->coherent);
    for (size_t i = begin; i < end; i++) {
        struct RTCRayHit hit = start_hit(&job->rays[i]);
        if (!is_too_large(&job->rays[i]))
            BB_INTERSECT1(job->embree->scene, &hit, &arguments);
        job->hits[i] = hit_of(job, hit.ray.tfar, hit.hit.geomID, hit.hit.primID);
    }
}

static void any_single(trace_job *job, size_t begin, size_t end)
{
    bb_occluded_arguments arguments;
    bb_occluded_arguments_init(&arguments, job->embree->coherent);
    for (size_t i = begin; i < end; i++) {
        struct RTCRay ray = convert(&job->rays[i]);
        if (!is_too_large(&job->rays[i]))
            BB_OCCLUDED1(job->embree->scene, &ray, &arguments);
        job->hits[i] = any_hit_of(ray.tfar);
    }
}

/* ---- packets ---- */

/* Puts `count` rays into a packet of n. Rays that are missing or too large are not traced. */
#define FILL(packet, n, valid, from, count)                                                        \
    for (unsigned int i = 0; i < (n); i++) {                                                       \
        const bb_ray *ray = &(from)[i < (count) ? i : 0];                                          \
        (valid)[i] = i < (count) && !is_too_large(ray) ? -1 : 0;                                   \
        (packet).org_x[i] = ray->o[0];                                                             \
        (packet).org_y[i] = ray->o[1];                                                             \
        (packet).org_z[i] = ray->o[2];                                                             \
        (packet).tnear[i] = ray->tmin;                                                             \
        (packet).dir_x[i] = ray->d[0];                                                             \
        (packet).dir_y[i] = ray->d[1];                                                             \
        (packet).dir_z[i] = ray->d[2];                                                             \
        (packet).time[i] = 0;                                                                      \
        (packet).tfar[i] = ray->tmax;                                                              \
        (packet).mask[i] = 0xFFFFFFFFu;                                                            \
        (packet).id[i] = (packet).flags[i] = 0;                                                    \
    }

/* Functions that trace packets of n. */
#define PACKETS(n)                                                                                 \
    static void closest_packet##n(trace_job *job, size_t begin, size_t end)                        \
    {                                                                                              \
        bb_intersect_arguments arguments;                                                          \
        bb_intersect_arguments_init(&arguments, job->embree->coherent);                            \
        for (size_t at = begin; at < end; at += n) {                                               \
            _Alignas(64) int valid[n];                                                             \
            _Alignas(64) struct RTCRayHit##n packet;                                               \
            const size_t count = end - at < n ? end - at : n;                                      \
            FILL(packet.ray, n, valid, job->rays + at, count)                                      \
            for (unsigned int i = 0; i < n; i++)                                                   \
                packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;          \
            BB_INTERSECT_PACKET(n, valid, job->embree->scene, &packet, &arguments);                \
            for (size_t i = 0; i < count; i++)                                                     \
                job->hits[at + i] =                                                                \
                    hit_of(job, packet.ray.tfar[i], packet.hit.geomID[i], packet.hit.primID[i]);   \
        }                                                                                          \
    }                                                                                              \
    static void any_packet##n(trace_job *job, size_t begin, size_t end)                            \
    {                                                                                              \
        bb_occluded_arguments arguments;                                                           \
        bb_occluded_arguments_init(&arguments, job->embree->coherent);                             \
        for (size_t at = begin; at < end; at += n) {                                               \
            _Alignas(64) int valid[n];                                                             \
            _Alignas(64) struct RTCRay##n packet;                                                  \
            const size_t count = end - at < n ? end - at : n;                                      \
            FILL(packet, n, valid, job->rays + at, count)                                          \
            BB_OCCLUDED_PACKET(n, valid, job->embree->scene, &packet, &arguments);                 \
            for (size_t i = 0; i < count; i++)                                                     \
                job->hits[at + i] = any_hit_of(packet.tfar[i]);                                    \
        }                                                                                          \
    }

PACKETS(4)
PACKETS(8)
PACKETS(16)

/* ---- streams ---- */

#if BB_EMBREE_MAJOR == 3

/* A ray that is not traced has an interval that is empty. */
static void hide(struct RTCRay *ray)
{
    *ray = (struct RTCRay){.dir_x = 1, .tnear = 1, .tfar = 0, .mask = ray->mask};
}

static void closest_stream(trace_job *job, size_t begin, size_t end)
{
    bb_intersect_arguments arguments;
    bb_intersect_arguments_init(&arguments, job->embree->coherent);
    for (size_t at = begin; at < end; at += STREAM) {
        struct RTCRayHit hits[STREAM];
        const size_t count = end - at < STREAM ? end - at : STREAM;
        for (size_t i = 0; i < count; i++) {
            hits[i] = start_hit(&job->rays[at + i]);
            if (is_too_large(&job->rays[at + i]))
                hide(&hits[i].ray);
        }
        rtcIntersect1M(job->embree->scene, &arguments, hits, (unsigned int)count, sizeof *hits);
        for (size_t i = 0; i < count; i++)
            job->hits[at + i] =
                hit_of(job, hits[i].ray.tfar, hits[i].hit.geomID, hits[i].hit.primID);
    }
}

static void any_stream(trace_job *job, size_t begin, size_t end)
{
    bb_occluded_arguments arguments;
    bb_occluded_arguments_init(&arguments, job->embree->coherent);
    for (size_t at = begin; at < end; at += STREAM) {
        struct RTCRay rays[STREAM];
        const size_t count = end - at < STREAM ? end - at : STREAM;
        for (size_t i = 0; i < count; i++) {
            rays[i] = convert(&job->rays[at + i]);
            if (is_too_large(&job->rays[at + i]))
                hide(&rays[i]);
        }
        rtcOccluded1M(job->embree->scene, &arguments, rays, (unsigned int)count, sizeof *rays);
        for (size_t i = 0; i < count; i++)
            job->hits[at + i] = any_hit_of(rays[i].tfar);
    }
}

#else
/* bb_embree_pass() refuses streams */
#define closest_stream closest_single
#define any_stream any_single
#endif

/* ---- all ---- */

typedef void trace_fn(trace_job *job, size_t begin, size_t end);

static trace_fn *const closest[] = {
    [BB_QUERY_SINGLE] = closest_single,   [BB_QUERY_PACKET4] = closest_packet4,
    [BB_QUERY_PACKET8] = closest_packet8, [BB_QUERY_PACKET16] = closest_packet16,
    [BB_QUERY_STREAM] = closest_stream,
};

static trace_fn *const any_hit[] = {
    [BB_QUERY_SINGLE] = any_single,   [BB_QUERY_PACKET4] = any_packet4,
    [BB_QUERY_PACKET8] = any_packet8, [BB_QUERY_PACKET16] = any_packet16,
    [BB_QUERY_STREAM] = any_stream,
};

bb_status bb_embree_trace(bb_embree *embree, const bb_ray *rays, uint32_t count, bool any,
                          bb_hit *hits)
{
    trace_job job = {.embree = embree, .rays = rays, .hits = hits};
#if defined(                                                                                       \
    __SSE__) /* flush to zero, as Embree asks; here alone, so that no other arithmetic changes */
    unsigned int saved = _mm_getcsr();
    _mm_setcsr(saved | 0x8040u); /* FTZ and DAZ */
#endif
    (any ? any_hit : closest)[embree->query](&job, 0, count);
#if defined(__SSE__)
    _mm_setcsr(saved);
#endif
    int code = atomic_exchange(&embree->error, RTC_ERROR_NONE);
    if (code != RTC_ERROR_NONE)
        return bb_fail(BB_FAILED, "Embree, tracing %u rays: %s (error %d)", count, embree->text,
                       code);
    return BB_OK;
}
