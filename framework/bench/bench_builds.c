/* Builds all entrants, interleaved in an order that is shuffled per round; then has their trees
 * measured, and their layouts made in such rounds. */
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

static bb_status finish_builder(bb_bench *bench, bb_entrant *entrant, bool own)
{
    finish_phases(entrant);
    bb_resident *resident = entrant->resident;
    BB_TRY(bb_bench_tree(bench, entrant));
    BB_TRY(bb_bench_measure_tree(bench, entrant, own));
    if (own)
        BB_TRY(bb_bench_simulate_build(bench, entrant));
    if (resident->built && resident->instance.tree.place == BB_ON_DEVICE)
        bb_tree_drop_copy(&resident->instance.tree);
    bb_bench_make_layouts(bench, entrant);
    if (bench->apart)
        bb_bench_measure_layouts_apart(bench, entrant);
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
    BB_TRY(bb_bench_measure_layouts(bench));
    free_trees(bench);
    return BB_OK;
}
