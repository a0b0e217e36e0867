#include "framework/bench/audit.h"

#include "framework/base/clock.h"
#include "framework/device/device_private.h"
#include "framework/device/run_row.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

/* Tolerances: by how much two clocks may differ, and how long starting and stopping them takes. */
static const double clock_share = 0.01, clock_ms = 0.05;

/* Time that may remain unaccounted for: reading clocks, shuffling, keeping records. */
static const double rest_share = 0.02, rest_ms = 200;

void bb_audit_complain(bb_audit *audit, const char *format, ...)
{
    if (audit->complaints < BB_COMPLAINTS_MAX) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(audit->texts[audit->complaints], sizeof audit->texts[0], format, arguments);
        va_end(arguments);
    }
    audit->complaints++;
}

bool bb_audit_exceeds(double event_ms, double ms)
{
    return event_ms > ms * (1 + clock_share) + clock_ms;
}

void bb_audit_timing(bb_audit *audit, const char *what, const bb_timing *timing, bool seen)
{
    audit->timings++;
    if (!(timing->ms > 0))
        bb_audit_complain(audit, "%s: took %g ms by the wall clock", what, timing->ms);
    else if (bb_audit_exceeds(timing->event_ms, timing->ms))
        bb_audit_complain(audit,
                          "%s: the work itself took %.3f ms, the clock around it saw %.3f ms", what,
                          timing->event_ms, timing->ms);
    else if (seen && !(timing->event_ms > 0))
        bb_audit_complain(audit, "%s: %.3f ms by the wall clock, but no work was seen in them",
                          what, timing->ms);
}

static void check_step(bb_audit *audit, const char *scene, const bb_instance *instance,
                       const bb_build_step *step)
{
    char what[256];
    const bb_phases *phases = &step->phases;
    const bool alone = instance->pipeline.count == 1;
    bb_timing seen = step->timing.timing;
    if (phases->device == NULL) {
        double inside = -phases->outside_ms;
        for (uint32_t i = 0; i < phases->count; i++)
            inside += phases->ms[i];
        seen.event_ms = seen.event_ms > inside ? seen.event_ms : inside;
    }
    snprintf(what, sizeof what, "build of %.100s by %.100s%s%.40s", scene, instance->pipeline.text,
             alone ? "" : ", ", alone ? "" : step->label);
    bb_audit_timing(audit, what, &seen,
                    phases->used_device || (phases->device == NULL && phases->count > 0));
}

void bb_audit_build(bb_audit *audit, const char *scene, const bb_instance *instance)
{
    for (uint32_t i = 0; i < instance->step_count; i++)
        check_step(audit, scene, instance, &instance->steps[i]);
}

void bb_audit_launches(bb_audit *audit, const char *what, uint64_t timed, uint64_t launched,
                       uint64_t count)
{
    if (timed != count || launched != count)
        bb_audit_complain(audit, "%s: of %llu rays the clock saw %llu launched, of %llu in all",
                          what, (unsigned long long)count, (unsigned long long)timed,
                          (unsigned long long)launched);
}

void bb_audit_add(bb_audit *sum, const bb_audit *more)
{
    sum->timings += more->timings;
    sum->rates += more->rates;
    for (uint32_t i = 0; i < more->complaints; i++)
        bb_audit_complain(sum, "%s", i < BB_COMPLAINTS_MAX ? more->texts[i] : "");
}

void bb_audit_total(bb_audit *audit, double build_ms, double trace_ms, double steps_ms,
                    double total_ms)
{
    audit->rest_ms = total_ms - build_ms - trace_ms - steps_ms;
    if (fabs(audit->rest_ms) > rest_share * total_ms + rest_ms)
        bb_audit_complain(
            audit,
            "builds (%.0f ms), traces (%.0f ms) and steps (%.0f ms) do not add up to the %.0f "
            "ms of the run",
            build_ms, trace_ms, steps_ms, total_ms);
}

void bb_audit_fill(const bb_audit *audit, const bb_bystanders *watch, bb_table *table)
{
    const uint32_t row = bb_table_row(table, (bb_cell){{NULL}});
    bb_table_set_number(table, row, &bb_run_columns[BB_RUN_AUDIT_TIMINGS], (double)audit->timings);
    bb_table_set_number(table, row, &bb_run_columns[BB_RUN_AUDIT_COMPLAINTS], audit->complaints);
    if (audit->complaints > 0)
        bb_table_set_text(table, row, &bb_run_columns[BB_RUN_AUDIT_TEXTS], audit->texts[0]);
    bb_table_set_number(table, row, &bb_run_columns[BB_RUN_OTHERS], bb_bystanders_share(watch));
}

bool bb_audit_blame(const bb_audit *audit)
{
    for (uint32_t i = 0; i < audit->complaints && i < BB_COMPLAINTS_MAX; i++)
        fprintf(stderr, "bvhbench: clocks: %s\n", audit->texts[i]);
    if (audit->complaints > 0)
        fprintf(stderr, "bvhbench: %u figures contradict each other: do not trust this run\n",
                audit->complaints);
    return audit->complaints > 0;
}

void bb_warn_of_bystanders(bb_bystanders *watch, const bb_device *device, bb_progress *progress)
{
    const double share = bb_bystanders_share(watch), shortest_ms = 200; /* for ticks of 10 ms */
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (watch->warned)
        return;
    watch->warned = true;
    if (!device->is_cpu)
        bb_progress_note(progress,
                         "what other programs do on %s cannot be seen: keep them off it; only "
                         "processors are watched, on which host code and transfers depend",
                         device->name);
    if (bb_wall_ms() - watch->wall_ms > shortest_ms && share > BB_BUSY_SHARE * (double)processors)
        bb_progress_note(progress,
                         "WARNING: the machine is busy: other programs keep %.2g of %ld processors "
                         "at work, and times will be noisy",
                         share, processors);
}
