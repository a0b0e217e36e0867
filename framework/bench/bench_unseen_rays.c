/* Rays that no tracer has seen: whoever answers them rightly, in the time of its other rounds,
 * traces each time. A tracer that keeps answers is slower then, or wrong.
 *
 * They are the rays of the set in reversed order, each a little aside, and each eighth with the
 * direction of another, as nobody can foresee. Processor time is compared, which other programs
 * hardly change. Tracers that are built in are not tried: their sources are here. */
#include "framework/bench/bench_cell.h"

#include "framework/base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TRIES = 4, ELSEWHERE = 8 };

static bb_status make_rays(bb_bench *bench, const bb_rays *from, bb_rays *rays)
{
    const double aside = 1e-3; /* of the direction's largest component */
    const uint32_t turn = bb_random_below(&bench->unseen, ELSEWHERE);
    *rays = *from;
    rays->must_hit = false;
    rays->width = rays->height = 0;
    rays->rays = NULL;
    memset(&rays->on_device, 0, sizeof rays->on_device);
    BB_TRY(bb_host_alloc(NULL, from->count * sizeof *rays->rays, "unseen rays", &rays->rays));
    for (uint32_t i = 0; i < from->count; i++) {
        const uint32_t own = from->count - 1 - i;
        const uint32_t other = bb_random_below(&bench->unseen, from->count);
        const float *like = from->rays[i % ELSEWHERE == turn ? other : own].d;
        const double size = fmax(fabs(like[0]), fmax(fabs(like[1]), fabs(like[2])));
        bb_ray *ray = &rays->rays[i];
        double d[3];
        *ray = from->rays[own];
        for (int k = 0; k < 3; k++)
            d[k] = like[k] + size * bb_random_range(&bench->unseen, -aside, aside);
        if (!bb_ray_set_direction(ray, d))
            *ray = from->rays[own];
    }
    rays->hash = bb_rays_hash(rays);
    return BB_OK;
}

/* Traces them once, in the place of the set's. It is no round: its time belongs to the step. */
static bb_status trace(bb_trace_set *set, bb_traced_cell *c, bb_rays *rays, double *cpu_ms)
{
    bb_timing timing = {0};
    bb_rays *own = set->rays;
    bb_bench_times *times = &set->bench->outcome->times;
    const double traced = times->trace_ms;
    set->rays = rays;
    set->loaded = 0;
    const bb_status status = bb_trace_once(set, c, &timing);
    set->rays = own;
    set->loaded = 0;
    times->trace_ms = traced;
    *cpu_ms = timing.cpu_ms;
    return status;
}

/* More wrong answers than to the rays of the set are no chance: one of a hundred more, and what
 * samples of this size differ by. Fewer by as much say that those rays are special to the tracer:
 * then their times say nothing (*comparable is false). */
static bb_status check_answers(const bb_trace_set *set, const bb_traced_cell *c,
                               bb_answers *answers, bool *comparable)
{
    bb_accuracy accuracy;
    const bb_verdict_request wanted = {
        .results = set->results, .count = c->count, .may_be_unnamed = true};
    BB_TRY(bb_bench_ready_oracle(set->bench, 0));
    BB_TRY(bb_judge(set->bench->oracle, answers, &wanted, &accuracy));
    const double seen = c->record.accuracy.wrong_ppm / 1e6, unseen = accuracy.wrong_ppm / 1e6;
    const double spread = sqrt(c->count * fmax(seen, 0.01));
    const double most = 0.01 * c->count + 5 * spread + 3;
    *comparable = c->count * (seen - unseen) <= most;
    if (c->count * (unseen - seen) <= most)
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "it remembers answers: of rays that it had not seen it answers %.3g %% wrong, "
                   "of the others %.3g %%",
                   100 * unseen, 100 * seen);
}

/* One set of rays for all tracers. */
typedef struct attempt {
    bb_rays rays;
    bb_answers answers;
} attempt;

static void release(attempt *a)
{
    bb_answers_release(&a->answers);
    bb_host_free(a->rays.rays);
}

static bb_status prepare(bb_trace_set *set, attempt *a)
{
    *a = (attempt){.rays = {.rays = NULL}};
    BB_TRY(make_rays(set->bench, set->rays, &a->rays));
    BB_TRY(bb_bench_ready_oracle(set->bench, 0));
    return bb_answers_make(set->bench->oracle, &a->rays, &a->answers);
}

/* Traces and judges; *slow: it took long beside the rounds that count. */
static bb_status try_once(bb_trace_set *set, bb_traced_cell *c, attempt *a, double *cpu_ms,
                          bool *slow)
{
    const double times = 1.5, caches_ms = 0.5;
    bool comparable;
    BB_TRY(trace(set, c, &a->rays, cpu_ms));
    BB_TRY(check_answers(set, c, &a->answers, &comparable));
    *slow = comparable && *cpu_ms > times * bb_samples_median(&c->record.cpu_ms) + caches_ms;
    return BB_OK;
}

/* Whoever was slow with the first set gets others, each right: only who is slow each time fails. */
static bb_status try_again(bb_trace_set *set, bb_traced_cell *c, double fastest)
{
    bool slow = true;
    for (int i = 1; i < TRIES && slow; i++) {
        attempt a;
        double cpu_ms = 0;
        bb_status status = prepare(set, &a);
        if (status == BB_OK)
            status = try_once(set, c, &a, &cpu_ms, &slow);
        release(&a);
        BB_TRY(status);
        fastest = fmin(fastest, cpu_ms);
    }
    if (!slow)
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "it remembers answers: of %d sets of rays that it had not seen the fastest took "
                   "%.3g ms of processors, and its other rounds %.3g ms",
                   TRIES, fastest, bb_samples_median(&c->record.cpu_ms));
}

static bool is_tried(const bb_traced_cell *c)
{
    const bb_entrant *entrant = c->entrant;
    return entrant->tracer != NULL && entrant->tracing != NULL &&
           !bb_tracer_is_builtin(entrant->tracer) && c->record.status == BB_OK &&
           c->record.ms.count > 1;
}

static void try_cell(bb_trace_set *set, bb_traced_cell *c, attempt *first)
{
    double cpu_ms;
    bool slow;
    bb_status status = try_once(set, c, first, &cpu_ms, &slow);
    if (status == BB_OK && slow)
        status = try_again(set, c, cpu_ms);
    if (status == BB_REFUSED)
        bb_progress_note(set->bench->progress, "%s: %s is not tried on unseen rays: %s",
                         set->rays->name, c->record.builder, bb_message());
    else if (status != BB_OK)
        bb_trace_note_failure(c, status);
}

static void try_all(bb_trace_set *set)
{
    attempt a;
    if (prepare(set, &a) != BB_OK)
        bb_progress_note(set->bench->progress, "%s: no tracer is tried on unseen rays: %s",
                         set->rays->name, bb_message());
    else
        for (uint32_t i = 0; i < set->count && !bb_interrupted(); i++)
            if (is_tried(&set->cells[i]))
                try_cell(set, &set->cells[i], &a);
    release(&a);
}

bb_status bb_trace_unseen(bb_trace_set *set)
{
    bool any = false;
    for (uint32_t i = 0; i < set->count; i++)
        any = any || is_tried(&set->cells[i]);
    if (!any || bb_interrupted())
        return BB_OK;
    bb_step step = bb_bench_begin(set->bench);
    try_all(set);
    return bb_bench_end(set->bench, step, "unseen rays", BB_OK);
}
