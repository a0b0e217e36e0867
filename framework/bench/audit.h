/* Holds the figures of a run against each other, so that a clock that runs wrong, or a rate of what
 * was not traced, is found out by the run itself.
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

enum { BB_COMPLAINTS_MAX = 20 }; /* that are kept; all are counted */

typedef struct bb_audit {
    uint64_t timings; /* that were checked */
    uint64_t rates;
    double rest_ms; /* of the run, not accounted for */
    uint32_t complaints;
    char texts[BB_COMPLAINTS_MAX][256];
} bb_audit;

/* `what` says what was timed, such as "trace of coffee by stack on lbvh"; `seen`: a second clock
 * must have seen some of the work. */
void bb_audit_timing(bb_audit *audit, const char *what, const bb_timing *timing, bool seen);

/* A time of which the only other witness is the clock of who called: `ms` of `outer_ms`. */
void bb_audit_outer(bb_audit *audit, const char *what, double ms, double outer_ms);

/* Rays launched, within the clock and in all, where `count` are the rate's. */
void bb_audit_launches(bb_audit *audit, const char *what, uint64_t timed, uint64_t launched,
                       uint64_t count);

/* The rates of all cells in the document, and the times of its builds. */
void bb_audit_rates(bb_audit *audit, bb_results *results);

/* sum += more. */
void bb_audit_add(bb_audit *sum, const bb_audit *more);

/* Wall times of timed builds and traces, of all steps, and of the whole run. */
void bb_audit_total(bb_audit *audit, double build_ms, double trace_ms, double steps_ms,
                    double total_ms);

/* Adds it as member "audit" of the document. */
bb_status bb_results_add_audit(bb_results *results, const bb_audit *audit);

#endif
