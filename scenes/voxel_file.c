#include "scenes/voxel_file.h"

#include "framework/base/file.h"
#include "framework/base/memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>
#include <zstd_errors.h>

static uint64_t bytes_of(const bb_voxels *voxels)
{
    return (uint64_t)voxels->dims[0] * voxels->dims[1] * voxels->dims[2] * voxels->bytes;
}

/* Reports how long the file should be. */
static bb_status wrong_size(const char *path, const char *has, const bb_voxels *voxels)
{
    return bb_fail(BB_INVALID,
                   "%s: %s, %u x %u x %u voxels of %u byte%s are %" PRIu64
                   ": check dims= and type=, or whether it is whole",
                   path, has, voxels->dims[0], voxels->dims[1], voxels->dims[2], voxels->bytes,
                   voxels->bytes == 1 ? "" : "s", bytes_of(voxels));
}

bb_status bb_voxel_file_read(const char *path, const bb_voxels *voxels)
{
    bb_input input;
    char has[64];
    BB_TRY(bb_input_open(path, "volume", &input));
    snprintf(has, sizeof has, "has %" PRIu64 " bytes", input.size);
    bb_status status = input.size == bytes_of(voxels)
                           ? bb_input_read(&input, voxels->values, (size_t)input.size)
                           : wrong_size(path, has, voxels);
    bb_input_close(&input);
    return status;
}

/* Expands all at once: a stream would allocate the window that a frame's header asks for, up to 128
 * MB. */
static bb_status expand(const char *path, const char *packed, size_t size, const bb_voxels *voxels)
{
    size_t expanded = ZSTD_decompress(voxels->values, (size_t)bytes_of(voxels), packed, size);
    if (ZSTD_isError(expanded))
        switch (ZSTD_getErrorCode(expanded)) {
        case ZSTD_error_memory_allocation:
            return bb_fail(BB_REFUSED, "%s: no memory to expand it", path);
        case ZSTD_error_dstSize_tooSmall:
            return wrong_size(path, "expands to more", voxels);
        case ZSTD_error_srcSize_wrong:
            return wrong_size(path, "ends too soon", voxels);
        default:
            return bb_fail(BB_INVALID, "%s: is no zstd file, or damaged: %s", path,
                           ZSTD_getErrorName(expanded));
        }
    return expanded == bytes_of(voxels) ? BB_OK : wrong_size(path, "ends too soon", voxels);
}

bb_status bb_voxel_file_read_zst(const char *path, const bb_voxels *voxels)
{
    char *packed;
    size_t size;
    BB_TRY(bb_file_read(path, (size_t)bb_host_limit(), "volume", &packed, &size));
    bb_status status = expand(path, packed, size, voxels);
    free(packed);
    return status;
}

void bb_voxels_swap(const bb_voxels *voxels)
{
    unsigned char *at = voxels->values;
    for (uint64_t i = 0; i + 1 < bytes_of(voxels); i += 2) {
        unsigned char first = at[i];
        at[i] = at[i + 1];
        at[i + 1] = first;
    }
}

bool bb_read_dims(const char *text, uint32_t dims[3])
{
    for (int k = 0; k < 3; k++) {
        size_t digits = strspn(text, "0123456789");
        if (digits == 0 || digits > 9)
            return false;
        dims[k] = (uint32_t)strtoul(text, NULL, 10);
        text += digits;
        if (dims[k] == 0 || *text++ != (k < 2 ? 'x' : '\0'))
            return false;
    }
    return true;
}
