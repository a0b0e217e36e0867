/* The steps of whatever a launch answers, such as pixels or voxels. */
#ifndef BB_STEPS_LAUNCH_H
#define BB_STEPS_LAUNCH_H

#include "framework/simulate/steps.h"

/* Launches the recording variant of a kernel over all items; need not wait. */
typedef bb_status (*bb_recorded_launch)(void *self, const bb_recording *recording);

/* Records the steps of items 0 to count - 1, or of a sample of `most` of them, as
 * bb_steps_record() has it of rays. All are launched twice. Fails as that does, or as a launch
 * does. */
bb_status bb_steps_record_launch(bb_device *device, bb_recorded_launch launch, void *self,
                                 uint32_t count, uint32_t most, bb_steps *steps);

#endif
