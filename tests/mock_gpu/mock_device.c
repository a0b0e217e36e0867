/* What the mock GPU says of itself. */
#include "mock_gpu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

mock_settings mock;

static cl_device_id devices[8];
static uint32_t device_count;

/* ---- settings ---- */

__attribute__((noreturn)) static void reject(const char *variable)
{
    fprintf(stderr, "mock GPU: %s=%s is not what tests/mock_gpu/README.md describes\n", variable,
            getenv(variable));
    abort();
}

static uint64_t number_of(const char *variable, uint64_t usual)
{
    const char *text = getenv(variable);
    if (text == NULL)
        return usual;
    char *end;
    uint64_t value = strtoull(text, &end, 10);
    if (*text == '\0' || *end != '\0')
        reject(variable);
    return value;
}

/* PoCL makes as many processors of itself as POCL_DEVICES names. */
static void read_types(void)
{
    static const struct {
        const char *name;
        cl_device_type type;
    } types[] = {{"cpu", CL_DEVICE_TYPE_CPU},
                 {"gpu", CL_DEVICE_TYPE_GPU},
                 {"accelerator", CL_DEVICE_TYPE_ACCELERATOR}};
    const char *at = getenv("MOCK_GPU_DEVICES");
    char wanted[80] = "";
    for (at = at != NULL ? at : "gpu"; *at != '\0';) {
        size_t length = strcspn(at, ","), t = 0;
        while (t < 3 && (strlen(types[t].name) != length || strncmp(types[t].name, at, length)))
            t++;
        if (t == 3 || mock.type_count == sizeof mock.types / sizeof mock.types[0])
            reject("MOCK_GPU_DEVICES");
        mock.types[mock.type_count++] = types[t].type;
        strcat(wanted, "pthread ");
        at += length + (at[length] == ',');
    }
    if (mock.type_count > 1)
        setenv("POCL_DEVICES", wanted, 1);
}

/* NAME of NAME:N, and what follows the colon. */
static const char *split(const char *variable, const char **rest)
{
    const char *text = getenv(variable);
    if (text == NULL)
        return NULL;
    char *name = strdup(text), *colon = strchr(name, ':');
    if (colon == NULL)
        reject(variable);
    *colon = '\0';
    *rest = colon + 1;
    return name;
}

__attribute__((constructor)) static void read_settings(void)
{
    read_types();
    mock.group = number_of("MOCK_GPU_GROUP", 256);
    mock.local_bytes = number_of("MOCK_GPU_LOCAL", 48) << 10;
    mock.largest = number_of("MOCK_GPU_LARGEST", 256) << 20;
    mock.memory = number_of("MOCK_GPU_MEMORY", 1024) << 20;
    mock.units = (cl_uint)number_of("MOCK_GPU_UNITS", 80);
    const char *fence = getenv("MOCK_GPU_FENCE");
    mock.fence = fence != NULL ? fence : "none";
    static const char *const styles[] = {"none", "old", "cl2", "list2", "cl3"};
    size_t style = 0;
    while (style < 5 && strcmp(styles[style], mock.fence) != 0)
        style++;
    if (style == 5)
        reject("MOCK_GPU_FENCE");
    const char *rest = NULL;
    mock.kernel = split("MOCK_GPU_KERNEL_GROUP", &rest);
    if (mock.kernel != NULL)
        mock.kernel_group = strtoull(rest, NULL, 10);
    mock.fails = split("MOCK_GPU_FAIL", &rest);
    if (mock.fails != NULL) {
        char *end;
        mock.fail_at = (uint32_t)strtoul(rest, &end, 10);
        mock.manner = end + 1;
        if (*end != ':' || (strcmp(end, ":resources") != 0 && strcmp(end, ":late") != 0 &&
                            strcmp(end, ":lost") != 0))
            reject("MOCK_GPU_FAIL");
    }
    mock.silent = getenv("MOCK_GPU_SILENT_BUILD");
    mock.record = getenv("MOCK_GPU_RECORD");
    mock.counts = getenv("MOCK_GPU_COUNTS");
}

/* ---- platforms and devices ---- */

CL_API_ENTRY cl_int CL_API_CALL clGetPlatformIDs(cl_uint room, cl_platform_id *out, cl_uint *count)
{
    cl_platform_id all[16];
    cl_uint all_count = 0, kept = 0;
    cl_int error = REAL(clGetPlatformIDs)(16, all, &all_count);
    if (error != CL_SUCCESS)
        return error;
    for (cl_uint i = 0; i < all_count && i < 16; i++) {
        char name[128] = "";
        clGetPlatformInfo(all[i], CL_PLATFORM_NAME, sizeof name, name, NULL);
        if (strcmp(name, "Portable Computing Language") != 0)
            continue;
        if (out != NULL && kept < room)
            out[kept] = all[i];
        kept++;
    }
    if (count != NULL)
        *count = kept;
    return CL_SUCCESS;
}

CL_API_ENTRY cl_int CL_API_CALL clGetDeviceIDs(cl_platform_id platform, cl_device_type type,
                                               cl_uint room, cl_device_id *out, cl_uint *count)
{
    cl_int error =
        REAL(clGetDeviceIDs)(platform, CL_DEVICE_TYPE_ALL, mock.type_count, devices, &device_count);
    if (error != CL_SUCCESS)
        return error;
    if (device_count < mock.type_count) {
        fprintf(stderr, "mock GPU: PoCL has %u devices, not the %u of MOCK_GPU_DEVICES\n",
                device_count, mock.type_count);
        abort();
    }
    device_count = mock.type_count;
    cl_uint kept = 0;
    for (uint32_t i = 0; i < device_count; i++) {
        if ((mock.types[i] & type) == 0)
            continue;
        if (out != NULL && kept < room)
            out[kept] = devices[i];
        kept++;
    }
    if (count != NULL)
        *count = kept;
    return kept > 0 ? CL_SUCCESS : CL_DEVICE_NOT_FOUND;
}

static cl_device_type type_of(cl_device_id device)
{
    for (uint32_t i = 0; i < device_count; i++)
        if (devices[i] == device)
            return mock.types[i];
    return CL_DEVICE_TYPE_CPU;
}

bool mock_is_gpu(cl_device_id device)
{
    return type_of(device) != CL_DEVICE_TYPE_CPU;
}

bool mock_queue_is_gpu(cl_command_queue queue)
{
    cl_device_id device = NULL;
    clGetCommandQueueInfo(queue, CL_QUEUE_DEVICE, sizeof device, &device, NULL);
    return mock_is_gpu(device);
}

bool mock_context_is_gpu(cl_context context)
{
    cl_device_id device = NULL;
    clGetContextInfo(context, CL_CONTEXT_DEVICES, sizeof device, &device, NULL);
    return mock_is_gpu(device);
}

cl_int mock_answer(const void *value, size_t size, size_t room, void *out, size_t *size_out)
{
    if (out != NULL && room < size)
        return CL_INVALID_VALUE;
    if (out != NULL)
        memcpy(out, value, size);
    if (size_out != NULL)
        *size_out = size;
    return CL_SUCCESS;
}

/* ---- versions, in each style that drivers have ---- */

static bool fence_is(const char *style)
{
    return strcmp(mock.fence, style) == 0;
}

static const char *version(void)
{
    return fence_is("old")   ? "OpenCL 1.2 mock"
           : fence_is("cl2") ? "OpenCL 2.0 mock"
                             : "OpenCL 3.0 mock";
}

/* Drivers of OpenCL 3.0 name here the newest C that is not 3.0. */
static const char *c_version(void)
{
    return fence_is("cl2") || fence_is("list2") ? "OpenCL C 2.0 mock" : "OpenCL C 1.2 mock";
}

static cl_int answer_versions(size_t room, void *out, size_t *size_out)
{
    cl_name_version list[5] = {{CL_MAKE_VERSION(1, 0, 0), "OpenCL C"},
                               {CL_MAKE_VERSION(1, 1, 0), "OpenCL C"},
                               {CL_MAKE_VERSION(1, 2, 0), "OpenCL C"},
                               {CL_MAKE_VERSION(3, 0, 0), "OpenCL C"},
                               {CL_MAKE_VERSION(2, 0, 0), "OpenCL C"}};
    return mock_answer(list, (fence_is("list2") ? 5 : 4) * sizeof list[0], room, out, size_out);
}

static cl_int answer_features(size_t room, void *out, size_t *size_out)
{
    cl_name_version list[3] = {{CL_MAKE_VERSION(3, 0, 0), "__opencl_c_int64"},
                               {CL_MAKE_VERSION(3, 0, 0), "__opencl_c_atomic_order_acq_rel"},
                               {CL_MAKE_VERSION(3, 0, 0), "__opencl_c_atomic_scope_device"}};
    return mock_answer(list, (fence_is("cl3") ? 3 : 1) * sizeof list[0], room, out, size_out);
}

/* ---- the device's answers ---- */

CL_API_ENTRY cl_int CL_API_CALL clGetDeviceInfo(cl_device_id device, cl_device_info what,
                                                size_t room, void *out, size_t *size_out)
{
    if (!mock_is_gpu(device))
        return REAL(clGetDeviceInfo)(device, what, room, out, size_out);
    cl_device_type type = type_of(device);
    const char *name = type == CL_DEVICE_TYPE_GPU ? "Mock GPU" : "Mock accelerator";
    size_t sizes[3] = {mock.group, mock.group, mock.group};
    cl_bool no = CL_FALSE;
#define ANSWER(value) mock_answer(&(value), sizeof(value), room, out, size_out)
#define ANSWER_TEXT(text) mock_answer(text, strlen(text) + 1, room, out, size_out)
    switch (what) {
    case CL_DEVICE_TYPE:
        return ANSWER(type);
    case CL_DEVICE_NAME:
        return ANSWER_TEXT(name);
    case CL_DEVICE_VERSION:
        return ANSWER_TEXT(version());
    case CL_DEVICE_OPENCL_C_VERSION:
        return ANSWER_TEXT(c_version());
    case CL_DEVICE_OPENCL_C_ALL_VERSIONS:
        return fence_is("old") || fence_is("cl2") ? CL_INVALID_VALUE
                                                  : answer_versions(room, out, size_out);
    case CL_DEVICE_OPENCL_C_FEATURES:
        return fence_is("old") || fence_is("cl2") ? CL_INVALID_VALUE
                                                  : answer_features(room, out, size_out);
    case CL_DEVICE_MAX_COMPUTE_UNITS:
        return ANSWER(mock.units);
    case CL_DEVICE_MAX_WORK_GROUP_SIZE:
        return ANSWER(mock.group);
    case CL_DEVICE_MAX_WORK_ITEM_SIZES:
        return ANSWER(sizes);
    case CL_DEVICE_LOCAL_MEM_SIZE:
        return ANSWER(mock.local_bytes);
    case CL_DEVICE_GLOBAL_MEM_SIZE:
        return ANSWER(mock.memory);
    case CL_DEVICE_MAX_MEM_ALLOC_SIZE:
        return ANSWER(mock.largest);
    case CL_DEVICE_HOST_UNIFIED_MEMORY:
        return ANSWER(no);
    default:
        return REAL(clGetDeviceInfo)(device, what, room, out, size_out);
    }
}

/* ---- kernels ---- */

void mock_kernel_name(cl_kernel kernel, char *name, size_t capacity)
{
    if (clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, capacity, name, NULL) != CL_SUCCESS)
        snprintf(name, capacity, "?");
}

bool mock_matches(const char *pattern, const char *name)
{
    return pattern != NULL && (strcmp(pattern, "*") == 0 || strcmp(pattern, name) == 0);
}

/* "*" leaves out kernels that are compiled for one size of groups. */
size_t mock_kernel_group(cl_kernel kernel)
{
    char name[128];
    size_t compiled[3] = {0};
    mock_kernel_name(kernel, name, sizeof name);
    if (mock.kernel != NULL && strcmp(mock.kernel, "*") == 0)
        REAL(clGetKernelWorkGroupInfo)
    (kernel, NULL, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof compiled, compiled, NULL);
    return mock_matches(mock.kernel, name) && compiled[0] == 0 && mock.kernel_group < mock.group
               ? mock.kernel_group
               : mock.group;
}

CL_API_ENTRY cl_int CL_API_CALL clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device,
                                                         cl_kernel_work_group_info what,
                                                         size_t room, void *out, size_t *size_out)
{
    if (what != CL_KERNEL_WORK_GROUP_SIZE || !mock_is_gpu(device))
        return REAL(clGetKernelWorkGroupInfo)(kernel, device, what, room, out, size_out);
    size_t group = mock_kernel_group(kernel);
    return ANSWER(group);
}
