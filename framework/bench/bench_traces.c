/* Traces all cells of one ray set, interleaved, and judges each answer. */
#include "framework/bench/bench_private.h"

#include "framework/base/clock.h"
#include "framework/builder/guard.h"
#include "framework/workload/workload.h"
#include "traversal/pass.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

/* Primitive tests that a tree of one leaf (brute force) is allowed per set. */
static const double brute_force_tests = 1e9;

typedef struct cell {
    bb_entrant *entrant;
    uint32_t kernel; /* index of the kernel's choice */
    uint32_t layout; /* index of the layout that it reads */
    const bb_intersector *intersector;
    bb_tracer *tracer;
    uint32_t count; /* rays that it traces, the first of the set */
    uint32_t batch; /* most rays of a launch */
    bb_trace_record record;
    uint64_t hits_hash;
    bool judged;
} cell;

typedef struct trace_set {
    bb_bench *bench;
    bb_rays *rays;
    bb_answers answers;
    size_t bytes;    /* size of one ray's answer */
    char *results;   /* answers of the last trace, on the host */
    char *first;     /* the first full answer of an `exact` cell, which all others must equal */
    char whose[256]; /* that cell; "": none yet */
    uint32_t loaded_from, loaded; /* the rays of the set that are on the device */
    bool warming;                 /* the round does not count */
    cell *cells;
    uint32_t count;
} trace_set;

/* ---- one measurement ---- */

/* Returns a pass through the bench's buffers. */
static bb_pass pass_of(const trace_set *set, const cell *c)
{
    return (bb_pass){.query = set->rays->query,
                     .tracer = c->tracer,
                     .layout = &c->entrant->resident->layouts[c->layout],
                     .rays = &set->bench->rays,
                     .results = &set->bench->answers};
}

/* Uploads rays [from, from + count), unless they are on the device already. */
static bb_status load_batch(trace_set *set, uint32_t from, uint32_t count)
{
    if (from == set->loaded_from && count <= set->loaded)
        return BB_OK;
    set->loaded_from = from;
    set->loaded = count;
    return bb_buffer_write(&set->bench->rays, 0, count * sizeof(bb_ray), set->rays->rays + from);
}

/* Traces a batch, and adds the rays that were launched while the clock ran to *timed. */
static bb_status trace_batch(trace_set *set, const bb_pass *pass, uint32_t count, bb_timing *timing,
                             uint64_t *timed)
{
    bb_stopwatch watch;
    BB_TRY(bb_stopwatch_start(set->bench->device, &watch));
    uint64_t before = bb_tracer_launched(pass->tracer);
    bb_status status = bb_pass_launch(pass, count);
    *timed += bb_tracer_launched(pass->tracer) - before;
    return bb_stopwatch_stop(&watch, status, timing);
}

/* Traces with the reference, which uses the device's buffers if the host can reach them, else
 * copies. */
static bb_status trace_reference(trace_set *set, cell *c, uint32_t from, uint32_t count,
                                 bb_timing *timing)
{
    bb_bench *bench = set->bench;
    void *rays = set->rays->rays + from, *hits = set->results + from * set->bytes;
    bool mapped = bench->device->is_cpu;
    if (mapped) {
        BB_TRY(bb_buffer_map(&bench->rays, false, &rays));
        bb_status status = bb_buffer_map(&bench->answers, true, &hits);
        if (status != BB_OK) {
            (void)bb_buffer_unmap(&bench->rays, rays);
            return status;
        }
    } else {
        memset(hits, 0xEE, count * set->bytes);
    }
    bb_status status = bb_embree_set_query(c->entrant->embree, &c->entrant->spec);
    double cpu = bb_cpu_ms(), start = bb_wall_ms();
    if (status == BB_OK)
        status = bb_embree_trace(c->entrant->embree, rays, count, set->rays->query, hits);
    *timing = (bb_timing){.ms = bb_wall_ms() - start,
                          .cpu_ms = bb_cpu_ms() - cpu,
                          .event_ms = bb_embree_span_ms(c->entrant->embree)};
    bb_status unmapped[2] = {BB_OK, BB_OK};
    if (mapped) {
        unmapped[0] = bb_buffer_unmap(&bench->rays, rays);
        unmapped[1] = bb_buffer_unmap(&bench->answers, hits);
    }
    return status != BB_OK ? status : unmapped[0] != BB_OK ? unmapped[0] : unmapped[1];
}

/* Keeps launches short enough for a display's watchdog. They grow and shrink while the device warms
 * up. After that they only shrink, so that counting rounds are split alike. */
static void fit_batch(const trace_set *set, cell *c, uint32_t count, double ms)
{
    if (c->entrant->reference || set->bench->device->is_cpu)
        return;
    if ((set->warming && count == c->batch) || ms > BB_LAUNCH_MS)
        c->batch = bb_launch_rays(count, ms, set->bench->batch);
}

/* What would be missing if this died. */
static bb_guarded guarded(const bb_trace_record *r)
{
    return (bb_guarded){r->scene, r->cell};
}

static void enter(const bb_trace_record *r, const char *hook)
{
    char who[512];
    snprintf(who, sizeof who, "%.200s on %.200s", r->kernel, r->builder);
    bb_guard_enter(guarded(r), who, hook);
}

/* Traces the cell's rays once, in batches, into set->results. A reference's event time is that of
 * its threads. */
static bb_status trace_rays(trace_set *set, cell *c, bb_timing *timing)
{
    bool reference = c->entrant->reference;
    *timing = (bb_timing){0};
    bb_step step = bb_bench_begin(set->bench);
    const bb_pass pass = pass_of(set, c);
    uint64_t timed = 0, before = reference ? 0 : bb_tracer_launched(c->tracer);
    c->record.launches = 0;
    for (uint32_t from = 0, count; from < c->count; from += count) {
        count = c->count - from < c->batch ? c->count - from : c->batch;
        BB_TRY(load_batch(set, from, count));
        BB_TRY(bb_pass_poison(&pass, count));
        bb_timing part;
        BB_TRY(reference ? trace_reference(set, c, from, count, &part)
                         : trace_batch(set, &pass, count, &part, &timed));
        fit_batch(set, c, count, part.ms);
        c->record.launches++;
        timing->ms += part.ms;
        timing->cpu_ms += part.cpu_ms;
        timing->event_ms += part.event_ms;
        if (!reference || set->bench->device->is_cpu)
            BB_TRY(bb_buffer_read(&set->bench->answers, 0, count * set->bytes,
                                  set->results + from * set->bytes));
    }
    char what[256];
    snprintf(what, sizeof what, "trace of %.60s, %.40s by %.60s on %.60s", c->record.scene,
             c->record.rays, c->record.kernel, c->record.builder);
    bb_audit_timing(&set->bench->outcome->audit, what, timing, true);
    if (!reference)
        bb_audit_launches(&set->bench->outcome->audit, what, timed,
                          bb_tracer_launched(c->tracer) - before, c->count);
    set->bench->outcome->times.trace_ms += timing->ms;
    return bb_bench_end(set->bench, step, "poison and copy answers", BB_OK);
}

static bb_status trace_once(trace_set *set, cell *c, bb_timing *timing)
{
    if (!c->entrant->reference)
        BB_TRY(bb_bench_layout(set->bench, c->entrant, c->layout));
    enter(&c->record, "trace");
    bb_status status = trace_rays(set, c, timing);
    bb_guard_leave();
    return status;
}

/* ---- preparation and judgement ---- */

static bb_tracer_request tracer_request(const trace_set *set, const cell *c)
{
    const bb_kernel_choice *choice = &set->bench->kernels[c->kernel];
    return (bb_tracer_request){
        .kernel = choice->kernel,
        .spec = &choice->spec,
        .intersector = c->intersector,
        .query = set->rays->query,
    };
}

/* Notes once, for a kernel made for CPUs, what it needs on another device. */
static void note_private(bb_bench *bench, bb_kernel_choice *choice, const bb_tracer *tracer)
{
    char by_driver[48] = "the driver does not tell how much in all";
    uint64_t bytes;
    if (bench->device->is_cpu || choice->noted || !bb_kernel_is_for_cpus(choice->kernel))
        return;
    choice->noted = true;
    if (bb_tracer_private_bytes(tracer, &bytes))
        snprintf(by_driver, sizeof by_driver, "%llu in all, says the driver",
                 (unsigned long long)bytes);
    bb_progress_note(bench->progress,
                     "%s is for CPUs: the stacks of a work-item are %llu bytes of private memory "
                     "(%s)",
                     choice->spec.text, (unsigned long long)bb_tracer_stack_bytes(tracer),
                     by_driver);
}

/* Notes once for each kernel that its stack is shorter than the tree needs, for lack of room on the
 * device. */
static void note_stack(bb_bench *bench, bb_kernel_choice *choice, const bb_decisions *decisions)
{
    for (uint32_t i = 0; i < decisions->count && !choice->capped; i++) {
        const bb_decision *d = &decisions->items[i];
        choice->capped = d->by == BB_BY_DEVICE;
        if (choice->capped)
            bb_progress_note(
                bench->progress,
                "%s has a stack of %s entries: %s; rays that need more are missed, and "
                "counted: the kernel short takes any tree",
                choice->spec.text, d->value, d->figure);
    }
}

static bb_status make_tracer(trace_set *set, cell *c)
{
    bb_bench *bench = set->bench;
    const bb_layout_data *layout = &c->entrant->resident->layouts[c->layout];
    bb_tracer_request request = tracer_request(set, c);
    bb_step step = bb_bench_begin(bench);
    BB_TRY(bb_tracer_get(bench->device, &request, layout, &c->tracer));
    c->record.group_size = bb_tracer_group_size(c->tracer);
    c->record.stack_size = bb_tracer_stack_size(c->tracer);
    BB_TRY(bb_tracer_decide(bench->device, &request, layout, &c->record.decisions));
    note_stack(bench, &bench->kernels[c->kernel], &c->record.decisions);
    note_private(bench, &bench->kernels[c->kernel], c->tracer);
    snprintf(c->record.layout, sizeof c->record.layout, "%s", layout->name);
    c->record.native = layout->keeps_shape;
    /* compile for the group size before the clock runs */
    uint32_t few = c->count < c->record.group_size ? c->count : c->record.group_size;
    const bb_pass pass = pass_of(set, c);
    BB_TRY(bb_pass_launch(&pass, few));
    BB_TRY(bb_finish(bench->device));
    return bb_bench_end(bench, step, "compile kernels", BB_OK);
}

static bb_status prepare_cell(trace_set *set, cell *c)
{
    if (c->entrant->reference)
        return BB_OK;
    BB_TRY(bb_bench_layout(set->bench, c->entrant, c->layout));
    enter(&c->record, "compile");
    bb_status status = make_tracer(set, c);
    bb_guard_leave();
    return status;
}

/* Judges set->results, unless the same answer was judged before. If a cell gives different answers,
 * the worst counts. */
static bb_status judge_cell(trace_set *set, cell *c)
{
    uint64_t hash = XXH3_64bits(set->results, c->count * set->bytes);
    if (c->judged && hash == c->hits_hash)
        return BB_OK;
    bb_accuracy accuracy;
    const bb_verdict_request wanted = {
        .results = set->results, .count = c->count, .may_be_unnamed = c->entrant->reference};
    BB_TRY(bb_judge(set->bench->oracle, &set->answers, &wanted, &accuracy));
    if (!c->judged || accuracy.wrong_ppm > c->record.accuracy.wrong_ppm)
        c->record.accuracy = accuracy;
    c->record.has_accuracy = true;
    c->judged = true;
    c->hits_hash = hash;
    return BB_OK;
}

/* Compares answers with those of the first `exact` cell. `exact` answers do not depend on builder,
 * layout and kernel (kernels/ERROR_BUDGET.md), so if two cells differ, one of them is wrong. */
static bb_status compare_cell(trace_set *set, cell *c)
{
    bb_trace_record *r = &c->record;
    if (!r->counts_for_exit || !bb_device_divides_exactly(set->bench->device))
        return BB_OK;
    if (set->whose[0] == '\0') {
        if (c->count < set->rays->count)
            return BB_OK;
        BB_TRY(bb_host_alloc(NULL, c->count * set->bytes, "answers", &set->first));
        memcpy(set->first, set->results, c->count * set->bytes);
        snprintf(set->whose, sizeof set->whose, "%.100s on %.100s", r->kernel, r->builder);
    }
    uint32_t unlike = 0;
    for (uint32_t i = 0; i < c->count; i++)
        unlike += !r->query->same(set->results + i * set->bytes, set->first + i * set->bytes);
    r->unlike = unlike > r->unlike ? unlike : r->unlike;
    snprintf(r->unlike_whom, sizeof r->unlike_whom, "%s", set->whose);
    return BB_OK;
}

/* Judges and compares the answers. */
static bb_status hold_answers(trace_set *set, cell *c)
{
    bb_step step = bb_bench_begin(set->bench);
    bb_status status = judge_cell(set, c);
    if (status == BB_OK)
        status = compare_cell(set, c);
    return bb_bench_end(set->bench, step, "judge answers", status);
}

static bb_status count_tests(trace_set *set, cell *c)
{
    bb_bench *bench = set->bench;
    if (c->entrant->reference || bench->request->lean)
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    BB_TRY(bb_bench_layout(bench, c->entrant, c->layout));
    /* brute force tests all primitives with each ray: a few rays are enough */
    uint32_t most = c->entrant->record.tree.node_count == 1 ? 64 : BB_COUNTED_RAYS;
    uint32_t count = c->count < most ? c->count : most;
    bb_tests tests;
    enter(&c->record, "count");
    bb_status status = bb_count_tests(&bench->counter, tracer_request(set, c),
                                      &c->entrant->resident->layouts[c->layout], set->rays,
                                      c->count, count, &tests);
    bb_guard_leave();
    BB_TRY(status);
    c->record.node_tests_per_ray = (double)tests.nodes / count;
    c->record.prim_tests_per_ray = (double)tests.prims / count;
    c->record.overflowed = tests.overflowed;
    c->record.counted = count;
    return bb_bench_end(bench, step, "count tests", BB_OK);
}

/* ---- the set ---- */

/* Records a failure, unless it failed because the run was interrupted. */
static void note_failure(cell *c, bb_status status)
{
    if (bb_interrupted())
        return;
    c->record.status = status;
    snprintf(c->record.reason, sizeof c->record.reason, "%s", bb_message());
}

/* Returns the cell's parts as in its record. A reference has no kernel and no intersector. */
static bb_cell_parts cell_of(const trace_set *set, const cell *c)
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

static void start_cell(trace_set *set, cell *c, bb_entrant *entrant, uint32_t kernel, uint32_t i)
{
    bb_bench *bench = set->bench;
    const bb_intersector *intersector = entrant->reference ? NULL : &bench->intersectors[i];
    bb_rays *rays = set->rays;
    *c = (cell){.entrant = entrant, .kernel = kernel, .intersector = intersector};
    if (!entrant->reference)
        c->layout = bb_bench_layout_of(bench, kernel, intersector);
    bb_trace_record *r = &c->record;
    bb_trace_record_init(r);
    r->reference = entrant->reference;
    snprintf(r->scene, sizeof r->scene, "%s", bench->scene->name);
    snprintf(r->view, sizeof r->view, "%s", rays->view);
    snprintf(r->builder, sizeof r->builder, "%s", entrant->text);
    snprintf(r->rays, sizeof r->rays, "%s", rays->name);
    if (entrant->reference) {
        snprintf(r->kernel, sizeof r->kernel, BB_EMBREE_KERNEL);
        snprintf(r->intersector, sizeof r->intersector, "embree-%s",
                 bb_spec_value(&entrant->spec, bb_embree_options, "mode"));
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
    const char *death = bb_guard_death(guarded(r));
    if (r->status == BB_OK && death != NULL) {
        r->status = BB_FAILED;
        snprintf(r->reason, sizeof r->reason, "%s", death);
    }
    r->counts_for_exit = !entrant->reference && bb_intersector_is_exact(intersector);

    c->count = rays->count;
    const bb_tree_info *tree = &entrant->record.tree;
    if (!entrant->reference && entrant->record.has_tree && tree->node_count == 1 &&
        (double)tree->ref_count * rays->count > brute_force_tests) {
        c->count = (uint32_t)(brute_force_tests / tree->ref_count);
        c->count = c->count > 0 ? c->count : 1;
    }
    r->count = c->count;
    c->batch = bench->batch;
    if (!entrant->reference && !bench->device->is_cpu && c->batch > BB_LAUNCH_FIRST)
        c->batch = BB_LAUNCH_FIRST;
}

static bb_status start_set(trace_set *set)
{
    bb_bench *bench = set->bench;
    const bb_bench_request *request = bench->request;
    uint32_t each = bench->kernel_count * request->intersector_count;
    uint32_t most = bench->entrant_count * (each > 0 ? each : 1); /* a reference is one cell */
    set->cells = calloc(most, sizeof *set->cells);
    if (set->cells == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    for (uint32_t e = 0; e < bench->entrant_count; e++) {
        bb_entrant *entrant = &bench->entrants[e];
        uint32_t kernels = entrant->reference ? 1 : bench->kernel_count;
        uint32_t intersectors = entrant->reference ? 1 : request->intersector_count;
        for (uint32_t k = 0; k < kernels; k++) {
            if (!entrant->reference && !bb_bench_takes(bench, entrant, k))
                continue;
            for (uint32_t i = 0; i < intersectors; i++) {
                cell *c = &set->cells[set->count];
                start_cell(set, c, entrant, k, i);
                bb_cell_parts parts = cell_of(set, c);
                set->count += bb_bench_wants(bench, &parts);
            }
        }
    }
    bench->outcome->cells += set->count;
    BB_TRY(bb_host_alloc(NULL, set->rays->count * set->bytes, "answers", &set->results));
    uint32_t first = set->rays->count < bench->batch ? set->rays->count : bench->batch;
    BB_TRY(load_batch(set, 0, first));
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
    trace_set *set = self;
    cell *c = &set->cells[who];
    const bool warming = round == BB_WARMING_UP;
    if (bb_interrupted())
        return BB_OK;
    if (!warming)
        bb_progress_step(set->bench->progress);
    if (c->record.status != BB_OK || (warming && c->entrant->reference))
        return BB_OK;
    bb_timing timing;
    set->warming = warming;
    bb_status status = trace_once(set, c, &timing);
    if (status == BB_OK)
        *ms += timing.ms;
    if (status == BB_OK && !warming) {
        bb_samples_add(&c->record.ms, timing.ms);
        bb_samples_add(&c->record.event_ms, timing.event_ms);
        bb_samples_add(&c->record.cpu_ms, timing.cpu_ms);
        status = hold_answers(set, c);
    }
    if (status != BB_OK)
        note_failure(c, status);
    c->record.warm_rounds += warming;
    return BB_OK;
}

static bb_status run_rounds(trace_set *set, uint32_t rounds)
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

static bb_status record_cell(trace_set *set, cell *c)
{
    bb_bench *bench = set->bench;
    bb_trace_record *r = &c->record;
    if (r->status == BB_OK && r->ms.count == 0)
        return BB_OK; /* the run was interrupted before its turn */
    if (r->status == BB_OK && !bb_interrupted()) {
        bb_status status = count_tests(set, c);
        if (status != BB_OK)
            note_failure(c, status);
    }
    r->wrong = r->has_accuracy && r->accuracy.wrong_ppm > bench->request->max_wrong_ppm;
    bool failed = strcmp(bb_status_word(r->status), "failed") == 0;
    if (r->counts_for_exit && c->entrant->record.status == BB_OK &&
        (r->wrong || failed || r->unlike > 0))
        bench->outcome->wrong++;
    bench->judged += r->has_accuracy;
    return bb_results_add_trace(bench->results, r);
}

bb_status bb_bench_traces(bb_bench *bench, bb_rays *rays)
{
    trace_set set = {.bench = bench, .rays = rays, .bytes = rays->query->result_bytes};
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
        bb_status prepared = prepare_cell(&set, &set.cells[i]);
        if (prepared != BB_OK)
            note_failure(&set.cells[i], prepared);
    }
    status = run_rounds(&set, rounds);
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
