/* Shared by the files of a stress run. */
#ifndef BB_STRESS_PRIVATE_H
#define BB_STRESS_PRIVATE_H

#include "framework/stress/stress.h"

/* Returns the points of an axis, without folder, identity and device. */
bb_points bb_stress_points(const bb_stress_request *request, const bb_axis *axis);

/* Hashes the device's name and driver with the request's identity. A child opens the device, so
 * that its faults are reported once, before all else. BB_INVALID: there is no such device. */
bb_status bb_stress_identify(const bb_stress_request *request, uint64_t *identity);

/* Checks the parameters of builders in a child, since some need a device for it. BB_INVALID names
 * the first faulty builder. */
bb_status bb_stress_check_parameters(const bb_stress_request *request);

/* Makes a picture at the value at which most methods begin to fail. There is none if the scene
 * cannot be drawn, such as a refused one. */
bb_status bb_stress_picture(const bb_stress_request *request, bb_stress_axis *axis);

#endif
