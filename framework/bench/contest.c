#include "framework/bench/contest_private.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "kernels/bb_shared.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bb_status check_input(const bb_contest *c)
{
    return c->task->check != NULL ? c->task->check(c->task->self) : BB_OK;
}

static bool is_refused(const bb_contest_runner *r)
{
    return r->way->refused[0] != '\0';
}

static const bb_contest_runner *first_with_tree(const bb_contest *c)
{
    for (uint32_t w = c->first; w < c->way_count && !c->task->blank; w++)
        if (!is_refused(&c->runners[w]))
            return &c->runners[w];
    return NULL;
}

/* ---- answers ---- */

/* Sees to it that what a way asks is on the device. */
static bb_status ready(bb_contest *c, const bb_contest_runner *r)
{
    if (r->without)
        return BB_OK;
    const bb_contest_entrant *e = &c->entrants[r->entrant];
    return bb_contest_bring(c, e, e->choices[r->choice].layout);
}

static bb_contest_answers answers_of(bb_contest *c, bool counting)
{
    return (bb_contest_answers){&c->d_answers, counting ? &c->d_counts : NULL, NULL};
}

/* Answers and counts of a way. */
static bb_status ask(bb_contest *c, const bb_contest_runner *r, uint32_t items,
                     unsigned char *answers)
{
    const size_t bytes = c->task->answer_bytes;
    for (uint32_t i = 0; c->task->blank && i < items; i++) {
        memcpy(answers + i * bytes, c->task->blank_answer, bytes);
        c->counts[i] = (bb_count){0};
    }
    if (c->task->blank && !r->without)
        return BB_OK;
    BB_TRY(ready(c, r));
    BB_TRY(bb_buffer_fill(&c->d_answers, items * bytes, BB_POISON));
    BB_TRY(c->task->ask(c->task->self, r, answers_of(c, true)));
    BB_TRY(bb_buffer_read(&c->d_answers, 0, items * bytes, answers));
    return bb_buffer_read(&c->d_counts, 0, items * sizeof *c->counts, c->counts);
}

static uint64_t count_differences(const bb_contest *c, uint32_t items)
{
    const size_t bytes = c->task->answer_bytes;
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
        way->restarts += c->counts[i].restarts;
        way->overflown += c->counts[i].overflow;
    }
    if (c->task->compare != NULL)
        c->task->compare(c->task->self, c->without, c->with, items, way);
}

static bb_status compare_question(bb_contest *c, uint32_t question)
{
    uint32_t items;
    BB_TRY(c->task->take(c->task->self, question, &items));
    c->items += items;
    BB_TRY(ask(c, &c->runners[c->base], items, c->without));
    memcpy(c->with, c->without, items * c->task->answer_bytes);
    add_answers(c, items, &c->ways[c->base]);
    if (c->task->see != NULL)
        BB_TRY(c->task->see(c->task->self, question, c->without, items));
    for (uint32_t w = c->base + 1; w < c->way_count; w++) {
        if (is_refused(&c->runners[w]))
            continue;
        BB_TRY(ask(c, &c->runners[w], items, c->with));
        add_answers(c, items, &c->ways[w]);
    }
    return question == 0 ? bb_contest_simulate(c, items) : BB_OK;
}

static bb_status compare_answers(bb_contest *c)
{
    for (uint32_t q = 0; q < c->task->questions; q++)
        BB_TRY(compare_question(c, q));
    for (uint32_t w = 0; w < c->way_count; w++) {
        bb_contest_way *way = &c->ways[w];
        way->visits /= (double)c->items;
        way->work /= (double)c->items;
        way->restarts /= (double)c->items;
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
    BB_TRY(bb_buffer_read(&c->d_answers, 0, items * c->task->answer_bytes, c->with));
    if (r->way->differ == 0) /* else they were counted, of all questions */
        r->way->differ = count_differences(c, items);
    return BB_OK;
}

/* Of all scenes together: their builds have the same phases. */
static void add_phases(bb_contest_way *way, const bb_contest_entrant *e)
{
    const bb_instance *first = &e->trees[0].instance;
    way->phase_count = 0;
    for (uint32_t s = 0; s < first->step_count; s++) {
        const bb_build_step *step = &first->steps[s];
        for (uint32_t p = 0; p < step->phases.count && way->phase_count < BB_PHASES_MAX; p++) {
            bb_contest_phase *phase = &way->phases[way->phase_count++];
            bool alone = first->step_count == 1;
            double ms = 0;
            for (uint32_t k = 0; k < e->tree_count; k++)
                if (s < e->trees[k].instance.step_count &&
                    p < e->trees[k].instance.steps[s].phases.count)
                    ms += e->trees[k].instance.steps[s].phases.ms[p];
            snprintf(phase->name, sizeof phase->name, "%s%s%s", alone ? "" : step->label,
                     alone ? "" : ": ", step->phases.names[p]);
            bb_samples_add(&phase->ms, ms);
        }
    }
}

/* Builds once for the time, once more for the phases. */
static bb_status time_builds(bb_contest *c, bb_contest_entrant *e, double *build_ms,
                             double *upload_ms)
{
    *build_ms = *upload_ms = 0;
    bb_contest_pin(c, e);
    for (uint32_t s = 0; s < e->tree_count; s++) {
        bb_build_timing timing;
        double ms = 0;
        BB_TRY(bb_resident_build(&c->residency, &e->trees[s], false, &timing));
        bb_audit_build(c->audit, c->request->name, &e->trees[s].instance);
        if (!c->task->blank)
            BB_TRY(bb_resident_upload(&c->residency, &e->trees[s], &ms));
        *build_ms += timing.timing.ms;
        *upload_ms += ms;
        BB_TRY(bb_resident_build(&c->residency, &e->trees[s], true, NULL));
        if (!c->task->blank)
            BB_TRY(bb_resident_upload(&c->residency, &e->trees[s], NULL));
    }
    return BB_OK;
}

static void audit(bb_contest *c, const bb_contest_runner *r, const char *part,
                  const bb_timing *timing)
{
    char what[256];
    snprintf(what, sizeof what, "%s of %.80s by %.60s%s%.60s", part, c->request->name,
             r->way->builder, r->without ? "no tree" : " with ", r->way->search);
    bb_audit_timing(c->audit, what, timing, true);
}

static bb_status time_layouts(bb_contest *c, bb_contest_entrant *e, uint32_t k, double *ms)
{
    const bb_contest_runner *r = &e->runners[k];
    for (uint32_t s = 0; s < e->tree_count && !c->task->blank; s++) {
        BB_TRY(bb_resident_layout_again(&c->residency, &e->trees[s], e->choices[k].layout));
        *ms += r->data[s]->timing.ms;
        audit(c, r, "layout", &r->data[s]->timing);
    }
    return BB_OK;
}

static bb_status time_entrant(bb_contest *c, bb_contest_entrant *e)
{
    double build_ms, upload_ms;
    bool refused = true;
    for (uint32_t k = 0; k < e->choice_count; k++)
        refused = refused && is_refused(&e->runners[k]);
    if (refused)
        return BB_OK;
    BB_TRY(time_builds(c, e, &build_ms, &upload_ms));
    for (uint32_t k = 0; k < e->choice_count; k++) {
        bb_contest_runner *r = &e->runners[k];
        double layout_ms = upload_ms;
        if (is_refused(r))
            continue;
        bb_samples_add(&r->way->build, build_ms);
        add_phases(r->way, e);
        BB_TRY(time_layouts(c, e, k, &layout_ms));
        bb_samples_add(&r->way->layout, layout_ms);
    }
    return BB_OK;
}

static bb_status time_answer(bb_contest *c, const bb_contest_runner *r, bb_timing *timing)
{
    bb_stopwatch watch;
    *timing = (bb_timing){0};
    if (!r->without && c->task->blank)
        return BB_OK; /* takes no search */
    BB_TRY(ready(c, r));
    BB_TRY(bb_stopwatch_start(c->request->device, &watch));
    BB_TRY(bb_stopwatch_stop(&watch, c->task->ask(c->task->self, r, answers_of(c, false)), timing));
    audit(c, r, "answer", timing);
    return BB_OK;
}

/* A question in a round: what its turns need. */
typedef struct question_round {
    bb_contest *contest;
    uint32_t items;
    bool last; /* whose answers are compared */
    bb_timing *sums;
} question_round;

static bb_status take_question_turn(void *self, uint32_t who, uint32_t round, double *ms)
{
    const question_round *q = self;
    bb_contest *c = q->contest;
    const uint32_t parts = c->task->summed ? 1 : c->task->questions;
    const bb_contest_runner *r = &c->runners[who];
    bb_timing timing;
    if (is_refused(r))
        return BB_OK;
    BB_TRY(time_answer(c, r, &timing));
    *ms += timing.ms;
    if (round == BB_WARMING_UP)
        return BB_OK;
    q->sums[who].ms += timing.ms / parts;
    q->sums[who].cpu_ms += timing.cpu_ms / parts;
    return q->last && (r->without || !c->task->blank) ? compare_timed(c, r, q->items) : BB_OK;
}

static bb_turns turns_of(bb_contest *c, question_round *question)
{
    return (bb_turns){.device = c->request->device,
                      .random = &c->random,
                      .count = c->way_count,
                      .self = question,
                      .turn = take_question_turn};
}

static bb_status warm_up(bb_contest *c, bb_progress *progress)
{
    question_round question = {.contest = c};
    bb_turns turns = turns_of(c, &question);
    BB_TRY(c->task->take(c->task->self, 0, &question.items));
    return bb_turns_warm_up(&turns, progress, c->request->name, "answers");
}

static bb_status time_question(bb_contest *c, uint32_t round, uint32_t question, bb_timing *sums)
{
    const bool last = round == c->repeats && question + 1 == c->task->questions;
    question_round q = {.contest = c, .last = last, .sums = sums};
    bb_turns turns = turns_of(c, &q);
    BB_TRY(c->task->take(c->task->self, question, &q.items));
    return bb_turns_round(&turns, round);
}

static bb_status take_build_turn(void *self, uint32_t who, uint32_t round, double *ms)
{
    bb_contest *c = self;
    (void)round;
    (void)ms;
    return time_entrant(c, &c->entrants[who]);
}

static bb_status time_round(bb_contest *c, uint32_t round, bb_progress *progress)
{
    bb_timing sums[BB_CONTEST_WAYS_MAX] = {{0}};
    bb_turns builds = {.device = c->request->device,
                       .random = &c->random,
                       .count = c->request->builder_count,
                       .self = c,
                       .turn = take_build_turn};
    if (c->task->time != NULL)
        BB_TRY(c->task->time(c->task->self));
    BB_TRY(bb_turns_round(&builds, round));
    for (uint32_t q = 0; q < c->task->questions; q++) {
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

/* Counts as interrupted only before a round that counts. */
static bb_status run_rounds(bb_contest *c)
{
    const uint32_t rounds = c->request->repeats + 1, steps = rounds * c->task->questions;
    bb_progress progress;
    c->repeats = c->request->repeats;
    bb_progress_start(&progress, c->request->quiet);
    if (c->request->watch != NULL)
        bb_warn_of_bystanders(c->request->watch, c->request->device, &progress);
    bb_progress_stage(&progress, steps, "%s: %u ways, %u rounds", c->request->name, c->way_count,
                      c->request->repeats);
    bb_progress_plan(&progress, steps);
    bb_progress_weigh(&progress, steps);
    bb_status status = warm_up(c, &progress);
    for (uint32_t r = 0; r <= c->repeats && status == BB_OK && !bb_interrupted(); r++) {
        const double start = bb_wall_ms();
        status = time_round(c, r, &progress);
        if (r == 0 && status == BB_OK)
            c->repeats = bb_turns_foretell(&progress, c->request->name, bb_wall_ms() - start,
                                           c->repeats, c->request->ends_ms);
    }
    bb_progress_end(&progress);
    if (!bb_interrupted()) /* which makes libraries fail */
        return status;
    return c->ways[c->base].answer.count >= 2
               ? BB_OK
               : bb_fail(BB_FAILED, "%s: interrupted before a round that counts", c->request->name);
}

static bb_status run(bb_contest *c)
{
    const bb_contest_task *task = c->task;
    BB_TRY(bb_contest_make(c));
    BB_TRY(check_input(c));
    BB_TRY(compare_answers(c));
    BB_TRY(run_rounds(c));
    BB_TRY(check_input(c));
    const bb_contest_runner *first = first_with_tree(c);
    if (task->end == NULL || bb_interrupted())
        return BB_OK;
    BB_TRY(first != NULL ? ready(c, first) : BB_OK);
    return task->end(task->self, first, answers_of(c, true));
}

static void fill(const bb_contest *c, bb_table *table)
{
    const bb_contest_task *task = c->task;
    const double answers = task->summed ? 1 : task->questions;
    double tets = 0;
    for (uint32_t s = 0; s < task->scene_count; s++)
        tets += task->scenes[s]->prims[BB_TETRAHEDRON].count;
    task->fill(task->self, table, bb_contest_scene_row(table, c->request->name, NULL));
    bb_contest_fill(table, c->request->name, c->ways, c->way_count, (double)c->items / answers,
                    tets);
    bb_contest_fill_simulated(table, c->request->name, c->ways, c->way_count,
                              (double)c->items / answers, c->request->simts,
                              c->request->simt_count);
}

bb_status bb_contest_run(const bb_contest_request *request, const bb_contest_task *task,
                         bb_table *table)
{
    const uint32_t first = request->without ? 1 : 0;
    const uint32_t count = bb_contest_count_ways(request);
    if (count > BB_CONTEST_WAYS_MAX || count == 0)
        return bb_fail(BB_INVALID, "%u builders with %u searches are more than %d ways, or none",
                       request->builder_count, request->search_count, BB_CONTEST_WAYS_MAX - 1);
    bb_contest *c = calloc(1, sizeof *c);
    if (c == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    c->request = request;
    c->task = task;
    c->first = first;
    c->way_count = count;
    c->random = bb_random_make(request->seed, 0);
    c->audit = request->audit != NULL ? request->audit : &c->no_audit;
    bb_status status = run(c);
    if (status == BB_OK)
        fill(c, table);
    bb_contest_clean_up(c);
    return status;
}
