/* Simulates scouts, then the pairs that they leave. */
#include "framework/advise/simulated.h"

#include "framework/advise/forecast.h"
#include "framework/advise/scouts.h"
#include "framework/base/interrupt.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- one list of contenders ---- */

/* Simulates all contenders of the list, in turns that fit into memory. */
static bb_status simulate(bb_advice *advice, const bb_heat *heat, const char *what,
                          bb_entered *field)
{
    const bb_advise_request *r = advice->request;
    bb_results *results;
    bb_bench_outcome outcome = {0};
    bb_heat named = *heat;
    char name[128];
    snprintf(name, sizeof name, "%s, %s", heat->simulation, what);
    named.name = name;
    bb_progress_note(heat->progress, "%s: %u %s simulated: %s", r->scene, field->count, what,
                     heat->simulation);
    BB_TRY(bb_results_create(&(bb_context){r->device, r->seed, r->command}, &results));
    const bb_status status = bb_heat_run(r, &named, field, results, &outcome);
    advice->taken.held_bytes = fmax(advice->taken.held_bytes, (double)outcome.bytes_held);
    for (uint32_t i = 0; i < field->count; i++)
        field->figures[i].build = field->figures[i].trace = NULL;
    bb_results_destroy(results);
    return status;
}

/* ---- a course ---- */

/* What is simulated: the contenders of the advice, by the kernels that have bounds, and by
 * `exact`, whose code is known. */
typedef struct parts {
    const bb_tried *builders, *kernels;
    bb_tried exact;
} parts;

static parts parts_of(const bb_advise_request *r)
{
    return (parts){&r->builders,
                   &r->simulated_kernels,
                   {.items = {(char *)bb_tried_exact(&r->intersectors)}, .count = 1}};
}

/* Scouts are of use if they are fewer than all pairs. An exhaustive search has none. */
static bool has_scouts(const bb_advise_request *r)
{
    return r->builders.count > 1 && r->simulated_kernels.count > 1 && !r->exhaustive;
}

static bb_status scout(bb_advice *advice, const bb_heat *heat, const parts *p,
                       bb_simulated_advice *s)
{
    BB_TRY(bb_scouts_enter(p->builders, p->kernels, &p->exact, &s->kernels));
    BB_TRY(simulate(advice, heat, "kernels", &s->kernels));
    const uint32_t best = bb_race_best(s->kernels.racers, s->kernels.count);
    const char *kernel = best != BB_NO_RACER ? s->kernels.who[best].kernel : p->kernels->items[0];
    BB_TRY(bb_scouts_enter_builders(p->builders, kernel, &p->exact, &s->builders));
    BB_TRY(simulate(advice, heat, "builders", &s->builders));
    bb_race_drop_least(s->kernels.racers, s->kernels.count, BB_SCOUT_SLACK);
    bb_race_drop_least(s->builders.racers, s->builders.count, BB_SCOUT_SLACK);
    return BB_OK;
}

static bb_status run_course(bb_advice *advice, const bb_heat *heat, bb_simulated_advice *s)
{
    const parts p = parts_of(advice->request);
    uint32_t count;
    if (has_scouts(advice->request))
        BB_TRY(scout(advice, heat, &p, s));
    bb_contender *who = bb_contenders_make(p.builders, p.kernels, &p.exact, &count);
    if (who != NULL && s->kernels.count > 0) {
        count = bb_scouts_keep(&s->kernels, who, count);
        count = bb_scouts_keep_builders(&s->builders, who, count);
    }
    BB_TRY(bb_entered_make(who, count, &s->field));
    BB_TRY(simulate(advice, heat, "configurations", &s->field));
    bb_choose_least(&s->field, &s->best, &s->choice, &s->within);
    return BB_OK;
}

/* A kernel has two layouts here: one that is timed, and one in preorder. */
static bb_sizes half_of(const bb_sizes *sizes)
{
    bb_sizes half = *sizes;
    half.room /= 2;
    return half;
}

static bb_heat heat_of(const bb_heat *all_rays, const bb_sizes *sizes, char *metric,
                       const char *simulation)
{
    bb_heat heat = *all_rays;
    heat.repeats = 1; /* times are not asked for */
    heat.last = true;
    heat.sizes = sizes;
    heat.metric = metric;
    heat.simulation = simulation;
    heat.guess = NULL;
    return heat;
}

bb_status bb_simulated_run(bb_advice *advice, const bb_heat *all_rays)
{
    const bb_advise_request *r = advice->request;
    const bb_sizes sizes = half_of(&advice->sizes);
    for (uint32_t i = 0; i < r->simt_count && !bb_interrupted(); i++) {
        bb_simulated_advice *s = &advice->simulated[i];
        snprintf(s->name, sizeof s->name, "%s", r->simts[i].name);
        const bb_heat heat = heat_of(all_rays, &sizes, r->metrics[i], s->name);
        BB_TRY(run_course(advice, &heat, s));
        advice->simulated_count += !bb_interrupted();
    }
    return BB_OK;
}

void bb_simulated_free(bb_advice *advice)
{
    for (uint32_t i = 0; i < BB_SIMT_MAX; i++) {
        bb_entered_free(&advice->simulated[i].kernels);
        bb_entered_free(&advice->simulated[i].builders);
        bb_entered_free(&advice->simulated[i].field);
    }
}

/* ---- forecast ---- */

/* Contenders of a course, if the scouts leave a quarter of all pairs. */
static double contenders_of(const bb_advise_request *r)
{
    const double builders = (double)r->builders.count, kernels = (double)r->simulated_kernels.count;
    return has_scouts(r) ? builders + kernels + ceil(builders * kernels / 4) : builders * kernels;
}

/* Builds of the whole scene by all builders: two rounds, by the scouts and by what they leave. */
static double builds_ms(const bb_advice *advice)
{
    double ms = 0;
    for (uint32_t i = 0; i < advice->builders.count; i++)
        if (advice->builders.figures[i].measured)
            ms += 2 * advice->builders.figures[i].build_ms;
    return has_scouts(advice->request) ? 2 * ms : ms;
}

bb_status bb_simulated_foretell(const bb_advice *advice, const bb_heat *all_rays, double *seconds)
{
    const bb_advise_request *r = advice->request;
    const parts p = parts_of(r);
    const bb_contender first = {p.builders->items[bb_tried_scout(p.builders)], p.kernels->items[0],
                                p.exact.items[0]};
    bb_contender *who = malloc(sizeof *who);
    bb_heat heat = heat_of(all_rays, NULL, r->metrics[0], NULL);
    bb_entered probe;
    bb_results *results;
    bb_bench_outcome outcome = {0};
    heat.ground = &advice->sample;
    if (who != NULL)
        *who = first;
    BB_TRY(bb_entered_make(who, 1, &probe));
    bb_status status = bb_results_create(&(bb_context){r->device, r->seed, r->command}, &results);
    if (status == BB_OK) {
        status = bb_heat_run(r, &heat, &probe, results, &outcome);
        *seconds = r->simt_count / 1e3 *
                   (builds_ms(advice) +
                    contenders_of(r) * (outcome.times.total_ms - bb_forecast_compiled_ms(results)));
        bb_results_destroy(results);
    }
    bb_entered_free(&probe);
    return status;
}
