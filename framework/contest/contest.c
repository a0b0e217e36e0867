#include "framework/contest/contest.h"

#include "framework/base/interrupt.h"
#include "framework/base/memory.h"
#include "framework/base/progress.h"
#include "framework/base/random.h"
#include "framework/device/stopwatch.h"
#include "kernels/bb_shared.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct entrant {
    bb_instance instances[BB_CONTEST_SCENES_MAX];
    bb_contest_runner *runners; /* one per search */
} entrant;

struct bb_contest {
    bb_contest_request request;
    bb_contest_task task;
    bb_contest_way *ways;
    uint32_t way_count, first; /* way with a tree */
    entrant *entrants;
    bb_contest_runner *runners; /* of all ways */
    uint32_t base;              /* the way that others are compared with */
    unsigned char *without, *with;
    bb_count *counts;
    uint64_t items; /* of all questions */
};

/* ---- making ---- */

/* What a builder or a search can't do is the way's, all else ends the contest. */
static bb_status note(bb_contest_way *way, bb_status status)
{
    if (status != BB_UNSUPPORTED && status != BB_REFUSED)
        return status;
    snprintf(way->refused, sizeof way->refused, "%s", bb_message());
    return BB_OK;
}

static bb_status make_runner(bb_contest *c, entrant *e, bb_contest_runner *r, const char *search)
{
    bb_tree *trees[BB_CONTEST_SCENES_MAX];
    bb_contest_way *way = r->way;
    for (uint32_t s = 0; s < c->request.scene_count; s++)
        trees[s] = &e->instances[s].tree;
    BB_TRY(c->task.make(c->task.self, search, trees, r));
    for (uint32_t s = 0; s < c->request.scene_count; s++) {
        way->nodes += trees[s]->info.node_count;
        way->leaves += trees[s]->info.leaf_count;
        way->references += trees[s]->info.ref_count;
        way->bytes += e->instances[s].account.peak + r->layouts[s].bytes;
        way->tree_bytes += bb_tree_bytes(trees[s]);
    }
    return BB_OK;
}

static bb_status make_tree(bb_contest *c, entrant *e, uint32_t s, const char *builder)
{
    bb_instance *instance = &e->instances[s];
    bb_scene *scene = c->request.scenes[s];
    BB_TRY(bb_instance_create(c->request.device, builder, scene, c->request.seed, instance));
    bool alone = instance->pipeline.count == 1;
    if (c->task.blank && (!alone || (bb_instance_inputs(instance) & BB_INPUT_VOLUME) == 0))
        return bb_fail(BB_UNSUPPORTED, "there is nothing to build over");
    BB_TRY(bb_instance_build(instance, scene, false, NULL));
    if (c->task.blank)
        return BB_OK;
    BB_TRY(bb_tree_download(&instance->tree, NULL));
    BB_TRY(bb_tree_check(&instance->tree, scene));
    return bb_tree_upload(&instance->tree, c->request.device, NULL);
}

static bb_status make_entrant(bb_contest *c, uint32_t i)
{
    const bb_contest_request *request = &c->request;
    entrant *e = &c->entrants[i];
    bb_status status = BB_OK;
    for (uint32_t s = 0; s < request->scene_count && status == BB_OK; s++)
        status = make_tree(c, e, s, request->builders[i]);
    const uint32_t first = c->first + i * request->search_count;
    e->runners = &c->runners[first];
    for (uint32_t k = 0; k < request->search_count; k++) {
        bb_contest_way *way = &c->ways[first + k];
        way->builder = request->builders[i];
        way->search = request->searches[k];
        if (status != BB_OK)
            BB_TRY(note(way, status));
        else if (!c->task.blank)
            BB_TRY(note(way, make_runner(c, e, &e->runners[k], request->searches[k])));
    }
    return BB_OK;
}

static bb_status reserve(bb_contest *c)
{
    const bb_contest_request *request = &c->request;
    const size_t bytes = request->most_items * c->task.answer_bytes;
    BB_TRY(bb_host_alloc(NULL, bytes, "answers", &c->with));
    BB_TRY(bb_host_alloc(NULL, bytes, "answers", &c->without));
    BB_TRY(bb_host_alloc(NULL, request->most_items * sizeof *c->counts, "counts", &c->counts));
    c->entrants = calloc(request->builder_count, sizeof *c->entrants);
    c->runners = calloc(c->way_count, sizeof *c->runners);
    if (c->entrants == NULL || c->runners == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    memset(c->ways, 0, c->way_count * sizeof *c->ways);
    for (uint32_t w = 0; w < c->way_count; w++) {
        c->ways[w].builder = c->ways[w].search = "";
        c->runners[w].way = &c->ways[w];
    }
    return BB_OK;
}

/* The first way that is not refused. */
static bb_status choose_base(bb_contest *c)
{
    while (c->base + 1 < c->way_count && c->ways[c->base].refused[0] != '\0')
        c->base++;
    return c->ways[c->base].refused[0] == '\0'
               ? BB_OK
               : bb_fail(BB_UNSUPPORTED, "%s by %s, and no other way either: %s",
                         c->ways[0].builder, c->ways[0].search, c->ways[0].refused);
}

bb_status bb_contest_create(const bb_contest_request *request, const bb_contest_task *task,
                            bb_contest_way *ways, uint32_t *way_count, bb_contest **out)
{
    *out = NULL;
    const uint32_t first = task->without ? 1 : 0;
    const uint32_t count = first + request->builder_count * request->search_count;
    if (count > BB_CONTEST_WAYS_MAX || count == 0)
        return bb_fail(BB_INVALID, "%u builders with %u searches are more than %d ways, or none",
                       request->builder_count, request->search_count, BB_CONTEST_WAYS_MAX - 1);
    bb_contest *c = calloc(1, sizeof *c);
    if (c == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    c->request = *request;
    c->task = *task;
    c->ways = ways;
    c->first = first;
    *way_count = c->way_count = count;
    bb_status status = reserve(c);
    for (uint32_t i = 0; i < request->builder_count && status == BB_OK; i++)
        status = make_entrant(c, i);
    if (status == BB_OK)
        status = choose_base(c);
    if (status == BB_OK)
        *out = c;
    else
        bb_contest_destroy(c);
    return status;
}

void bb_contest_destroy(bb_contest *c)
{
    if (c == NULL)
        return;
    for (uint32_t w = 0; c->runners != NULL && w < c->way_count; w++)
        for (uint32_t s = 0; s < BB_CONTEST_SCENES_MAX; s++) {
            bb_layout_data_release(&c->runners[w].layouts[s]);
            bb_layout_maker_destroy(&c->runners[w].makers[s]);
        }
    for (uint32_t i = 0; c->entrants != NULL && i < c->request.builder_count; i++)
        for (uint32_t s = 0; s < BB_CONTEST_SCENES_MAX; s++)
            bb_instance_destroy(&c->entrants[i].instances[s]);
    free(c->runners);
    free(c->entrants);
    bb_host_free(c->with);
    bb_host_free(c->without);
    bb_host_free(c->counts);
    free(c);
}

static bb_status check_input(const bb_contest *c)
{
    return c->task.check != NULL ? c->task.check(c->task.self) : BB_OK;
}

static bool is_refused(const bb_contest_runner *r)
{
    return r->way->refused[0] != '\0';
}

const bb_contest_runner *bb_contest_first(const bb_contest *c)
{
    for (uint32_t w = c->first; w < c->way_count && !c->task.blank; w++)
        if (!is_refused(&c->runners[w]))
            return &c->runners[w];
    return NULL;
}

/* ---- answers ---- */

static const bb_contest_runner *tree_of(const bb_contest_runner *r)
{
    return r->way->builder[0] == '\0' ? NULL : r;
}

/* Answers and counts of a way. */
static bb_status ask(bb_contest *c, const bb_contest_runner *r, uint32_t items,
                     unsigned char *answers)
{
    const size_t bytes = c->task.answer_bytes;
    for (uint32_t i = 0; c->task.blank && i < items; i++) {
        memcpy(answers + i * bytes, c->task.blank_answer, bytes);
        c->counts[i] = (bb_count){0, 0, 0};
    }
    if (c->task.blank && tree_of(r) != NULL)
        return BB_OK;
    BB_TRY(bb_buffer_fill(c->task.answers, items * bytes, BB_POISON));
    BB_TRY(c->task.ask(c->task.self, tree_of(r), true));
    BB_TRY(bb_buffer_read(c->task.answers, 0, items * bytes, answers));
    return bb_buffer_read(c->task.counts, 0, items * sizeof *c->counts, c->counts);
}

static uint64_t count_differences(const bb_contest *c, uint32_t items)
{
    const size_t bytes = c->task.answer_bytes;
    uint64_t differ = 0;
    for (uint32_t i = 0; i < items; i++)
        differ += memcmp(c->without + i * bytes, c->with + i * bytes, bytes) != 0;
    return differ;
}

static void add_answers(const bb_contest *c, uint32_t items, bb_contest_way *way)
{
    way->differ += count_differences(c, items);
    for (uint32_t i = 0; i < items; i++) {
        way->visits += c->counts[i].nodes;
        way->work += c->counts[i].prims;
        way->overflown += c->counts[i].overflow;
    }
    if (c->task.compare != NULL)
        c->task.compare(c->task.self, c->without, c->with, items, way);
}

static bb_status compare_question(bb_contest *c, uint32_t question)
{
    uint32_t items;
    BB_TRY(c->task.take(c->task.self, question, &items));
    c->items += items;
    BB_TRY(ask(c, &c->runners[c->base], items, c->without));
    memcpy(c->with, c->without, items * c->task.answer_bytes);
    add_answers(c, items, &c->ways[c->base]);
    if (c->task.see != NULL)
        BB_TRY(c->task.see(c->task.self, question, c->without, items));
    for (uint32_t w = c->base + 1; w < c->way_count; w++) {
        if (is_refused(&c->runners[w]))
            continue;
        BB_TRY(ask(c, &c->runners[w], items, c->with));
        add_answers(c, items, &c->ways[w]);
    }
    return BB_OK;
}

static bb_status compare_answers(bb_contest *c)
{
    for (uint32_t q = 0; q < c->task.questions; q++)
        BB_TRY(compare_question(c, q));
    for (uint32_t w = 0; w < c->way_count; w++) {
        bb_contest_way *way = &c->ways[w];
        way->visits /= (double)c->items;
        way->work /= (double)c->items;
        if (way->overflown == 0)
            continue;
        snprintf(way->refused, sizeof way->refused, "its stack was too small for %llu of %llu rays",
                 (unsigned long long)way->overflown, (unsigned long long)c->items);
        way->differ = 0;
    }
    return BB_OK;
}

/* ---- rounds ---- */

/* Of an answer that was timed, to the last question. */
static bb_status compare_timed(bb_contest *c, const bb_contest_runner *r, uint32_t items)
{
    BB_TRY(bb_buffer_read(c->task.answers, 0, items * c->task.answer_bytes, c->with));
    if (r->way->differ == 0) /* else they were counted, of all questions */
        r->way->differ = count_differences(c, items);
    return BB_OK;
}

/* Of all scenes together: their builds have the same phases. */
static void add_phases(bb_contest_way *way, const entrant *e, uint32_t scenes)
{
    const bb_instance *first = &e->instances[0];
    way->phase_count = 0;
    for (uint32_t s = 0; s < first->step_count; s++) {
        const bb_build_step *step = &first->steps[s];
        for (uint32_t p = 0; p < step->phases.count && way->phase_count < BB_PHASES_MAX; p++) {
            bb_contest_phase *phase = &way->phases[way->phase_count++];
            bool alone = first->step_count == 1;
            double ms = 0;
            for (uint32_t k = 0; k < scenes; k++)
                if (s < e->instances[k].step_count && p < e->instances[k].steps[s].phases.count)
                    ms += e->instances[k].steps[s].phases.ms[p];
            snprintf(phase->name, sizeof phase->name, "%s%s%s", alone ? "" : step->label,
                     alone ? "" : ": ", step->phases.names[p]);
            bb_samples_add(&phase->ms, ms);
        }
    }
}

/* Builds once for the time, once more for the phases. */
static bb_status time_builds(bb_contest *c, entrant *e, double *build_ms, double *upload_ms)
{
    *build_ms = *upload_ms = 0;
    for (uint32_t s = 0; s < c->request.scene_count; s++) {
        bb_instance *instance = &e->instances[s];
        bb_build_timing timing;
        double ms = 0;
        BB_TRY(bb_instance_build(instance, c->request.scenes[s], false, &timing));
        if (!c->task.blank)
            BB_TRY(bb_tree_upload(&instance->tree, c->request.device, &ms));
        *build_ms += timing.timing.ms;
        *upload_ms += ms;
        BB_TRY(bb_instance_build(instance, c->request.scenes[s], true, NULL));
        if (!c->task.blank)
            BB_TRY(bb_tree_upload(&instance->tree, c->request.device, NULL));
    }
    return BB_OK;
}

static bb_status time_layouts(bb_contest *c, entrant *e, bb_contest_runner *r, double *ms)
{
    for (uint32_t s = 0; s < c->request.scene_count && !c->task.blank; s++) {
        BB_TRY(bb_layout_maker_make(&r->makers[s], c->request.scenes[s], &e->instances[s].tree,
                                    r->leaf, BB_FORMAT_VERTICES, &r->layouts[s]));
        *ms += r->layouts[s].timing.ms;
    }
    return BB_OK;
}

static bb_status time_entrant(bb_contest *c, entrant *e)
{
    const uint32_t searches = c->request.search_count;
    double build_ms, upload_ms;
    bool refused = true;
    for (uint32_t k = 0; k < searches; k++)
        refused = refused && is_refused(&e->runners[k]);
    if (refused)
        return BB_OK;
    BB_TRY(time_builds(c, e, &build_ms, &upload_ms));
    for (uint32_t k = 0; k < searches; k++) {
        bb_contest_runner *r = &e->runners[k];
        double layout_ms = upload_ms;
        if (is_refused(r))
            continue;
        bb_samples_add(&r->way->build, build_ms);
        add_phases(r->way, e, c->request.scene_count);
        BB_TRY(time_layouts(c, e, r, &layout_ms));
        bb_samples_add(&r->way->layout, layout_ms);
    }
    return BB_OK;
}

static bb_status time_answer(bb_contest *c, const bb_contest_runner *r, bb_timing *timing)
{
    bb_stopwatch watch;
    *timing = (bb_timing){0};
    if (tree_of(r) != NULL && c->task.blank)
        return BB_OK; /* takes no search */
    BB_TRY(bb_stopwatch_start(c->request.device, &watch));
    bb_status status = c->task.ask(c->task.self, tree_of(r), false);
    bb_status stopped = bb_stopwatch_stop(&watch, timing);
    return status != BB_OK ? status : stopped;
}

/* 0 to count - 1 in another order in each round and for each question, so that nobody always
 * follows the same. */
static void shuffle(const bb_contest *c, uint32_t round, uint32_t question, uint32_t count,
                    uint32_t order[BB_CONTEST_WAYS_MAX])
{
    bb_random random =
        bb_random_make(c->request.seed, ((uint64_t)round << 32 | question) * 2654435761u);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t k = bb_random_below(&random, i + 1);
        order[i] = order[k];
        order[k] = i;
    }
}

static bb_status time_question(bb_contest *c, uint32_t round, uint32_t question, bb_timing *sums)
{
    const bool last = round == c->request.repeats && question + 1 == c->task.questions;
    const uint32_t parts = c->task.summed ? 1 : c->task.questions;
    uint32_t items, order[BB_CONTEST_WAYS_MAX];
    BB_TRY(c->task.take(c->task.self, question, &items));
    shuffle(c, round, question, c->way_count, order);
    for (uint32_t i = 0; i < c->way_count; i++) {
        const uint32_t w = order[i];
        const bb_contest_runner *r = &c->runners[w];
        bb_timing timing;
        if (is_refused(r))
            continue;
        BB_TRY(time_answer(c, r, &timing));
        sums[w].ms += timing.ms / parts;
        sums[w].cpu_ms += timing.cpu_ms / parts;
        if (last && (tree_of(r) == NULL || !c->task.blank))
            BB_TRY(compare_timed(c, r, items));
    }
    return BB_OK;
}

static bb_status time_round(bb_contest *c, uint32_t round, bb_progress *progress)
{
    bb_timing sums[BB_CONTEST_WAYS_MAX] = {{0}};
    const uint32_t builders = c->request.builder_count;
    uint32_t order[BB_CONTEST_WAYS_MAX];
    shuffle(c, round, UINT32_MAX, builders, order);
    if (c->task.time != NULL)
        BB_TRY(c->task.time(c->task.self));
    for (uint32_t i = 0; i < builders; i++)
        BB_TRY(time_entrant(c, &c->entrants[order[i]]));
    for (uint32_t q = 0; q < c->task.questions; q++) {
        BB_TRY(time_question(c, round, q, sums));
        bb_progress_step(progress);
    }
    for (uint32_t w = 0; w < c->way_count; w++) {
        if (is_refused(&c->runners[w]))
            continue;
        bb_samples_add(&c->ways[w].answer, sums[w].ms);
        bb_samples_add(&c->ways[w].answer_cpu, sums[w].cpu_ms);
    }
    return BB_OK;
}

bb_status bb_contest_run(bb_contest *c)
{
    const uint32_t steps = (c->request.repeats + 1) * c->task.questions;
    bb_progress progress;
    BB_TRY(check_input(c));
    BB_TRY(compare_answers(c));
    bb_progress_start(&progress, c->request.quiet);
    bb_progress_stage(&progress, steps, "%s: %u ways, %u rounds", c->request.scenes[0]->name,
                      c->way_count, c->request.repeats);
    bb_progress_plan(&progress, steps);
    bb_progress_weigh(&progress, steps);
    bb_status status = BB_OK;
    for (uint32_t r = 0; r <= c->request.repeats && status == BB_OK && !bb_interrupted(); r++)
        status = time_round(c, r, &progress);
    bb_progress_end(&progress);
    BB_TRY(status);
    if (bb_interrupted() && c->ways[c->base].answer.count < 2)
        return bb_fail(BB_FAILED, "%s: interrupted before a round that counts",
                       c->request.scenes[0]->name);
    return check_input(c);
}
