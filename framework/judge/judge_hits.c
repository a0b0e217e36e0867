/* Judges hits in two passes, each on all cores, and counts the classes. The first pass is cheap and
 * settles answers that are already proved right; the second takes the rest to the arbiter. */
#include "framework/judge/judge_hits.h"

#include "framework/base/memory.h"
#include "framework/base/statistics.h"
#include "framework/judge/oracle_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OPEN = 255, QUICK_CHUNK = 4096, SLOW_CHUNK = 64 };

/* Flags of a verdict. */
enum { LIMITED = 1, FORGIVEN = 2, T_OFF = 4 };

typedef struct verdict {
    float ulps; /* error of t of a right hit; NAN: not measured */
    uint8_t class;
    uint8_t flags;
} verdict;

/* The first judged answers of a set; other answers are often the same. */
struct bb_judged {
    uint32_t count;
    bb_hit *hits;
    verdict *verdicts;
};

void bb_judged_release(bb_answers *answers)
{
    if (answers->judged != NULL) {
        bb_host_free(answers->judged->hits);
        bb_host_free(answers->judged->verdicts);
    }
    free(answers->judged);
    answers->judged = NULL;
}

typedef struct job {
    const bb_oracle *oracle;
    const bb_answers *answers;
    const bb_verdict_request *request;
    const bb_hit *hits; /* request->results */
    verdict *verdicts;
    uint32_t *open; /* rays that go to the arbiter */
} job;

/* ---- one answer ---- */

static bool is_unnamed(const job *job, const bb_hit *hit)
{
    return job->answers->rays->query->any && hit->prim == BB_UNNAMED;
}

/* Returns whether a tracer wrote this: a miss is (inf, BB_NONE), a hit a number and a primitive. */
static bool is_written(const job *job, const bb_hit *hit)
{
    if (is_unnamed(job, hit))
        return job->request->may_be_unnamed;
    if (hit->prim == BB_NONE)
        return isinf(hit->t) && hit->t > 0.0f;
    return hit->prim < job->oracle->scene->prim_count && isfinite(hit->t);
}

static bool is_named(const job *job, const bb_hit *hit)
{
    return hit->prim < job->oracle->scene->prim_count;
}

/* Returns whether eps is so large, compared with the primitive, that a float cannot tell whether
 * the ray meets it. */
static bool is_limited(const job *job, const bb_ray *ray, const bb_hit *hit)
{
    return is_named(job, hit) && bb_margin(job->oracle->scene, ray, hit->prim) >
                                     0.25 * (double)job->oracle->heights[hit->prim];
}

/* Notes the error of a right t, in units in the last place of a float at `exact`, and whether it is
 * large. */
static void note_error(verdict *v, float t, double exact)
{
    int exponent;
    frexp(exact, &exponent);
    double ulp = ldexp(1.0, exponent - 24 > -149 ? exponent - 24 : -149);
    double error = fabs((double)t - exact);
    v->ulps = (float)(error / ulp);
    v->flags |= error > 0x1p-10 * fabs(exact) ? T_OFF : 0;
}

/* Returns the class of an answer that needs no arbiter, else OPEN. */
static uint8_t judge_quickly(const job *job, size_t i, verdict *v)
{
    const bb_scene *scene = job->oracle->scene;
    const bb_rays *rays = job->answers->rays;
    const bb_ray *ray = &rays->rays[i];
    const bb_hit *hit = &job->hits[i], *expected = &job->answers->hits[i];
    uint8_t shown = job->answers->shown[i];
    if (!is_written(job, hit))
        return BB_UNWRITTEN;
    if (is_limited(job, ray, hit) || is_limited(job, ray, expected))
        v->flags |= LIMITED;
    if (hit->prim == BB_NONE) {
        if (rays->must_hit)
            return BB_MISSED;
        return expected->prim == BB_NONE && shown == BB_ORACLE_SURE ? BB_RIGHT : OPEN;
    }
    if (is_unnamed(job, hit))
        return is_unnamed(job, expected) && shown == BB_ORACLE_SURE ? BB_RIGHT : OPEN;
    if (!rays->query->any && (shown != BB_ORACLE_SURE || hit->prim != expected->prim))
        return OPEN;
    double t;
    if (!bb_exact_first(scene, ray, hit->prim, &t) ||
        fabs((double)hit->t - t) > bb_t_margin(scene, ray, hit->prim))
        return OPEN;
    note_error(v, hit->t, t);
    return BB_RIGHT;
}

static void quick_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    const job *job = context;
    const struct bb_judged *judged = job->answers->judged;
    for (size_t i = begin; i < end; i++) {
        verdict *v = &job->verdicts[i];
        const bb_hit *hit = &job->hits[i];
        if (judged != NULL && i < judged->count && !is_unnamed(job, hit) &&
            memcmp(hit, &judged->hits[i], sizeof *hit) == 0) {
            *v = judged->verdicts[i];
            continue;
        }
        *v = (verdict){.ulps = NAN};
        v->class = judge_quickly(job, i, v);
    }
}

static void slow_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    const job *job = context;
    const bb_arbiter *arbiter = &job->oracle->arbiter;
    const bb_rays *rays = job->answers->rays;
    for (size_t n = begin; n < end; n++) {
        uint32_t i = job->open[n];
        verdict *v = &job->verdicts[i];
        const bb_ray *ray = &rays->rays[i];
        const bb_hit *hit = &job->hits[i], *expected = &job->answers->hits[i];
        v->class = (uint8_t)bb_arbiter_judge(arbiter, ray, hit, rays->query, rays->must_hit);
        if (v->class != BB_RIGHT)
            continue;
        if (!rays->must_hit && bb_arbiter_forgives(arbiter, ray, hit, rays->query))
            v->flags |= FORGIVEN;
        double t;
        if (is_named(job, hit) && bb_exact_t(arbiter->scene, ray, hit->prim, hit->t, &t))
            note_error(v, hit->t, t);
        if (!rays->query->any && is_named(job, hit) && is_named(job, expected) &&
            hit->prim != expected->prim)
            v->class = BB_TIE;
    }
}

/* ---- all of them ---- */

static bb_status arbitrate(bb_oracle *oracle, job *job, uint64_t *arbitrated)
{
    uint32_t open = 0, count = job->request->count;
    for (uint32_t i = 0; i < count; i++)
        open += job->verdicts[i].class == OPEN;
    *arbitrated = open;
    if (open == 0)
        return BB_OK;
    BB_TRY(bb_host_alloc(NULL, open * sizeof *job->open, "rays to arbitrate", &job->open));
    open = 0;
    for (uint32_t i = 0; i < count; i++)
        if (job->verdicts[i].class == OPEN)
            job->open[open++] = i;
    bb_parallel_for(oracle->pool, open, SLOW_CHUNK, slow_chunk, job);
    return BB_OK;
}

static void count_verdicts(const job *job, bb_accuracy *accuracy)
{
    uint32_t count = job->request->count;
    accuracy->first_wrong = BB_NONE;
    for (uint32_t i = 0; i < count; i++) {
        uint8_t class = job->verdicts[i].class, flags = job->verdicts[i].flags;
        accuracy->right += class == BB_RIGHT || class == BB_TIE;
        accuracy->ties += class == BB_TIE;
        accuracy->missed += class == BB_MISSED || class == BB_UNWRITTEN;
        accuracy->false_hits += class == BB_FALSE_HIT;
        accuracy->wrong_t += class == BB_WRONG_T;
        accuracy->unwritten += class == BB_UNWRITTEN;
        accuracy->margin_limited += (flags & LIMITED) != 0;
        accuracy->forgiven += (flags & FORGIVEN) != 0;
        accuracy->t_off += (flags & T_OFF) != 0;
        accuracy->oracle_wrong += job->answers->shown[i] == BB_ORACLE_WRONG;
        if (class != BB_RIGHT && class != BB_TIE && accuracy->first_wrong == BB_NONE)
            accuracy->first_wrong = i;
        if (job->request->classes != NULL)
            job->request->classes[i] = class;
    }
    accuracy->checked = count;
    uint64_t wrong = accuracy->missed + accuracy->false_hits + accuracy->wrong_t;
    accuracy->wrong_ppm = count > 0 ? 1e6 * (double)wrong / count : 0.0;
}

/* Measures the errors of t; p99 is taken by nearest rank. */
static bb_status measure_ulps(const job *job, bb_accuracy *accuracy)
{
    float *ulps = NULL, largest = 0.0f;
    BB_TRY(bb_host_alloc(NULL, job->request->count * sizeof *ulps, "errors of t", &ulps));
    accuracy->t_ulp_max = accuracy->t_ulp_p99 = NAN;
    size_t filled = 0;
    for (uint32_t i = 0; i < job->request->count; i++)
        if (!isnan(job->verdicts[i].ulps)) {
            largest = fmaxf(largest, job->verdicts[i].ulps);
            ulps[filled++] = job->verdicts[i].ulps;
        }
    if (filled > 0) {
        accuracy->t_ulp_max = largest;
        accuracy->t_ulp_p99 = bb_select(ulps, filled, (99 * filled + 99) / 100 - 1);
    }
    bb_host_free(ulps);
    return BB_OK;
}

/* Keeps the first verdicts on a set. */
static bb_status remember(bb_answers *answers, job *job)
{
    if (answers->judged != NULL)
        return BB_OK;
    struct bb_judged *judged = calloc(1, sizeof *judged);
    if (judged == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    answers->judged = judged;
    size_t bytes = job->request->count * sizeof *judged->hits;
    BB_TRY(bb_host_alloc(NULL, bytes, "judged answers", &judged->hits));
    memcpy(judged->hits, job->hits, bytes);
    judged->verdicts = job->verdicts;
    judged->count = job->request->count;
    job->verdicts = NULL;
    return BB_OK;
}

bb_status bb_judge_hits(bb_oracle *oracle, bb_answers *answers, const bb_verdict_request *request,
                        bb_accuracy *accuracy)
{
    job job = {.oracle = oracle, .answers = answers, .request = request, .hits = request->results};
    BB_TRY(bb_oracle_prepare(oracle));
    BB_TRY(bb_host_alloc(NULL, request->count * sizeof *job.verdicts, "verdicts on rays",
                         &job.verdicts));
    bb_parallel_for(oracle->pool, request->count, QUICK_CHUNK, quick_chunk, &job);
    bb_status status = arbitrate(oracle, &job, &accuracy->arbitrated);
    if (status == BB_OK) {
        count_verdicts(&job, accuracy);
        status = measure_ulps(&job, accuracy);
    }
    if (status == BB_OK)
        status = remember(answers, &job);
    bb_host_free(job.open);
    bb_host_free(job.verdicts);
    return status;
}

void bb_hit_say(const void *result, char *text, size_t capacity)
{
    const bb_hit *hit = result;
    if (hit->prim == BB_NONE)
        snprintf(text, capacity, "a miss");
    else
        snprintf(text, capacity, "primitive %u at %a", hit->prim, (double)hit->t);
}
