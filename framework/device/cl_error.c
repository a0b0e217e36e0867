#include "framework/device/cl_error.h"

#include <stdarg.h>
#include <stdio.h>

const char *bb_cl_error(cl_int error)
{
    static _Thread_local char unnamed[48];
    switch (error) {
#define NAME(code)                                                                                 \
    case code:                                                                                     \
        return #code
        NAME(CL_DEVICE_NOT_AVAILABLE);
        NAME(CL_COMPILER_NOT_AVAILABLE);
        NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE);
        NAME(CL_OUT_OF_RESOURCES);
        NAME(CL_OUT_OF_HOST_MEMORY);
        NAME(CL_BUILD_PROGRAM_FAILURE);
        NAME(CL_COMPILE_PROGRAM_FAILURE);
        NAME(CL_LINK_PROGRAM_FAILURE);
        NAME(CL_INVALID_VALUE);
        NAME(CL_INVALID_BINARY);
        NAME(CL_INVALID_BUFFER_SIZE);
        NAME(CL_INVALID_BUILD_OPTIONS);
        NAME(CL_INVALID_COMPILER_OPTIONS);
        NAME(CL_INVALID_KERNEL_NAME);
        NAME(CL_INVALID_KERNEL_ARGS);
        NAME(CL_INVALID_ARG_INDEX);
        NAME(CL_INVALID_ARG_VALUE);
        NAME(CL_INVALID_ARG_SIZE);
        NAME(CL_INVALID_WORK_GROUP_SIZE);
        NAME(CL_INVALID_WORK_ITEM_SIZE);
        NAME(CL_INVALID_GLOBAL_WORK_SIZE);
        NAME(CL_INVALID_MEM_OBJECT);
        NAME(CL_INVALID_OPERATION);
#undef NAME
    default:
        snprintf(unnamed, sizeof unnamed, "OpenCL error %d", (int)error);
        return unnamed;
    }
}

/* Returns what to do about errors that neither the program nor its user has caused. */
static const char *advice(cl_int error)
{
    switch (error) {
    case CL_DEVICE_NOT_AVAILABLE:
        return " (the device is lost: see its driver's log, then run again)";
    case CL_OUT_OF_RESOURCES:
        return " (the kernel needs more registers or memory than the device has, or the driver "
               "has ended it: see its log)";
    default:
        return "";
    }
}

bb_status bb_cl_fail(cl_int error, const char *format, ...)
{
    char what[256];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return bb_fail(BB_FAILED, "%s: %s%s", what, bb_cl_error(error), advice(error));
}
