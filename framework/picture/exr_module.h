/* Functions of bvhbench-exr.so: EXR in memory, and comparison, by OpenImageIO.
 *
 * The module is loaded at first use. OpenImageIO needs about 250 shared libraries, which would add
 * 0.3 to 0.5 s to a start of 10 ms. Without the module, the bench lacks only EXR.
 *
 * Values are floats, pixel by pixel, row by row from the top. `channels` has the name of each
 * channel in the file, a letter per value of a pixel. Functions return 0, or 1 and one line in
 * `message`. *data and *values come from malloc(). */
#ifndef BB_EXR_MODULE_H
#define BB_EXR_MODULE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/* The difference of two images. */
typedef struct bb_exr_difference {
    double mean, most; /* of |a - b| */
    uint32_t x, y;     /* the pixel that differs most */
    uint64_t pixels;   /* number of pixels that differ */
} bb_exr_difference;

int bb_exr_encode(const float *values, const char *channels, uint32_t width, uint32_t height,
                  unsigned char **data, size_t *size, char *message, size_t capacity);
int bb_exr_decode(const unsigned char *data, size_t size, const char *channels, float **values,
                  uint32_t *width, uint32_t *height, char *message, size_t capacity);
/* Compares finite values. `difference`, unless NULL, gets |a - b| of each value. */
int bb_exr_compare(const float *a, const float *b, uint32_t channel_count, uint32_t width,
                   uint32_t height, float *difference, bb_exr_difference *found, char *message,
                   size_t capacity);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
