/* The folder that a comparison writes: results.json, report.html and pictures. */
#ifndef BB_OUTPUT_H
#define BB_OUTPUT_H

#include "framework/bench.h"

/* Writes results.json and report.html; the time that the page took becomes a step of the results. */
bb_status bb_output_write(bb_results *results, const char *folder, const bb_bench_times *times);

/* After a comparison that could not be finished: keeps what was measured, if anything was. Returns `status` with its message, which
 * then says where that lies. */
bb_status bb_output_keep(bb_results *results, const char *folder, bb_status status);

#endif
