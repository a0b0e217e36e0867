/* The steps of rays, recorded on the device by the recording variant of a kernel
 * (kernels/steps_shared.h). */
#ifndef BB_STEPS_H
#define BB_STEPS_H

#include "framework/judge/rays.h"
#include "framework/simulate/sample.h"
#include "kernels/steps_shared.h"
#include "traversal/traversal.h"

/* Steps of rays 0 to rays - 1, all or a sample of those of a set: those of ray i are
 * words[ends[i - 1]] to words[ends[i] - 1]; the first begins at 0. */
typedef struct bb_steps {
    uint32_t rays, set_rays;
    uint32_t *ends;
    uint32_t *words;
} bb_steps;

enum { BB_STEPS_MOST = 1 << 28 }; /* words that are recorded at most: 1 GiB */

/* Launches the recording variant of a kernel over all items; need not wait. */
typedef bb_status (*bb_recorded_launch)(void *self, const bb_recording *recording);

/* Records the steps of items 0 to count - 1, or of a sample of them: bb_sample_take(). All are
 * launched twice: the first launch counts their steps, the second writes them; it is divided if the
 * device has no buffer for all steps. BB_REFUSED if there are more than BB_STEPS_MOST steps to
 * record, or no room for them. */
bb_status bb_steps_record(bb_device *device, bb_recorded_launch launch, void *self, uint32_t count,
                          bb_sample_size size, bb_steps *steps);
void bb_steps_release(bb_steps *steps); /* a zeroed one is allowed */

static inline uint32_t bb_step_kind(uint32_t word)
{
    return word >> BB_STEP_INDEX_BITS;
}

static inline uint32_t bb_step_index(uint32_t word)
{
    return word & BB_STEP_INDEX_MASK;
}

#endif
