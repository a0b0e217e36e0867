#include "framework/device/tally.h"

#include "framework/device/cl_error.h"

#include <stdlib.h>
#include <xxhash.h>

/* The device that builds are made for. It names no product: sizes that most GPUs have. */
enum { GPU_UNITS = 64, GPU_LOCAL_BYTES = 32 << 10, GPU_GROUP = 256 };

void bb_tally_attach(bb_tally *tally, bb_device *device)
{
    tally->before.form = device->form;
    tally->before.handover = device->handover;
    tally->before.compute_units = device->compute_units;
    tally->before.local_bytes = device->local_bytes;
    tally->before.max_group_size = device->max_group_size;
    device->form = BB_FORM_GPU;
    device->handover = BB_HANDOVER_LEVELS;
    device->compute_units = GPU_UNITS;
    if (device->local_bytes > GPU_LOCAL_BYTES)
        device->local_bytes = GPU_LOCAL_BYTES;
    if (device->max_group_size > GPU_GROUP)
        device->max_group_size = GPU_GROUP;
    device->tally = tally;
}

void bb_tally_detach(bb_tally *tally, bb_device *device)
{
    device->form = tally->before.form;
    device->handover = tally->before.handover;
    device->compute_units = tally->before.compute_units;
    device->local_bytes = tally->before.local_bytes;
    device->max_group_size = tally->before.max_group_size;
    device->tally = NULL;
}

void bb_tally_release(bb_tally *tally)
{
    for (uint32_t i = 0; i < tally->array_count; i++)
        clReleaseMemObject(tally->arrays[i]);
    free(tally->arrays);
    free(tally->moves);
    free(tally->seen);
    *tally = (bb_tally){0};
}

/* Returns the list with room for one more item, which it lacks if `count` is a power of two; NULL
 * without memory. */
static void *with_room(void *list, uint32_t count, size_t bytes)
{
    if ((count & (count - 1)) != 0)
        return list;
    return realloc(list, (count == 0 ? 1 : 2 * (size_t)count) * bytes);
}

static bb_status add_move(bb_tally *tally, bb_tally_move move)
{
    bb_tally_move *moves = with_room(tally->moves, tally->move_count, sizeof *moves);
    if (moves == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    tally->moves = moves;
    moves[tally->move_count++] = move;
    return BB_OK;
}

/* Gets an array's number and size; adds it if it is new. */
static bb_status find_array(bb_tally *tally, cl_mem mem, uint32_t *number, uint64_t *bytes)
{
    size_t size = 0;
    BB_CL_TRY(clGetMemObjectInfo(mem, CL_MEM_SIZE, sizeof size, &size, NULL),
              "asking for the size of a buffer");
    *bytes = size;
    for (*number = 0; *number < tally->array_count; ++*number)
        if (tally->arrays[*number] == mem)
            return BB_OK;
    cl_mem *arrays = with_room(tally->arrays, tally->array_count, sizeof *arrays);
    if (arrays == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    tally->arrays = arrays;
    BB_CL_TRY(clRetainMemObject(mem), "keeping a buffer");
    arrays[tally->array_count++] = mem;
    tally->array_bytes += size;
    return BB_OK;
}

/* Returns whether the kernel had exactly these arrays before, and remembers that it has. */
static bb_status is_repeated(bb_tally *tally, cl_kernel kernel, const bool *has, bool *repeated)
{
    uint64_t hash = XXH3_64bits(&kernel, sizeof kernel);
    for (uint32_t i = 0; i < tally->array_count; i++)
        if (has[i])
            hash = XXH3_64bits_withSeed(&i, sizeof i, hash);
    for (uint32_t i = 0; i < tally->seen_count; i++)
        if (tally->seen[i] == hash) {
            *repeated = true;
            return BB_OK;
        }
    *repeated = false;
    uint64_t *seen = with_room(tally->seen, tally->seen_count, sizeof *seen);
    if (seen == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    tally->seen = seen;
    seen[tally->seen_count++] = hash;
    return BB_OK;
}

/* Gets the array that an argument names; NULL if it names none. */
static bb_status array_of(cl_kernel kernel, uint32_t index, const bb_arg *arg, cl_mem *mem)
{
    cl_kernel_arg_address_qualifier address;
    if (clGetKernelArgInfo(kernel, index, CL_KERNEL_ARG_ADDRESS_QUALIFIER, sizeof address, &address,
                           NULL) != CL_SUCCESS)
        return bb_fail(BB_UNSUPPORTED, "the driver does not tell which arguments are arrays");
    const bool is_array =
        address == CL_KERNEL_ARG_ADDRESS_GLOBAL || address == CL_KERNEL_ARG_ADDRESS_CONSTANT;
    *mem = is_array ? *(const cl_mem *)arg->value : NULL;
    return BB_OK;
}

bb_status bb_tally_launch(bb_device *device, cl_kernel kernel, const bb_arg *args, uint32_t count)
{
    bb_tally *tally = device->tally;
    const bool passes = tally->passes;
    bool repeated, *has = calloc(tally->array_count + count + 1, sizeof *has);
    bb_tally_move move = {0};
    bb_status status = has != NULL ? BB_OK : bb_fail(BB_FAILED, "out of memory");
    for (uint32_t i = 0; i < count && status == BB_OK; i++) {
        cl_mem mem = NULL;
        uint32_t number = 0;
        uint64_t bytes = 0;
        status = array_of(kernel, i, &args[i], &mem);
        if (status != BB_OK || mem == NULL)
            continue;
        status = find_array(tally, mem, &number, &bytes);
        if (status == BB_OK && !has[number]) {
            has[number] = true;
            move.arrays += bytes;
        }
    }
    if (status == BB_OK)
        status = is_repeated(tally, kernel, has, &repeated);
    free(has);
    BB_TRY(status);
    tally->passes = false;
    move.bytes = repeated && !passes ? 0 : move.arrays;
    return add_move(tally, move);
}

bb_status bb_tally_part(bb_device *device, cl_mem array, uint64_t bytes)
{
    uint32_t number;
    uint64_t whole = 0;
    BB_TRY(find_array(device->tally, array, &number, &whole));
    return add_move(device->tally, (bb_tally_move){bytes, whole});
}

bb_device *bb_tally_pass(bb_device *device)
{
    if (bb_device_tallies(device))
        device->tally->passes = true;
    return device;
}

void bb_tally_sort_pass(bb_device *device)
{
    if (bb_device_tallies(device))
        device->tally->sort_passes++;
}
