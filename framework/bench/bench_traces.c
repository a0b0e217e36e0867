/* Traces all cells of one ray set, interleaved, and judges each answer (bench_cell.h). */
#include "framework/bench/bench_cell.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Primitive tests that a tree of one leaf (brute force) is allowed per set. */
static const double brute_force_tests = 1e9;

/* Returns the cell's parts as in its record. A tracer has no kernel and no intersector. */
static bb_cell_parts cell_of(const bb_trace_set *set, const bb_traced_cell *c)
{
    const bb_trace_record *r = &c->record;
    bb_cell_parts cell = bb_bench_cell(set->bench);
    snprintf(cell.rays, sizeof cell.rays, "%s", r->rays);
    snprintf(cell.view, sizeof cell.view, "%s", r->view);
    snprintf(cell.builder, sizeof cell.builder, "%s", r->builder);
    if (r->reference)
        return cell;
    snprintf(cell.kernel, sizeof cell.kernel, "%s", r->kernel);
    snprintf(cell.intersector, sizeof cell.intersector, "%s", r->intersector);
    return cell;
}

/* A tracer has neither kernel nor intersector: the record has its own names in their places. */
static void put_names(const bb_entrant *entrant, bb_trace_record *r)
{
    const bb_tracer *tracer = entrant->tracer;
    const char *code = tracer->code != NULL ? tracer->code : tracer->name;
    snprintf(r->kernel, sizeof r->kernel, "%s", code);
    snprintf(r->intersector, sizeof r->intersector, "%s%s%s", code,
             tracer->exactness != NULL ? "-" : "",
             tracer->exactness != NULL
                 ? bb_spec_value(&entrant->spec, tracer->options, tracer->exactness)
                 : "");
}

static void start_cell(bb_trace_set *set, bb_traced_cell *c, bb_entrant *entrant, uint32_t kernel,
                       uint32_t i)
{
    bb_bench *bench = set->bench;
    const bb_intersector *intersector = entrant->tracer != NULL ? NULL : &bench->intersectors[i];
    bb_rays *rays = set->rays;
    *c = (bb_traced_cell){.entrant = entrant, .kernel = kernel, .intersector = intersector};
    if (entrant->tracer == NULL)
        c->layout = bb_bench_layout_of(bench, kernel, intersector);
    bb_trace_record *r = &c->record;
    bb_trace_record_init(r);
    r->reference = entrant->tracer != NULL;
    snprintf(r->scene, sizeof r->scene, "%s", bench->scene->name);
    snprintf(r->view, sizeof r->view, "%s", rays->view);
    snprintf(r->builder, sizeof r->builder, "%s", entrant->text);
    snprintf(r->rays, sizeof r->rays, "%s", rays->name);
    if (entrant->tracer != NULL) {
        put_names(entrant, r);
        snprintf(r->traced_on, sizeof r->traced_on, "%s",
                 bench->device->is_cpu ? "" : BB_DEVICE_CPU);
    } else {
        snprintf(r->kernel, sizeof r->kernel, "%s", bench->kernels[kernel].spec.text);
        snprintf(r->intersector, sizeof r->intersector, "%s", bench->request->intersectors[i]);
    }
    bb_cell_parts key = cell_of(set, c);
    bb_bench_key(&key, r->cell);
    r->query = rays->query;
    r->rays_hash = rays->hash;
    r->rays_spec = &rays->spec;
    r->rays_options = rays->options;
    r->status = entrant->record.status;
    snprintf(r->reason, sizeof r->reason, "%s", entrant->record.reason);
    const char *death = bb_guard_death(bb_trace_guarded(r));
    if (r->status == BB_OK && death != NULL) {
        r->status = BB_FAILED;
        snprintf(r->reason, sizeof r->reason, "%s", death);
    }
    r->counts_for_exit = entrant->tracer == NULL && bb_intersector_is_exact(intersector);

    c->count = rays->count;
    const bb_tree_info *tree = &entrant->record.tree;
    if (entrant->tracer == NULL && entrant->record.has_tree && tree->node_count == 1 &&
        (double)tree->ref_count * rays->count > brute_force_tests) {
        c->count = (uint32_t)(brute_force_tests / tree->ref_count);
        c->count = c->count > 0 ? c->count : 1;
    }
    r->count = c->count;
    c->batch = bench->batch;
    if (entrant->tracer == NULL && !bench->device->is_cpu && c->batch > BB_LAUNCH_FIRST)
        c->batch = BB_LAUNCH_FIRST;
}

static bb_status start_set(bb_trace_set *set)
{
    bb_bench *bench = set->bench;
    const bb_bench_request *request = bench->request;
    uint32_t each = bench->kernel_count * request->intersector_count;
    uint32_t most = bench->entrant_count * (each > 0 ? each : 1); /* a tracer is one cell */
    set->cells = calloc(most, sizeof *set->cells);
    if (set->cells == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    for (uint32_t e = 0; e < bench->entrant_count; e++) {
        bb_entrant *entrant = &bench->entrants[e];
        uint32_t kernels = entrant->tracer != NULL ? 1 : bench->kernel_count;
        uint32_t intersectors = entrant->tracer != NULL ? 1 : request->intersector_count;
        for (uint32_t k = 0; k < kernels; k++) {
            if (entrant->tracer == NULL && !bb_bench_takes(bench, entrant, k))
                continue;
            for (uint32_t i = 0; i < intersectors; i++) {
                bb_traced_cell *c = &set->cells[set->count];
                start_cell(set, c, entrant, k, i);
                bb_cell_parts parts = cell_of(set, c);
                set->count += bb_bench_wants(bench, &parts);
            }
        }
    }
    bench->outcome->cells += set->count;
    BB_TRY(bb_host_alloc(NULL, set->rays->count * set->bytes, "answers", &set->results));
    uint32_t first = set->rays->count < bench->batch ? set->rays->count : bench->batch;
    BB_TRY(bb_trace_load(set, 0, first));
    bb_step step = bb_bench_begin(bench);
    BB_TRY(bb_answers_trace(bench->oracle, set->rays, &set->answers));
    BB_TRY(bb_bench_end(bench, step, "oracle: trace", BB_OK));
    step = bb_bench_begin(bench);
    bb_status status = bb_answers_show(bench->oracle, &set->answers);
    return bb_bench_end(bench, step, "oracle: arbitrate", status);
}

/* A cell's turn. Rounds of warming up are no samples. */
static bb_status take_turn(void *self, uint32_t who, uint32_t round, double *ms)
{
    bb_trace_set *set = self;
    bb_traced_cell *c = &set->cells[who];
    const bool warming = round == BB_WARMING_UP;
    if (bb_interrupted())
        return BB_OK;
    if (!warming)
        bb_bench_show_progress(set->bench);
    if (c->record.status != BB_OK || (warming && c->entrant->tracer != NULL))
        return BB_OK;
    bb_timing timing;
    set->warming = warming;
    bb_status status = bb_trace_once(set, c, &timing);
    if (status == BB_OK)
        *ms += timing.ms;
    if (status == BB_OK && !warming) {
        bb_samples_add(&c->record.ms, timing.ms);
        bb_samples_add(&c->record.event_ms, timing.event_ms);
        bb_samples_add(&c->record.cpu_ms, timing.cpu_ms);
        if (c->traverser != NULL && bb_traverser_sorts(c->traverser))
            bb_samples_add(&c->record.sort_ms, c->sort_ms);
        status = bb_trace_judge(set, c);
    }
    if (status != BB_OK)
        bb_trace_note_failure(c, status);
    c->record.warm_rounds += warming;
    return BB_OK;
}

static bb_status run_rounds(bb_trace_set *set, uint32_t rounds)
{
    bb_bench *bench = set->bench;
    bb_turns turns = {.device = bench->device,
                      .random = &bench->random,
                      .count = set->count,
                      .self = set,
                      .turn = take_turn};
    BB_TRY(bb_turns_warm_up(&turns, bench->progress, bench->scene->name, set->rays->name));
    for (uint32_t round = 0; round < rounds && !bb_interrupted(); round++)
        BB_TRY(bb_turns_round(&turns, round));
    return BB_OK;
}

static bb_status record_cell(bb_trace_set *set, bb_traced_cell *c)
{
    bb_bench *bench = set->bench;
    bb_trace_record *r = &c->record;
    if (r->status == BB_OK && r->ms.count == 0)
        return BB_OK; /* the run was interrupted before its turn */
    if (r->status == BB_OK && !bb_interrupted()) {
        bb_status status = bb_trace_count(set, c);
        if (status == BB_OK)
            status = bb_trace_simulate(set, c);
        if (status != BB_OK)
            bb_trace_note_failure(c, status);
    }
    r->wrong = r->has_accuracy && r->accuracy.wrong_ppm > bench->request->max_wrong_ppm;
    bool failed = strcmp(bb_status_word(r->status), "failed") == 0;
    const bool bad = r->counts_for_exit ? r->wrong || failed || r->unlike > 0
                                        : c->entrant->tracer != NULL && failed;
    if (bad && c->entrant->record.status == BB_OK)
        bench->outcome->wrong++;
    bench->judged += r->has_accuracy;
    return bb_results_add_trace(bench->results, r);
}

bb_status bb_bench_traces(bb_bench *bench, bb_rays *rays)
{
    bb_trace_set set = {.bench = bench, .rays = rays, .bytes = rays->query->result_bytes};
    bb_step step = bb_bench_begin(bench);
    bb_status status = bb_bench_end(bench, step, "make rays", start_set(&set));
    if (status != BB_OK)
        goto out;
    uint32_t rounds = bench->request->repeats + 1;
    bb_progress_stage(bench->progress, set.count * rounds, "%s: %s%s%s, %u rays",
                      bench->scene->name, rays->name, rays->view[0] != '\0' ? " from " : "",
                      rays->view, rays->count);
    bb_progress_weigh(bench->progress, (double)bb_bench_cells_of_set(bench) * rounds);
    for (uint32_t i = 0; i < set.count; i++) {
        if (set.cells[i].record.status != BB_OK || bb_interrupted())
            continue;
        bb_status prepared = bb_trace_prepare(&set, &set.cells[i]);
        if (prepared != BB_OK)
            bb_trace_note_failure(&set.cells[i], prepared);
    }
    status = run_rounds(&set, rounds);
    if (status == BB_OK && !bench->request->lean)
        status = bb_trace_unseen(&set);
    step = bb_bench_begin(bench);
    for (uint32_t i = 0; i < set.count && status == BB_OK; i++)
        status = record_cell(&set, &set.cells[i]);
    status = bb_bench_end(bench, step, "keep records", status);
out:
    step = bb_bench_begin(bench);
    bb_answers_release(&set.answers);
    bb_host_free(set.results);
    bb_host_free(set.first);
    free(set.cells);
    return bb_bench_end(bench, step, "keep records", status);
}
