/* Rays that no tracer has seen: whoever answers them rightly, in the time of its other rounds,
 * traces each time. A tracer that keeps answers is slower then, or wrong.
 *
 * They are the rays of the set in reversed order, each a little aside, as nobody can foresee. Those
 * that are built in are not tried: their sources are here. */
#include "framework/bench/bench_cell.h"

#include "framework/base/memory.h"

#include <math.h>
#include <string.h>

enum { TRIES = 4 };

static const double aside = 1e-3; /* of the direction's largest component */
/* More wrong answers than to the rays of the set, per million, than such rays can explain. */
static const double more_wrong_ppm = 10000;

static bb_status make_rays(bb_bench *bench, const bb_rays *from, bb_rays *rays)
{
    *rays = *from;
    rays->must_hit = false;
    rays->width = rays->height = 0;
    rays->rays = NULL;
    memset(&rays->on_device, 0, sizeof rays->on_device);
    BB_TRY(bb_host_alloc(NULL, from->count * sizeof *rays->rays, "unseen rays", &rays->rays));
    for (uint32_t i = 0; i < from->count; i++) {
        const bb_ray ray = from->rays[from->count - 1 - i];
        const double size =
            fmax(fabs((double)ray.d[0]), fmax(fabs((double)ray.d[1]), fabs((double)ray.d[2])));
        double d[3];
        for (int k = 0; k < 3; k++)
            d[k] = ray.d[k] + size * bb_random_range(&bench->unseen, -aside, aside);
        rays->rays[i] = ray;
        (void)bb_ray_set_direction(&rays->rays[i], d); /* else it stays what it is */
    }
    rays->hash = bb_rays_hash(rays);
    return BB_OK;
}

/* Traces them once, in the place of the set's. */
static bb_status trace(bb_trace_set *set, bb_traced_cell *c, bb_rays *rays, double *ms)
{
    bb_timing timing;
    bb_rays *own = set->rays;
    set->rays = rays;
    set->loaded = 0;
    const bb_status status = bb_trace_once(set, c, &timing);
    set->rays = own;
    set->loaded = 0;
    *ms = status == BB_OK ? timing.ms : (double)NAN;
    return status;
}

static bb_status check_answers(const bb_trace_set *set, const bb_traced_cell *c,
                               bb_answers *answers)
{
    bb_accuracy accuracy;
    const bb_verdict_request wanted = {
        .results = set->results, .count = c->count, .may_be_unnamed = true};
    BB_TRY(bb_judge(set->bench->oracle, answers, &wanted, &accuracy));
    if (accuracy.wrong_ppm <= c->record.accuracy.wrong_ppm + more_wrong_ppm)
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "it remembers answers: of rays that it had not seen it answers %.3g per million "
                   "wrong, of the others %.3g",
                   accuracy.wrong_ppm, c->record.accuracy.wrong_ppm);
}

/* Whoever is slow each time, beside its slowest counted round, is asked no more. */
static bb_status check_time(bb_trace_set *set, bb_traced_cell *c, double ms)
{
    const double times = 1.5, caches_ms = 0.2;
    double slowest = 0, fastest = ms;
    for (uint32_t i = 1; i < c->record.ms.count; i++)
        slowest = fmax(slowest, c->record.ms.values[i]);
    const double most = times * slowest + caches_ms;
    for (int i = 1; i < TRIES && fastest > most; i++) {
        bb_rays rays;
        BB_TRY(make_rays(set->bench, set->rays, &rays));
        const bb_status status = trace(set, c, &rays, &ms);
        bb_host_free(rays.rays);
        BB_TRY(status);
        fastest = fmin(fastest, ms);
    }
    if (fastest <= most)
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "it remembers answers: of %d sets of rays that it had not seen it traced the "
                   "fastest in %.3g ms, and the slowest of its other rounds took %.3g ms",
                   TRIES, fastest, slowest);
}

static bool is_tried(const bb_traced_cell *c)
{
    const bb_tracer *tracer = c->entrant->tracer;
    return tracer != NULL && !bb_tracer_is_builtin(tracer) && c->record.status == BB_OK &&
           c->record.ms.count > 1;
}

static bb_status try_cell(bb_trace_set *set, bb_traced_cell *c, bb_rays *rays, bb_answers *answers)
{
    double ms;
    BB_TRY(trace(set, c, rays, &ms));
    BB_TRY(check_answers(set, c, answers));
    return check_time(set, c, ms);
}

static bb_status try_all(bb_trace_set *set)
{
    bb_rays rays;
    bb_answers answers = {0};
    BB_TRY(make_rays(set->bench, set->rays, &rays));
    bb_status status = bb_answers_make(set->bench->oracle, &rays, &answers);
    for (uint32_t i = 0; i < set->count && status == BB_OK && !bb_interrupted(); i++) {
        if (!is_tried(&set->cells[i]))
            continue;
        const bb_status tried = try_cell(set, &set->cells[i], &rays, &answers);
        if (tried != BB_OK)
            bb_trace_note_failure(&set->cells[i], tried);
    }
    bb_answers_release(&answers);
    bb_host_free(rays.rays);
    return status;
}

bb_status bb_trace_unseen(bb_trace_set *set)
{
    bool any = false;
    for (uint32_t i = 0; i < set->count; i++)
        any = any || is_tried(&set->cells[i]);
    if (!any || bb_interrupted())
        return BB_OK;
    bb_step step = bb_bench_begin(set->bench);
    return bb_bench_end(set->bench, step, "unseen rays", try_all(set));
}
