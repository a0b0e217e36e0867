/* Tests of boxes and primitives, which the counting variant of a kernel counts on some rays. */
#ifndef BB_COUNT_H
#define BB_COUNT_H

#include "framework/judge/rays.h"
#include "traversal/traversal.h"

/* Buffers for a sample. */
typedef struct bb_counter {
    bb_device *device;
    bb_buffer rays, answers, counts;
} bb_counter;

/* Sums over a sample. */
typedef struct bb_tests {
    uint64_t nodes, prims;
    uint64_t overflowed; /* rays that needed more stack than there is */
} bb_tests;

/* Makes room for samples of up to `most` rays. `account` may be NULL. */
bb_status bb_counter_create(bb_device *device, bb_account *account, uint32_t most,
                            bb_counter *counter);
void bb_counter_release(bb_counter *counter); /* a zeroed one is allowed */

/* Traces `count` of the first `of` rays, evenly spaced, by the counting variant of the requested
 * traverser. */
bb_status bb_count_tests(bb_counter *counter, bb_traverser_request request,
                         const bb_layout_data *layout, const bb_rays *rays, uint32_t of,
                         uint32_t count, bb_tests *tests);

#endif
