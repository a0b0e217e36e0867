/* Chooses how work-groups of a device hand over to each other (kernels/handover.clh). */
#ifndef BB_HANDOVER_H
#define BB_HANDOVER_H

#include "framework/device/device.h"

/* cl_name_version of OpenCL 3.0. A name of full length is not terminated. */
typedef struct bb_named_version {
    cl_uint version;
    char name[64];
} bb_named_version;

/* A list of OpenCL 3.0: versions of OpenCL C, or features. */
typedef struct bb_driver_names {
    bb_named_version *names;
    size_t count;
} bb_driver_names;

/* Returns the option that compiles a fence between work-groups for a device with these lists, each
 * of which may be empty, and this CL_DEVICE_OPENCL_C_VERSION; "" if it documents none. */
const char *bb_fence_option(const bb_driver_names *versions, const bb_driver_names *features,
                            const char *version);

/* Sets device->handover, fence and the litmus counts. The queue must exist. */
bb_status bb_choose_handover(bb_device *device);

#endif
