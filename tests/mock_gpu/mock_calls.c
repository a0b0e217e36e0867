/* What the mock GPU refuses, how it fails, and what is counted. */
#include "mock_gpu.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static const unsigned char poison = 0xa5; /* memory of a GPU is not zero at first */

/* What every call returns once the device has failed; CL_SUCCESS before. */
static cl_int gone = CL_SUCCESS;
static uint32_t launches_to_fail;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static cl_int refuse(cl_int error)
{
    mock_count(MOCK_REFUSED);
    return error;
}

/* ---- buffers ---- */

static cl_int check_buffer(cl_mem_flags flags, size_t bytes)
{
    if (gone != CL_SUCCESS)
        return gone;
    if ((flags & (CL_MEM_USE_HOST_PTR | CL_MEM_ALLOC_HOST_PTR)) != 0)
        return CL_INVALID_HOST_PTR;
    return bytes == 0 || bytes > mock.largest ? CL_INVALID_BUFFER_SIZE : CL_SUCCESS;
}

CL_API_ENTRY cl_mem CL_API_CALL clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes,
                                               void *host, cl_int *error)
{
    if (!mock_context_is_gpu(context))
        return REAL(clCreateBuffer)(context, flags, bytes, host, error);
    mock_count(MOCK_BUFFER);
    cl_int refused = check_buffer(flags, bytes);
    unsigned char *first = refused == CL_SUCCESS && host == NULL ? malloc(bytes) : NULL;
    if (refused != CL_SUCCESS) {
        if (error != NULL)
            *error = refuse(refused);
        return NULL;
    }
    if (first != NULL) {
        memset(first, poison, bytes);
        flags |= CL_MEM_COPY_HOST_PTR;
        host = first;
    }
    cl_mem mem = REAL(clCreateBuffer)(context, flags, bytes, host, error);
    free(first);
    return mem;
}

CL_API_ENTRY void *CL_API_CALL clEnqueueMapBuffer(cl_command_queue queue, cl_mem buffer,
                                                  cl_bool blocking, cl_map_flags flags,
                                                  size_t offset, size_t bytes, cl_uint count,
                                                  const cl_event *list, cl_event *event,
                                                  cl_int *error)
{
    mock_count(MOCK_MAP);
    if (!mock_queue_is_gpu(queue))
        return REAL(clEnqueueMapBuffer)(queue, buffer, blocking, flags, offset, bytes, count, list,
                                        event, error);
    if (error != NULL)
        *error = refuse(CL_INVALID_OPERATION);
    return NULL;
}

/* ---- what moves data, and what waits ---- */

#define COUNTED(call, name, queue, ...)                                                            \
    mock_count(call);                                                                              \
    return gone != CL_SUCCESS && mock_queue_is_gpu(queue) ? refuse(gone)                           \
                                                          : REAL(name)(queue, __VA_ARGS__)

CL_API_ENTRY cl_int CL_API_CALL clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer,
                                                    cl_bool blocking, size_t offset, size_t bytes,
                                                    void *out, cl_uint count, const cl_event *list,
                                                    cl_event *event)
{
    COUNTED(MOCK_READ, clEnqueueReadBuffer, queue, buffer, blocking, offset, bytes, out, count,
            list, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer,
                                                     cl_bool blocking, size_t offset, size_t bytes,
                                                     const void *data, cl_uint count,
                                                     const cl_event *list, cl_event *event)
{
    COUNTED(MOCK_WRITE, clEnqueueWriteBuffer, queue, buffer, blocking, offset, bytes, data, count,
            list, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer,
                                                    const void *pattern, size_t pattern_bytes,
                                                    size_t offset, size_t bytes, cl_uint count,
                                                    const cl_event *list, cl_event *event)
{
    COUNTED(MOCK_FILL, clEnqueueFillBuffer, queue, buffer, pattern, pattern_bytes, offset, bytes,
            count, list, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueCopyBuffer(cl_command_queue queue, cl_mem from, cl_mem to,
                                                    size_t from_offset, size_t to_offset,
                                                    size_t bytes, cl_uint count,
                                                    const cl_event *list, cl_event *event)
{
    COUNTED(MOCK_COPY, clEnqueueCopyBuffer, queue, from, to, from_offset, to_offset, bytes, count,
            list, event);
}

CL_API_ENTRY cl_int CL_API_CALL clFinish(cl_command_queue queue)
{
    mock_count(MOCK_FINISH);
    return gone != CL_SUCCESS && mock_queue_is_gpu(queue) ? refuse(gone) : REAL(clFinish)(queue);
}

/* ---- programs ---- */

static bool is_silent(cl_program program)
{
    if (mock.silent == NULL)
        return false;
    char name[128], *text = mock_program_text(program);
    mock_program_name(text, name, sizeof name);
    free(text);
    return mock_matches(mock.silent, name);
}

CL_API_ENTRY cl_int CL_API_CALL clBuildProgram(cl_program program, cl_uint count,
                                               const cl_device_id *devices, const char *options,
                                               void(CL_CALLBACK *notify)(cl_program, void *),
                                               void *data)
{
    mock_count(MOCK_BUILD);
    if (mock.record != NULL)
        mock_record_program(program, options);
    if (gone != CL_SUCCESS)
        return refuse(gone);
    if (is_silent(program))
        return refuse(CL_BUILD_PROGRAM_FAILURE);
    char *known = strdup(options != NULL ? options : ""), *version = strstr(known, "-cl-std=CL2.0");
    if (version != NULL)
        version[strlen("-cl-std=CL")] = '3'; /* which PoCL compiles, unlike 2.0 */
    cl_int error = REAL(clBuildProgram)(program, count, devices, known, notify, data);
    free(known);
    return error;
}

CL_API_ENTRY cl_int CL_API_CALL clGetProgramBuildInfo(cl_program program, cl_device_id device,
                                                      cl_program_build_info what, size_t room,
                                                      void *out, size_t *size_out)
{
    if (what == CL_PROGRAM_BUILD_LOG && is_silent(program))
        return mock_answer("", 0, room, out, size_out);
    return REAL(clGetProgramBuildInfo)(program, device, what, room, out, size_out);
}

/* ---- launches ---- */

static cl_int check_launch(cl_command_queue queue, cl_kernel kernel, size_t global, size_t local)
{
    cl_device_id device = NULL;
    cl_ulong bytes = 0;
    clGetCommandQueueInfo(queue, CL_QUEUE_DEVICE, sizeof device, &device, NULL);
    clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_LOCAL_MEM_SIZE, sizeof bytes, &bytes, NULL);
    if (local == 0 || global % local != 0 || local > mock_kernel_group(kernel))
        return CL_INVALID_WORK_GROUP_SIZE;
    return bytes > mock.local_bytes ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
}

/* Whether this launch is the one that MOCK_GPU_FAIL names. */
static bool is_chosen(const char *kernel)
{
    if (!mock_matches(mock.fails, kernel))
        return false;
    pthread_mutex_lock(&lock);
    bool chosen = ++launches_to_fail == mock.fail_at;
    pthread_mutex_unlock(&lock);
    return chosen;
}

/* The device is gone from here on. What was launched ends first, as nothing runs on such a device:
 * PoCL's threads would crash where they still compile or run when the program leaves. */
static void lose_device(cl_command_queue queue, cl_int error)
{
    REAL(clFinish)(queue);
    gone = error;
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel,
                                                       cl_uint dimensions, const size_t *offset,
                                                       const size_t *global, const size_t *local,
                                                       cl_uint count, const cl_event *list,
                                                       cl_event *event)
{
    char name[128];
    mock_kernel_name(kernel, name, sizeof name);
    mock_count_launch(name);
    bool late = false;
    if (mock_queue_is_gpu(queue)) {
        cl_int error = gone != CL_SUCCESS ? gone : check_launch(queue, kernel, *global, *local);
        if (error != CL_SUCCESS)
            return refuse(error);
        bool chosen = is_chosen(name);
        if (chosen && strcmp(mock.manner, "resources") == 0)
            return refuse(CL_OUT_OF_RESOURCES);
        late = chosen && strcmp(mock.manner, "late") == 0;
        if (chosen && !late) {
            lose_device(queue, CL_DEVICE_NOT_AVAILABLE);
            return refuse(gone);
        }
    }
    cl_int error = REAL(clEnqueueNDRangeKernel)(queue, kernel, dimensions, offset, global, local,
                                                count, list, event);
    if (late)
        lose_device(queue, CL_OUT_OF_RESOURCES);
    return error;
}
