/* The audit of results: each rate is that of as many rays as were judged, in a time that
 * holds what the device saw; builds likewise. */
#ifndef BB_AUDIT_RESULTS_H
#define BB_AUDIT_RESULTS_H

#include "framework/bench/audit.h"
#include "framework/record/record.h"

/* Checks the rates of all cells in the results, and the times of its builds. */
void bb_audit_rates(bb_audit *audit, bb_results *results);

/* Puts the audit into the context. */
bb_status bb_results_set_audit(bb_results *results, const bb_audit *audit);

#endif
