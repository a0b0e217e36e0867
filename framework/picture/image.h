/* Pictures: 8-bit PNG by stb_image_write; float EXR by OpenImageIO (exr.h). */
#ifndef BB_IMAGE_H
#define BB_IMAGE_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Writes a picture. `rgb` has 3 linear floats from 0 to 1 per pixel, row by row from the top. The
 * ending of `path` chooses the format: .png (8-bit sRGB) or .exr (linear 32-bit floats). A
 * temporary file is written first, then renamed. BB_INVALID: another ending. BB_UNSUPPORTED: the
 * build has no EXR module; the message says what to install. */
bb_status bb_image_write(const char *path, const float *rgb, uint32_t width, uint32_t height);

/* Checks the ending of `path`, and that the module for it is there. To be called before the work.
 */
bb_status bb_image_check(const char *path);

/* Returns whether `path` ends in .exr. */
bool bb_image_is_exr(const char *path);

/* Reads a picture into *rgb, which is from bb_host_alloc(). */
bb_status bb_image_read(const char *path, float **rgb, uint32_t *width, uint32_t *height);

/* Maps a value from 0 to 1 to linear RGB. The map is perceptually uniform and readable in grey. */
void bb_colour_map(float value, float rgb[3]);

#endif
