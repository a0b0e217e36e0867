/* Which cells belong to this shard. */
#include "framework/bench/bench_private.h"

#include <stdio.h>

bool bb_bench_owns(const bb_bench *bench, uint32_t number)
{
    const bb_shard *shard = bench->request->shard;
    return shard == NULL || number % shard->count == shard->index - 1;
}

bool bb_bench_owns_builds(const bb_bench *bench)
{
    return bb_bench_owns(bench, bench->part->first);
}

static uint32_t wanted_sets(const bb_bench *bench, const bb_scene *scene)
{
    const bb_bench_request *request = bench->request;
    uint32_t sets = 0;
    for (uint32_t w = 0; w < request->workload_count; w++) {
        bb_spec spec;
        const bb_workload *workload = NULL;
        bb_cell_parts parts = bb_bench_cell(bench);
        if (bb_workload_parse(request->workloads[w], &spec, &workload) != BB_OK)
            continue;
        uint32_t most = request->max_views;
        uint32_t views = most > 0 && most < scene->view_count ? most : scene->view_count;
        snprintf(parts.rays, sizeof parts.rays, "%s", spec.text);
        for (uint32_t v = 0; v < (workload->per_view ? views : 1); v++) {
            if (workload->per_view)
                snprintf(parts.view, sizeof parts.view, "%s", scene->views[v].name);
            sets += bb_bench_wants(bench, &parts);
        }
    }
    return sets;
}

bb_scene_part bb_bench_part_of(bb_bench *bench, const bb_scene *scene, const char *text)
{
    bb_shard *shard = bench->request->shard;
    bench->scene_text = text;
    bb_scene_part part = {.sets = wanted_sets(bench, scene)};
    if (part.sets == 0)
        part.sets = 1;
    if (shard != NULL) {
        part.first = shard->next;
        shard->next += part.sets;
    }
    for (uint32_t i = 0; i < part.sets; i++)
        part.own += bb_bench_owns(bench, part.first + i);
    return part;
}
