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

enum { BB_REDUCED = 160 };

/* How much less a comparison does, to keep a time. */
typedef struct bb_thrift {
    uint32_t number;             /* of bb_bench_thrifty() */
    char reduced_to[BB_REDUCED]; /* what the smaller comparison has, in words; "": all */
} bb_thrift;

/* Prints a line on standard error for each scene that is large, or why it is not foretold; nothing
 * for what the comparison will refuse. All of it, choose() too, runs in children, so nothing stays
 * but the driver's cache of kernels. To be called before anything asks for OpenCL's devices, whose
 * drivers do not survive a fork.
 *
 * With ends_ms, small scenes count too, and *thrift is the least that keeps the time: a line says
 * what the comparison is reduced to. BB_REFUSED if none does, or a scene cannot be foretold. If
 * this process is not the first, since a builder died in the one before
 * (framework/builder/guard.h), what that one foretold holds. */
bb_status bb_foretell(const bb_foretelling *what, bb_thrift *thrift);

#endif
