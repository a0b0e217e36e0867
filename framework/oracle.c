/* Compares answers with Embree's, sends what disagrees to the arbiter, and counts.
 *
 * In two passes, each on all cores: the first is cheap and settles what agrees, the second
 * arbitrates the rest, for which the arbiter's hierarchy is made when it is first needed.
 */
#include "framework/oracle.h"

#include "framework/arbiter.h"
#include "framework/clock.h"
#include "framework/embree.h"
#include "framework/memory.h"
#include "framework/statistics.h"
#include "framework/threads.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { OPEN = 255, QUICK_CHUNK = 4096, SLOW_CHUNK = 64 };

struct bb_oracle {
    const bb_scene *scene;
    bb_embree *embree;
    bb_pool *pool;
    bool has_arbiter;
    bb_arbiter arbiter;
};

bb_status bb_oracle_create(const bb_scene *scene, uint32_t threads, bb_oracle **out)
{
    *out = NULL;
    bb_oracle *oracle = calloc(1, sizeof *oracle);
    if (oracle == NULL)
        return bb_fail(BB_REFUSED, "the host refused the memory of the oracle");
    oracle->scene = scene;
    bb_status status = bb_pool_create(threads, &oracle->pool);
    if (status == BB_OK)
        status = bb_embree_create(scene, NULL, threads, &oracle->embree, NULL, NULL);
    if (status != BB_OK) {
        bb_oracle_destroy(oracle);
        return status;
    }
    *out = oracle;
    return BB_OK;
}

void bb_oracle_destroy(bb_oracle *oracle)
{
    if (oracle == NULL)
        return;
    if (oracle->has_arbiter)
        bb_arbiter_destroy(&oracle->arbiter);
    bb_embree_destroy(oracle->embree);
    bb_pool_destroy(oracle->pool);
    free(oracle);
}

bb_status bb_oracle_trace(bb_oracle *oracle, const bb_ray *rays, uint32_t count, bb_query query,
                          bb_hit *hits)
{
    return bb_embree_trace(oracle->embree, rays, count, query, hits);
}

bb_status bb_answers_make(bb_oracle *oracle, const bb_rays *rays, bb_answers *answers)
{
    *answers = (bb_answers){.rays = rays};
    BB_TRY(
        bb_host_alloc(NULL, rays->count * sizeof(bb_hit), "the oracle's answers", &answers->hits));
    double start = bb_wall_ms();
    bb_status status = bb_oracle_trace(oracle, rays->rays, rays->count, rays->query, answers->hits);
    answers->trace_ms = bb_wall_ms() - start;
    if (status != BB_OK)
        bb_answers_release(answers);
    return status;
}

void bb_answers_release(bb_answers *answers)
{
    bb_host_free(answers->hits);
    answers->hits = NULL;
}

/* ---- judging ---- */

typedef struct judge_job {
    const bb_oracle *oracle;
    const bb_rays *rays;
    const bb_hit *hits, *expected;
    uint8_t *classes;
    float *ulps;    /* error of t of the right hits; NAN: none */
    uint32_t *open; /* the rays that go to the arbiter */
    _Atomic uint64_t margin_limited, oracle_wrong, forgiven;
} judge_job;

/* Whether a kernel wrote this: a miss is (inf, BB_NONE), a hit a number and a primitive. */
static bool is_written(const bb_scene *scene, bb_query query, const bb_hit *hit)
{
    if (query == BB_ANY_HIT && hit->prim == BB_UNNAMED)
        return true;
    if (hit->prim == BB_NONE)
        return isinf(hit->t) && hit->t > 0.0f;
    return hit->prim < scene->prim_count && isfinite(hit->t);
}

static bool is_unnamed(bb_query query, const bb_hit *hit)
{
    return query == BB_ANY_HIT && hit->prim == BB_UNNAMED;
}

static bool is_limited(const bb_scene *scene, uint32_t prim, double eps)
{
    const bb_box *box = &scene->boxes[prim];
    double extent = 0.0;
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, (double)box->hi[k] - (double)box->lo[k]);
    return eps > 0.25 * extent;
}

/* |t - exact| in units of the last place of a float at `exact`. */
static float error_in_ulps(float t, double exact)
{
    int exponent;
    frexp(exact, &exponent);
    double ulp = ldexp(1.0, exponent - 24 > -149 ? exponent - 24 : -149);
    return (float)(fabs((double)t - exact) / ulp);
}

/* The cheap rule; it gives the classes that the arbiter would give to answers that agree. */
static uint8_t judge_quickly(judge_job *job, size_t i, uint64_t *limited)
{
    const bb_scene *scene = job->oracle->scene;
    const bb_ray *ray = &job->rays->rays[i];
    const bb_hit *hit = &job->hits[i], *expected = &job->expected[i];
    bb_query query = job->rays->query;
    job->ulps[i] = NAN;
    if (!is_written(scene, query, hit))
        return BB_UNWRITTEN;

    const bb_hit *named = hit->prim != BB_NONE && !is_unnamed(query, hit) ? hit : expected;
    double eps = 0.0;
    if (named->prim != BB_NONE && !is_unnamed(query, named)) {
        eps = bb_margin(scene, ray, named->prim);
        *limited += is_limited(scene, named->prim, eps);
    }
    if (hit->prim == BB_NONE)
        return job->rays->must_hit ? BB_MISSED : expected->prim == BB_NONE ? BB_RIGHT : OPEN;
    if (expected->prim == BB_NONE)
        return OPEN;
    if (is_unnamed(query, hit))
        return BB_RIGHT;
    if (query == BB_CLOSEST_HIT && hit->prim != expected->prim)
        return OPEN;

    double t, square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (double)ray->d[k] * (double)ray->d[k];
    double e = eps / sqrt(square);
    if (!bb_exact_t(scene, ray, hit->prim, hit->t, &t) || fabs((double)hit->t - t) > e ||
        hit->t < ray->tmin - e || hit->t > ray->tmax + e)
        return OPEN;
    /* A sphere has two t, and only one is the nearest. */
    if (query == BB_CLOSEST_HIT && fabs((double)hit->t - (double)expected->t) > e)
        return OPEN;
    /* The oracle did not name its primitive: that this one is hit, and not only its plane, is left
     * to the arbiter. */
    if (query == BB_ANY_HIT && !bb_exact_hit(scene, ray, hit->prim))
        return OPEN;
    job->ulps[i] = error_in_ulps(hit->t, t);
    return BB_RIGHT;
}

static void quick_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    judge_job *job = context;
    uint64_t limited = 0, oracle_wrong = 0;
    for (size_t i = begin; i < end; i++) {
        job->classes[i] = judge_quickly(job, i, &limited);
        oracle_wrong += job->classes[i] == BB_MISSED && job->expected[i].prim == BB_NONE;
    }
    atomic_fetch_add_explicit(&job->margin_limited, limited, memory_order_relaxed);
    atomic_fetch_add_explicit(&job->oracle_wrong, oracle_wrong, memory_order_relaxed);
}

static void slow_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    judge_job *job = context;
    const bb_arbiter *arbiter = &job->oracle->arbiter;
    uint64_t oracle_wrong = 0, forgiven = 0;
    for (size_t n = begin; n < end; n++) {
        uint32_t i = job->open[n];
        const bb_ray *ray = &job->rays->rays[i];
        const bb_hit *hit = &job->hits[i], *expected = &job->expected[i];
        bb_query query = job->rays->query;
        bool must_hit = job->rays->must_hit;
        uint8_t class = bb_arbiter_judge(arbiter, ray, hit, query, must_hit);
        forgiven += class == BB_RIGHT && !must_hit && bb_arbiter_forgives(arbiter, ray, hit, query);
        double t;
        if (class == BB_RIGHT && hit->prim != BB_NONE && !is_unnamed(query, hit) &&
            bb_exact_t(arbiter->scene, ray, hit->prim, hit->t, &t))
            job->ulps[i] = error_in_ulps(hit->t, t);
        if (class == BB_RIGHT && query == BB_CLOSEST_HIT && hit->prim != BB_NONE &&
            expected->prim != BB_NONE && hit->prim != expected->prim)
            class = BB_TIE;
        job->classes[i] = class;
        oracle_wrong += bb_arbiter_judge(arbiter, ray, expected, query, must_hit) != BB_RIGHT;
    }
    atomic_fetch_add_explicit(&job->oracle_wrong, oracle_wrong, memory_order_relaxed);
    atomic_fetch_add_explicit(&job->forgiven, forgiven, memory_order_relaxed);
}

/* ---- counting ---- */

static void count_classes(const judge_job *job, uint32_t count, bb_accuracy *accuracy)
{
    accuracy->first_wrong = BB_NONE;
    for (uint32_t i = 0; i < count; i++) {
        uint8_t class = job->classes[i];
        accuracy->right += class == BB_RIGHT || class == BB_TIE;
        accuracy->ties += class == BB_TIE;
        accuracy->missed += class == BB_MISSED || class == BB_UNWRITTEN;
        accuracy->false_hits += class == BB_FALSE_HIT;
        accuracy->wrong_t += class == BB_WRONG_T;
        accuracy->unwritten += class == BB_UNWRITTEN;
        if (class != BB_RIGHT && class != BB_TIE && accuracy->first_wrong == BB_NONE)
            accuracy->first_wrong = i;
    }
    accuracy->checked = count;
    uint64_t wrong = accuracy->missed + accuracy->false_hits + accuracy->wrong_t;
    accuracy->wrong_ppm = count > 0 ? 1e6 * (double)wrong / count : 0.0;
}

/* Uses up job->ulps. p99 by the nearest rank. */
static void measure_ulps(judge_job *job, uint32_t count, bb_accuracy *accuracy)
{
    accuracy->t_ulp_max = accuracy->t_ulp_p99 = NAN;
    size_t filled = 0;
    float largest = 0.0f;
    for (uint32_t i = 0; i < count; i++)
        if (!isnan(job->ulps[i])) {
            largest = fmaxf(largest, job->ulps[i]);
            job->ulps[filled++] = job->ulps[i];
        }
    if (filled == 0)
        return;
    accuracy->t_ulp_max = largest;
    accuracy->t_ulp_p99 = bb_select(job->ulps, filled, (99 * filled + 99) / 100 - 1);
}

static bb_status arbitrate(bb_oracle *oracle, judge_job *job, uint32_t count, uint64_t *arbitrated)
{
    uint32_t open = 0;
    for (uint32_t i = 0; i < count; i++)
        open += job->classes[i] == OPEN;
    *arbitrated = open;
    if (open == 0)
        return BB_OK;
    if (!oracle->has_arbiter) {
        BB_TRY(bb_arbiter_create(oracle->scene, &oracle->arbiter));
        oracle->has_arbiter = true;
    }
    BB_TRY(bb_host_alloc(NULL, open * sizeof *job->open, "rays to arbitrate", &job->open));
    open = 0;
    for (uint32_t i = 0; i < count; i++)
        if (job->classes[i] == OPEN)
            job->open[open++] = i;
    bb_parallel_for(oracle->pool, open, SLOW_CHUNK, slow_chunk, job);
    return BB_OK;
}

bb_status bb_judge(bb_oracle *oracle, const bb_answers *answers, const bb_hit *hits, uint32_t count,
                   uint8_t *classes, bb_accuracy *accuracy)
{
    double start = bb_wall_ms();
    memset(accuracy, 0, sizeof *accuracy);
    if (count > answers->rays->count)
        return bb_fail(BB_INVALID, "%u hits for %u rays: give at most one per ray", count,
                       answers->rays->count);
    judge_job job = {.oracle = oracle,
                     .rays = answers->rays,
                     .hits = hits,
                     .expected = answers->hits,
                     .classes = classes};
    uint8_t *own = NULL;
    bb_status status = BB_OK;
    if (classes == NULL) {
        status = bb_host_alloc(NULL, count, "classes of rays", &own);
        job.classes = own;
    }
    if (status == BB_OK)
        status = bb_host_alloc(NULL, count * sizeof *job.ulps, "errors of t", &job.ulps);
    if (status != BB_OK)
        goto out;
    bb_parallel_for(oracle->pool, count, QUICK_CHUNK, quick_chunk, &job);
    status = arbitrate(oracle, &job, count, &accuracy->arbitrated);
    if (status != BB_OK)
        goto out;
    count_classes(&job, count, accuracy);
    measure_ulps(&job, count, accuracy);
    accuracy->margin_limited = atomic_load(&job.margin_limited);
    accuracy->oracle_wrong = atomic_load(&job.oracle_wrong);
    accuracy->forgiven = atomic_load(&job.forgiven);
    accuracy->judge_ms = bb_wall_ms() - start;
out:
    bb_host_free(job.open);
    bb_host_free(job.ulps);
    bb_host_free(own);
    return status;
}
