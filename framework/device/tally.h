/* What builds on a GPU move, tallied launch by launch while a stopwatch runs: for simulations, not
 * for what is timed (framework/simulate/build.h). A device without a tally does nothing of this.
 *
 * What a kernel reads and writes is not known to the host, only which arrays it gets. The model:
 * a launch moves each of its arrays once, whole. Launches of one kernel with the same arrays share
 * that between them, each for a part, as the levels of a tree do; only what is known to pass over
 * its arrays again, sort, scan and reduction, moves them each time. Fills and transfers move their
 * bytes, copies twice. The model's errors: framework/simulate/README.md.
 *
 * Arrays that are larger than what a build needs count whole; what a kernel reads several times is
 * taken to be in a cache; a launch that skips most of an array, or passes over it once more without
 * saying so, is counted wrongly.
 */
#ifndef BB_TALLY_H
#define BB_TALLY_H

#include "framework/device/device.h"

/* A launch, fill, copy or transfer. */
typedef struct bb_tally_move {
    uint64_t bytes;  /* moved, once those of earlier launches are left out */
    uint64_t arrays; /* sizes of the arrays that these are of, together */
} bb_tally_move;

/* Zeroed, it is empty. It must not move while it is attached. */
typedef struct bb_tally {
    bb_tally_move *moves;
    uint32_t move_count;
    uint64_t sort_passes;
    uint64_t array_bytes; /* of all arrays, each once */

    bool passes;    /* the next launch passes over its arrays again */
    cl_mem *arrays; /* kept alive, so that no other one gets such a handle */
    uint32_t array_count;
    uint64_t *seen; /* hashes: a kernel and its arrays */
    uint32_t seen_count;
    struct { /* the device as it was */
        bb_form form;
        bb_handover handover;
        uint32_t compute_units;
        uint64_t local_bytes;
        size_t max_group_size;
    } before;
} bb_tally;

/* Begins to tally what the device's stopwatches enclose. Until bb_tally_detach(), objects are made
 * for a GPU, the same on any machine: GPU form, hand-over by levels, which any GPU can, sizes of
 * groups and local memory. */
void bb_tally_attach(bb_tally *tally, bb_device *device);
void bb_tally_detach(bb_tally *tally, bb_device *device);
void bb_tally_release(bb_tally *tally);

/* ---- called where work is enqueued ---- */

static inline bool bb_device_tallies(const bb_device *device)
{
    return device->tally != NULL && device->profile_events;
}

bb_status bb_tally_launch(bb_device *device, cl_kernel kernel, const bb_arg *args, uint32_t count);
/* Part of an array, by a fill, a copy or a transfer. */
bb_status bb_tally_part(bb_device *device, cl_mem array, uint64_t bytes);
/* The next launch passes over its arrays, whatever its kernel did before. Returns the device. */
bb_device *bb_tally_pass(bb_device *device);
void bb_tally_sort_pass(bb_device *device);

#endif
