/* The figures of a tree: what it is, its metrics, its transfers. */
#include "framework/bench/bench_private.h"

#include <string.h>

enum {
    TRANSFERS = 5, /* that count, after a first one */
    METRIC_SAMPLES = 1000000,
};

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
    entrant->record.transfer_ms.count = 0;
    BB_TRY(describe_tree(bench, entrant));
    bb_tree_take_copy(tree, &copy);
    (void)bb_resident_free_tree(entrant->resident);
    bb_status status = measure_metrics(bench, entrant, &copy, false);
    if (status == BB_OK && bb_bench_owns_builds(bench))
        status = measure_metrics(bench, entrant, &copy, true);
    bb_tree_release(&copy);
    if (entrant->record.step_count > 0)
        entrant->record.steps[entrant->record.step_count - 1].sah = sah_of_tree(entrant);
    return status;
}

static bb_status measure_built(bb_bench *bench, bb_entrant *entrant, bool own)
{
    entrant->record.transfer_ms.count = 0;
    if (own)
        BB_TRY(measure_transfer(bench, entrant));
    return measure_tree(bench, entrant);
}

bb_status bb_bench_measure_tree(bb_bench *bench, bb_entrant *entrant, bool own)
{
    bb_status status = measure_built(bench, entrant, own);
    while (status == BB_REFUSED && bb_residency_make_room(&bench->residency, entrant->resident))
        status = measure_built(bench, entrant, own);
    return status == BB_REFUSED ? measure_copy(bench, entrant) : status;
}
