/* Reads, writes and compares EXR files by OpenImageIO (exr_module.h). If the bench was built
 * without it, all functions return BB_UNSUPPORTED, and the message says what to install.
 *
 * `values` are 32-bit floats, pixel by pixel, row by row from the top. NaN and infinities are kept
 * bit for bit. `channels` has a letter for each value of a pixel: R, G, B, a single Y, Z for depth.
 */
#ifndef BB_EXR_H
#define BB_EXR_H

#include "framework/base/status.h"
#include "framework/picture/exr_module.h"

#include <stddef.h>
#include <stdint.h>

/* Checks that EXR files can be written. */
bb_status bb_exr_check(void);

/* Writes a temporary file first, then renames it. */
bb_status bb_exr_write(const char *path, const float *values, const char *channels, uint32_t width,
                       uint32_t height);

/* Decodes the bytes of a file; `path` is for messages. *values is from bb_host_alloc(). BB_INVALID:
 * the bytes are no EXR file with these channels. */
bb_status bb_exr_read(const char *path, const char *data, size_t size, const char *channels,
                      float **values, uint32_t *width, uint32_t *height);

/* Compares finite values. `difference`, unless NULL, gets |a - b| of each value. */
bb_status bb_exr_differences(const float *a, const float *b, uint32_t channel_count, uint32_t width,
                             uint32_t height, float *difference, bb_exr_difference *found);

#endif
