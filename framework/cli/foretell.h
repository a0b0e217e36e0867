/* Says what a comparison will take before it begins, and leaves out what does not fit into a given
 * time. */
#ifndef BB_FORETELL_H
#define BB_FORETELL_H

#include "framework/bench/bench.h"
#include "framework/cli/choice.h"

/* What is foretold: a request that choose() makes of `user`, on a device. */
typedef struct bb_foretelling {
    const bb_names *scenes;
    const bb_device_choice *device;
    bb_status (*choose)(void *user, const bb_bench_request **request);
    void *user;
    double ends_ms; /* bb_wall_ms() at which it is to end; 0: at any time */
} bb_foretelling;

/* Prints a line on standard error for each scene that is large, or why it is not foretold; nothing
 * for what the comparison will refuse. All of it, choose() too, runs in children, so nothing stays
 * but the driver's cache of kernels. To be called before anything asks for OpenCL's devices, whose
 * drivers do not survive a fork.
 *
 * With ends_ms, small scenes count too, and *thrift (bb_bench_thrifty()) is the least that keeps
 * the time: a line says what it leaves out. BB_REFUSED if none does, or a scene cannot be
 * foretold. */
bb_status bb_foretell(const bb_foretelling *what, uint32_t *thrift);

#endif
