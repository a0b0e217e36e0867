/* Builds simulated on GPUs on paper: once each, beside those that are timed, and after them. */
#include "framework/bench/bench_private.h"

#include <stdio.h>

static void simulate(const bb_bench *bench, const bb_build_moves *moves, bb_build_record *record)
{
    for (uint32_t i = 0; i < bench->simt_count; i++) {
        const bb_simt *simt = &bench->simts[i];
        snprintf(record->simulated[i].name, sizeof record->simulated[i].name, "%s", simt->name);
        record->simulated[i].simulation = bb_simulate_build(&simt->device, moves);
    }
    record->simulated_count = bench->simt_count;
}

bb_status bb_bench_simulate_build(bb_bench *bench, bb_entrant *entrant)
{
    bb_build_moves moves;
    if (bench->simt_count == 0 || bench->request->lean)
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    bb_status status =
        bb_build_tally(bench->device, entrant->text, bench->scene, bench->request->seed, &moves);
    if (status == BB_OK)
        simulate(bench, &moves, &entrant->record);
    bb_build_moves_release(&moves);
    if (status != BB_OK) /* what was measured stays as it is */
        bb_progress_note(bench->progress, "build not simulated in its form for GPUs: %s",
                         bb_message());
    return bb_bench_end(bench, step, "simulate builds", BB_OK);
}
