/* Chooses how work-groups of a device hand over to each other (kernels/handover.clh). */
#ifndef BB_HANDOVER_H
#define BB_HANDOVER_H

#include "framework/device/device.h"

/* Sets device->handover, fence and the litmus counts. The queue must be there. */
bb_status bb_choose_handover(bb_device *device);

#endif
