/* Times a span of work on a device, by three clocks: wall, process CPU, and the device's own
 * events.
 *
 * The clocks check each other: in an in-order queue the kernels' own times cannot exceed the wall
 * time around them. A wall clock that stops before the queue is finished, or starts after the first
 * launch, violates that (audit.h).
 */
#ifndef BB_STOPWATCH_H
#define BB_STOPWATCH_H

#include "framework/device/device.h"

typedef struct bb_stopwatch {
    bb_device *device;
    double wall, cpu;
    uint64_t launches, waits; /* the device's, at the start */
} bb_stopwatch;

typedef struct bb_timing {
    double ms;                /* wall */
    double cpu_ms;            /* of the process, all threads */
    double event_ms;          /* kernels, copies and fills, by the device's clock */
    uint64_t launches, waits; /* of them; see bb_device */
} bb_timing;

/* Starts with a finished queue; BB_FAILED if the device fails. No other watch may run on the
 * device. */
bb_status bb_stopwatch_start(bb_device *device, bb_stopwatch *watch);

/* Stops with a finished queue. `status` is that of the timed work: a failure of it is returned. */
bb_status bb_stopwatch_stop(bb_stopwatch *watch, bb_status status, bb_timing *timing);

#endif
