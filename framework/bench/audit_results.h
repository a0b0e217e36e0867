/* The audit of a result document: each rate is that of as many rays as were judged, in a time that
 * holds what the device saw; builds likewise. */
#ifndef BB_AUDIT_RESULTS_H
#define BB_AUDIT_RESULTS_H

#include "framework/measure/audit.h"
#include "framework/record/record.h"

/* Checks the rates of all cells in the document, and the times of its builds. */
void bb_audit_rates(bb_audit *audit, bb_results *results);

/* Adds the audit to the document, as member "audit". */
bb_status bb_results_add_audit(bb_results *results, const bb_audit *audit);

#endif
