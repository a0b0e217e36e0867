/* The course of an advice: scouts, race, choice, savings, exhaustive search. */
#include "framework/advise/advise.h"

#include "framework/advise/advice.h"
#include "framework/advise/forecast.h"
#include "framework/advise/ground.h"
#include "framework/advise/heat.h"
#include "framework/advise/savings.h"
#include "framework/advise/scouts.h"
#include "framework/advise/simulated.h"
#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/base/memory.h"
#include "framework/base/progress.h"
#include "framework/builder/instance.h"
#include "framework/builder/tracers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    HEATS_MAX = 3,
    DOCUMENTS_MAX = 8,
    ROUNDS = 8,        /* in heats before the last (race.h has the probability of an error) */
    LEAST_RAYS = 1024, /* per sampled kind, enough for kinds with many rays per hit */
};

typedef struct course {
    const bb_advise_request *request;
    bb_advice advice;
    const char *guess; /* the builder that is probably the fastest; NULL: unknown */
    bb_progress progress;
    bb_results *documents[DOCUMENTS_MAX]; /* of all comparisons except the last */
    uint32_t document_count;
    bb_results *results; /* this and the next two are the caller's */
    bb_bench_outcome *outcome;
    bb_table *table;
} course;

/* ---- comparisons ---- */

/* Makes a document for one comparison. It is kept until the end, since figures point into it. */
static bb_status add_document(course *c, bb_results **out)
{
    const bb_advise_request *request = c->request;
    const bb_context context = {request->device, request->seed, request->command};
    if (c->document_count == DOCUMENTS_MAX)
        return bb_fail(BB_FAILED, "advise: more than %d comparisons", DOCUMENTS_MAX);
    BB_TRY(bb_results_create(&context, out));
    c->documents[c->document_count++] = *out;
    return BB_OK;
}

/* Takes the scene from the first document that has it, since the last one may be empty. */
static void note_scene(course *c, const bb_results *document)
{
    if (c->advice.scene == NULL)
        c->advice.scene = bb_first(bb_results_section(document, BB_SCENES));
}

static void note_held(course *c, const bb_bench_outcome *outcome)
{
    c->advice.taken.held_bytes = fmax(c->advice.taken.held_bytes, (double)outcome->bytes_held);
}

/* Copies measurements before an interrupt or a failure to the caller's document. */
static bb_status keep_document(course *c, const bb_results *document,
                               const bb_bench_outcome *outcome)
{
    if (bb_first(bb_results_section(document, BB_BUILDS)) == NULL)
        return BB_OK;
    c->outcome->times = outcome->times;
    return bb_results_merge(c->results, document);
}

/* Keeps the document, and returns the failure with its message. */
static bb_status keep_failed(course *c, const bb_results *document, const bb_bench_outcome *outcome,
                             bb_status failure)
{
    char reason[1024];
    snprintf(reason, sizeof reason, "%s", bb_message());
    (void)keep_document(c, document, outcome);
    return bb_fail(failure, "%s", reason);
}

/* Measures a heat into a document of its own. Complaints about its clocks are added to the caller's
 * outcome. `outcome` may be NULL. */
static bb_status compare(course *c, const bb_heat *heat, bb_entered *field,
                         bb_bench_outcome *outcome, bb_results **document)
{
    bb_bench_outcome own = {0};
    BB_TRY(add_document(c, document));
    const bb_status measured = bb_heat_run(c->request, heat, field, *document, &own);
    if (measured != BB_OK)
        return keep_failed(c, *document, &own, measured);
    bb_audit_add(&c->outcome->audit, &own.audit);
    if (heat->ground == &c->advice.whole)
        note_scene(c, *document);
    note_held(c, &own);
    if (outcome != NULL)
        *outcome = own;
    return bb_interrupted() ? keep_document(c, *document, &own) : BB_OK;
}

/* Measures a heat into the caller's document. */
static bb_status compare_last(course *c, const bb_heat *heat, bb_entered *field)
{
    bb_bench_outcome outcome = {0};
    BB_TRY(bb_heat_run(c->request, heat, field, c->results, &outcome));
    outcome.wrong = outcome.unbuilt = outcome.unjudged = 0; /* they are no failure of an advice */
    bb_bench_outcome_add(c->outcome, &outcome);
    note_scene(c, c->results);
    note_held(c, &outcome);
    return BB_OK;
}

static uint32_t racing(const bb_entered *field)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < field->count; i++)
        count += field->racers[i].state == BB_RACING;
    return count;
}

/* ---- scouts ---- */

static bb_heat few_rays(course *c, uint32_t shift)
{
    const bb_advise_request *request = c->request;
    uint32_t side = shift / 2;
    bb_heat heat = {.width = request->width >> side,
                    .height = request->height >> side,
                    .max_rays = request->max_rays >> shift,
                    .repeats = ROUNDS,
                    .ground = &c->advice.whole,
                    .sizes = &c->advice.sizes,
                    .guess = c->guess,
                    .progress = &c->progress};
    const uint32_t least = request->max_rays < LEAST_RAYS ? request->max_rays : LEAST_RAYS;
    heat.width = heat.width > 0 ? heat.width : 1;
    heat.height = heat.height > 0 ? heat.height : 1;
    heat.max_rays = heat.max_rays > least ? heat.max_rays : least;
    return heat;
}

static bb_heat all_rays(course *c)
{
    bb_heat heat = few_rays(c, 0);
    heat.repeats = c->request->repeats;
    heat.last = true;
    return heat;
}

static bb_heat of_scouts(course *c, const char *name)
{
    bb_heat heat = few_rays(c, 4);
    heat.ground = &c->advice.sample;
    heat.sizes = NULL;
    heat.name = name;
    return heat;
}

static bb_scouts_drop *drop_of_scouts(const bb_advice *advice)
{
    return advice->sample.factor > 1 ? bb_race_drop_least : bb_race_drop;
}

static bool is_worth_scouting(const bb_advise_request *r)
{
    return r->builders.count > 1 && r->kernels.count + r->intersectors.count > 2;
}

static bb_status scout_kernels(course *c)
{
    const bb_heat heat = of_scouts(c, "kernels");
    const bb_advise_request *r = c->request;
    bb_results *document;
    if (!is_worth_scouting(r) || bb_interrupted())
        return BB_OK;
    bb_entered *scouts = &c->advice.scouts;
    BB_TRY(bb_scouts_enter(&r->builders, &r->kernels, &r->intersectors, scouts));
    bb_progress_note(&c->progress, "%s: %u kernels and intersectors tried on %s", r->scene,
                     scouts->count, scouts->who[0].builder);
    BB_TRY(compare(c, &heat, scouts, NULL, &document));
    bb_scouts_judge(scouts, (uint32_t)r->kernels.count, drop_of_scouts(&c->advice),
                    c->advice.scout_slack);
    return BB_OK;
}

/* Returns the fastest kernel of the scouts. */
static const char *scouts_kernel(const course *c)
{
    const bb_entered *scouts = &c->advice.scouts;
    const bb_tried *kernels = &c->request->kernels;
    uint32_t best =
        scouts->count > 0 ? bb_race_fastest(scouts->racers, (uint32_t)kernels->count) : BB_NO_RACER;
    return best != BB_NO_RACER ? scouts->who[best].kernel : kernels->items[0];
}

static bb_status scout_builders(course *c, bb_bench_outcome *outcome, bb_results **document)
{
    const bb_heat heat = of_scouts(c, "builders");
    const bb_advise_request *r = c->request;
    bb_entered *builders = &c->advice.builders;
    if (bb_interrupted())
        return BB_OK;
    BB_TRY(bb_scouts_enter_builders(&r->builders, scouts_kernel(c), &r->intersectors, builders));
    bb_progress_note(&c->progress, "%s: %u builders tried with %s", r->scene, builders->count,
                     builders->who[0].kernel);
    BB_TRY(compare(c, &heat, builders, outcome, document));
    const uint32_t best = bb_race_fastest(builders->racers, builders->count);
    c->guess = best != BB_NO_RACER ? builders->who[best].builder : NULL;
    drop_of_scouts (&c->advice)(builders->racers, builders->count, c->advice.scout_slack);
    return BB_OK;
}

/* ---- forecast ---- */

/* Adds the time of simulations to the forecast. */
static bb_status foretell_simulations(course *c)
{
    const bb_heat heat = all_rays(c);
    double seconds = 0;
    if (c->request->simt_count > 0)
        BB_TRY(bb_simulated_foretell(&c->advice, &heat, &seconds));
    c->advice.foretold.seconds += seconds;
    return BB_OK;
}

static bb_status foretell(course *c, const bb_bench_outcome *scouted, const bb_results *document)
{
    bb_advice *advice = &c->advice;
    const double first = ROUNDS + 1, last = c->request->repeats + 1;
    const bb_forecast_heat quick[] = {{first, 1}, {last, 16}, {last, 16}},
                           full[] = {{first, 1}, {first, 4}, {last, 16}, {last, 16}};
    char text[400];
    if (bb_interrupted())
        return BB_OK;
    advice->foretold =
        c->request->quick
            ? bb_forecast(advice, quick, 3, &scouted->times, document, (double)bb_host_peak())
            : bb_forecast(advice, full, 4, &scouted->times, document, (double)bb_host_peak());
    BB_TRY(foretell_simulations(c));
    bb_takings_say(&advice->foretold, text, sizeof text);
    bb_progress_note(&c->progress, "%s: %u of %zu configurations are left; about %s",
                     c->request->scene, advice->field.count,
                     c->request->builders.count * c->request->kernels.count *
                         c->request->intersectors.count,
                     text);
    return BB_OK;
}

/* Enters all contenders that the scouts left. */
static bb_status enter_field(course *c)
{
    const bb_advise_request *r = c->request;
    bb_bench_outcome scouted = {0};
    bb_results *document = NULL;
    uint32_t count;
    BB_TRY(scout_kernels(c));
    BB_TRY(scout_builders(c, &scouted, &document));
    bb_contender *who = bb_contenders_make(&r->builders, &r->kernels, &r->intersectors, &count);
    if (who != NULL) {
        count = bb_scouts_keep(&c->advice.scouts, who, count);
        count = bb_scouts_keep_builders(&c->advice.builders, who, count);
        const uint32_t before = count;
        count = bb_scouts_keep_likely(&c->advice.scouts, &c->advice.builders, who, count,
                                      BB_FORETOLD_SLACK);
        c->advice.unlikely = before - count;
    }
    BB_TRY(bb_entered_make(who, count, &c->advice.field));
    BB_TRY(foretell(c, &scouted, document));
    bb_ground_free(&c->advice.sample, &c->advice.whole);
    return BB_OK;
}

/* ---- race ---- */

static bb_status measure(void *user, uint32_t index, bb_racer *racers, uint32_t count)
{
    course *c = user;
    const bb_advise_request *r = c->request;
    const bool last = index + 1 == c->advice.heats;
    bb_heat heat = last ? all_rays(c) : few_rays(c, index == 0 ? 4 : 2);
    bb_results *document;
    char name[64];
    (void)racers;
    (void)count;
    if (bb_interrupted())
        return BB_OK;
    snprintf(name, sizeof name, "heat %u of %u", index + 1, c->advice.heats);
    heat.name = name;
    bb_progress_note(&c->progress, "%s: heat %u of %u: %u configurations, up to %u rays of a kind",
                     r->scene, index + 1, c->advice.heats, racing(&c->advice.field),
                     heat.width * heat.height > heat.max_rays ? heat.width * heat.height
                                                              : heat.max_rays);
    return last && !r->exhaustive ? compare_last(c, &heat, &c->advice.field)
                                  : compare(c, &heat, &c->advice.field, NULL, &document);
}

static bb_status race(course *c)
{
    bb_entered *field = &c->advice.field;
    return bb_race_run(field->racers, field->count, c->advice.heats, BB_ADVISE_SLACK, measure, c);
}

/* ---- search ---- */

static bool same(const bb_contender *a, const bb_contender *b)
{
    return strcmp(a->builder, b->builder) == 0 && strcmp(a->kernel, b->kernel) == 0 &&
           strcmp(a->intersector, b->intersector) == 0;
}

static bb_status search(course *c)
{
    const bb_advise_request *r = c->request;
    bb_advice *advice = &c->advice;
    bb_heat heat = all_rays(c);
    uint32_t count, within;
    heat.name = "exhaustive search";
    bb_contender *who = bb_contenders_make(&r->builders, &r->kernels, &r->intersectors, &count);
    BB_TRY(bb_entered_make(who, count, &advice->all));
    bb_progress_note(&c->progress, "%s: exhaustive search: all %u configurations", r->scene, count);
    BB_TRY(compare_last(c, &heat, &advice->all));
    bb_choose_least(&advice->all, &advice->all_best, &advice->all_least, &within);
    advice->all_choice = BB_NONE_CHOSEN;
    for (uint32_t i = 0; advice->choice != BB_NONE_CHOSEN && i < count; i++)
        if (same(&advice->all.who[i], &advice->field.who[advice->choice]))
            advice->all_choice = i;
    return BB_OK;
}

/* ---- all of it ---- */

static bb_status save(course *c)
{
    bb_results *document;
    const bb_advise_request *r = c->request;
    bb_heat heat = all_rays(c);
    if (c->advice.choice == BB_NONE_CHOSEN || bb_interrupted())
        return BB_OK;
    bb_progress_note(&c->progress, "%s: what the choice saves", r->scene);
    heat.name = "savings";
    BB_TRY(add_document(c, &document));
    BB_TRY(bb_savings_measure(&c->advice, &heat, document, c->outcome));
    note_held(c, c->outcome);
    return BB_OK;
}

/* Makes each builder once, so that bad parameters are refused before anything is measured. */
static bb_status try_builders(const bb_advise_request *r)
{
    for (size_t i = 0; i < r->builders.count; i++)
        BB_TRY(bb_instance_try(r->device, r->builders.items[i], r->seed));
    return BB_OK;
}

static bb_status race_and_choose(course *c)
{
    BB_TRY(race(c));
    if (bb_interrupted())
        return BB_OK;
    bb_choose(&c->advice);
    BB_TRY(save(c));
    if (c->request->exhaustive && !bb_interrupted())
        BB_TRY(search(c));
    const bb_heat heat = all_rays(c);
    if (bb_simulated_run(&c->advice, &heat) != BB_OK) /* the measured advice stays as it is */
        bb_progress_note(&c->progress, "%s: not simulated: %s", c->request->scene, bb_message());
    return BB_OK;
}

/* An interrupt after the choice keeps the choice. */
static bb_status run(course *c)
{
    bb_advice *advice = &c->advice;
    const double start = bb_wall_ms();
    bb_status status = try_builders(c->request);
    if (status == BB_OK)
        status = bb_ground_load(c->request->device, c->request->scene, &advice->whole);
    if (status == BB_OK)
        status = bb_ground_sample(c->request->device, &advice->whole, &advice->sample);
    advice->scout_slack = advice->sample.factor > 1 ? BB_FORETOLD_SLACK : BB_SCOUT_SLACK;
    if (status == BB_OK)
        status = enter_field(c);
    if (status == BB_OK && !bb_interrupted())
        status = race_and_choose(c);
    if (bb_interrupted()) /* a signal also makes compilers fail */
        status = BB_OK;
    BB_TRY(status);
    if (bb_interrupted() && advice->choice == BB_NONE_CHOSEN)
        bb_choose_preliminary(advice);
    advice->taken.seconds = (bb_wall_ms() - start) / 1e3;
    advice->taken.host_bytes = (double)bb_host_peak();
    const bool nothing = bb_interrupted() && advice->choice == BB_NONE_CHOSEN;
    return nothing ? BB_OK : bb_advice_fill(advice, c->table);
}

bb_status bb_advise(const bb_advise_request *request, bb_results *results,
                    bb_bench_outcome *outcome, bb_table *table, bool *found)
{
    course *c = calloc(1, sizeof *c);
    if (c == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *outcome = (bb_bench_outcome){0};
    *c = (course){.request = request, .results = results, .outcome = outcome, .table = table};
    c->advice = (bb_advice){.request = request,
                            .heats = request->quick ? HEATS_MAX - 1 : HEATS_MAX,
                            .foretold = {NAN, NAN, NAN, NAN},
                            .sizes = {{&c->advice.scouts, &c->advice.builders}, request->memory},
                            .best = BB_NONE_CHOSEN,
                            .choice = BB_NONE_CHOSEN,
                            .all_best = BB_NONE_CHOSEN,
                            .all_least = BB_NONE_CHOSEN,
                            .all_choice = BB_NONE_CHOSEN};
    bb_progress_start(&c->progress, request->quiet);
    bb_status status = run(c);
    *found = c->advice.choice != BB_NONE_CHOSEN;
    bb_progress_end(&c->progress);
    bb_ground_free(&c->advice.sample, &c->advice.whole);
    bb_ground_free(&c->advice.whole, NULL);
    bb_entered_free(&c->advice.scouts);
    bb_entered_free(&c->advice.builders);
    bb_entered_free(&c->advice.field);
    bb_entered_free(&c->advice.all);
    bb_simulated_free(&c->advice);
    for (uint32_t i = 0; i < c->document_count; i++)
        bb_results_destroy(c->documents[i]);
    free(c);
    return status;
}

static bb_status check_simulated(const bb_advise_request *request)
{
    if (request->simulated_kernels.count == 0)
        return bb_fail(BB_INVALID,
                       "--metrics: simulations have bounds for none of the kernels, of which '%s' "
                       "is the first: add one such as stack",
                       request->kernels.items[0]);
    return bb_tried_exact(&request->intersectors) != NULL
               ? BB_OK
               : bb_fail(BB_INVALID, "--metrics: only `exact` is simulated, not '%s': add it",
                         request->intersectors.items[0]);
}

bb_status bb_advise_check(const bb_advise_request *request)
{
    const bb_bench_request bench = {.builders = request->builders.items,
                                    .builder_count = (uint32_t)request->builders.count,
                                    .kernels = request->kernels.items,
                                    .kernel_count = (uint32_t)request->kernels.count,
                                    .intersectors = request->intersectors.items,
                                    .intersector_count = (uint32_t)request->intersectors.count,
                                    .workloads = request->rays,
                                    .workload_count = request->ray_count,
                                    .metrics = request->metrics,
                                    .metric_count = request->simt_count,
                                    .max_rays = request->max_rays};
    for (size_t i = 0; i < request->builders.count; i++)
        if (bb_tracer_of(request->builders.items[i]) != NULL)
            return bb_fail(BB_INVALID,
                           "--builder %s is a reference row, no builder of trees: leave it out",
                           request->builders.items[i]);
    BB_TRY(bb_bench_check(&bench));
    return request->simt_count > 0 ? check_simulated(request) : BB_OK;
}
