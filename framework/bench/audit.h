/* Checks the timings of a run against each other, so that a run itself finds a wrong clock, or a
 * rate that counts rays that were not traced.
 *
 *   each timing      the kernels' own times (a host builder's phases, a reference's threads) within
 *                    the wall time, and more than nothing where there is such a clock
 *   each launch      of as many rays within the clock as are counted, and of none beside it
 *   the whole run    builds, traces and named steps add up to it, but for a small rest
 */
#ifndef BB_AUDIT_H
#define BB_AUDIT_H

#include "framework/base/progress.h"
#include "framework/builder/instance.h"
#include "framework/device/bystanders.h"
#include "framework/table/table.h"

#include <stdbool.h>

enum { BB_COMPLAINTS_MAX = 20 }; /* complaints that are kept; all are counted */

typedef struct bb_audit {
    uint64_t timings; /* timings that were checked */
    uint64_t rates;   /* rates that were checked, of `run` */
    double rest_ms;   /* time of the run that nothing accounts for, of `run` */
    uint32_t complaints;
    char texts[BB_COMPLAINTS_MAX][256];
} bb_audit;

/* Adds a complaint: "WHAT: how figures contradict each other". */
void bb_audit_complain(bb_audit *audit, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Returns whether a time by the device's own clock is longer than the wall time around it, beyond
 * the tolerance of two clocks. */
bool bb_audit_exceeds(double event_ms, double ms);

/* Checks a timing of `what`, such as "trace of coffee by stack on lbvh". `seen`: a second clock
 * must have seen some of the work. */
void bb_audit_timing(bb_audit *audit, const char *what, const bb_timing *timing, bool seen);

/* Checks all steps of an instance's last build. A host builder's phases are its second clock. */
void bb_audit_build(bb_audit *audit, const char *scene, const bb_instance *instance);

/* Checks the numbers of rays launched, while the clock ran and in all, against the `count` of the
 * rate. */
void bb_audit_launches(bb_audit *audit, const char *what, uint64_t timed, uint64_t launched,
                       uint64_t count);

/* sum += more. */
void bb_audit_add(bb_audit *sum, const bb_audit *more);

/* Checks that the wall times of timed builds and traces and of all steps add up to the whole run.
 */
void bb_audit_total(bb_audit *audit, double build_ms, double trace_ms, double steps_ms,
                    double total_ms);

/* Puts the audit of clocks, and how many processors other programs kept busy, into the row of the
 * whole run. */
void bb_audit_fill(const bb_audit *audit, const bb_bystanders *watch, bb_table *table);

/* Prints the complaints on standard error. Returns true if there are any. */
bool bb_audit_blame(const bb_audit *audit);

/* Warns once, before the work, if other programs have kept the machine busy since the watch
 * started, and says what cannot be seen of a device that is no CPU. */
void bb_warn_of_bystanders(bb_bystanders *watch, const bb_device *device, bb_progress *progress);

#endif
