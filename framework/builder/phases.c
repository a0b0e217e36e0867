/* The clock of a build's phases, and the counts of its events. */
#include "framework/builder/phases.h"

#include "framework/base/clock.h"

#include <string.h>

bb_status bb_phase(bb_phases *phases, const char *name)
{
    if (phases == NULL)
        return BB_OK;
    if (phases->device != NULL) {
        phases->used_device = true;
        if (phases->exact)
            BB_TRY(bb_finish(phases->device));
    }
    double now = bb_wall_ms();
    if (phases->current >= 0) {
        phases->ms[phases->current] += now - phases->started;
        if (phases->outside)
            phases->outside_ms += now - phases->started;
    }
    phases->current = -1;
    phases->outside = false;
    if (name == NULL)
        return BB_OK;
    uint32_t index = 0;
    while (index < phases->count && strcmp(phases->names[index], name) != 0)
        index++;
    if (index == BB_PHASES_MAX)
        return bb_fail(BB_FAILED, "phase '%s': a build has at most %d phases", name, BB_PHASES_MAX);
    if (index == phases->count) {
        phases->names[phases->count++] = name;
        phases->ms[index] = 0.0;
    }
    phases->current = (int32_t)index;
    phases->started = now;
    return BB_OK;
}

void bb_phases_on_host(bb_phases *phases)
{
    if (phases != NULL)
        phases->device = NULL;
}

bb_status bb_phase_outside(bb_phases *phases, const char *name)
{
    if (phases == NULL)
        return BB_OK;
    if (phases->device != NULL)
        return bb_fail(BB_FAILED,
                       "phase '%s': a builder on the device has no phases outside its time", name);
    BB_TRY(bb_phase(phases, name));
    phases->outside = true;
    return BB_OK;
}

bb_status bb_event(bb_phases *phases, const char *name, uint64_t number)
{
    if (phases == NULL)
        return BB_OK;
    uint32_t index = 0;
    while (index < phases->event_count && strcmp(phases->event_names[index], name) != 0)
        index++;
    if (index == BB_EVENTS_MAX)
        return bb_fail(BB_FAILED, "'%s': a build counts at most %d things", name, BB_EVENTS_MAX);
    if (index == phases->event_count) {
        phases->event_names[phases->event_count++] = name;
        phases->events[index] = 0;
    }
    phases->events[index] += number;
    return BB_OK;
}
