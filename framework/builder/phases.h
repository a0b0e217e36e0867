/* The clock of a build's phases, which hooks only get to hand on: what is outside the build's time
 * is subtracted from it, and no hook may write that itself. */
#ifndef BB_PHASES_H
#define BB_PHASES_H

#include "framework/builder/builder.h"

struct bb_phases {
    bb_device *device;
    bool exact;       /* each boundary waits for the queue */
    bool used_device; /* a boundary saw work on the device */
    uint32_t count;
    int32_t current; /* -1: between phases */
    double started;
    bool outside;      /* the current phase does not count as build time */
    double outside_ms; /* sum of such phases, which the build's time leaves out */
    const char *names[BB_PHASES_MAX];
    double ms[BB_PHASES_MAX];
    uint32_t event_count;
    const char *event_names[BB_EVENTS_MAX];
    uint64_t events[BB_EVENTS_MAX];
};

#endif
