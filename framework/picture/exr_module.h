/* What bvhbench-exr.so exports: EXR to and from memory. The module is loaded only when a picture in
 * this format is asked for, since OpenImageIO brings hundreds of libraries along and starts slowly.
 */
#ifndef BB_EXR_MODULE_H
#define BB_EXR_MODULE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Both return 0, or 1 with one line in `message`. *data and *rgb come from malloc(). */
int bb_exr_encode(const float *rgb, uint32_t width, uint32_t height, unsigned char **data,
                  size_t *size, char *message, size_t capacity);
int bb_exr_decode(const unsigned char *data, size_t size, float **rgb, uint32_t *width,
                  uint32_t *height, char *message, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
