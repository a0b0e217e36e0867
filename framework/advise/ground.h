/* Loads the scene of an advice once, and samples its primitives for scouts. */
#ifndef BB_GROUND_H
#define BB_GROUND_H

#include "framework/advise/advice.h"

/* Loads the scene, copies it to the device and makes its oracle. */
bb_status bb_ground_load(bb_device *device, const char *scene, bb_ground *whole);

/* A sample of so many primitives that times on it say something of the whole: the whole itself
 * where it has few, or is a volume. */
bb_status bb_ground_sample(bb_device *device, const bb_ground *whole, bb_ground *sample);

/* `ground` may be zeroed; a sample that is the whole stays with it. */
void bb_ground_free(bb_ground *ground, const bb_ground *whole);

#endif
