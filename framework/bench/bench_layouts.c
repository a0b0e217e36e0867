/* Makes the layouts of all trees, timed in rounds, or apart where trees are too many for memory. */
#include "framework/bench/bench_private.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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
    record->layouts[k].sah = isnan(data->sah) && data->keeps_shape
                                 ? entrant->record.metrics[bb_metric_of_layouts()].value
                                 : data->sah;
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

void bb_bench_make_layouts(bb_bench *bench, bb_entrant *entrant)
{
    for (uint32_t k = 0; k < bench->kernel_count; k++)
        for (uint32_t i = 0;
             bb_bench_takes(bench, entrant, k) && i < bench->request->intersector_count; i++) {
            if (!wants_layout(bench, entrant, k, i))
                continue;
            uint32_t layout = bb_bench_layout_of(bench, k, &bench->intersectors[i]);
            if (bb_bench_layout(bench, entrant, layout) == BB_OK)
                record_layout(bench, entrant, layout);
            /* now that the tree is here */
            if (bb_bench_simulates(bench, k, &bench->intersectors[i], &layout))
                (void)bb_bench_layout(bench, entrant, layout);
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

bb_status bb_bench_measure_layouts(bb_bench *bench)
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

void bb_bench_measure_layouts_apart(bb_bench *bench, bb_entrant *entrant)
{
    double unused;
    const uint32_t who = (uint32_t)(entrant - bench->entrants);
    for (uint32_t round = 0; round < bench->request->repeats && !bb_interrupted(); round++)
        (void)take_layout_turn(bench, who, round, &unused);
    (void)bb_resident_free_tree(entrant->resident);
}
