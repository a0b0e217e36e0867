#include "framework/bench/bench_cell.h"
#include "framework/simulate/trace_steps.h"

#include "traversal/pass.h"

#include <stdio.h>
#include <string.h>
#include <xxhash.h>

void bb_trace_note_failure(bb_traced_cell *c, bb_status status)
{
    if (bb_interrupted())
        return;
    c->record.status = status;
    snprintf(c->record.reason, sizeof c->record.reason, "%s", bb_message());
}

/* ---- one measurement ---- */

/* Returns a pass through the bench's buffers. */
static bb_pass pass_of(const bb_trace_set *set, const bb_traced_cell *c)
{
    return (bb_pass){.query = set->rays->query,
                     .traverser = c->traverser,
                     .layout = &c->entrant->resident->layouts[c->layout],
                     .rays = &set->bench->rays,
                     .results = &set->bench->answers};
}

bb_status bb_trace_load(bb_trace_set *set, uint32_t from, uint32_t count)
{
    if (from == set->loaded_from && count <= set->loaded)
        return BB_OK;
    set->loaded_from = from;
    set->loaded = count;
    return bb_buffer_write(&set->bench->rays, 0, count * sizeof(bb_ray), set->rays->rays + from);
}

static void add_timing(bb_timing *sum, const bb_timing *part)
{
    sum->ms += part->ms;
    sum->cpu_ms += part->cpu_ms;
    sum->event_ms += part->event_ms;
}

/* Sorts and traces a batch, and adds the rays that were launched while the clock ran to *timed. Of
 * *timing, the sort took *sort_ms. */
static bb_status trace_batch(bb_trace_set *set, const bb_pass *pass, uint32_t count,
                             bb_timing *timing, double *sort_ms, uint64_t *timed)
{
    bb_stopwatch watch;
    bb_timing sort = {0};
    if (bb_traverser_sorts(pass->traverser)) {
        BB_TRY(bb_stopwatch_start(set->bench->device, &watch));
        BB_TRY(bb_stopwatch_stop(&watch, bb_pass_sort(pass, count), &sort));
    }
    BB_TRY(bb_stopwatch_start(set->bench->device, &watch));
    uint64_t before = bb_traverser_launched(pass->traverser);
    bb_status status = bb_pass_trace(pass, count);
    *timed += bb_traverser_launched(pass->traverser) - before;
    BB_TRY(bb_stopwatch_stop(&watch, status, timing));
    add_timing(timing, &sort);
    *sort_ms = sort.ms;
    return BB_OK;
}

/* Traces with a tracer, which uses the device's buffers if the host can reach them, else copies. It
 * must leave the rays as they are, since others trace them too. */
static bb_status trace_outside(bb_trace_set *set, bb_traced_cell *c, uint32_t from, uint32_t count,
                               bb_timing *timing)
{
    bb_bench *bench = set->bench;
    const bb_query *query = set->rays->query;
    void *rays = NULL, *hits = set->results + from * set->bytes;
    const bool mapped = bench->device->is_cpu;
    if (!query->is_hit)
        return bb_fail(BB_UNSUPPORTED, "%s does not answer %s queries", c->entrant->tracer->name,
                       query->name);
    if (mapped) {
        BB_TRY(bb_buffer_map(&bench->rays, false, &rays));
        bb_status status = bb_buffer_map(&bench->answers, true, &hits);
        if (status != BB_OK) {
            (void)bb_buffer_unmap(&bench->rays, rays);
            return status;
        }
    } else {
        BB_TRY(bb_host_alloc(NULL, count * sizeof(bb_ray), "rays", &rays));
        memcpy(rays, set->rays->rays + from, count * sizeof(bb_ray));
        memset(hits, 0xEE, count * set->bytes);
    }
    const uint64_t before = XXH3_64bits(rays, count * sizeof(bb_ray));
    bb_status status = bb_tracing_trace(c->entrant->tracing, bb_trace_guarded(&c->record),
                                        &c->entrant->spec, rays, count, query->any, hits, timing);
    if (XXH3_64bits(rays, count * sizeof(bb_ray)) != before) {
        set->loaded = 0; /* what the device has of them is lost */
        status = bb_fail(BB_FAILED, "%s changed the rays in trace(): all others trace them too",
                         c->entrant->tracer->name);
    }
    bb_status unmapped[2] = {BB_OK, BB_OK};
    if (mapped) {
        unmapped[0] = bb_buffer_unmap(&bench->rays, rays);
        unmapped[1] = bb_buffer_unmap(&bench->answers, hits);
    } else {
        bb_host_free(rays);
    }
    return status != BB_OK ? status : unmapped[0] != BB_OK ? unmapped[0] : unmapped[1];
}

/* Keeps launches short enough for a display's watchdog. They grow and shrink while the device warms
 * up. After that they only shrink, so that counting rounds are split alike. */
static void fit_batch(const bb_trace_set *set, bb_traced_cell *c, uint32_t count, double ms)
{
    if (c->entrant->tracer != NULL || set->bench->device->is_cpu)
        return;
    if ((set->warming && count == c->batch) || ms > BB_LAUNCH_MS)
        c->batch = bb_launch_rays(count, ms, set->bench->batch);
}

bb_guarded bb_trace_guarded(const bb_trace_record *r)
{
    return (bb_guarded){r->scene, r->cell};
}

static void enter(const bb_trace_record *r, const char *hook)
{
    char who[512];
    snprintf(who, sizeof who, "%.200s on %.200s", r->kernel, r->builder);
    bb_guard_enter(bb_trace_guarded(r), who, hook);
}

/* Traces the cell's rays once, in batches, into set->results. A tracer's event time is that of its
 * threads. */
static bb_status trace_rays(bb_trace_set *set, bb_traced_cell *c, bb_timing *timing)
{
    const bool outside = c->entrant->tracer != NULL;
    *timing = (bb_timing){0};
    const bb_pass pass = pass_of(set, c);
    uint64_t timed = 0, before = outside ? 0 : bb_traverser_launched(c->traverser);
    c->record.launches = 0;
    c->sort_ms = 0;
    for (uint32_t from = 0, count; from < c->count; from += count) {
        count = c->count - from < c->batch ? c->count - from : c->batch;
        bb_guard_alive();
        BB_TRY(bb_trace_load(set, from, count));
        BB_TRY(bb_pass_poison(&pass, count));
        bb_timing part;
        double sort_ms = 0;
        BB_TRY(outside ? trace_outside(set, c, from, count, &part)
                       : trace_batch(set, &pass, count, &part, &sort_ms, &timed));
        fit_batch(set, c, count, part.ms);
        c->record.launches++;
        add_timing(timing, &part);
        c->sort_ms += sort_ms;
        if (!outside || set->bench->device->is_cpu)
            BB_TRY(bb_buffer_read(&set->bench->answers, 0, count * set->bytes,
                                  set->results + from * set->bytes));
    }
    char what[256];
    snprintf(what, sizeof what, "trace of %.60s, %.40s by %.60s on %.60s", c->record.scene,
             c->record.rays, c->record.kernel, c->record.builder);
    bb_audit_timing(&set->bench->outcome->audit, what, timing, true);
    if (!outside)
        bb_audit_launches(&set->bench->outcome->audit, what, timed,
                          bb_traverser_launched(c->traverser) - before, c->count);
    set->bench->outcome->times.trace_ms += timing->ms;
    return BB_OK;
}

bb_status bb_trace_once(bb_trace_set *set, bb_traced_cell *c, bb_timing *timing)
{
    if (c->entrant->tracer == NULL)
        BB_TRY(bb_bench_layout(set->bench, c->entrant, c->layout));
    else if (c->entrant->tracing == NULL)
        return bb_fail(c->entrant->record.status, "%s", c->entrant->record.reason);
    bb_step step = bb_bench_begin(set->bench);
    enter(&c->record, "trace");
    bb_status status = trace_rays(set, c, timing);
    bb_guard_leave();
    return bb_bench_end(set->bench, step, "poison and copy answers", status);
}

/* ---- preparation and judgement ---- */

static bb_traverser_request traverser_request(const bb_trace_set *set, const bb_traced_cell *c)
{
    const bb_kernel_choice *choice = &set->bench->kernels[c->kernel];
    return (bb_traverser_request){
        .kernel = choice->kernel,
        .spec = &choice->spec,
        .intersector = c->intersector,
        .query = set->rays->query,
    };
}

/* Notes once, for a kernel made for CPUs, what it needs on another device. */
static void note_private(bb_bench *bench, bb_kernel_choice *choice, const bb_traverser *traverser)
{
    char by_driver[48] = "the driver does not tell how much in all";
    uint64_t bytes;
    if (bench->device->is_cpu || choice->noted || !bb_kernel_is_for_cpus(choice->kernel))
        return;
    choice->noted = true;
    if (bb_traverser_private_bytes(traverser, &bytes))
        snprintf(by_driver, sizeof by_driver, "%llu in all, says the driver",
                 (unsigned long long)bytes);
    bb_progress_note(bench->progress,
                     "%s is for CPUs: the stacks of a work-item are %llu bytes of private memory "
                     "(%s)",
                     choice->spec.text, (unsigned long long)bb_traverser_stack_bytes(traverser),
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

static bb_status make_traverser(bb_trace_set *set, bb_traced_cell *c)
{
    bb_bench *bench = set->bench;
    const bb_layout_data *layout = &c->entrant->resident->layouts[c->layout];
    bb_traverser_request request = traverser_request(set, c);
    BB_TRY(bb_traverser_get(bench->device, &request, layout, &c->traverser));
    c->record.group_size = bb_traverser_group_size(c->traverser);
    c->record.stack_size = bb_traverser_stack_size(c->traverser);
    BB_TRY(bb_traverser_decide(bench->device, &request, layout, &c->record.decisions));
    note_stack(bench, &bench->kernels[c->kernel], &c->record.decisions);
    note_private(bench, &bench->kernels[c->kernel], c->traverser);
    snprintf(c->record.layout, sizeof c->record.layout, "%s", layout->name);
    c->record.native = layout->keeps_shape;
    /* compile for the group size before the clock runs */
    uint32_t few = c->count < c->record.group_size ? c->count : c->record.group_size;
    const bb_pass pass = pass_of(set, c);
    BB_TRY(bb_pass_launch(&pass, few));
    return bb_finish(bench->device);
}

bb_status bb_trace_prepare(bb_trace_set *set, bb_traced_cell *c)
{
    if (c->entrant->tracer != NULL)
        return BB_OK;
    BB_TRY(bb_bench_layout(set->bench, c->entrant, c->layout));
    bb_step step = bb_bench_begin(set->bench);
    enter(&c->record, "compile");
    bb_status status = make_traverser(set, c);
    bb_guard_leave();
    return bb_bench_end(set->bench, step, "compile kernels", status);
}

/* Judges set->results, unless the same answer was judged before. If a cell gives different answers,
 * the worst counts. */
static bb_status judge_cell(bb_trace_set *set, bb_traced_cell *c)
{
    uint64_t hash = XXH3_64bits(set->results, c->count * set->bytes);
    if (c->judged && hash == c->hits_hash)
        return BB_OK;
    bb_accuracy accuracy;
    const bb_verdict_request wanted = {
        .results = set->results, .count = c->count, .may_be_unnamed = c->entrant->tracer != NULL};
    BB_TRY(bb_bench_ready_oracle(set->bench, 0));
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
static bb_status compare_cell(bb_trace_set *set, bb_traced_cell *c)
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

bb_status bb_trace_judge(bb_trace_set *set, bb_traced_cell *c)
{
    bb_step step = bb_bench_begin(set->bench);
    bb_status status = judge_cell(set, c);
    if (status == BB_OK)
        status = compare_cell(set, c);
    return bb_bench_end(set->bench, step, "judge answers", status);
}

bb_status bb_trace_count(bb_trace_set *set, bb_traced_cell *c)
{
    bb_bench *bench = set->bench;
    if (c->entrant->tracer != NULL || bench->request->lean)
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    BB_TRY(bb_bench_layout(bench, c->entrant, c->layout));
    /* brute force tests all primitives with each ray: a few rays are enough */
    uint32_t most = c->entrant->record.tree.node_count == 1 ? 64 : BB_COUNTED_RAYS;
    uint32_t count = c->count < most ? c->count : most;
    bb_tests tests;
    enter(&c->record, "count");
    bb_status status = bb_count_tests(&bench->counter, traverser_request(set, c),
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

/* Says why a kernel is not simulated, unless that was said of it last. */
static void note_unsimulated(bb_bench *bench, bb_kernel_choice *choice, const char *why)
{
    if (strncmp(choice->unsimulated, why, sizeof choice->unsimulated - 1) != 0)
        bb_progress_note(bench->progress, "not simulated: %s", why);
    snprintf(choice->unsimulated, sizeof choice->unsimulated, "%.127s", why);
}

static bb_status simulate(bb_trace_set *set, bb_traced_cell *c, uint32_t layout)
{
    bb_bench *bench = set->bench;
    const bb_traverser_request request = traverser_request(set, c);
    const bb_layout_data *data = &c->entrant->resident->layouts[layout];
    bb_trace_record *r = &c->record;
    bb_steps steps;
    BB_TRY(bb_bench_layout(bench, c->entrant, layout));
    if (!bb_simulates_bounds(request.kernel, data->kinds)) {
        char why[640];
        snprintf(
            why, sizeof why,
            "bounds of kernel %s: kernels/isa.tsv has the code of a ray among triangles alone or "
            "spheres alone, none of a packet's",
            request.spec->text);
        note_unsimulated(bench, &bench->kernels[c->kernel], why);
    }
    enter(r, "simulate");
    bb_status status = bb_trace_steps(bench->device, &request, data, set->rays->rays, c->count,
                                      BB_SIMT_SAMPLE, &steps);
    bb_guard_leave();
    BB_TRY(status);
    for (uint32_t i = 0; i < bench->simt_count; i++) {
        const bb_simt *simt = &bench->simts[i];
        const uint32_t n = r->simulated_count;
        snprintf(r->simulated[n].name, sizeof r->simulated[n].name, "%s", simt->name);
        if (bb_simulate(simt, &request, data, &steps, &r->simulated[n].simulation) == BB_OK)
            r->simulated_count++;
        else
            note_unsimulated(bench, &bench->kernels[c->kernel], bb_message());
    }
    bb_steps_release(&steps);
    return BB_OK;
}

bb_status bb_trace_simulate(bb_trace_set *set, bb_traced_cell *c)
{
    bb_bench *bench = set->bench;
    uint32_t layout;
    if (c->entrant->tracer != NULL || bench->simt_count == 0 ||
        c->entrant->record.tree.node_count == 1)
        return BB_OK;
    bb_kernel_choice *choice = &bench->kernels[c->kernel];
    if (!bb_bench_simulates(bench, c->kernel, c->intersector, &layout)) {
        char why[640];
        snprintf(why, sizeof why, "the steps of kernel %s are not recorded", choice->spec.text);
        note_unsimulated(bench, choice, why);
        return BB_OK;
    }
    bb_step step = bb_bench_begin(bench);
    bb_status status = simulate(set, c, layout);
    if (status != BB_OK) /* what was measured stays as it is */
        note_unsimulated(bench, choice, bb_message());
    return bb_bench_end(bench, step, "simulate", BB_OK);
}
