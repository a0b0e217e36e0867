/* Checks the figures of a run against each other, so that a run itself finds a wrong clock, or a
 * rate that counts rays that were not traced.
 *
 *   each timing      the kernels' own times (a host builder's phases, a reference's threads) within
 *                    the wall time, and more than nothing where there is such a clock
 *   each launch      of as many rays within the clock as are counted, and of none beside it
 *   each rate        that of as many rays as were judged, in a time that holds what the device saw;
 *                    builds likewise
 *   the whole run    builds, traces and named steps add up to it, but for a small rest
 */
#ifndef BB_AUDIT_H
#define BB_AUDIT_H

#include "framework/device/stopwatch.h"
#include "framework/record/record.h"

#include <stdbool.h>

enum { BB_COMPLAINTS_MAX = 20 }; /* complaints that are kept; all are counted */

typedef struct bb_audit {
    uint64_t timings; /* timings that were checked */
    uint64_t rates;
    double rest_ms; /* time of the run that nothing accounts for */
    uint32_t complaints;
    char texts[BB_COMPLAINTS_MAX][256];
} bb_audit;

/* Checks a timing of `what`, such as "trace of coffee by stack on lbvh". `seen`: a second clock
 * must have seen some of the work. */
void bb_audit_timing(bb_audit *audit, const char *what, const bb_timing *timing, bool seen);

/* Checks `ms`, a time that only the caller's clock, `outer_ms`, can confirm. */
void bb_audit_outer(bb_audit *audit, const char *what, double ms, double outer_ms);

/* Checks the numbers of rays launched, while the clock ran and in all, against the `count` of the
 * rate. */
void bb_audit_launches(bb_audit *audit, const char *what, uint64_t timed, uint64_t launched,
                       uint64_t count);

/* Checks the rates of all cells in the document, and the times of its builds. */
void bb_audit_rates(bb_audit *audit, bb_results *results);

/* sum += more. */
void bb_audit_add(bb_audit *sum, const bb_audit *more);

/* Checks that the wall times of timed builds and traces and of all steps add up to the whole run.
 */
void bb_audit_total(bb_audit *audit, double build_ms, double trace_ms, double steps_ms,
                    double total_ms);

/* Adds the audit to the document, as member "audit". */
bb_status bb_results_add_audit(bb_results *results, const bb_audit *audit);

#endif
