/* The OpenCL device: finding and opening it, its queue, its buffers. Programs are in program.c. */
#include "framework/device/device.h"

#include "framework/base/threads.h"
#include "framework/device/cl_error.h"
#include "framework/device/handover.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/stat.h>

enum { DEVICES_MAX = 64 };

typedef struct found_device {
    cl_platform_id platform;
    cl_device_id id;
} found_device;

static bb_status find_devices(found_device *found, uint32_t *count)
{
    cl_platform_id platforms[16];
    cl_uint platform_count = 0;
    *count = 0;
    cl_int error = clGetPlatformIDs(16, platforms, &platform_count);
    if (error != CL_SUCCESS)
        return BB_OK; /* the ICD loader reports "no platform" as an error: there is no device */
    for (cl_uint p = 0; p < platform_count && p < 16; p++) {
        cl_device_id ids[DEVICES_MAX];
        cl_uint ids_count = 0;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, DEVICES_MAX, ids, &ids_count) !=
            CL_SUCCESS)
            continue;
        for (cl_uint i = 0; i < ids_count && *count < DEVICES_MAX; i++)
            found[(*count)++] = (found_device){platforms[p], ids[i]};
    }
    return BB_OK;
}

static void describe(const found_device *found, char *text, size_t capacity)
{
    char platform[128] = "", name[128] = "", version[128] = "";
    cl_uint units = 0;
    clGetPlatformInfo(found->platform, CL_PLATFORM_NAME, sizeof platform, platform, NULL);
    clGetDeviceInfo(found->id, CL_DEVICE_NAME, sizeof name, name, NULL);
    clGetDeviceInfo(found->id, CL_DEVICE_VERSION, sizeof version, version, NULL);
    clGetDeviceInfo(found->id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    snprintf(text, capacity, "%s / %s / %s / %u compute units", platform, name, version, units);
}

bb_status bb_device_count(uint32_t *count)
{
    found_device found[DEVICES_MAX];
    return find_devices(found, count);
}

bb_status bb_device_describe(uint32_t index, char *text, size_t capacity)
{
    found_device found[DEVICES_MAX];
    uint32_t count;
    BB_TRY(find_devices(found, &count));
    if (index >= count)
        return bb_fail(BB_INVALID, "there is no device %u: `bvhbench list devices` shows them",
                       index);
    describe(&found[index], text, capacity);
    return BB_OK;
}

static bb_status select_device(const char *selector, found_device *selected)
{
    found_device found[DEVICES_MAX];
    uint32_t count;
    BB_TRY(find_devices(found, &count));
    if (count == 0)
        return bb_fail(BB_INVALID,
                       "no OpenCL device: install a driver (Debian: pocl-opencl-icd for "
                       "the CPU, or the vendor's ICD) and check with `clinfo -l`");
    if (selector == NULL) {
        *selected = found[0];
        return BB_OK;
    }
    char *end;
    unsigned long index = strtoul(selector, &end, 10);
    if (selector[0] >= '0' && selector[0] <= '9' && *end == '\0' && index < count) {
        *selected = found[index];
        return BB_OK;
    }
    for (uint32_t i = 0; i < count; i++) {
        char text[512];
        describe(&found[i], text, sizeof text);
        if (strcasestr(text, selector) != NULL) {
            *selected = found[i];
            return BB_OK;
        }
    }
    return bb_fail(BB_INVALID,
                   "no OpenCL device matches '%s' among the %u there are: `bvhbench list "
                   "devices` shows them",
                   selector, count);
}

static void query_device(bb_device *device)
{
    cl_device_type type = 0;
    cl_uint units = 1;
    cl_ulong global = 0, largest = 0, local = 0;
    clGetDeviceInfo(device->id, CL_DEVICE_NAME, sizeof device->name, device->name, NULL);
    clGetDeviceInfo(device->id, CL_DRIVER_VERSION, sizeof device->driver, device->driver, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_VERSION, sizeof device->version, device->version, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof global, &global, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof largest, &largest, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_LOCAL_MEM_SIZE, sizeof local, &local, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof device->max_group_size,
                    &device->max_group_size, NULL);
    clGetDeviceInfo(device->id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof device->float_config,
                    &device->float_config, NULL);
    device->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    device->compute_units = units;
    device->global_bytes = global;
    device->largest_allocation = largest;
    device->local_bytes = local;
}

bb_status bb_device_open(const char *selector, bb_form form, const char *kernel_folder,
                         bb_device **out)
{
    struct stat info;
    if (kernel_folder != NULL && (stat(kernel_folder, &info) != 0 || !S_ISDIR(info.st_mode)))
        return bb_fail(BB_INVALID, "%s is no folder to read device code from", kernel_folder);
    found_device selected = {0};
    BB_TRY(select_device(selector, &selected));
    bb_device *device = calloc(1, sizeof *device);
    if (device == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    device->platform = selected.platform;
    device->id = selected.id;
    query_device(device);
    device->form = form != BB_FORM_AUTO ? form : device->is_cpu ? BB_FORM_CPU : BB_FORM_GPU;
    device->kernel_folder = kernel_folder;
    strcpy(device->sources, "embedded");

    cl_int error;
    device->context = clCreateContext(NULL, 1, &device->id, NULL, NULL, &error);
    if (error == CL_SUCCESS)
        device->queue =
            clCreateCommandQueue(device->context, device->id, CL_QUEUE_PROFILING_ENABLE, &error);
    if (error != CL_SUCCESS) {
        bb_status status = bb_fail(BB_FAILED, "cannot open the OpenCL device %s: %s", device->name,
                                   bb_cl_error(error));
        bb_device_close(device);
        return status;
    }
    bb_status status = bb_choose_handover(device);
    if (status != BB_OK) {
        bb_device_close(device);
        return status;
    }
    *out = device;
    return BB_OK;
}

void bb_device_close(bb_device *device)
{
    if (device == NULL)
        return;
    bb_device_clear_events(device);
    bb_programs_clear(device);
    free(device->events);
    if (device->queue != NULL) {
        /* A driver's thread that still compiles or runs when the process ends can crash there. */
        clFinish(device->queue);
        clReleaseCommandQueue(device->queue);
    }
    if (device->context != NULL)
        clReleaseContext(device->context);
    free(device);
}

uint32_t bb_host_threads(const bb_device *device)
{
    uint32_t cores = bb_core_count();
    return device->is_cpu && device->compute_units < cores ? device->compute_units : cores;
}

bool bb_device_divides_exactly(const bb_device *device)
{
    return (device->float_config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
}

bb_status bb_finish(bb_device *device)
{
    BB_CL_TRY(clFinish(device->queue), "waiting for %s", device->name);
    return BB_OK;
}

/* ---- buffers ---- */

/* Large buffers of devices that share memory with the host are put on huge pages: traversal jumps through them, and a
 * build touches them whole. */
static const size_t huge_page = (size_t)2 << 20;

static void CL_CALLBACK free_host_pages(cl_mem mem, void *pages)
{
    (void)mem;
    free(pages);
}

static cl_mem create_buffer(bb_device *device, size_t bytes, cl_int *error)
{
    if (!device->is_cpu || bytes < 2 * huge_page)
        return clCreateBuffer(device->context, CL_MEM_READ_WRITE, bytes, NULL, error);
    size_t whole = (bytes + huge_page - 1) / huge_page * huge_page;
    void *pages = aligned_alloc(huge_page, whole);
    if (pages == NULL) {
        *error = CL_MEM_OBJECT_ALLOCATION_FAILURE;
        return NULL;
    }
    madvise(pages, whole, MADV_HUGEPAGE); /* a hint: its failure changes nothing but speed */
    cl_mem mem = clCreateBuffer(device->context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes,
                                pages, error);
    if (*error != CL_SUCCESS)
        free(pages);
    else
        clSetMemObjectDestructorCallback(mem, free_host_pages, pages);
    return mem;
}

bb_status bb_buffer_reserve(bb_device *device, bb_account *account, size_t bytes, const char *what,
                            bb_buffer *buffer)
{
    if (buffer->mem != NULL && buffer->bytes >= bytes && buffer->device == device)
        return BB_OK;
    bb_buffer_release(buffer);
    if (bytes == 0)
        bytes = 4;
    if (bytes > device->largest_allocation)
        return bb_fail(BB_REFUSED,
                       "%s needs a buffer of %zu bytes, the largest that %s allows is %llu", what,
                       bytes, device->name, (unsigned long long)device->largest_allocation);
    if (bytes > device->global_bytes - device->bytes)
        return bb_fail(BB_REFUSED, "%s needs %zu bytes, %llu of the %llu of %s are in use", what,
                       bytes, (unsigned long long)device->bytes,
                       (unsigned long long)device->global_bytes, device->name);
    cl_int error;
    cl_mem mem = create_buffer(device, bytes, &error);
    if (error != CL_SUCCESS)
        return bb_fail(BB_REFUSED, "%s needs %zu bytes, which %s refused: %s", what, bytes,
                       device->name, bb_cl_error(error));
    *buffer = (bb_buffer){mem, bytes, device, account};
    device->bytes += bytes;
    bb_account_add(account, bytes);
    return BB_OK;
}

void bb_buffer_release(bb_buffer *buffer)
{
    if (buffer->mem != NULL) {
        clReleaseMemObject(buffer->mem);
        buffer->device->bytes -= buffer->bytes;
        bb_account_subtract(buffer->account, buffer->bytes);
    }
    *buffer = (bb_buffer){0};
}

bb_status bb_buffer_write(bb_buffer *buffer, size_t offset, size_t bytes, const void *source)
{
    if (bytes > 0)
        BB_CL_TRY(clEnqueueWriteBuffer(buffer->device->queue, buffer->mem, CL_TRUE, offset, bytes,
                                       source, 0, NULL, NULL),
                  "writing %zu bytes to the device", bytes);
    return BB_OK;
}

bb_status bb_buffer_read(const bb_buffer *buffer, size_t offset, size_t bytes, void *target)
{
    if (bytes > 0)
        BB_CL_TRY(clEnqueueReadBuffer(buffer->device->queue, buffer->mem, CL_TRUE, offset, bytes,
                                      target, 0, NULL, NULL),
                  "reading %zu bytes from the device", bytes);
    return BB_OK;
}

bb_status bb_buffer_fill(bb_buffer *buffer, size_t bytes, uint32_t pattern)
{
    if (bytes > 0)
        BB_CL_TRY(clEnqueueFillBuffer(buffer->device->queue, buffer->mem, &pattern, sizeof pattern,
                                      0, bytes, 0, NULL, NULL),
                  "filling %zu bytes on the device", bytes);
    return BB_OK;
}

bb_status bb_buffer_map(const bb_buffer *buffer, bool write, void **pointer)
{
    cl_int error;
    *pointer = clEnqueueMapBuffer(buffer->device->queue, buffer->mem, CL_TRUE,
                                  write ? CL_MAP_READ | CL_MAP_WRITE : CL_MAP_READ, 0,
                                  buffer->bytes, 0, NULL, NULL, &error);
    BB_CL_TRY(error, "mapping %zu bytes of the device", buffer->bytes);
    return BB_OK;
}

bb_status bb_buffer_unmap(const bb_buffer *buffer, void *pointer)
{
    BB_CL_TRY(clEnqueueUnmapMemObject(buffer->device->queue, buffer->mem, pointer, 0, NULL, NULL),
              "unmapping %zu bytes of the device", buffer->bytes);
    return bb_finish(buffer->device);
}
