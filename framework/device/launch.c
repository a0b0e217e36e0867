/* Launches: arguments, and the times of events. */
#include "framework/device/cl_error.h"
#include "framework/device/device_private.h"
#include "framework/device/tally.h"

#include <stdio.h>
#include <stdlib.h>

enum { EVENTS_MAX = 4096 };

struct bb_event_list {
    uint32_t count;
    cl_event events[EVENTS_MAX];
};

bb_status bb_device_add_event(bb_device *device, cl_event event)
{
    if (device->events == NULL)
        device->events = calloc(1, sizeof *device->events);
    if (device->events == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    if (device->events->count == EVENTS_MAX)
        BB_TRY(bb_device_collect_events(device));
    device->events->events[device->events->count++] = event;
    return BB_OK;
}

/* Gets a kernel's name for a message. */
static const char *name_of(cl_kernel kernel, char *name, size_t capacity)
{
    if (clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, capacity, name, NULL) != CL_SUCCESS)
        snprintf(name, capacity, "of an unknown name");
    return name;
}

/* A driver that gets too few arguments uses those of the previous launch, so the count is
 * checked. */
static bb_status set_args(cl_kernel kernel, const bb_arg *args, uint32_t count)
{
    char name[128];
    cl_uint wanted = 0;
    BB_CL_TRY(clGetKernelInfo(kernel, CL_KERNEL_NUM_ARGS, sizeof wanted, &wanted, NULL),
              "asking kernel %s for its arguments", name_of(kernel, name, sizeof name));
    if (count != wanted)
        return bb_fail(BB_FAILED, "kernel %s takes %u arguments, %u were given",
                       name_of(kernel, name, sizeof name), wanted, count);
    for (uint32_t i = 0; i < count; i++)
        BB_CL_TRY(clSetKernelArg(kernel, i, args[i].size, args[i].value),
                  "argument %u (from 0) of kernel %s, of %zu bytes", i,
                  name_of(kernel, name, sizeof name), args[i].size);
    return BB_OK;
}

bb_status bb_kernel_group(const bb_device *device, cl_kernel kernel, size_t wanted, size_t *group)
{
    char name[128];
    size_t most = 0, compiled[3] = {0};
    BB_CL_TRY(clGetKernelWorkGroupInfo(kernel, device->id, CL_KERNEL_WORK_GROUP_SIZE, sizeof most,
                                       &most, NULL),
              "asking kernel %s for the size of its groups", name_of(kernel, name, sizeof name));
    *group = wanted;
    if (wanted <= most)
        return BB_OK;
    BB_CL_TRY(clGetKernelWorkGroupInfo(kernel, device->id, CL_KERNEL_COMPILE_WORK_GROUP_SIZE,
                                       sizeof compiled, compiled, NULL),
              "asking kernel %s for the size of its groups", name_of(kernel, name, sizeof name));
    if (compiled[0] != 0 || most == 0)
        return bb_fail(BB_UNSUPPORTED,
                       "kernel %s needs groups of %zu work-items, and %s runs it in groups of up "
                       "to %zu",
                       name_of(kernel, name, sizeof name), wanted, device->name, most);
    while (*group > most)
        *group /= 2;
    return BB_OK;
}

bb_status bb_launch_args(bb_device *device, cl_kernel kernel, size_t global, size_t local,
                         const bb_arg *args, uint32_t count)
{
    if (global == 0)
        return BB_OK;
    char name[128];
    BB_TRY(set_args(kernel, args, count));
    BB_TRY(bb_kernel_group(device, kernel, local, &local));
    size_t whole = (global + local - 1) / local * local;
    cl_event event;
    BB_CL_TRY(clEnqueueNDRangeKernel(device->queue, kernel, 1, NULL, &whole, &local, 0, NULL,
                                     device->profile_events ? &event : NULL),
              "launching kernel %s on %zu work-items in groups of %zu",
              name_of(kernel, name, sizeof name), whole, local);
    device->launches++;
    if (device->profile_events)
        BB_TRY(bb_device_add_event(device, event));
    return bb_device_tallies(device) ? bb_tally_launch(device, kernel, args, count) : BB_OK;
}

static void drop_events(bb_device *device)
{
    for (uint32_t i = 0; device->events != NULL && i < device->events->count; i++)
        clReleaseEvent(device->events->events[i]);
    if (device->events != NULL)
        device->events->count = 0;
}

void bb_device_clear_events(bb_device *device)
{
    drop_events(device);
    device->event_ms = 0;
}

bb_status bb_device_collect_events(bb_device *device)
{
    BB_TRY(bb_finish(device));
    for (uint32_t i = 0; device->events != NULL && i < device->events->count; i++) {
        cl_ulong start = 0, end = 0;
        cl_event event = device->events->events[i];
        BB_CL_TRY(
            clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, NULL),
            "reading the time of a kernel");
        BB_CL_TRY(clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, NULL),
                  "reading the time of a kernel");
        device->event_ms += 1e-6 * (double)(end - start);
    }
    drop_events(device);
    return BB_OK;
}
