/* EXR files of numbers, and their comparison, by OpenImageIO (exr_module.h). All functions give
 * BB_UNSUPPORTED, with what to install, if the bench was built without it.
 *
 * `values` are 32-bit floats, pixel by pixel, row by row from the top, of any value: NaN and
 * infinities come back bit for bit. `channels` has a letter for each value of a pixel, after the
 * custom of the format: R, G, B, a single Y, and Z for depth. */
#ifndef BB_EXR_H
#define BB_EXR_H

#include "framework/base/status.h"
#include "framework/picture/exr_module.h"

#include <stddef.h>
#include <stdint.h>

/* Whether EXR can be written at all. */
bb_status bb_exr_check(void);

/* Written by way of a temporary file. */
bb_status bb_exr_write(const char *path, const float *values, const char *channels, uint32_t width,
                       uint32_t height);

/* Of the bytes of a file, whose `path` is for messages. *values is from bb_host_alloc().
 * BB_INVALID if they are no EXR with these channels. */
bb_status bb_exr_read(const char *path, const char *data, size_t size, const char *channels,
                      float **values, uint32_t *width, uint32_t *height);

/* Compares finite values; `difference`, unless NULL, gets |a - b| of each. */
bb_status bb_exr_differences(const float *a, const float *b, uint32_t channel_count, uint32_t width,
                             uint32_t height, float *difference, bb_exr_difference *found);

#endif
