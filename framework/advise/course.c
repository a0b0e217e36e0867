/* Scout, race, choice, search. */
#include "framework/advise/advise.h"

#include "framework/advise/advice.h"
#include "framework/advise/heat.h"
#include "framework/advise/savings.h"
#include "framework/advise/scouts.h"
#include "framework/base/interrupt.h"
#include "framework/base/progress.h"
#include "framework/builder/instance.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    HEATS_MAX = 3,
    DOCUMENTS_MAX = 8,
    ROUNDS = 8,        /* of heats before the last: race.h says what that makes of a chance */
    LEAST_RAYS = 1024, /* of a kind that samples: enough for those that are many per hit */
};

typedef struct course {
    const bb_advise_request *request;
    bb_advice advice;
    bb_progress progress;
    bb_results *documents[DOCUMENTS_MAX]; /* of all comparisons but the last one */
    uint32_t document_count;
    bb_results *results; /* the caller's */
    bb_bench_outcome *outcome;
} course;

/* ---- comparisons ---- */

/* A document of its own, since figures point into it until the end. */
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

/* The first document that has it: the last one may have nothing. */
static void note_scene(course *c, const bb_results *document)
{
    if (c->advice.scene == NULL)
        c->advice.scene = cJSON_GetArrayItem(bb_results_section(document, "scenes"), 0);
}

/* What is found out of the clocks of an earlier comparison counts for the last one too. */
static bb_status compare(course *c, const bb_heat *heat, bb_entered *field)
{
    bb_results *document;
    bb_bench_outcome outcome = {0};
    BB_TRY(add_document(c, &document));
    BB_TRY(bb_heat_run(c->request, heat, field, document, &outcome));
    bb_audit_add(&c->outcome->audit, &outcome.audit);
    note_scene(c, document);
    return BB_OK;
}

/* Into the caller's document. */
static bb_status compare_last(course *c, const bb_heat *heat, bb_entered *field)
{
    bb_bench_outcome outcome = {0};
    BB_TRY(bb_heat_run(c->request, heat, field, c->results, &outcome));
    outcome.wrong = outcome.unbuilt = outcome.unjudged = 0; /* an advice is not wrong by them */
    bb_bench_outcome_add(c->outcome, &outcome);
    note_scene(c, c->results);
    return BB_OK;
}

static uint32_t racing(const bb_entered *field)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < field->count; i++)
        count += field->racers[i].state == BB_RACING;
    return count;
}

/* ---- scout ---- */

static bb_heat few_rays(const bb_advise_request *request, uint32_t shift)
{
    uint32_t side = shift / 2;
    bb_heat heat = {.width = request->width >> side,
                    .height = request->height >> side,
                    .max_rays = request->max_rays >> shift,
                    .repeats = ROUNDS};
    const uint32_t least = request->max_rays < LEAST_RAYS ? request->max_rays : LEAST_RAYS;
    heat.width = heat.width > 0 ? heat.width : 1;
    heat.height = heat.height > 0 ? heat.height : 1;
    heat.max_rays = heat.max_rays > least ? heat.max_rays : least;
    return heat;
}

static bool is_worth_scouting(const bb_advise_request *r)
{
    return r->builders.count > 1 && r->kernels.count + r->intersectors.count > 2;
}

static bb_status scout(course *c)
{
    const bb_heat heat = few_rays(c->request, 4);
    if (!is_worth_scouting(c->request))
        return BB_OK;
    bb_entered *scouts = &c->advice.scouts;
    BB_TRY(bb_scouts_enter(&c->request->builders, &c->request->kernels, &c->request->intersectors,
                           scouts));
    bb_progress_note(&c->progress, "%s: %u kernels and intersectors tried on %s", c->request->scene,
                     scouts->count, scouts->who[0].builder);
    BB_TRY(compare(c, &heat, scouts));
    bb_scouts_judge(scouts, (uint32_t)c->request->kernels.count, BB_SCOUT_SLACK);
    return BB_OK;
}

/* ---- race ---- */

static bb_status measure(void *user, uint32_t index, bb_racer *racers, uint32_t count)
{
    course *c = user;
    const bb_advise_request *r = c->request;
    const bool last = index + 1 == c->advice.heats;
    bb_heat heat = few_rays(r, index == 0 ? 4 : 2);
    (void)racers;
    (void)count;
    if (last)
        heat = (bb_heat){r->width, r->height, r->max_rays, r->repeats, true};
    if (bb_interrupted())
        return BB_OK;
    bb_progress_note(&c->progress, "%s: heat %u of %u: %u configurations, up to %u rays of a kind",
                     r->scene, index + 1, c->advice.heats, racing(&c->advice.field),
                     heat.width * heat.height > heat.max_rays ? heat.width * heat.height
                                                              : heat.max_rays);
    return last && !r->exhaustive ? compare_last(c, &heat, &c->advice.field)
                                  : compare(c, &heat, &c->advice.field);
}

static bb_status race(course *c)
{
    const bb_advise_request *r = c->request;
    uint32_t count;
    bb_entered *field = &c->advice.field;
    bb_contender *who = bb_contenders_make(&r->builders, &r->kernels, &r->intersectors, &count);
    if (who != NULL)
        count = bb_scouts_keep(&c->advice.scouts, who, count);
    BB_TRY(bb_entered_make(who, count, field));
    c->advice.heats = r->quick ? HEATS_MAX - 1 : HEATS_MAX;
    return bb_race_run(field->racers, count, c->advice.heats, BB_ADVISE_SLACK, measure, c);
}

/* ---- choice ---- */

void bb_choose_least(const bb_entered *field, uint32_t *best, uint32_t *least, uint32_t *within)
{
    *best = bb_race_fastest(field->racers, field->count);
    *least = *best == BB_NO_RACER ? BB_NONE_CHOSEN : *best;
    *best = *least;
    *within = 0;
    for (uint32_t i = 0; i < field->count && *best != BB_NONE_CHOSEN; i++) {
        if (field->racers[i].state != BB_RACING)
            continue;
        double ratio = bb_race_ratio(&field->racers[i], &field->racers[*best]).value;
        if (!(ratio <= BB_ADVISE_SLACK) && i != *best)
            continue;
        ++*within;
        if (bb_extent_compare(&field->figures[i].extent, &field->figures[*least].extent) < 0)
            *least = i;
    }
}

static void choose(bb_advice *advice)
{
    const bb_entered *field = &advice->field;
    bb_choose_least(field, &advice->best, &advice->choice, &advice->within);
    if (advice->choice != BB_NONE_CHOSEN)
        advice->choice_ratio =
            bb_race_ratio(&field->racers[advice->choice], &field->racers[advice->best]);
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
    const bb_heat heat = {r->width, r->height, r->max_rays, r->repeats, true};
    uint32_t count, within;
    bb_contender *who = bb_contenders_make(&r->builders, &r->kernels, &r->intersectors, &count);
    BB_TRY(bb_entered_make(who, count, &advice->all));
    bb_progress_note(&c->progress, "%s: exhaustive search: all %u configurations", r->scene, count);
    BB_TRY(compare_last(c, &heat, &advice->all));
    bb_choose_least(&advice->all, &advice->all_best, &advice->all_least, &within);
    advice->all_choice = BB_NONE_CHOSEN;
    for (uint32_t i = 0; advice->choice != BB_NONE_CHOSEN && i < count; i++)
        if (same(&advice->all.who[i], &advice->field.who[advice->choice]))
            advice->all_choice = i;
    if (advice->all_choice != BB_NONE_CHOSEN && advice->all_best != BB_NONE_CHOSEN)
        advice->all_ratio = bb_race_ratio(&advice->all.racers[advice->all_choice],
                                          &advice->all.racers[advice->all_best]);
    return BB_OK;
}

/* ---- all of it ---- */

static bb_status save(course *c)
{
    bb_results *document;
    const bb_advise_request *r = c->request;
    const bb_heat heat = {r->width, r->height, r->max_rays, r->repeats, true};
    if (c->advice.choice == BB_NONE_CHOSEN || bb_interrupted())
        return BB_OK;
    bb_progress_note(&c->progress, "%s: what the choice saves", r->scene);
    BB_TRY(add_document(c, &document));
    return bb_savings_measure(&c->advice, &heat, document, c->outcome);
}

/* What a builder does not take is found out before anything is measured on the others. */
static bb_status try_builders(const bb_advise_request *r)
{
    for (size_t i = 0; i < r->builders.count; i++)
        BB_TRY(bb_instance_try(r->device, r->builders.items[i], r->seed));
    return BB_OK;
}

static bb_status run(course *c)
{
    bb_advice *advice = &c->advice;
    BB_TRY(try_builders(c->request));
    BB_TRY(scout(c));
    if (!bb_interrupted())
        BB_TRY(race(c));
    if (bb_interrupted())
        return BB_OK;
    choose(advice);
    BB_TRY(save(c));
    if (c->request->exhaustive && !bb_interrupted())
        BB_TRY(search(c));
    return bb_interrupted() ? BB_OK : bb_advice_add(advice, c->results);
}

bb_status bb_advise(const bb_advise_request *request, bb_results *results,
                    bb_bench_outcome *outcome, bool *found)
{
    course *c = calloc(1, sizeof *c);
    if (c == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *outcome = (bb_bench_outcome){0};
    *c = (course){.request = request, .results = results, .outcome = outcome};
    c->advice = (bb_advice){.request = request,
                            .best = BB_NONE_CHOSEN,
                            .choice = BB_NONE_CHOSEN,
                            .all_best = BB_NONE_CHOSEN,
                            .all_least = BB_NONE_CHOSEN,
                            .all_choice = BB_NONE_CHOSEN,
                            .choice_ratio = bb_not_measured,
                            .all_ratio = bb_not_measured};
    bb_progress_start(&c->progress, request->quiet);
    bb_status status = run(c);
    *found = c->advice.choice != BB_NONE_CHOSEN;
    bb_progress_end(&c->progress);
    bb_entered_free(&c->advice.scouts);
    bb_entered_free(&c->advice.field);
    bb_entered_free(&c->advice.all);
    for (uint32_t i = 0; i < c->document_count; i++)
        bb_results_destroy(c->documents[i]);
    free(c);
    return status;
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
                                    .max_rays = request->max_rays};
    for (size_t i = 0; i < request->builders.count; i++)
        if (bb_is_reference(request->builders.items[i]))
            return bb_fail(BB_INVALID,
                           "--builder %s is a reference row, no builder of trees: leave it out",
                           request->builders.items[i]);
    return bb_bench_check(&bench);
}
