/* What the parts of a stress run share. */
#ifndef BB_STRESS_PRIVATE_H
#define BB_STRESS_PRIVATE_H

#include "framework/stress/stress.h"

/* What is measured of an axis; without folder, identity and device. */
bb_points bb_stress_points(const bb_stress_request *request, const bb_axis *axis);

/* What the device that is asked for calls itself, hashed together with the request's identity;
 * opened in a child, so that what is wrong with it is said once, before all. BB_INVALID if there is
 * none such. */
bb_status bb_stress_identify(const bb_stress_request *request, uint64_t *identity);

/* Whether builders take their parameters, which some find out on a device only; in a child too.
 * BB_INVALID names the first that does not. */
bb_status bb_stress_check_parameters(const bb_stress_request *request);

/* Makes the picture of the value at which most methods fail for the first time. A scene of which no
 * picture can be made, such as one that is refused, has none. */
bb_status bb_stress_picture(const bb_stress_request *request, bb_stress_axis *axis);

#endif
