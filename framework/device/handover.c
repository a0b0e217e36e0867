/* A fence is used where the device documents one (OpenCL C 3.0 with the features for it, or 2.x,
 * where they are required) and passes the litmus test (kernels/litmus.cl); else launches by levels.
 */
#define CL_TARGET_OPENCL_VERSION 300
#include "framework/device/handover.h"
#include "framework/device/device_private.h"

#include <stdio.h>
#include <string.h>

enum { SLOTS = 1 << 16, ROUNDS = 4, GROUP_SIZE = 64, NAMES_MAX = 64 };

static bool has_name(const cl_name_version *names, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(names[i].name, name) == 0)
            return true;
    return false;
}

/* The OpenCL C version to compile for: "" if none has such a fence. */
static void find_fence(const bb_device *device, char *fence, size_t capacity)
{
    cl_name_version versions[NAMES_MAX], features[NAMES_MAX];
    size_t bytes = 0, version_count, feature_count;
    fence[0] = '\0';
    if (clGetDeviceInfo(device->id, CL_DEVICE_OPENCL_C_ALL_VERSIONS, sizeof versions, versions,
                        &bytes) != CL_SUCCESS) {
        /* before OpenCL 3.0 there was one version, and no list of features */
        char version[128] = "";
        clGetDeviceInfo(device->id, CL_DEVICE_OPENCL_C_VERSION, sizeof version, version, NULL);
        if (strncmp(version, "OpenCL C 2.", 11) == 0)
            snprintf(fence, capacity, "-cl-std=CL2.0");
        return;
    }
    version_count = bytes / sizeof versions[0];
    if (clGetDeviceInfo(device->id, CL_DEVICE_OPENCL_C_FEATURES, sizeof features, features,
                        &bytes) != CL_SUCCESS)
        return;
    feature_count = bytes / sizeof features[0];
    for (size_t i = 0; i < version_count; i++)
        if (CL_VERSION_MAJOR(versions[i].version) >= 3 &&
            has_name(features, feature_count, "__opencl_c_atomic_order_acq_rel") &&
            has_name(features, feature_count, "__opencl_c_atomic_scope_device"))
            snprintf(fence, capacity, "-cl-std=CL3.0");
}

static bb_status run_litmus(bb_device *device)
{
    bb_buffer messages = {0}, gates = {0}, stale = {0};
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    char defines[96];
    bb_handover_defines(device, defines, sizeof defines);
    bb_status status = bb_program_build(device, bb_source_find("litmus.cl"), defines, &program);
    if (status == BB_OK)
        status = bb_kernel_get(program, "litmus", &kernel);
    if (status == BB_OK)
        status = bb_buffer_reserve(device, NULL, 2 * SLOTS * 8 * sizeof(cl_uint),
                                   "litmus test: messages", &messages);
    if (status == BB_OK)
        status =
            bb_buffer_reserve(device, NULL, SLOTS * sizeof(cl_uint), "litmus test: gates", &gates);
    if (status == BB_OK)
        status = bb_buffer_reserve(device, NULL, sizeof(cl_uint), "litmus test: count", &stale);
    if (status == BB_OK)
        status = bb_buffer_fill(&messages, 2 * SLOTS * 8 * sizeof(cl_uint), 0);
    if (status == BB_OK)
        status = bb_buffer_fill(&gates, SLOTS * sizeof(cl_uint), 0);
    if (status == BB_OK)
        status = bb_buffer_fill(&stale, sizeof(cl_uint), 0);
    cl_uint slots = SLOTS;
    for (cl_uint stamp = 1; stamp <= ROUNDS && status == BB_OK; stamp++)
        status = bb_launch(device, kernel, 2 * SLOTS, GROUP_SIZE, BB_VALUE(slots), BB_VALUE(stamp),
                           BB_MEM(messages), BB_MEM(gates), BB_MEM(stale));
    if (status == BB_OK)
        status = bb_buffer_read(&stale, 0, sizeof device->litmus_stale, &device->litmus_stale);
    device->litmus_pairs = SLOTS * ROUNDS;
    bb_kernel_release(kernel);
    bb_program_release(program);
    bb_buffer_release(&messages);
    bb_buffer_release(&gates);
    bb_buffer_release(&stale);
    return status;
}

bb_status bb_choose_handover(bb_device *device)
{
    find_fence(device, device->fence, sizeof device->fence);
    device->handover = device->fence[0] != '\0' ? BB_HANDOVER_FENCE : BB_HANDOVER_LEVELS;
    if (device->handover == BB_HANDOVER_LEVELS)
        return BB_OK;
    BB_TRY(run_litmus(device));
    if (device->litmus_stale > 0)
        device->handover = BB_HANDOVER_LEVELS;
    return BB_OK;
}

bb_status bb_device_set_handover(bb_device *device, bb_handover handover)
{
    if (handover == BB_HANDOVER_FENCE && device->fence[0] == '\0')
        return bb_fail(BB_INVALID,
                       "%s has no fence between work-groups (OpenCL C 2.0 or 3.0): use "
                       "--handover levels",
                       device->name);
    if (handover == BB_HANDOVER_FENCE && device->litmus_stale > 0)
        return bb_fail(BB_INVALID,
                       "the fence of %s is unreliable: %u words of %u messages between "
                       "work-groups came late: use --handover levels",
                       device->name, device->litmus_stale, device->litmus_pairs);
    if (handover != BB_HANDOVER_AUTO)
        device->handover = handover;
    return BB_OK;
}

void bb_handover_defines(const bb_device *device, char *text, size_t capacity)
{
    bool fence = device->handover == BB_HANDOVER_FENCE;
    snprintf(text, capacity, "-DBB_HANDOVER=%d %s", fence, fence ? device->fence : "");
}
