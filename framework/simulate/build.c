#include "framework/simulate/build.h"

#include <math.h>

static bb_status build(bb_device *device, const char *text, const bb_scene *scene, uint64_t seed,
                       bb_build_moves *moves)
{
    bb_instance instance = {0};
    bb_build_timing timing;
    BB_TRY(bb_instance_create(device, text, scene, seed, &instance));
    bb_status status = BB_OK;
    if (bb_pipeline_on_device(&instance.pipeline) < instance.pipeline.count)
        status = bb_fail(BB_UNSUPPORTED, "%s builds on the host, or partly so", text);
    if (status == BB_OK)
        status = bb_instance_build(&instance, scene, false, &timing);
    bb_instance_destroy(&instance);
    BB_TRY(status);
    moves->launches = timing.timing.launches;
    moves->waits = timing.timing.waits;
    return BB_OK;
}

bb_status bb_build_tally(bb_device *device, const char *text, const bb_scene *scene, uint64_t seed,
                         bb_build_moves *moves)
{
    *moves = (bb_build_moves){0};
    bb_tally_attach(&moves->tally, device);
    bb_status status = build(device, text, scene, seed, moves);
    bb_tally_detach(&moves->tally, device);
    return status;
}

void bb_build_moves_release(bb_build_moves *moves)
{
    bb_tally_release(&moves->tally);
}

bb_build_simulation bb_simulate_build(const bb_description *d, const bb_build_moves *moves)
{
    const bb_tally *tally = &moves->tally;
    bb_build_simulation s = {.launches = (double)moves->launches,
                             .waits = (double)moves->waits,
                             .sort_passes = (double)tally->sort_passes};
    for (uint32_t i = 0; i < tally->move_count; i++) {
        const bb_tally_move *move = &tally->moves[i];
        s.bytes += (double)move->bytes;
        s.memory_bytes += (double)move->arrays > d->second_bytes ? (double)move->bytes : 0;
    }
    s.memory_bytes = fmax(s.memory_bytes, (double)tally->array_bytes);
    s.l2_ms = s.bytes / (d->second_bytes_per_clock * d->clock_ghz * 1e6);
    s.memory_ms = s.memory_bytes / (d->memory_gb_s * 1e6);
    s.binds = s.l2_ms > s.memory_ms ? BB_BY_SECOND : BB_BY_MEMORY;
    s.ms = fmax(s.l2_ms, s.memory_ms);
    return s;
}
