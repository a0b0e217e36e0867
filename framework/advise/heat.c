/* Turns contenders into comparisons, and results into figures. */
#include "framework/advise/heat.h"

#include "framework/advise/turns.h"
#include "framework/base/clock.h"
#include "framework/base/interrupt.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bb_status bb_entered_make(bb_contender *who, uint32_t count, bb_entered *field)
{
    *field = (bb_entered){.who = who, .count = count};
    field->racers = calloc(count + 1, sizeof *field->racers);
    field->figures = calloc(count + 1, sizeof *field->figures);
    if (who == NULL || field->racers == NULL || field->figures == NULL) {
        bb_entered_free(field);
        return bb_fail(BB_FAILED, "out of memory");
    }
    for (uint32_t i = 0; i < count; i++)
        field->racers[i] = (bb_racer){.behind = BB_NO_RACER};
    return BB_OK;
}

void bb_entered_free(bb_entered *field)
{
    free(field->who);
    free(field->racers);
    free(field->figures);
    *field = (bb_entered){0};
}

/* ---- turns ---- */

/* Returns the best contender so far, at first one with the guessed builder. */
static uint32_t choose_reference(const bb_heat *heat, const bb_entered *field)
{
    uint32_t reference = bb_race_best(field->racers, field->count);
    for (uint32_t i = 0; reference == BB_NO_RACER && heat->guess != NULL && i < field->count; i++)
        if (field->racers[i].state == BB_RACING && strcmp(field->who[i].builder, heat->guess) == 0)
            reference = i;
    for (uint32_t i = 0; reference == BB_NO_RACER && i < field->count; i++)
        if (field->racers[i].state == BB_RACING)
            reference = i;
    return reference;
}

/* ---- one turn ---- */

typedef struct turn {
    const bb_advise_request *request;
    const bb_heat *heat;
    bb_entered *field;
    uint32_t reference;
    bool *in, *done;
    uint32_t count;     /* contenders of this turn; later turns do not count the reference */
    uint32_t past, all; /* contenders of earlier turns, of all turns */
} turn;

/* Distinct names in the turn, owned by the contenders. */
typedef struct names {
    char *items[BB_TRIED_MAX];
    uint32_t count;
} names;

static void add_name(names *n, const char *name)
{
    for (uint32_t i = 0; i < n->count; i++)
        if (strcmp(n->items[i], name) == 0)
            return;
    if (n->count < BB_TRIED_MAX) /* lists have no more */
        n->items[n->count++] = (char *)name;
}

static bool takes(const void *user, const char *builder, const char *kernel,
                  const char *intersector)
{
    const turn *t = user;
    for (uint32_t i = 0; i < t->field->count; i++)
        if (t->in[i] && bb_bench_fits(builder, t->field->who[i].builder) &&
            bb_bench_fits(kernel, t->field->who[i].kernel) &&
            bb_bench_fits(intersector, t->field->who[i].intersector))
            return true;
    return false;
}

static void tell(void *whom, double share)
{
    const turn *t = whom;
    char text[160];
    const double done = t->past + share * t->count;
    snprintf(text, sizeof text, "%s: %.0f of %u configurations", t->heat->name, floor(done),
             t->all);
    bb_progress_at(t->heat->progress, done / t->all, text);
}

static bool too_wrong(const bb_tried_figures *f, double limit, bool last)
{
    const bb_wrong_rate rate = bb_wrong_rate_of(f->wrong, f->checked);
    return f->unlike > 0 || rate.low > limit || (last && f->wrong > limit * f->checked / 1e6);
}

/* Scales a cost by the reference's cost in the first turn over its cost in this turn. */
static void scale_cost(bb_tried_figures *f, const bb_samples *first, const bb_samples *now)
{
    for (uint32_t r = 0;
         r < f->cost.count && f->cost.count == first->count && f->cost.count == now->count; r++)
        f->cost.values[r] *= first->values[r] / now->values[r];
}

static void read_contender(const turn *t, const bb_image *image, uint32_t i, const bb_samples *now)
{
    bb_racer *racer = &t->field->racers[i];
    bb_tried_figures *f = &t->field->figures[i], read;
    bb_tried_read(image, &t->field->who[i], &read);
    if (!read.measured && bb_interrupted())
        return;
    *f = read;
    f->extent.place = i;
    if (now != NULL)
        scale_cost(f, &t->field->racers[t->reference].cost, now);
    racer->cost = f->cost;
    if (!f->measured)
        racer->state = BB_NOT_RUN;
    else if (too_wrong(f, t->request->max_wrong_ppm, t->heat->last))
        racer->state = BB_TOO_WRONG;
}

/* `run`: the turn's number. */
static void read_turn(const turn *t, const bb_results *results, uint32_t run)
{
    const bb_entry *scene = bb_first(bb_results_section(results, BB_SCENES));
    const bb_image image = {results,
                            bb_get_text(scene, BB_F_SCENE_NAME),
                            run,
                            t->request->image_rays,
                            t->heat->ground->factor,
                            t->heat->simulation};
    bb_tried_figures again = {.measured = false};
    const bool later = t->done[t->reference];
    if (later)
        bb_tried_read(&image, &t->field->who[t->reference], &again);
    else
        read_contender(t, &image, t->reference, NULL);
    for (uint32_t i = 0; i < t->field->count; i++)
        if (t->in[i] && i != t->reference)
            read_contender(t, &image, i, later && again.measured ? &again.cost : NULL);
}

static bb_status run_turn(turn *t, bb_results *results, bb_bench_outcome *outcome)
{
    const bb_advise_request *request = t->request;
    const bb_heat *heat = t->heat;
    names builders = {.count = 0}, kernels = {.count = 0}, intersectors = {.count = 0};
    char *scene = (char *)request->scene;
    for (uint32_t i = 0; i < t->field->count; i++) {
        if (!t->in[i])
            continue;
        add_name(&builders, t->field->who[i].builder);
        add_name(&kernels, t->field->who[i].kernel);
        add_name(&intersectors, t->field->who[i].intersector);
    }
    const bb_bench_request bench = {.device = request->device,
                                    .scenes = &scene,
                                    .scene_count = 1,
                                    .scene = heat->ground->scene,
                                    .oracle = heat->ground->oracle,
                                    .builders = builders.items,
                                    .builder_count = builders.count,
                                    .kernels = kernels.items,
                                    .kernel_count = kernels.count,
                                    .intersectors = intersectors.items,
                                    .intersector_count = intersectors.count,
                                    .workloads = request->rays,
                                    .workload_count = request->ray_count,
                                    .width = heat->width,
                                    .height = heat->height,
                                    .max_rays = heat->max_rays,
                                    .max_views = request->max_views,
                                    .repeats = heat->repeats,
                                    .seed = request->seed,
                                    .metrics = (char **)&heat->metric,
                                    .metric_count = heat->metric != NULL,
                                    .max_wrong_ppm = request->max_wrong_ppm,
                                    .takes = takes,
                                    .user = t,
                                    .lean = true,
                                    .tell = heat->progress != NULL ? tell : NULL,
                                    .whom = t,
                                    .quiet = true};
    const uint32_t run = bb_results_begin_run(results);
    bb_bench_outcome more;
    BB_TRY(bb_bench_run(&bench, results, &more));
    bb_bench_outcome_add(outcome, &more);
    read_turn(t, results, run);
    return BB_OK;
}

static bb_status run_turns(turn *t, bb_results *results, bb_bench_outcome *outcome)
{
    const bb_entered *field = t->field;
    for (uint32_t i = 0; i < field->count; i++)
        t->all += field->racers[i].state == BB_RACING;
    if (t->heat->progress != NULL) {
        t->heat->progress->start = t->heat->progress->shown = bb_wall_ms();
        bb_progress_plan(t->heat->progress, 1);
    }
    while (!bb_interrupted() &&
           (t->count = bb_turn(field, t->reference, t->heat->sizes, t->done, t->in)) > 0) {
        BB_TRY(run_turn(t, results, outcome));
        for (uint32_t i = 0; i < field->count; i++)
            t->done[i] = t->done[i] || t->in[i];
        t->past += t->count;
    }
    return BB_OK;
}

bb_status bb_heat_run(const bb_advise_request *request, const bb_heat *heat, bb_entered *field,
                      bb_results *results, bb_bench_outcome *outcome)
{
    turn t = {.request = request,
              .heat = heat,
              .field = field,
              .reference = choose_reference(heat, field),
              .in = calloc(field->count + 1, sizeof *t.in),
              .done = calloc(field->count + 1, sizeof *t.done)};
    bb_status status = t.in != NULL && t.done != NULL ? run_turns(&t, results, outcome)
                                                      : bb_fail(BB_FAILED, "out of memory");
    free(t.in);
    free(t.done);
    return status;
}
