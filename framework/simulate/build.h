/* Simulates a build on a GPU on paper: it is made once more in its form for GPUs, never timed, and
 * what it moves is tallied (framework/device/tally.h). A bound on its time follows.
 *
 * Left out: the time that a launch takes to begin, of which the number is given instead; that short
 * launches cannot fill a GPU; instructions, atomics and latency; the bus to the host.
 */
#ifndef BB_SIMULATE_BUILD_H
#define BB_SIMULATE_BUILD_H

#include "framework/builder/instance.h"
#include "framework/device/tally.h"
#include "framework/simulate/simulate.h"

typedef struct bb_build_simulation {
    bb_binding binds; /* BB_BY_SECOND or BB_BY_MEMORY */
#define SIMT_BUILD(id, member, name, unit, better, heading, help) double member;
#include "framework/simulate/simt_build_figures.h"
} bb_build_simulation;

/* What one build moves, on any GPU. */
typedef struct bb_build_moves {
    bb_tally tally;
    uint64_t launches, waits;
} bb_build_moves;

/* Builds the pipeline `text` over the scene, whose boxes are on the device, and frees the tree.
 * BB_UNSUPPORTED if a stage works on the host. To be released in any case. */
bb_status bb_build_tally(bb_device *device, const char *text, const bb_scene *scene, uint64_t seed,
                         bb_build_moves *moves);
void bb_build_moves_release(bb_build_moves *moves); /* a zeroed one is allowed */

/* Simulates it on one. */
bb_build_simulation bb_simulate_build(const bb_description *device, const bb_build_moves *moves);

#endif
