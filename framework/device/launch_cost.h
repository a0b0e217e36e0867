/* What a launch costs that does nothing: a build of few primitives takes little more than its
 * launches. */
#ifndef BB_LAUNCH_COST_H
#define BB_LAUNCH_COST_H

#include "framework/device/device.h"

/* Times launches of an empty kernel on one work-item, enqueued one after the other without waiting,
 * as builders enqueue theirs. Writes the median of several rounds, in microseconds per launch.
 * BB_FAILED if the device fails. */
bb_status bb_launch_cost(bb_device *device, double *us);

#endif
