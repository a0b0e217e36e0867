/* The first and the last hit along a ray. Only for meshes: a ray meets a triangle once but a body
 * twice, and the tests of bodies return the nearer hit.
 *
 * The first hit is right if it is a right closest hit; the last if it is a right any hit and, on
 * the rest of the ray behind it, no hit is missed (arbiter.h). Embree is not used. */
#include "framework/base/memory.h"
#include "framework/judge/judge.h"
#include "framework/judge/oracle_private.h"
#include "framework/judge/queries.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CHUNK = 64 };

typedef struct job {
    const bb_oracle *oracle;
    const bb_rays *rays;
    const bb_interval *results;
    uint8_t *classes;
    bool *limited;
} job;

static bool is_miss(const bb_interval *interval)
{
    return interval->prims[0] == BB_NONE && interval->prims[1] == BB_NONE;
}

/* A miss is (inf, -inf, BB_NONE, BB_NONE). */
static bool is_written(const bb_scene *scene, const bb_interval *interval)
{
    const float *t = interval->t;
    if (is_miss(interval))
        return isinf(t[0]) && t[0] > 0 && isinf(t[1]) && t[1] < 0;
    return interval->prims[0] < scene->prim_count && interval->prims[1] < scene->prim_count &&
           isfinite(t[0]) && isfinite(t[1]);
}

static bb_class judge_one(const job *job, const bb_ray *ray, const bb_interval *interval)
{
    const bb_arbiter *arbiter = &job->oracle->arbiter;
    const bb_hit miss = {INFINITY, BB_NONE};
    const bb_hit ends[2] = {{interval->t[0], interval->prims[0]},
                            {interval->t[1], interval->prims[1]}};
    if (!is_written(job->oracle->scene, interval))
        return BB_UNWRITTEN;
    if (is_miss(interval))
        return bb_arbiter_judge(arbiter, ray, &miss, &bb_query_closest, job->rays->must_hit);
    bb_class class = bb_arbiter_judge(arbiter, ray, &ends[0], &bb_query_closest, false);
    if (class == BB_RIGHT)
        class = bb_arbiter_judge(arbiter, ray, &ends[1], &bb_query_any, false);
    if (class != BB_RIGHT)
        return class;
    bb_ray rest = *ray;
    rest.tmin = fmaxf(ray->tmin, ends[1].t);
    bool passed = rest.tmin < rest.tmax &&
                  bb_arbiter_judge(arbiter, &rest, &miss, &bb_query_closest, false) == BB_MISSED;
    return passed || interval->t[1] < interval->t[0] ? BB_WRONG_T : BB_RIGHT;
}

static bool is_limited(const bb_oracle *oracle, const bb_ray *ray, uint32_t prim)
{
    return prim < oracle->scene->prim_count &&
           bb_margin(oracle->scene, ray, prim) > 0.25 * (double)oracle->heights[prim];
}

static void judge_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    const job *job = context;
    for (size_t i = begin; i < end; i++) {
        const bb_ray *ray = &job->rays->rays[i];
        const bb_interval *interval = &job->results[i];
        job->classes[i] = (uint8_t)judge_one(job, ray, interval);
        job->limited[i] = is_limited(job->oracle, ray, interval->prims[0]) ||
                          is_limited(job->oracle, ray, interval->prims[1]);
    }
}

static void count_classes(const job *job, uint32_t count, bb_accuracy *accuracy)
{
    accuracy->first_wrong = BB_NONE;
    for (uint32_t i = 0; i < count; i++) {
        uint8_t class = job->classes[i];
        accuracy->right += class == BB_RIGHT;
        accuracy->missed += class == BB_MISSED || class == BB_UNWRITTEN;
        accuracy->unwritten += class == BB_UNWRITTEN;
        accuracy->false_hits += class == BB_FALSE_HIT;
        accuracy->wrong_t += class == BB_WRONG_T;
        accuracy->margin_limited += job->limited[i];
        if (class != BB_RIGHT && accuracy->first_wrong == BB_NONE)
            accuracy->first_wrong = i;
    }
    accuracy->checked = accuracy->arbitrated = count;
    accuracy->wrong_ppm = count > 0 ? 1e6 * (double)(count - accuracy->right) / count : 0.0;
    accuracy->t_ulp_max = accuracy->t_ulp_p99 = NAN;
    accuracy->ties = accuracy->t_off = accuracy->forgiven = accuracy->oracle_wrong = BB_UNCOUNTED;
}

static bb_status judge(bb_oracle *oracle, bb_answers *answers, const bb_verdict_request *request,
                       bb_accuracy *accuracy)
{
    uint32_t count = request->count;
    job job = {.oracle = oracle, .rays = answers->rays, .results = request->results};
    BB_TRY(bb_oracle_prepare(oracle));
    bb_status status = bb_host_alloc(NULL, count, "classes of answers", &job.classes);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, count * sizeof *job.limited, "margins", &job.limited);
    if (status == BB_OK) {
        bb_parallel_for(oracle->pool, count, CHUNK, judge_chunk, &job);
        count_classes(&job, count, accuracy);
        if (request->classes != NULL)
            memcpy(request->classes, job.classes, count);
    }
    bb_host_free(job.classes);
    bb_host_free(job.limited);
    return status;
}

static bool same(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(bb_interval)) == 0;
}

static void say(const void *result, char *text, size_t capacity)
{
    const bb_interval *i = result;
    if (is_miss(i))
        snprintf(text, capacity, "a miss");
    else
        snprintf(text, capacity, "primitive %u at %a to primitive %u at %a", i->prims[0],
                 (double)i->t[0], i->prims[1], (double)i->t[1]);
}

extern const bb_query bb_query_interval;
const bb_query bb_query_interval = {
    .name = "interval",
    .asks = "first and last hit",
    .define = "BB_QUERY_INTERVAL",
    .way = BB_ALONG_RAYS,
    .kinds = BB_TRIANGLES,
    .result_bytes = sizeof(bb_interval),
    .same = same,
    .say = say,
    .judge = judge,
};
