/* What bvhbench-exr.so exports: EXR to and from memory, and comparison, by OpenImageIO.
 *
 * It is a module that is loaded at first use, for two reasons: OpenImageIO takes some 250 shared
 * libraries along, 0.3 to 0.5 s at each start of a program that otherwise starts in 10 ms; and the
 * bench is whole without it, but for EXR.
 *
 * Values are floats, pixel by pixel, row by row from the top; `channels` has a letter per value of
 * a pixel, which is the channel's name in the file. All functions return 0, or 1 with one line in
 * `message`. *data and *values come from malloc(). */
#ifndef BB_EXR_MODULE_H
#define BB_EXR_MODULE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/* Where and by how much two images differ. */
typedef struct bb_exr_difference {
    double mean, most; /* of |a - b| */
    uint32_t x, y;     /* of the pixel with the most */
    uint64_t pixels;   /* that differ at all */
} bb_exr_difference;

int bb_exr_encode(const float *values, const char *channels, uint32_t width, uint32_t height,
                  unsigned char **data, size_t *size, char *message, size_t capacity);
int bb_exr_decode(const unsigned char *data, size_t size, const char *channels, float **values,
                  uint32_t *width, uint32_t *height, char *message, size_t capacity);
/* `difference` gets |a - b| of each value, unless it is NULL. The values must be finite. */
int bb_exr_compare(const float *a, const float *b, uint32_t channel_count, uint32_t width,
                   uint32_t height, float *difference, bb_exr_difference *found, char *message,
                   size_t capacity);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
