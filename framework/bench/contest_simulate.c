/* What each way's answer to the first question takes on GPUs on paper. */
#include "framework/bench/contest_private.h"
#include "framework/simulate/steps.h"
#include "kernels/bb_shared.h"

#include <stdio.h>
#include <string.h>

typedef struct asked {
    bb_contest *contest;
    const bb_contest_runner *runner;
    uint32_t items;
} asked;

static bb_status launch(void *self, const bb_recording *recording)
{
    const asked *a = self;
    bb_contest *c = a->contest;
    const bb_contest_answers answers = {&c->d_answers, &c->d_counts, recording};
    BB_TRY(bb_buffer_fill(&c->d_answers, a->items * c->task->answer_bytes, BB_POISON));
    return c->task->ask(c->task->self, a->runner, answers);
}

static bb_status describe(bb_contest *c, const bb_contest_runner *r, bb_simulated_code *code)
{
    if (c->task->code == NULL)
        return bb_fail(BB_UNSUPPORTED, "its steps are not recorded");
    if (!r->without) {
        const bb_contest_entrant *e = &c->entrants[r->entrant];
        BB_TRY(bb_contest_bring(c, e, e->choices[r->choice].layout));
    }
    return c->task->code(c->task->self, r, code);
}

/* The same way by layouts whose addresses are the same on all machines. */
static bb_status by_ordered_layouts(bb_contest *c, bb_contest_runner *r)
{
    if (r->without)
        return BB_OK;
    const bb_contest_entrant *e = &c->entrants[r->entrant];
    const uint32_t layout = e->choices[r->choice].simulated;
    BB_TRY(bb_contest_bring(c, e, layout));
    for (uint32_t s = 0; s < e->tree_count; s++)
        r->data[s] = &e->trees[s].layouts[layout];
    return BB_OK;
}

/* What is recorded must answer as what is measured does. */
static bb_status check_answers(bb_contest *c, const bb_contest_runner *r, uint32_t items)
{
    const size_t bytes = items * c->task->answer_bytes;
    BB_TRY(bb_buffer_read(&c->d_answers, 0, bytes, c->with));
    return r->way->differ > 0 || memcmp(c->with, c->without, bytes) == 0
               ? BB_OK
               : bb_fail(BB_FAILED,
                         "%s: the variant of %.60s %.60s that records its steps answers "
                         "otherwise",
                         c->request->name, r->way->builder, r->way->search);
}

static bb_status replay(bb_contest *c, const bb_contest_runner *way, uint32_t items,
                        const bb_simulated_code *code)
{
    const bb_contest_request *request = c->request;
    bb_contest_runner runner = *way;
    bb_steps steps;
    asked self = {c, &runner, items};
    BB_TRY(by_ordered_layouts(c, &runner));
    BB_TRY(bb_steps_record(request->device, launch, &self, items, BB_SIMT_SAMPLE, &steps));
    bb_status status = check_answers(c, way, items);
    for (uint32_t i = 0; i < request->simt_count && status == BB_OK; i++)
        status = bb_simulate_code(&request->simts[i], code, &steps, &way->way->simulations[i]);
    bb_steps_release(&steps);
    return status;
}

static bb_status simulate(bb_contest *c, const bb_contest_runner *way, uint32_t items)
{
    bb_simulated_code code = {.program = ""};
    bb_status status = describe(c, way, &code);
    if (status == BB_OK)
        status = replay(c, way, items, &code);
    bb_simulated_code_release(&code);
    return status;
}

bb_status bb_contest_simulate(bb_contest *c, uint32_t items)
{
    if (c->request->simt_count == 0 || c->task->blank)
        return BB_OK;
    for (uint32_t w = 0; w < c->way_count; w++) {
        bb_contest_way *way = &c->ways[w];
        if (way->refused[0] != '\0')
            continue;
        const bb_status status = simulate(c, &c->runners[w], items);
        way->simulated = status == BB_OK;
        snprintf(way->unsimulated, sizeof way->unsimulated, "%s",
                 status == BB_OK ? "" : bb_message());
    }
    return BB_OK;
}
