/* Who gives way where memory is short: the oracle while nobody asks it, then tracers. */
#include "framework/bench/bench_private.h"

#include <stdio.h>

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
                 "its tree made room for %s: compare it alone with fewer builders, or in a smaller "
                 "scene",
                 bench->asks_oracle ? "the oracle" : "a builder's");
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
    (void)bb_host_missing(); /* what others lacked is no reason to give up anything for it */
    bb_status status = ready_oracle(bench, beside);
    while (status == BB_REFUSED && bb_residency_make_room(&bench->residency, NULL))
        status = ready_oracle(bench, beside);
    bench->asks_oracle = false;
    return bb_bench_end(bench, step, "oracle: prepare", status);
}
