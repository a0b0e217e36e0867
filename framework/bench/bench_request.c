/* Reads a request: its names and parameters, and how many cells they make. */
#include "framework/bench/bench_private.h"

#include "framework/builder/registry.h"
#include "framework/workload/workload.h"

#include <stdio.h>
#include <string.h>

bb_status bb_bench_parse_kernel(const char *text, bb_kernel_choice *choice)
{
    BB_TRY(bb_kernel_parse(text, &choice->spec, &choice->kernel));
    uint64_t leaf, group;
    BB_TRY(bb_spec_u64(&choice->spec, bb_kernel_common_options, "leaf", 1, 64, &leaf));
    BB_TRY(bb_spec_u64(&choice->spec, bb_kernel_common_options, "group", 1, 65536, &group));
    choice->leaf = (uint32_t)leaf;
    return BB_OK;
}

static bb_status check_metrics(const bb_bench_request *request)
{
    bb_simt simts[BB_SIMT_MAX];
    uint32_t count;
    for (uint32_t i = 0; i < request->metric_count; i++)
        if (!bb_is_simt(request->metrics[i]))
            BB_TRY(bb_metric_check(request->metrics[i]));
    return bb_simts_parse(request->metrics, request->metric_count, simts, &count);
}

bb_status bb_bench_check(const bb_bench_request *request)
{
    bb_spec spec;
    const bb_tracer *tracer;
    bb_kernel_choice choice;
    if (request->builder_count > BB_ENTRANTS_MAX)
        return bb_fail(BB_INVALID, "at most %d builders at once", BB_ENTRANTS_MAX);
    if (request->kernel_count > BB_KERNELS_MAX)
        return bb_fail(BB_INVALID, "at most %d kernels at once", BB_KERNELS_MAX);
    for (uint32_t i = 0; i < request->builder_count; i++)
        BB_TRY(bb_tracer_of(request->builders[i]) != NULL
                   ? bb_tracer_parse(request->builders[i], &tracer, &spec)
                   : bb_instance_check(request->builders[i]));
    for (uint32_t i = 0; i < request->kernel_count; i++)
        BB_TRY(bb_bench_parse_kernel(request->kernels[i], &choice));
    for (uint32_t i = 0; i < request->workload_count; i++)
        BB_TRY(bb_workload_check(request->workloads[i], request->max_rays));
    bb_intersector intersector;
    for (uint32_t i = 0; i < request->intersector_count; i++)
        BB_TRY(bb_intersector_parse(request->intersectors[i], &intersector));
    return check_metrics(request);
}

bool bb_bench_is_apart(const bb_bench_request *request, uint32_t prims)
{
    const uint64_t together = 1 << 24; /* primitives of all builders: about 3 GB */
    return (uint64_t)prims * request->builder_count > together;
}

/* Counts all kernels, although some trees may not need all of them. */
uint32_t bb_bench_cells_of_set(const bb_bench *bench)
{
    uint32_t cells = 0;
    for (uint32_t i = 0; i < bench->request->builder_count; i++)
        cells += bb_tracer_of(bench->request->builders[i]) != NULL
                     ? 1
                     : bench->kernel_count * bench->request->intersector_count;
    return cells;
}
