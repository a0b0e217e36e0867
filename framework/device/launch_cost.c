#include "framework/device/launch_cost.h"

#include "framework/base/statistics.h"
#include "framework/device/stopwatch.h"

enum { ROUNDS = 7, LAUNCHES = 32 };

static bb_status time_round(bb_device *device, cl_kernel kernel, bb_samples *us)
{
    const uint32_t unused = 0;
    bb_stopwatch watch;
    bb_timing timing;
    BB_TRY(bb_stopwatch_start(device, &watch));
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < LAUNCHES && status == BB_OK; i++)
        status = bb_launch(device, kernel, 1, 1, BB_VALUE(unused));
    BB_TRY(bb_stopwatch_stop(&watch, status, &timing));
    bb_samples_add(us, 1e3 * timing.ms / LAUNCHES);
    return BB_OK;
}

bb_status bb_launch_cost(bb_device *device, double *us)
{
    bb_samples samples = {0}; /* whose median leaves out the first, which warms up */
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_status status = bb_program_build(device, bb_source_find("empty.cl"), "", &program);
    if (status == BB_OK)
        status = bb_kernel_get(program, "empty", &kernel);
    for (uint32_t i = 0; i <= ROUNDS && status == BB_OK; i++)
        status = time_round(device, kernel, &samples);
    *us = bb_samples_median(&samples);
    bb_kernel_release(kernel);
    bb_program_release(program);
    return status;
}
