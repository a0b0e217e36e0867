/* Builds: all entrants interleaved, in an order shuffled per round; then what is measured of their trees. */
#include "framework/bench/bench_private.h"

#include "framework/base/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    /* builds with exact phase boundaries, made apart from those that count where the work is on the device */
    PHASE_BUILDS = 3,
    REPEATS = 5, /* of transfers and layouts */
    METRIC_SAMPLES = 1000000,
};

void bb_bench_evict(bb_entrant *entrant)
{
    for (uint32_t k = 0; k < BB_LAYOUTS_MAX; k++) {
        bb_layout_data_release(&entrant->layouts[k]);
        entrant->has_layout[k] = false;
    }
    bb_instance_destroy(&entrant->instance);
    entrant->built = false;
}

bool bb_bench_evict_others(bb_bench *bench, const bb_entrant *keep)
{
    bool freed = false;
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_entrant *other = &bench->entrants[i];
        if (other == keep || other->instance.builder == NULL)
            continue;
        bb_bench_evict(other);
        freed = true;
    }
    return freed;
}

static bb_status create_and_build(bb_bench *bench, bb_entrant *entrant, double *ms)
{
    bb_build_timing timing;
    if (entrant->instance.builder == NULL)
        BB_TRY(bb_instance_create(bench->device, entrant->text, bench->scene, bench->request->seed,
                                  &entrant->instance));
    BB_TRY(bb_instance_build(&entrant->instance, bench->scene, false, NULL, &timing));
    *ms = timing.timing.ms;
    return BB_OK;
}

/* A first build, on fresh memory. Drivers may compile a kernel when it is first enqueued; so that this is no part of the cold
 * time, the very first build on a device is thrown away, memory and all. */
static bb_status first_build(bb_bench *bench, bb_entrant *entrant, double *cold_ms)
{
    bb_step step = bb_bench_begin(bench);
    const bb_builder *builder = bb_builder_find(entrant->spec.name);
    bb_status status = BB_OK;
    if (!entrant->compiled && builder->place == BB_ON_DEVICE) {
        status = create_and_build(bench, entrant, cold_ms);
        bb_bench_evict(entrant);
    }
    entrant->compiled = true;
    if (status == BB_OK)
        status = create_and_build(bench, entrant, cold_ms);
    entrant->built = status == BB_OK;
    return bb_bench_end(bench, step, "compile, allocate, first builds", status);
}

/* Makes the entrant's tree exist. What does not fit beside the others' is built in their place. */
static bb_status acquire(bb_bench *bench, bb_entrant *entrant)
{
    if (entrant->built)
        return BB_OK;
    double cold_ms = NAN;
    bb_status status = first_build(bench, entrant, &cold_ms);
    if (status == BB_REFUSED && bb_bench_evict_others(bench, entrant)) {
        bb_bench_evict(entrant);
        status = first_build(bench, entrant, &cold_ms);
    }
    if (status != BB_OK) {
        bb_bench_evict(entrant);
        return status;
    }
    if (isnan(entrant->record.cold_ms))
        entrant->record.cold_ms = cold_ms;
    return BB_OK;
}

static void add_phases(bb_entrant *entrant, const bb_phases *phases)
{
    bb_build_record *record = &entrant->record;
    for (uint32_t i = 0; i < phases->count; i++) {
        uint32_t k = 0;
        while (k < record->phase_count && strcmp(record->phases[k].name, phases->names[i]) != 0)
            k++;
        if (k == BB_PHASES_MAX)
            continue;
        if (k == record->phase_count) {
            snprintf(record->phases[k].name, sizeof record->phases[k].name, "%s", phases->names[i]);
            record->phase_count++;
        }
        bb_samples_add(&entrant->phase_samples[k], phases->ms[i]);
    }
}

/* ---- transfers ---- */

/* Reads the buffers once into `target`, which has room for the largest. */
static bb_status read_all(const bb_buffer *const *buffers, uint32_t count, void *target, double *ms)
{
    double start = bb_wall_ms();
    for (uint32_t i = 0; i < count; i++)
        BB_TRY(bb_buffer_read(buffers[i], 0, buffers[i]->bytes, target));
    *ms = bb_wall_ms() - start;
    return BB_OK;
}

static bb_status repeat_transfer(bb_bench *bench, bb_entrant *entrant,
                                 const bb_buffer *const *buffers, uint32_t count, void *target)
{
    bb_tree *tree = &entrant->instance.tree;
    for (uint32_t i = 0; i <= REPEATS; i++) {
        double down, up = 0;
        BB_TRY(read_all(buffers, count, target, &down));
        bb_tree_changed(tree); /* else it is there already */
        BB_TRY(bb_tree_upload(tree, bench->device, &up));
        bb_samples_add(&entrant->record.transfer_ms, down + up);
    }
    return BB_OK;
}

/* What a builder on the host needs moved: what it declares of the scene down, the tree up. One on the
 * device needs nothing moved. The first time, on fresh memory, is left out of the median. */
static bb_status measure_transfer(bb_bench *bench, bb_entrant *entrant)
{
    const bb_builder *builder = entrant->instance.builder;
    if (builder->place == BB_ON_DEVICE)
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    const bb_scene_device *there = &bench->scene->on_device;
    const bb_buffer *buffers[4];
    uint32_t count = 0;
    if ((builder->inputs & BB_INPUT_BOXES) != 0)
        buffers[count++] = &there->boxes;
    if ((builder->inputs & BB_INPUT_GEOMETRY) != 0) {
        buffers[count++] = &there->vertices;
        buffers[count++] = &there->indices;
        buffers[count++] = &there->spheres;
    }
    size_t most = 0;
    for (uint32_t i = 0; i < count; i++)
        most = buffers[i]->bytes > most ? buffers[i]->bytes : most;
    void *target = NULL;
    BB_TRY(bb_host_alloc(NULL, most, "the builder's input on the host", &target));
    bb_status status = repeat_transfer(bench, entrant, buffers, count, target);
    bb_host_free(target);
    return bb_bench_end(bench, step, "transfers", status);
}

/* A hand-over between work-groups that fails now and then shows in one tree of many. */
static bb_status check_tree(bb_bench *bench, bb_entrant *entrant)
{
    bb_step step = bb_bench_begin(bench);
    bb_tree *tree = &entrant->instance.tree;
    BB_TRY(bb_tree_download(tree, NULL));
    BB_TRY(bb_tree_check(tree, bench->scene));
    return bb_bench_end(bench, step, "check trees, SAH", BB_OK);
}

/* What the device's clock, or that of a host builder's own phases, saw must lie within the wall time. */
static void audit_build(bb_bench *bench, const bb_entrant *entrant, const bb_phases *phases,
                        const bb_build_timing *timing)
{
    char what[256];
    bb_timing seen = timing->timing;
    if (phases->device == NULL) {
        double inside = -phases->outside_ms;
        for (uint32_t i = 0; i < phases->count; i++)
            inside += phases->ms[i];
        seen.event_ms = seen.event_ms > inside ? seen.event_ms : inside;
    }
    snprintf(what, sizeof what, "build of %.100s by %.100s", bench->scene->name, entrant->text);
    bb_audit_timing(&bench->outcome->audit, what, &seen,
                    phases->used_device || (phases->device == NULL && phases->count > 0));
}

static bb_status timed_build(bb_bench *bench, bb_entrant *entrant, bool exact)
{
    BB_TRY(acquire(bench, entrant));
    bb_phases phases;
    bb_build_timing timing;
    bb_build_record *record = &entrant->record;
    bb_step step = bb_bench_begin(bench);
    bb_account_mark(&entrant->instance.account);
    BB_TRY(bb_instance_build(&entrant->instance, bench->scene, exact, &phases, &timing));
    audit_build(bench, entrant, &phases, &timing);
    if (!exact) {
        bench->outcome->times.build_ms += timing.timing.ms;
        BB_TRY(bb_bench_end(bench, step, "prepare, restore, warm up", BB_OK));
        bb_samples_add(&record->build_ms, timing.timing.ms);
        bb_samples_add(&record->event_ms, timing.timing.event_ms);
        bb_samples_add(&record->cpu_ms, timing.timing.cpu_ms);
        bb_samples_add(&record->restore_ms, timing.restore_ms);
        bb_samples_add(&record->outside_ms, timing.outside_ms);
        record->prepare_ms = entrant->instance.prepare_ms;
        bb_input_words(entrant->instance.builder->inputs, record->inputs, sizeof record->inputs);
        if ((entrant->instance.builder->inputs & BB_INPUT_BOXES) != 0)
            record->boxes_ms = bb_samples_median(&bench->boxes_ms);
        record->bytes_peak = entrant->instance.account.peak;
    }
    if (bench->device->form == BB_FORM_GPU)
        BB_TRY(check_tree(bench, entrant));
    if (exact == phases.used_device)
        add_phases(entrant, &phases);
    return BB_OK;
}

static bool is_requested(const bb_bench *bench, const bb_metric *metric)
{
    for (uint32_t i = 0; i < bench->request->metric_count; i++)
        if (strcmp(bench->request->metrics[i], metric->name) == 0)
            return true;
    return false;
}

/* The metrics that are always measured, or those on request, each a step of its own. */
static bb_status measure_metrics(bb_bench *bench, bb_entrant *entrant, bool on_request)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        const bb_metric *metric = bb_metrics[i];
        if (metric->on_request != on_request || (on_request && !is_requested(bench, metric)))
            continue;
        bb_step step = bb_bench_begin(bench);
        BB_TRY(bb_metric_compute(metric, &entrant->instance.tree, bench->scene, METRIC_SAMPLES,
                                 bench->request->seed, &entrant->record.metrics[i]));
        if (on_request)
            BB_TRY(bb_bench_end(bench, step, metric->title, BB_OK));
    }
    return BB_OK;
}

/* Correctness of the tree, then its figures. */
static bb_status measure_tree(bb_bench *bench, bb_entrant *entrant)
{
    bb_build_record *record = &entrant->record;
    bb_tree *tree = &entrant->instance.tree;
    bb_step step = bb_bench_begin(bench);
    BB_TRY(bb_tree_download(tree, NULL));
    BB_TRY(bb_tree_check(tree, bench->scene));
    record->has_tree = true;
    record->tree = tree->info;
    record->bytes_tree = bb_tree_bytes(tree);
    BB_TRY(measure_metrics(bench, entrant, false));
    BB_TRY(bb_instance_describe(&entrant->instance, bench->scene, record->about,
                                sizeof record->about));
    BB_TRY(bb_bench_end(bench, step, "check trees, SAH", BB_OK));
    return measure_metrics(bench, entrant, true);
}

static void note_failure(bb_entrant *entrant, bb_status status)
{
    entrant->record.status = status;
    snprintf(entrant->record.reason, sizeof entrant->record.reason, "%s", bb_message());
    bb_bench_evict(entrant);
}

/* The first build, on fresh memory, is the reference's cold one, as the others have theirs. */
static bb_status build_reference(bb_bench *bench, bb_entrant *entrant)
{
    bb_build_record *record = &entrant->record;
    double ms = 0;
    if (entrant->embree == NULL) {
        bb_step step = bb_bench_begin(bench);
        BB_TRY(bb_embree_create(bench->scene, &entrant->spec, bb_host_threads(bench->device),
                                &entrant->embree, &record->cold_ms));
        BB_TRY(bb_bench_end(bench, step, "compile, allocate, first builds", BB_OK));
    }
    char what[256];
    snprintf(what, sizeof what, "build of %.100s by %.100s", bench->scene->name, entrant->text);
    double start = bb_wall_ms();
    BB_TRY(bb_embree_rebuild(entrant->embree, &ms));
    bb_audit_outer(&bench->outcome->audit, what, ms, bb_wall_ms() - start);
    bb_samples_add(&record->build_ms, ms);
    bench->outcome->times.build_ms += ms;
    record->bytes_native = (double)bb_embree_bytes(entrant->embree);
    return BB_OK;
}

static bb_status build_once(bb_bench *bench, bb_entrant *entrant, bool exact)
{
    if (entrant->reference)
        return exact ? BB_OK : build_reference(bench, entrant);
    /* the phases of a builder on the host were exact all along */
    if (exact && bb_builder_find(entrant->spec.name)->place == BB_ON_HOST)
        return BB_OK;
    if (!exact)
        return timed_build(bench, entrant, exact);
    bb_step step = bb_bench_begin(bench);
    bb_status status = timed_build(bench, entrant, exact);
    return bb_bench_end(bench, step, "builds for phase times", status);
}

static void finish_phases(bb_entrant *entrant)
{
    for (uint32_t i = 0; i < entrant->record.phase_count; i++)
        entrant->record.phases[i].ms = bb_samples_median(&entrant->phase_samples[i]);
}

bb_status bb_bench_builds(bb_bench *bench)
{
    uint32_t order[BB_ENTRANTS_MAX];
    uint32_t rounds = bench->request->repeats + 1;
    bb_progress_stage(bench->progress, bench->entrant_count * rounds, "%s: building",
                      bench->scene->name);
    for (uint32_t round = 0; round < rounds + PHASE_BUILDS; round++) {
        bool exact = round >= rounds;
        bb_bench_shuffle(bench, order, bench->entrant_count);
        for (uint32_t i = 0; i < bench->entrant_count; i++) {
            bb_entrant *entrant = &bench->entrants[order[i]];
            if (entrant->record.status != BB_OK)
                continue;
            bb_status status = build_once(bench, entrant, exact);
            if (status != BB_OK)
                note_failure(entrant, status);
            bb_progress_step(bench->progress);
        }
    }
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_entrant *entrant = &bench->entrants[i];
        if (entrant->record.status != BB_OK || entrant->reference)
            continue;
        finish_phases(entrant);
        bb_status status = acquire(bench, entrant);
        if (status == BB_OK)
            status = measure_transfer(bench, entrant);
        if (status == BB_OK)
            status = measure_tree(bench, entrant);
        /* a layout that is refused is the trace's failure, not the build's: bb_bench_layout() will say so again */
        for (uint32_t k = 0; k < bench->kernel_count && status == BB_OK; k++)
            for (uint32_t i = 0;
                 bb_bench_takes(bench, entrant, k) && i < bench->request->intersector_count; i++)
                (void)bb_bench_layout(bench, entrant,
                                      bb_bench_layout_of(bench, k, &bench->intersectors[i]));
        if (status != BB_OK)
            note_failure(entrant, status);
    }
    return BB_OK;
}

static bb_status make_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    bb_layout_choice *choice = &bench->layouts[layout];
    bb_layout_data *data = &entrant->layouts[layout];
    bb_tree *tree = &entrant->instance.tree;
    BB_TRY(bb_tree_upload(tree, bench->device, NULL));
    return bb_layout_maker_make(&choice->maker, bench->scene, tree, choice->leaf, choice->form,
                                data);
}

static double sah_of_tree(const bb_entrant *entrant)
{
    return entrant->record.metrics[bb_metric_find("sah")].value;
}

/* Makes it some times more, for its time, when it is the first of its name. The one that is there paid for
 * fresh memory: it is kept, and left out of the median. */
static bb_status measure_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    bb_build_record *record = &entrant->record;
    const bb_layout_data *data = &entrant->layouts[layout];
    for (uint32_t k = 0; k < record->layout_count; k++)
        if (strcmp(record->layouts[k].name, data->name) == 0)
            return BB_OK;
    uint32_t k = record->layout_count++;
    snprintf(record->layouts[k].name, sizeof record->layouts[k].name, "%s", data->name);
    record->layouts[k].sah =
        isnan(data->sah) && data->keeps_shape ? sah_of_tree(entrant) : data->sah;
    bb_samples_add(&record->layouts[k].ms, data->timing.ms);
    for (uint32_t i = 0; i < REPEATS; i++) {
        char what[256];
        BB_TRY(make_layout(bench, entrant, layout));
        bb_samples_add(&record->layouts[k].ms, data->timing.ms);
        snprintf(what, sizeof what, "layout %s of %.100s by %.100s", data->name, bench->scene->name,
                 entrant->text);
        bb_audit_timing(&bench->outcome->audit, what, &data->timing, true);
    }
    return BB_OK;
}

bool bb_bench_takes(const bb_bench *bench, const bb_entrant *entrant, uint32_t kernel)
{
    if (!bench->kernels[kernel].native_only)
        return true;
    for (uint32_t k = 0; k < bench->kernel_count; k++)
        for (uint32_t i = 0; i < bench->request->intersector_count; i++)
            if (!bench->kernels[k].native_only &&
                entrant->keeps_shape[bb_bench_layout_of(bench, k, &bench->intersectors[i])])
                return false;
    return entrant->record.has_tree;
}

/* Makes room for one layout: other builders' trees, the entrant's other layouts, and the scratch that made those. All of it is made
 * again when its turn comes. */
static bb_status make_room(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    bb_bench_evict_others(bench, entrant);
    for (uint32_t k = 0; k < bench->layout_count; k++) {
        bb_layout_data_release(&entrant->layouts[k]);
        entrant->has_layout[k] = false;
        bb_layout_maker *maker = &bench->layouts[k].maker;
        const bb_layout *made = maker->layout;
        if (k == layout || made == NULL)
            continue;
        bb_layout_maker_destroy(maker);
        BB_TRY(bb_layout_maker_create(made, bench->device, maker));
    }
    return BB_OK;
}

bb_status bb_bench_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    if (entrant->has_layout[layout])
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    bb_status status = acquire(bench, entrant);
    const bb_tree_info *info = &entrant->instance.tree.info;
    if (status == BB_OK && entrant->record.has_tree &&
        (info->node_count != entrant->record.tree.node_count ||
         info->depth != entrant->record.tree.depth))
        status =
            bb_fail(BB_FAILED, "built again, the tree has %u nodes and depth %u, not %u and %u",
                    info->node_count, info->depth, entrant->record.tree.node_count,
                    entrant->record.tree.depth);
    if (status == BB_OK)
        status = make_layout(bench, entrant, layout);
    if (status == BB_REFUSED) {
        status = make_room(bench, entrant, layout);
        if (status == BB_OK)
            status = make_layout(bench, entrant, layout);
    }
    if (status == BB_OK)
        status = measure_layout(bench, entrant, layout);
    status = bb_bench_end(bench, step, "layouts", status);
    if (status != BB_OK) {
        bb_layout_data_release(&entrant->layouts[layout]);
        return status;
    }
    entrant->has_layout[layout] = true;
    entrant->keeps_shape[layout] = entrant->layouts[layout].keeps_shape;
    return BB_OK;
}
