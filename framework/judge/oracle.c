/* Embree's answers, and which of them are proved right.
 *
 * One exact and fast test of the ray's own way is nearly always enough: the reported primitive is
 * hit, and nothing before it. Only where that is undecided is the answer judged by the arbiter's
 * full definitions. */
#include "framework/judge/oracle_private.h"

#include "framework/base/memory.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

enum { CHUNK = 1024 };

/* Builds Embree's tree, unless it is there. */
static bb_status ready_embree(bb_oracle *oracle)
{
    if (oracle->embree != NULL)
        return BB_OK;
    BB_TRY(bb_embree_create(oracle->scene, NULL, oracle->threads, &oracle->embree));
    const bb_status status = bb_embree_build(oracle->embree);
    if (status == BB_OK)
        return BB_OK;
    bb_embree_destroy(oracle->embree);
    oracle->embree = NULL;
    return status;
}

bb_status bb_oracle_create(const bb_scene *scene, uint32_t threads, bb_oracle **out)
{
    *out = NULL;
    bb_oracle *oracle = calloc(1, sizeof *oracle);
    if (oracle == NULL)
        return bb_fail(BB_REFUSED, "the host refused the memory of the oracle");
    oracle->scene = scene;
    oracle->threads = threads;
    bb_status status = bb_pool_create(threads, &oracle->pool);
    if (status == BB_OK)
        status = ready_embree(oracle);
    if (status != BB_OK) {
        bb_oracle_destroy(oracle);
        return status;
    }
    *out = oracle;
    return BB_OK;
}

bool bb_oracle_give_up(bb_oracle *oracle)
{
    const bool had = oracle->embree != NULL;
    bb_way_destroy(oracle->way);
    oracle->way = NULL;
    bb_arbiter_destroy(&oracle->arbiter);
    bb_host_free(oracle->heights);
    oracle->heights = NULL;
    bb_embree_destroy(oracle->embree);
    oracle->embree = NULL;
    return had;
}

void bb_oracle_destroy(bb_oracle *oracle)
{
    if (oracle == NULL)
        return;
    (void)bb_oracle_give_up(oracle);
    bb_pool_destroy(oracle->pool);
    free(oracle);
}

typedef struct trace_job {
    bb_oracle *oracle;
    const bb_ray *rays;
    bb_hit *hits;
    bool any;
    atomic_flag failed; /* the first failure is kept: */
    char message[BB_MESSAGE_MAX];
} trace_job;

static void trace_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    trace_job *job = context;
    (void)thread;
    if (bb_embree_trace(job->oracle->embree, job->rays + begin, (uint32_t)(end - begin), job->any,
                        job->hits + begin) != BB_OK &&
        !atomic_flag_test_and_set(&job->failed))
        snprintf(job->message, sizeof job->message, "%s", bb_message());
}

bb_status bb_oracle_trace(bb_oracle *oracle, const bb_ray *rays, uint32_t count,
                          const bb_query *query, bb_hit *hits)
{
    trace_job job = {oracle, rays, hits, query->any, ATOMIC_FLAG_INIT, ""};
    if (!query->is_hit)
        return bb_fail(BB_UNSUPPORTED, "Embree does not answer %s queries", query->name);
    BB_TRY(ready_embree(oracle));
    bb_parallel_for(oracle->pool, count, CHUNK, trace_chunk, &job);
    return job.message[0] == '\0' ? BB_OK : bb_fail(BB_FAILED, "%s", job.message);
}

/* ---- what arbitration needs ---- */

static void height_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    bb_oracle *oracle = context;
    for (size_t prim = begin; prim < end; prim++)
        oracle->heights[prim] = bb_smallest_height(oracle->scene, (uint32_t)prim);
}

bb_status bb_oracle_prepare(bb_oracle *oracle)
{
    const bb_scene *scene = oracle->scene;
    BB_TRY(ready_embree(oracle));
    if (oracle->way != NULL)
        return BB_OK;
    if (oracle->arbiter.tree == NULL)
        BB_TRY(bb_arbiter_create(scene, &oracle->arbiter));
    BB_TRY(bb_host_alloc(NULL, scene->prim_count * sizeof *oracle->heights, "heights of primitives",
                         &oracle->heights));
    bb_parallel_for(oracle->pool, scene->prim_count, 16 * CHUNK, height_chunk, oracle);
    return bb_way_create(scene, oracle->arbiter.tree, &oracle->way);
}

/* ---- showing ---- */

/* Returns whether the ray itself hits the reported primitive, near the reported t, and nothing else
 * before the end of its margin. */
static bool is_sure(const bb_oracle *oracle, const bb_ray *ray, const bb_hit *hit)
{
    double t, margin = bb_t_margin(oracle->scene, ray, hit->prim);
    if (!bb_exact_first(oracle->scene, ray, hit->prim, &t) || fabs((double)hit->t - t) > margin)
        return false;
    double limit = fmin(ray->tmax, t + margin);
    return bb_way_ask(oracle->way, ray, limit, hit->prim) == BB_WAY_CLEAR;
}

static uint8_t show(const bb_oracle *oracle, const bb_rays *rays, const bb_ray *ray,
                    const bb_hit *hit)
{
    if (hit->prim == BB_NONE && !rays->must_hit &&
        bb_way_ask(oracle->way, ray, ray->tmax, BB_NONE) == BB_WAY_CLEAR)
        return BB_ORACLE_SURE;
    if (hit->prim == BB_UNNAMED && rays->query->any &&
        bb_way_ask(oracle->way, ray, ray->tmax, BB_NONE) == BB_WAY_BLOCKED)
        return BB_ORACLE_SURE;
    if (hit->prim < oracle->scene->prim_count && !rays->query->any && is_sure(oracle, ray, hit))
        return BB_ORACLE_SURE;
    bb_class class = bb_arbiter_judge(&oracle->arbiter, ray, hit, rays->query, rays->must_hit);
    return class == BB_RIGHT ? BB_ORACLE_RIGHT : BB_ORACLE_WRONG;
}

typedef struct show_job {
    const bb_oracle *oracle;
    bb_answers *answers;
} show_job;

static void show_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    const show_job *job = context;
    const bb_rays *rays = job->answers->rays;
    for (size_t i = begin; i < end; i++)
        job->answers->shown[i] = show(job->oracle, rays, &rays->rays[i], &job->answers->hits[i]);
}

/* ---- answers ---- */

bb_status bb_answers_trace(bb_oracle *oracle, const bb_rays *rays, bb_answers *answers)
{
    *answers = (bb_answers){.rays = rays};
    if (!rays->query->is_hit)
        return BB_OK; /* Embree has no such answers, so there is nothing to prove */
    BB_TRY(
        bb_host_alloc(NULL, rays->count * sizeof(bb_hit), "the oracle's answers", &answers->hits));
    return bb_oracle_trace(oracle, rays->rays, rays->count, rays->query, answers->hits);
}

bb_status bb_answers_show(bb_oracle *oracle, bb_answers *answers)
{
    if (answers->hits == NULL)
        return BB_OK;
    BB_TRY(bb_host_alloc(NULL, answers->rays->count, "what is known of them", &answers->shown));
    BB_TRY(bb_oracle_prepare(oracle));
    show_job job = {oracle, answers};
    bb_parallel_for(oracle->pool, answers->rays->count, CHUNK, show_chunk, &job);
    return BB_OK;
}

bb_status bb_answers_make(bb_oracle *oracle, const bb_rays *rays, bb_answers *answers)
{
    bb_status status = bb_answers_trace(oracle, rays, answers);
    if (status == BB_OK)
        status = bb_answers_show(oracle, answers);
    if (status != BB_OK)
        bb_answers_release(answers);
    return status;
}

void bb_answers_release(bb_answers *answers)
{
    bb_judged_release(answers);
    bb_host_free(answers->hits);
    bb_host_free(answers->shown);
    answers->hits = NULL;
    answers->shown = NULL;
}
