/* Says what large scenes will take, before a comparison begins. */
#ifndef BB_FORETELL_H
#define BB_FORETELL_H

#include "framework/bench/bench.h"
#include "framework/cli/choice.h"

/* Prints a line on standard error for each scene of `request` that is large, or why it is not
 * foretold. All is tried in children, so nothing stays of it but the driver's cache of kernels. No
 * device may be open. */
void bb_foretell(const bb_device_choice *device, const bb_bench_request *request);

#endif
