/* Pictures: 8-bit PNG by stb_image_write; float EXR by OpenImageIO (exr.h). */
#ifndef BB_IMAGE_H
#define BB_IMAGE_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* RGB, row by row from the top, linear 0..1 floats, 3 per pixel. The ending of `path` chooses: .png
 * (sRGB, 8 bit) or .exr (linear, 32-bit float). Written by way of a temporary file. BB_INVALID for
 * another ending, BB_UNSUPPORTED with what to install if the build has no EXR module. */
bb_status bb_image_write(const char *path, const float *rgb, uint32_t width, uint32_t height);

/* Checks, before the work, that a picture can be written to such a `path`: ending, module. */
bb_status bb_image_check(const char *path);

/* By the ending. */
bool bb_image_is_exr(const char *path);

/* Reads a picture back into *rgb (from bb_host_alloc); for tests and later comparisons. */
bb_status bb_image_read(const char *path, float **rgb, uint32_t *width, uint32_t *height);

/* Colour map (perceptually uniform, readable in grey): value 0..1 to linear RGB. */
void bb_colour_map(float value, float rgb[3]);

#endif
