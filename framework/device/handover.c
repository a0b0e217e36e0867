/* A fence is used if the device documents one (OpenCL C 3.0 with its features, or 2.x, where they
 * are required) and passes the litmus test (kernels/litmus.cl); otherwise launches by levels.
 */
#define CL_TARGET_OPENCL_VERSION 300
#include "framework/device/handover.h"
#include "framework/device/device_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLOTS = 1 << 16, ROUNDS = 4, GROUP_SIZE = 64, NAMES_MAX = 4096 };

_Static_assert(sizeof(bb_named_version) == sizeof(cl_name_version), "as OpenCL has it");

static bool has_name(const bb_driver_names *list, const char *name)
{
    for (size_t i = 0; i < list->count; i++)
        if (strncmp(list->names[i].name, name, sizeof list->names[i].name) == 0)
            return true;
    return false;
}

static bool has_version(const bb_driver_names *list, cl_uint major)
{
    for (size_t i = 0; i < list->count; i++)
        if (CL_VERSION_MAJOR(list->names[i].version) == major)
            return true;
    return false;
}

const char *bb_fence_option(const bb_driver_names *versions, const bb_driver_names *features,
                            const char *version)
{
    if (has_version(versions, 3) && has_name(features, "__opencl_c_atomic_order_acq_rel") &&
        has_name(features, "__opencl_c_atomic_scope_device"))
        return "-cl-std=CL3.0";
    /* before OpenCL 3.0 there was one version, and no list */
    if (has_version(versions, 2) || strncmp(version, "OpenCL C 2.", 11) == 0)
        return "-cl-std=CL2.0";
    return "";
}

/* Leaves the list empty if the device has none, or an impossible one. */
static bb_status read_names(const bb_device *device, cl_device_info what, bb_driver_names *list)
{
    const size_t one = sizeof(bb_named_version);
    size_t bytes = 0;
    *list = (bb_driver_names){0};
    if (clGetDeviceInfo(device->id, what, 0, NULL, &bytes) != CL_SUCCESS || bytes == 0 ||
        bytes % one != 0 || bytes > NAMES_MAX * one)
        return BB_OK;
    list->names = calloc(1, bytes);
    if (list->names == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    if (clGetDeviceInfo(device->id, what, bytes, list->names, NULL) == CL_SUCCESS)
        list->count = bytes / one;
    return BB_OK;
}

static bb_status find_fence(bb_device *device)
{
    bb_driver_names versions, features = {0};
    char version[128] = "";
    bb_status status = read_names(device, CL_DEVICE_OPENCL_C_ALL_VERSIONS, &versions);
    if (status == BB_OK)
        status = read_names(device, CL_DEVICE_OPENCL_C_FEATURES, &features);
    if (clGetDeviceInfo(device->id, CL_DEVICE_OPENCL_C_VERSION, sizeof version, version, NULL) !=
        CL_SUCCESS)
        version[0] = '\0';
    snprintf(device->fence, sizeof device->fence, "%s",
             status == BB_OK ? bb_fence_option(&versions, &features, version) : "");
    free(versions.names);
    free(features.names);
    return status;
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
    BB_TRY(find_fence(device));
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

const char *bb_handover_word(const bb_device *device)
{
    return device->handover == BB_HANDOVER_FENCE ? "fence" : "levels";
}

/* On a device that is only a CPU, lists are handled without barriers in both forms. oclgrind is a
 * device of all types: there the form for GPUs has barriers, which are checked. */
static bool lists_are_serial(const bb_device *device)
{
    cl_device_type type = 0;
    return bb_cpu_form(device) ||
           (clGetDeviceInfo(device->id, CL_DEVICE_TYPE, sizeof type, &type, NULL) == CL_SUCCESS &&
            (type & (CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_GPU)) == CL_DEVICE_TYPE_CPU);
}

void bb_handover_defines(const bb_device *device, char *text, size_t capacity)
{
    bool fence = device->handover == BB_HANDOVER_FENCE;
    const char *serial = lists_are_serial(device) ? "-DBB_LISTS_SERIAL=1" : "";
    snprintf(text, capacity, "-DBB_HANDOVER=%d %s", fence, fence ? device->fence : serial);
}
