/* The folder that a comparison writes: results.json, report.html and pictures. */
#ifndef BB_OUTPUT_H
#define BB_OUTPUT_H

#include "framework/bench/bench.h"

#include <stdio.h>

typedef struct bb_output_request {
    const char *folder;
    bb_bench_outcome *outcome; /* whose audit is finished, and written */
    bool charts;               /* as pictures too */
    bool quiet;                /* does not say on standard error what was written */
    bb_status (*print)(bb_results *results, FILE *out); /* the text on standard output */
} bb_output_request;

/* Writes results.json and report.html, draws the charts, prints. The time that page and charts took becomes a step of the results.
 * A chart that can't be drawn is said when all else is done. */
bb_status bb_output_write(bb_results *results, const bb_output_request *request);

/* Says on standard error what is wrong with a comparison that was done, a line each; true if anything is. */
bool bb_output_blame(const bb_bench_outcome *outcome);

/* After a comparison that could not be finished: keeps what was measured, if anything was. Returns `status` with its message, which
 * then says where that lies. */
bb_status bb_output_keep(bb_results *results, const char *folder, bb_status status);

#endif
