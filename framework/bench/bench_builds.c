/* Builds all entrants, interleaved in an order that is shuffled per round; then measures their
 * trees, and makes their layouts in such rounds. */
#include "framework/bench/bench_private.h"

#include "framework/base/clock.h"
#include "framework/builder/registry.h"
#include "framework/device/device_private.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    /* builds with exact phase boundaries; on a device they are extra builds, which do not count */
    PHASE_BUILDS = 3,
    TRANSFERS = 5, /* that count, after a first one */
    METRIC_SAMPLES = 1000000,
    /* bytes; a device's compiler, which may run in any build, needs more */
    UNBOOKED_LEAST = 32 << 20,
    UNBOOKED_LEAST_ON_DEVICE = 128 << 20,
};

/* Adds phases. In a pipeline, the stage's label stands before the phase's name; NULL: it is none.
 */
static void add_phases(bb_entrant *entrant, const char *label, const bb_phases *phases)
{
    bb_build_record *record = &entrant->record;
    const bool alone = label == NULL;
    for (uint32_t i = 0; i < phases->count; i++) {
        char name[sizeof record->phases[0].name];
        uint32_t k = 0;
        snprintf(name, sizeof name, "%s%s%s", alone ? "" : label, alone ? "" : ": ",
                 phases->names[i]);
        while (k < record->phase_count && strcmp(record->phases[k].name, name) != 0)
            k++;
        if (k == BB_RECORD_PHASES_MAX)
            continue;
        if (k == record->phase_count) {
            snprintf(record->phases[k].name, sizeof record->phases[k].name, "%s", name);
            record->phase_count++;
        }
        bb_samples_add(&entrant->phase_samples[k], phases->ms[i]);
    }
}

/* Adds time and memory of each step of a pipeline. */
static void add_steps(bb_entrant *entrant)
{
    bb_build_record *record = &entrant->record;
    const bb_instance *instance = &entrant->resident->instance;
    if (instance->pipeline.count == 1)
        return;
    record->step_count = instance->step_count;
    for (uint32_t i = 0; i < instance->step_count; i++) {
        snprintf(record->steps[i].name, sizeof record->steps[i].name, "%s",
                 instance->steps[i].label);
        bb_samples_add(&record->steps[i].ms, instance->steps[i].timing.timing.ms);
        record->steps[i].bytes = instance->steps[i].bytes;
        record->steps[i].bytes_peak = instance->steps[i].peak;
    }
}

/* ---- transfers ---- */

/* Times the transfers that stages on the host need (bb_instance_transfer()). A pipeline on the
 * device needs none. The first transfer, on fresh memory, does not enter the median. */
static bb_status measure_transfer(bb_bench *bench, bb_entrant *entrant)
{
    if (bb_pipeline_on_device(&entrant->pipeline) == entrant->pipeline.count)
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    for (uint32_t i = 0; i <= TRANSFERS; i++) {
        double ms;
        BB_TRY(bb_instance_transfer(&entrant->resident->instance, bench->scene, &ms));
        bb_samples_add(&entrant->record.transfer_ms, ms);
    }
    return bb_bench_end(bench, step, "transfers", BB_OK);
}

/* Checks a tree. Every tree is checked: a hand-over between work-groups may fail only now and then.
 */
static bb_status check_tree(bb_bench *bench, bb_entrant *entrant)
{
    bb_step step = bb_bench_begin(bench);
    return bb_bench_end(bench, step, "check trees, SAH", bb_resident_check(entrant->resident));
}

/* Returns what its hooks have added to the process's memory beyond what is booked; 0 if that is
 * less than allocators, drivers and huge pages may add. */
static uint64_t unbooked(const bb_instance *instance)
{
    const int64_t booked = (int64_t)instance->account.peak;
    const int64_t more = instance->footprint.peak - booked;
    const int64_t least =
        bb_pipeline_on_device(&instance->pipeline) > 0 ? UNBOOKED_LEAST_ON_DEVICE : UNBOOKED_LEAST;
    return more > least && more > booked / 10 ? (uint64_t)more : 0;
}

static void record_timing(bb_bench *bench, bb_entrant *entrant, const bb_build_timing *timing)
{
    bb_build_record *record = &entrant->record;
    const bb_instance *instance = &entrant->resident->instance;
    uint32_t inputs = bb_instance_inputs(instance);
    bb_samples_add(&record->build_ms, timing->timing.ms);
    bb_samples_add(&record->event_ms, timing->timing.event_ms);
    bb_samples_add(&record->cpu_ms, timing->timing.cpu_ms);
    bb_samples_add(&record->restore_ms, timing->restore_ms);
    bb_samples_add(&record->outside_ms, timing->outside_ms);
    record->launches = (uint32_t)timing->timing.launches;
    add_steps(entrant);
    if (isnan(record->prepare_ms)) /* an unseen input may call for it again */
        record->prepare_ms = bb_instance_prepare_ms(instance);
    bb_input_words(inputs, record->inputs, sizeof record->inputs);
    for (uint32_t i = 0; i < entrant->pipeline.count; i++)
        if (entrant->pipeline.stages[i].builder->place == BB_ON_DEVICE)
            strcpy(record->handover, bb_handover_word(bench->device));
    if ((inputs & BB_INPUT_BOXES) != 0)
        record->boxes_ms = bb_samples_median(&bench->boxes_ms);
    record->bytes_unbooked = unbooked(instance);
    record->bytes_peak = instance->account.peak + record->bytes_unbooked;
}

static bb_status timed_build(bb_bench *bench, bb_entrant *entrant, bool exact)
{
    BB_TRY(bb_bench_tree(bench, entrant));
    bb_build_timing timing;
    bb_instance *instance = &entrant->resident->instance;
    bb_account_mark(&instance->account);
    BB_TRY(bb_resident_build(&bench->residency, entrant->resident, exact, &timing));
    bb_residency_note(&bench->residency);
    bb_audit_build(&bench->outcome->audit, bench->scene->name, instance);
    if (!exact) {
        bench->outcome->times.build_ms += timing.timing.ms;
        record_timing(bench, entrant, &timing);
    }
    if (bench->device->form == BB_FORM_GPU)
        BB_TRY(check_tree(bench, entrant));
    for (uint32_t i = 0; i < instance->step_count; i++)
        if (exact == instance->steps[i].phases.used_device)
            add_phases(entrant, entrant->pipeline.count == 1 ? NULL : instance->steps[i].label,
                       &instance->steps[i].phases);
    return BB_OK;
}

static bool is_requested(const bb_bench *bench, const bb_metric *metric)
{
    for (uint32_t i = 0; i < bench->request->metric_count; i++)
        if (strcmp(bench->request->metrics[i], metric->name) == 0)
            return true;
    return false;
}

/* Measures the metrics that are always measured, or those on request, which are sampled and booked
 * as a step.
 */
static bb_status measure_metrics(bb_bench *bench, bb_entrant *entrant, const bb_tree *tree,
                                 bool on_request)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        const bb_metric *metric = bb_metrics[i];
        if (metric->on_request != on_request || (on_request && !is_requested(bench, metric)) ||
            (bench->request->lean && metric->sampled))
            continue;
        bb_step step = bb_bench_begin(bench);
        BB_TRY(bb_metric_compute(metric, tree, bench->scene, METRIC_SAMPLES, bench->request->seed,
                                 &entrant->record.metrics[i]));
        if (on_request || metric->sampled)
            BB_TRY(bb_bench_end(bench, step, metric->title, BB_OK));
    }
    return BB_OK;
}

static double sah_of_tree(const bb_entrant *entrant)
{
    return entrant->record.metrics[bb_metric_of_layouts()].value;
}

/* Measures the SAH of the trees between the stages of a pipeline; that of the last is known. A tree
 * that the host has no room for gets no figure. */
static bb_status measure_stages(bb_entrant *entrant)
{
    bb_build_record *record = &entrant->record;
    bb_instance *instance = &entrant->resident->instance;
    for (uint32_t i = 0; i < record->step_count; i++) {
        const uint32_t stage = instance->steps[i].stage;
        if (stage + 1 == instance->pipeline.count)
            record->steps[i].sah = sah_of_tree(entrant);
        else if (stage != BB_NONE) {
            bb_status status = bb_instance_stage_sah(instance, stage, &record->steps[i].sah);
            if (status != BB_OK && status != BB_REFUSED)
                return status;
        }
    }
    return BB_OK;
}

/* Checks the tree, and records what it is and what its builder says of it. */
static bb_status describe_tree(bb_bench *bench, bb_entrant *entrant)
{
    bb_build_record *record = &entrant->record;
    bb_instance *instance = &entrant->resident->instance;
    BB_TRY(bb_resident_check(entrant->resident));
    record->has_tree = true;
    record->tree = instance->tree.info;
    record->bytes_tree = bb_tree_bytes(&instance->tree);
    BB_TRY(bb_instance_describe(instance, bench->scene, record->about, sizeof record->about));
    return bb_instance_decisions(instance, bench->scene, &record->decisions);
}

static bb_status measure_tree(bb_bench *bench, bb_entrant *entrant)
{
    const bb_tree *tree = &entrant->resident->instance.tree;
    BB_TRY(describe_tree(bench, entrant));
    BB_TRY(measure_metrics(bench, entrant, tree, false));
    BB_TRY(measure_stages(entrant));
    return bb_bench_owns_builds(bench) ? measure_metrics(bench, entrant, tree, true) : BB_OK;
}

/* Measures a tree for whose metrics there is no room beside what its builder holds: a copy of it,
 * after the builder has gone. The tree is built again when somebody asks for it. Trees between
 * stages get no figure. */
static bb_status measure_copy(bb_bench *bench, bb_entrant *entrant)
{
    bb_tree *tree = &entrant->resident->instance.tree, copy;
    if (tree->place != BB_ON_DEVICE)
        return BB_REFUSED; /* as was said */
    BB_TRY(describe_tree(bench, entrant));
    bb_tree_take_copy(tree, &copy);
    (void)bb_resident_free_tree(entrant->resident);
    bb_status status = measure_metrics(bench, entrant, &copy, false);
    if (status == BB_OK && bb_bench_owns_builds(bench))
        status = measure_metrics(bench, entrant, &copy, true);
    bb_tree_release(&copy);
    return status;
}

void bb_bench_note_failure(bb_entrant *entrant, bb_status status)
{
    if (bb_interrupted())
        return;
    entrant->record.status = status;
    snprintf(entrant->record.reason, sizeof entrant->record.reason, "%s", bb_message());
    bb_resident_evict(entrant->resident);
}

static void finish_phases(bb_entrant *entrant)
{
    for (uint32_t i = 0; i < entrant->record.phase_count; i++)
        entrant->record.phases[i].ms = bb_samples_median(&entrant->phase_samples[i]);
}

/* Frees the trees of all tracers if they hold what was missing. */
static bool give_up_tracers(bb_bench *bench)
{
    const uint64_t missing = bb_host_missing();
    uint64_t held = 0;
    for (uint32_t i = 0; i < bench->entrant_count; i++)
        if (bench->entrants[i].tracing != NULL && bench->entrants[i].tree_of == NULL)
            held += bb_tracing_bytes(bench->entrants[i].tracing);
    if (missing == 0 || held < missing)
        return false;
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_entrant *entrant = &bench->entrants[i];
        if (entrant->tracing == NULL)
            continue;
        if (entrant->tree_of == NULL)
            bb_tracing_destroy(entrant->tracing);
        entrant->tracing = NULL;
        entrant->record.build_ms.count = 0; /* nothing is traced with it from now on */
        entrant->record.status = BB_REFUSED;
        snprintf(entrant->record.reason, sizeof entrant->record.reason,
                 "its tree made room for a builder's: compare it alone with fewer builders, or in "
                 "a smaller scene");
    }
    return true;
}

bool bb_bench_give_up(void *whom)
{
    bb_bench *bench = whom;
    if (!bench->asks_oracle && bench->oracle != NULL && bb_oracle_give_up(bench->oracle))
        return true;
    return give_up_tracers(bench);
}

static bb_status ready_oracle(bb_bench *bench, uint64_t beside)
{
    BB_TRY(bb_oracle_prepare(bench->oracle));
    return bb_host_has_room(beside, "rays and answers");
}

bb_status bb_bench_ready_oracle(bb_bench *bench, uint64_t beside)
{
    bb_step step = bb_bench_begin(bench);
    bench->asks_oracle = true;
    bb_status status = ready_oracle(bench, beside);
    while (status == BB_REFUSED && bb_residency_make_room(&bench->residency, NULL))
        status = ready_oracle(bench, beside);
    bench->asks_oracle = false;
    return bb_bench_end(bench, step, "oracle: prepare", status);
}

/* After a failure the tree is gone. */
static bb_status build_tracing(bb_bench *bench, bb_entrant *entrant, bb_build_timing *timing,
                               bb_phases *phases)
{
    char what[256];
    snprintf(what, sizeof what, "build of %.100s by %.100s", bench->scene->name, entrant->text);
    const bb_status status = bb_tracing_build(entrant->tracing, timing, phases);
    if (status == BB_OK) {
        bb_audit_timing(&bench->outcome->audit, what, &timing->timing, phases->count > 0);
        return BB_OK;
    }
    bb_tracing_destroy(entrant->tracing);
    entrant->tracing = NULL;
    return status;
}

/* The first build, on fresh memory, is the cold one, as for builders. */
static bb_status start_tracing(bb_bench *bench, bb_entrant *entrant)
{
    bb_build_timing timing;
    bb_phases phases;
    BB_TRY(bb_tracing_create(bench->device, entrant->text, bench->scene, &entrant->tracing));
    BB_TRY(build_tracing(bench, entrant, &timing, &phases));
    entrant->record.cold_ms = timing.timing.ms;
    entrant->record.prepare_ms = bb_tracing_create_ms(entrant->tracing);
    return BB_OK;
}

static bb_status build_tracer(bb_bench *bench, bb_entrant *entrant)
{
    bb_build_record *record = &entrant->record;
    bb_build_timing timing;
    bb_phases phases;
    if (entrant->tracing == NULL) {
        bb_step step = bb_bench_begin(bench);
        BB_TRY(bb_bench_end(bench, step, "compile, allocate, first builds",
                            start_tracing(bench, entrant)));
    }
    BB_TRY(build_tracing(bench, entrant, &timing, &phases));
    bb_samples_add(&record->build_ms, timing.timing.ms);
    bb_samples_add(&record->cpu_ms, timing.timing.cpu_ms);
    bb_samples_add(&record->outside_ms, timing.outside_ms);
    bench->outcome->times.build_ms += timing.timing.ms;
    record->bytes_native = (double)bb_tracing_bytes(entrant->tracing);
    add_phases(entrant, NULL, &phases);
    return BB_OK;
}

/* Takes the tree of the row that builds the same one, with its times and its failure, before that
 * one's way to pass rays is checked: to lack it is the other's alone. */
static void share_tree(bb_entrant *entrant)
{
    const bb_build_record *from = &entrant->tree_of->record;
    bb_build_record *record = &entrant->record;
    entrant->tracing = entrant->tree_of->tracing;
    record->cold_ms = from->cold_ms;
    record->prepare_ms = from->prepare_ms;
    record->build_ms = from->build_ms;
    record->cpu_ms = from->cpu_ms;
    record->outside_ms = from->outside_ms;
    record->bytes_native = from->bytes_native;
    record->phase_count = from->phase_count;
    memcpy(record->phases, from->phases, sizeof record->phases);
    memcpy(entrant->phase_samples, entrant->tree_of->phase_samples, sizeof entrant->phase_samples);
    record->status = from->status;
    snprintf(record->reason, sizeof record->reason, "%s", from->reason);
}

/* Makes sure that the library has what the row asks for. */
static bb_status finish_tracer(const bb_bench *bench, bb_entrant *entrant)
{
    const bb_guarded whose = {bench->scene->name, entrant->text};
    if (entrant->tracing == NULL)
        return BB_OK;
    finish_phases(entrant);
    bb_status status =
        bb_tracing_describe(entrant->tracing, entrant->record.about, sizeof entrant->record.about);
    if (status == BB_OK)
        status = bb_tracing_pass(entrant->tracing, whose, &entrant->spec);
    if (status != BB_OK)
        entrant->record.build_ms.count = 0; /* nothing is traced with it */
    return status;
}

static bb_status build_once(bb_bench *bench, bb_entrant *entrant, bool exact)
{
    /* the phases of a builder on the host are always exact */
    if (exact && (entrant->tracer != NULL || bb_pipeline_on_device(&entrant->pipeline) == 0))
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    bb_status status =
        entrant->tracer != NULL ? build_tracer(bench, entrant) : timed_build(bench, entrant, exact);
    return bb_bench_end(bench, step, exact ? "builds for phase times" : "prepare, restore, warm up",
                        status);
}

/* Records a layout that was just made, unless one of its name was recorded. Its time, on fresh
 * memory, does not enter the median. */
static void record_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    bb_build_record *record = &entrant->record;
    const bb_layout_data *data = &entrant->resident->layouts[layout];
    for (uint32_t k = 0; k < record->layout_count; k++)
        if (strcmp(record->layouts[k].name, data->name) == 0)
            return;
    if (!bb_bench_owns_builds(bench))
        return;
    uint32_t k = record->layout_count++;
    entrant->layouts[k] = layout;
    snprintf(record->layouts[k].name, sizeof record->layouts[k].name, "%s", data->name);
    record->layouts[k].bytes = data->bytes;
    record->layouts[k].launches = (uint32_t)data->timing.launches;
    record->layouts[k].sah =
        isnan(data->sah) && data->keeps_shape ? sah_of_tree(entrant) : data->sah;
    bb_samples_add(&record->layouts[k].ms, data->timing.ms);
}

/* Returns whether a cell of this entrant, kernel and intersector is to be measured. */
static bool wants_layout(const bb_bench *bench, const bb_entrant *entrant, uint32_t kernel,
                         uint32_t intersector)
{
    bb_cell_parts parts = bb_bench_cell(bench);
    snprintf(parts.builder, sizeof parts.builder, "%s", entrant->text);
    snprintf(parts.kernel, sizeof parts.kernel, "%s", bench->kernels[kernel].spec.text);
    snprintf(parts.intersector, sizeof parts.intersector, "%s",
             bench->request->intersectors[intersector]);
    return bb_bench_wants(bench, &parts);
}

/* Makes the layouts. A refused layout is a failure of the trace, not of the build:
 * bb_bench_layout() reports it again. */
static void make_layouts(bb_bench *bench, bb_entrant *entrant)
{
    for (uint32_t k = 0; k < bench->kernel_count; k++)
        for (uint32_t i = 0;
             bb_bench_takes(bench, entrant, k) && i < bench->request->intersector_count; i++) {
            if (!wants_layout(bench, entrant, k, i))
                continue;
            uint32_t layout = bb_bench_layout_of(bench, k, &bench->intersectors[i]);
            if (bb_bench_layout(bench, entrant, layout) == BB_OK)
                record_layout(bench, entrant, layout);
        }
}

static bb_status layout_again(bb_bench *bench, bb_entrant *entrant, uint32_t k)
{
    char what[256];
    const uint32_t layout = entrant->layouts[k];
    const bb_layout_data *data = &entrant->resident->layouts[layout];
    BB_TRY(bb_bench_layout(bench, entrant, layout)); /* others may have taken its room */
    bb_step step = bb_bench_begin(bench);
    bb_status status = bb_resident_layout_again(&bench->residency, entrant->resident, layout);
    if (status == BB_OK) {
        bb_samples_add(&entrant->record.layouts[k].ms, data->timing.ms);
        snprintf(what, sizeof what, "layout %s of %.100s by %.100s", data->name, bench->scene->name,
                 entrant->text);
        bb_audit_timing(&bench->outcome->audit, what, &data->timing, true);
    }
    return bb_bench_end(bench, step, "layouts", status);
}

/* What fails here fails the traces. */
static bb_status take_layout_turn(void *self, uint32_t who, uint32_t round, double *ms)
{
    bb_bench *bench = self;
    bb_entrant *entrant = &bench->entrants[who];
    (void)round, (void)ms;
    for (uint32_t k = 0; k < entrant->record.layout_count; k++)
        if (entrant->record.status == BB_OK && !bb_interrupted())
            (void)layout_again(bench, entrant, k);
    return BB_OK;
}

static bb_status measure_layouts(bb_bench *bench)
{
    if (bench->apart)
        return BB_OK;
    bb_turns turns = {.device = bench->device,
                      .random = &bench->random,
                      .count = bench->entrant_count,
                      .self = bench,
                      .turn = take_layout_turn};
    for (uint32_t round = 0; round < bench->request->repeats && !bb_interrupted(); round++)
        BB_TRY(bb_turns_round(&turns, round));
    return BB_OK;
}

/* Measures an entrant's layouts in one go, and frees its tree, so that no more than one stands
 * beside all layouts. */
static void measure_layouts_apart(bb_bench *bench, bb_entrant *entrant)
{
    double unused;
    const uint32_t who = (uint32_t)(entrant - bench->entrants);
    for (uint32_t round = 0; round < bench->request->repeats && !bb_interrupted(); round++)
        (void)take_layout_turn(bench, who, round, &unused);
    (void)bb_resident_free_tree(entrant->resident);
}

/* Rays are traced through layouts: a tree, and all that its builder holds, has served. */
static void free_trees(bb_bench *bench)
{
    bb_step step = bb_bench_begin(bench);
    for (uint32_t i = 0; i < bench->entrant_count; i++)
        (void)bb_resident_free_tree(bench->entrants[i].resident);
    bench->traces = true;
    (void)bb_bench_end(bench, step, "free trees", BB_OK);
}

/* Removes the times of a build that another shard measures: here it was only built once. */
static void forget_times(bb_build_record *record)
{
    bb_samples *const samples[] = {&record->build_ms, &record->event_ms, &record->cpu_ms,
                                   &record->restore_ms, &record->outside_ms};
    record->unmeasured = record->has_tree || record->reference || record->status != BB_OK;
    for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++)
        samples[i]->count = 0;
    record->cold_ms = record->prepare_ms = NAN;
    record->phase_count = record->step_count = 0;
    record->bytes_peak = 0;
}

/* Builds once, outside the samples; *ms is 0 for a builder on the host. */
static bb_status warm_once(bb_bench *bench, bb_entrant *entrant, double *ms)
{
    bb_build_timing timing;
    if (entrant->tracer != NULL || bb_pipeline_on_device(&entrant->pipeline) == 0)
        return BB_OK;
    BB_TRY(bb_bench_tree(bench, entrant));
    bb_step step = bb_bench_begin(bench);
    bb_status status = bb_resident_build(&bench->residency, entrant->resident, false, &timing);
    *ms += status == BB_OK ? timing.timing.ms : 0;
    return bb_bench_end(bench, step, "warming up", status);
}

/* The rounds after `plain` are for phases. */
typedef struct build_rounds {
    bb_bench *bench;
    uint32_t plain;
} build_rounds;

static bb_status take_turn(void *self, uint32_t who, uint32_t round, double *ms)
{
    const build_rounds *rounds = self;
    bb_bench *bench = rounds->bench;
    bb_entrant *entrant = &bench->entrants[who];
    const bool warming = round == BB_WARMING_UP;
    if (entrant->record.status != BB_OK || entrant->tree_of != NULL ||
        (warming && bb_interrupted()))
        return BB_OK;
    bb_status status = warming ? warm_once(bench, entrant, ms)
                               : build_once(bench, entrant, round >= rounds->plain);
    if (status != BB_OK)
        bb_bench_note_failure(entrant, status);
    if (!warming)
        bb_bench_show_progress(bench);
    return BB_OK;
}

/* Makes all builders' first trees. Tracers come after them, into the room that is left. */
static void make_first_trees(bb_bench *bench)
{
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_entrant *entrant = &bench->entrants[i];
        if (entrant->tracer != NULL || entrant->record.status != BB_OK)
            continue;
        const bb_status status = bb_bench_tree(bench, entrant);
        if (status != BB_OK)
            bb_bench_note_failure(entrant, status);
    }
}

static bb_status measure_built(bb_bench *bench, bb_entrant *entrant, bool own)
{
    entrant->record.transfer_ms.count = 0;
    if (own)
        BB_TRY(measure_transfer(bench, entrant));
    return measure_tree(bench, entrant);
}

static bb_status finish_builder(bb_bench *bench, bb_entrant *entrant, bool own)
{
    finish_phases(entrant);
    bb_resident *resident = entrant->resident;
    BB_TRY(bb_bench_tree(bench, entrant));
    bb_status status = measure_built(bench, entrant, own);
    while (status == BB_REFUSED && bb_residency_make_room(&bench->residency, resident))
        status = measure_built(bench, entrant, own);
    if (status == BB_REFUSED)
        status = measure_copy(bench, entrant);
    BB_TRY(status);
    if (resident->built && resident->instance.tree.place == BB_ON_DEVICE)
        bb_tree_drop_copy(&resident->instance.tree);
    make_layouts(bench, entrant);
    if (bench->apart)
        measure_layouts_apart(bench, entrant);
    return BB_OK;
}

bb_status bb_bench_builds(bb_bench *bench)
{
    const bool own = bb_bench_owns_builds(bench);
    bench->traces = false;
    bench->apart =
        bench->request->apart || bb_bench_is_apart(bench->request, bench->scene->prim_count);
    const uint32_t phase_builds = own && !bench->request->lean ? PHASE_BUILDS : 0;
    uint32_t rounds = own ? bench->request->repeats + 1 : 1;
    bb_progress_stage(bench->progress, bench->entrant_count * (rounds + phase_builds),
                      "%s: building", bench->scene->name);
    bb_progress_weigh(bench->progress, (double)bench->entrant_count * rounds);
    build_rounds self = {bench, rounds};
    bb_turns turns = {.device = bench->device,
                      .random = &bench->random,
                      .count = bench->entrant_count,
                      .self = &self,
                      .turn = take_turn};
    const bool begins = !bb_interrupted(); /* the first round is then made to its end */
    if (begins)
        make_first_trees(bench);
    BB_TRY(bb_turns_warm_up(&turns, bench->progress, bench->scene->name, "builds"));
    const uint32_t unseen = bb_bench_draw_unseen(bench, bench->request->lean ? 0 : rounds);
    for (uint32_t round = 0;
         round < rounds + phase_builds && (round == 0 ? begins : !bb_interrupted()); round++) {
        if (round == unseen)
            BB_TRY(bb_bench_unseen_round(bench));
        BB_TRY(bb_turns_round(&turns, round));
    }
    BB_TRY(bb_bench_judge_unseen(bench));
    bb_disguise_end(&bench->disguise);
    for (uint32_t i = 0; i < bench->entrant_count; i++)
        if (bench->entrants[i].tree_of != NULL)
            share_tree(&bench->entrants[i]);
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_entrant *entrant = &bench->entrants[i];
        if (entrant->record.status != BB_OK || bb_interrupted())
            continue;
        bb_step step = bb_bench_begin(bench);
        bb_status status = entrant->tracer != NULL ? finish_tracer(bench, entrant)
                                                   : finish_builder(bench, entrant, own);
        status = bb_bench_end(bench, step, "check trees, SAH", status);
        if (status != BB_OK)
            bb_bench_note_failure(entrant, status);
    }
    for (uint32_t i = 0; i < bench->entrant_count && !own && !bb_interrupted(); i++)
        forget_times(&bench->entrants[i].record);
    BB_TRY(measure_layouts(bench));
    free_trees(bench);
    return BB_OK;
}
