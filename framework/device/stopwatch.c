#include "framework/device/stopwatch.h"

#include "framework/base/clock.h"
#include "framework/device/device_private.h"

bb_status bb_stopwatch_start(bb_device *device, bb_stopwatch *watch)
{
    BB_TRY(bb_finish(device));
    bb_device_clear_events(device);
    device->profile_events = true;
    *watch = (bb_stopwatch){device, 0, bb_cpu_ms(), device->launches, device->waits};
    watch->wall = bb_wall_ms();
    return BB_OK;
}

bb_status bb_stopwatch_stop(bb_stopwatch *watch, bb_status status, bb_timing *timing)
{
    bb_device *device = watch->device;
    timing->waits = device->waits - watch->waits; /* before the wait below */
    bb_status finished = bb_finish(device);
    timing->ms = bb_wall_ms() - watch->wall;
    timing->cpu_ms = bb_cpu_ms() - watch->cpu;
    device->profile_events = false;
    if (finished == BB_OK)
        finished = bb_device_collect_events(device);
    timing->event_ms = device->event_ms;
    timing->launches = device->launches - watch->launches;
    return status != BB_OK ? status : finished;
}
