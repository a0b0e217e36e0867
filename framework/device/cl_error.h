/* OpenCL's error codes, in words; inside the framework only. */
#ifndef BB_CL_ERROR_H
#define BB_CL_ERROR_H

#include "framework/device/device.h"

const char *bb_cl_error(
    cl_int error); /* such as "CL_OUT_OF_RESOURCES"; valid until the next call of the thread */

/* Returns BB_FAILED from the calling function when the OpenCL `call` fails; the rest says what was
 * being done. */
#define BB_CL_TRY(call, ...)                                                                       \
    do {                                                                                           \
        cl_int bb_cl_status_ = (call);                                                             \
        if (bb_cl_status_ != CL_SUCCESS)                                                           \
            return bb_cl_fail(bb_cl_status_, __VA_ARGS__);                                         \
    } while (0)

bb_status bb_cl_fail(cl_int error, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
