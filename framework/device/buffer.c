/* Buffers of a device, booked on accounts; and its queue. */
#include "framework/base/limits.h"
#include "framework/device/cl_error.h"
#include "framework/device/device_private.h"
#include "framework/device/tally.h"

#include <stdlib.h>
#include <sys/mman.h>

bb_status bb_finish(bb_device *device)
{
    device->waits++;
    BB_CL_TRY(clFinish(device->queue), "waiting for %s", device->name);
    return BB_OK;
}

/* Large buffers of devices that share memory with the host are put on huge pages: traversal jumps
 * through them, and a build touches all of them. */
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
    madvise(pages, whole, MADV_HUGEPAGE); /* a hint: if it fails, only speed suffers */
    cl_mem mem = clCreateBuffer(device->context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes,
                                pages, error);
    if (*error == CL_SUCCESS) {
        *error = clSetMemObjectDestructorCallback(mem, free_host_pages, pages);
        if (*error == CL_SUCCESS)
            return mem;
        clReleaseMemObject(mem);
    }
    free(pages);
    return NULL;
}

/* What bounds the device's memory: its own size, or what this process may use. */
static const char *bounded_by(const bb_device *device)
{
    const bool own = !device->is_cpu || device->global_bytes < bb_memory_limit();
    return own ? device->name : bb_memory_limit_by();
}

bb_status bb_device_has_room(const bb_device *device, uint64_t bytes, const char *what)
{
    if (device->bytes + bytes <= device->global_bytes)
        return device->is_cpu ? bb_host_has_room(bytes, what) : BB_OK;
    return bb_fail(BB_REFUSED,
                   "%s needs %llu bytes, %llu of the %llu of %s are in use: take a smaller scene "
                   "or another device",
                   what, (unsigned long long)bytes, (unsigned long long)device->bytes,
                   (unsigned long long)device->global_bytes, bounded_by(device));
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
    BB_TRY(bb_device_has_room(device, bytes, what));
    cl_int error;
    cl_mem mem = create_buffer(device, bytes, &error);
    if (error != CL_SUCCESS)
        return bb_fail(BB_REFUSED, "%s needs %zu bytes, which %s refused: %s", what, bytes,
                       device->name, bb_cl_error(error));
    *buffer = (bb_buffer){mem, bytes, device, account};
    device->bytes += bytes;
    if (device->is_cpu)
        bb_host_book(bytes);
    bb_account_add(account, bytes);
    return BB_OK;
}

void bb_buffer_release(bb_buffer *buffer)
{
    if (buffer->mem != NULL) {
        clReleaseMemObject(buffer->mem);
        buffer->device->bytes -= buffer->bytes;
        if (buffer->device->is_cpu)
            bb_host_unbook(buffer->bytes);
        bb_account_subtract(buffer->account, buffer->bytes);
    }
    *buffer = (bb_buffer){0};
}

/* Tallies what is moved of the buffer. */
static bb_status tally(const bb_buffer *buffer, size_t bytes)
{
    return bb_device_tallies(buffer->device) ? bb_tally_part(buffer->device, buffer->mem, bytes)
                                             : BB_OK;
}

bb_status bb_buffer_write(bb_buffer *buffer, size_t offset, size_t bytes, const void *source)
{
    if (bytes == 0)
        return BB_OK;
    buffer->device->waits++;
    BB_CL_TRY(clEnqueueWriteBuffer(buffer->device->queue, buffer->mem, CL_TRUE, offset, bytes,
                                   source, 0, NULL, NULL),
              "writing %zu bytes to the device", bytes);
    return tally(buffer, bytes);
}

bb_status bb_buffer_send(bb_buffer *buffer, size_t bytes, const void *source)
{
    bb_device *device = buffer->device;
    device->launches++;
    BB_CL_TRY(
        clEnqueueWriteBuffer(device->queue, buffer->mem, CL_FALSE, 0, bytes, source, 0, NULL, NULL),
        "sending %zu bytes to the device", bytes);
    return tally(buffer, bytes);
}

bb_status bb_buffer_read(const bb_buffer *buffer, size_t offset, size_t bytes, void *target)
{
    if (bytes == 0)
        return BB_OK;
    buffer->device->waits++;
    BB_CL_TRY(clEnqueueReadBuffer(buffer->device->queue, buffer->mem, CL_TRUE, offset, bytes,
                                  target, 0, NULL, NULL),
              "reading %zu bytes from the device", bytes);
    return tally(buffer, bytes);
}

bb_status bb_device_check(bb_device *device)
{
    const uint32_t sent = 0x600dd00d;
    uint32_t got = 0;
    cl_int error;
    cl_mem word = clCreateBuffer(device->context, CL_MEM_READ_WRITE, sizeof sent, NULL, &error);
    if (error == CL_SUCCESS)
        error = clEnqueueWriteBuffer(device->queue, word, CL_TRUE, 0, sizeof sent, &sent, 0, NULL,
                                     NULL);
    if (error == CL_SUCCESS)
        error =
            clEnqueueReadBuffer(device->queue, word, CL_TRUE, 0, sizeof got, &got, 0, NULL, NULL);
    if (word != NULL)
        clReleaseMemObject(word);
    if (error == CL_SUCCESS && got == sent)
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "%s does not answer any more (%s): see its driver's log, then run again",
                   device->name,
                   error != CL_SUCCESS ? bb_cl_error(error)
                                       : "a word came back as "
                                         "another one");
}

bb_status bb_buffer_fill(bb_buffer *buffer, size_t bytes, uint32_t pattern)
{
    bb_device *device = buffer->device;
    cl_event event;
    if (bytes == 0)
        return BB_OK;
    BB_TRY(tally(buffer, bytes));
    device->launches++;
    BB_CL_TRY(clEnqueueFillBuffer(device->queue, buffer->mem, &pattern, sizeof pattern, 0, bytes, 0,
                                  NULL, device->profile_events ? &event : NULL),
              "filling %zu bytes on the device", bytes);
    return device->profile_events ? bb_device_add_event(device, event) : BB_OK;
}

bb_status bb_buffer_copy(const bb_buffer *from, bb_buffer *to, size_t bytes)
{
    bb_device *device = to->device;
    cl_event event;
    if (bytes == 0)
        return BB_OK;
    BB_TRY(tally(from, bytes));
    BB_TRY(tally(to, bytes));
    device->launches++;
    BB_CL_TRY(clEnqueueCopyBuffer(device->queue, from->mem, to->mem, 0, 0, bytes, 0, NULL,
                                  device->profile_events ? &event : NULL),
              "copying %zu bytes on the device", bytes);
    return device->profile_events ? bb_device_add_event(device, event) : BB_OK;
}

/* Used on devices with memory of their own: mapped pinned memory is scarce, and on some slow to
 * read. The copy itself follows this header. */
typedef struct map_copy {
    _Alignas(64) bool write;
} map_copy;

static bb_status copy_to_host(const bb_buffer *buffer, bool write, void **pointer)
{
    map_copy *copy = NULL;
    BB_TRY(bb_host_alloc(buffer->account, sizeof *copy + buffer->bytes, "a copy of the device's",
                         &copy));
    copy->write = write;
    bb_status status = bb_buffer_read(buffer, 0, buffer->bytes, copy + 1);
    if (status == BB_OK)
        *pointer = copy + 1;
    else
        bb_host_free(copy);
    return status;
}

static bb_status copy_back(const bb_buffer *buffer, void *pointer)
{
    map_copy *copy = (map_copy *)pointer - 1;
    bb_buffer target = *buffer;
    bb_status status = copy->write ? bb_buffer_write(&target, 0, buffer->bytes, pointer) : BB_OK;
    bb_host_free(copy);
    return status;
}

/* On processors, but not in builds that are tallied as those of GPUs. */
static bool maps(const bb_device *device)
{
    return device->is_cpu && device->tally == NULL;
}

bb_status bb_buffer_map(const bb_buffer *buffer, bool write, void **pointer)
{
    cl_int error;
    if (!maps(buffer->device))
        return copy_to_host(buffer, write, pointer);
    buffer->device->waits++;
    *pointer = clEnqueueMapBuffer(buffer->device->queue, buffer->mem, CL_TRUE,
                                  write ? CL_MAP_READ | CL_MAP_WRITE : CL_MAP_READ, 0,
                                  buffer->bytes, 0, NULL, NULL, &error);
    BB_CL_TRY(error, "mapping %zu bytes of the device", buffer->bytes);
    return BB_OK;
}

bb_status bb_buffer_unmap(const bb_buffer *buffer, void *pointer)
{
    if (!maps(buffer->device))
        return copy_back(buffer, pointer);
    BB_CL_TRY(clEnqueueUnmapMemObject(buffer->device->queue, buffer->mem, pointer, 0, NULL, NULL),
              "unmapping %zu bytes of the device", buffer->bytes);
    return bb_finish(buffer->device);
}
