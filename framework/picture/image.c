/* Pictures: PNG by stb, EXR by exr.c; the colour map.
 *
 * sRGB transfer curve: IEC 61966-2-1. Colour map: a path through OKLab (Björn Ottosson, 2020) in
 * which lightness rises linearly from dark purple by blue and green to yellow, so that equal steps
 * look equal and the map reads in grey too.
 */
#include "framework/picture/image.h"
#include "framework/base/file.h"
#include "framework/base/memory.h"
#include "framework/picture/exr.h"

#include <math.h>
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_MAX = 65536, PICTURE_BYTES_MAX = 1 << 30 };

static bool ends_with(const char *path, const char *ending)
{
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcmp(path + length - tail, ending) == 0;
}

/* ---- PNG ---- */

/* Returns 0 for NaN. */
static unsigned char encode_srgb(float linear)
{
    float v = linear > 0.0f ? (linear < 1.0f ? linear : 1.0f) : 0.0f;
    v = v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1.0f / 2.4f) - 0.055f;
    return (unsigned char)(255.0f * v + 0.5f);
}

static float decode_srgb(unsigned char byte)
{
    float v = (float)byte / 255.0f;
    return v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
}

typedef struct sink {
    const char *path;
    bb_status status;
} sink;

/* stb passes the whole file in one call. */
static void write_png(void *context, void *data, int size)
{
    sink *target = context;
    target->status = bb_file_write(target->path, data, (size_t)size, "picture");
}

static bb_status png_write(const char *path, const float *rgb, uint32_t width, uint32_t height)
{
    size_t values = 3 * (size_t)width * height;
    unsigned char *bytes = malloc(values);
    if (bytes == NULL)
        return bb_fail(BB_FAILED, "picture %s: no memory for %ux%u pixels", path, width, height);
    for (size_t i = 0; i < values; i++)
        bytes[i] = encode_srgb(rgb[i]);
    sink target = {path, BB_OK};
    int done = stbi_write_png_to_func(write_png, &target, (int)width, (int)height, 3, bytes,
                                      (int)width * 3);
    free(bytes);
    return done ? target.status : bb_fail(BB_FAILED, "picture %s: no memory for the PNG", path);
}

static bb_status png_decode(const char *path, const char *data, size_t size, float **rgb,
                            uint32_t *width, uint32_t *height)
{
    int w = 0, h = 0, channels = 0;
    unsigned char *bytes =
        stbi_load_from_memory((const unsigned char *)data, (int)size, &w, &h, &channels, 3);
    if (bytes == NULL)
        return bb_fail(BB_INVALID, "picture %s cannot be read as PNG: %s", path,
                       stbi_failure_reason());
    size_t values = 3 * (size_t)w * (size_t)h;
    bb_status status = bb_host_alloc(NULL, values * sizeof(float), "picture", rgb);
    for (size_t i = 0; status == BB_OK && i < values; i++)
        (*rgb)[i] = decode_srgb(bytes[i]);
    stbi_image_free(bytes);
    *width = (uint32_t)w;
    *height = (uint32_t)h;
    return status;
}

/* ---- by ending ---- */

bool bb_image_is_exr(const char *path)
{
    return ends_with(path, ".exr");
}

bb_status bb_image_check(const char *path)
{
    if (bb_image_is_exr(path))
        BB_TRY(bb_exr_check());
    else if (!ends_with(path, ".png"))
        return bb_fail(BB_INVALID, "picture %s: the ending must be .png or .exr", path);
    return BB_OK;
}

bb_status bb_image_write(const char *path, const float *rgb, uint32_t width, uint32_t height)
{
    if (width < 1 || height < 1 || width > SIDE_MAX || height > SIDE_MAX ||
        3 * (uint64_t)width * height > PICTURE_BYTES_MAX)
        return bb_fail(BB_INVALID, "picture %s: %ux%u pixels: the size is zero or too large", path,
                       width, height);
    if (ends_with(path, ".png"))
        return png_write(path, rgb, width, height);
    if (bb_image_is_exr(path))
        return bb_exr_write(path, rgb, "RGB", width, height);
    return bb_fail(BB_INVALID, "picture %s: the ending must be .png or .exr", path);
}

bb_status bb_image_read(const char *path, float **rgb, uint32_t *width, uint32_t *height)
{
    *rgb = NULL;
    *width = *height = 0;
    bool png = ends_with(path, ".png");
    if (!png && !bb_image_is_exr(path))
        return bb_fail(BB_INVALID, "picture %s: the ending must be .png or .exr", path);
    char *data = NULL;
    size_t size = 0;
    BB_TRY(bb_file_read(path, PICTURE_BYTES_MAX, "picture", &data, &size));
    bb_status status = png ? png_decode(path, data, size, rgb, width, height)
                           : bb_exr_read(path, data, size, "RGB", rgb, width, height);
    free(data);
    return status;
}

/* ---- colours ---- */

/* Converts OKLab to linear sRGB, with the constants of its author. */
static void from_oklab(float lightness, float a, float b, float rgb[3])
{
    float l = lightness + 0.3963377774f * a + 0.2158037573f * b;
    float m = lightness - 0.1055613458f * a - 0.0638541728f * b;
    float s = lightness - 0.0894841775f * a - 1.2914855480f * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    rgb[0] = 4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s;
    rgb[1] = -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s;
    rgb[2] = -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s;
}

void bb_colour_map(float value, float rgb[3])
{
    /* Hue and chroma keep the whole path inside sRGB. NaN gives the lower end. */
    float x = value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f;
    float lightness = 0.26f + 0.66f * x;
    float chroma = 0.095f + 0.08f * x * (2.0f * x - 1.0f) * (2.0f * x - 1.0f);
    float hue = (310.0f - 205.0f * x) * 0.017453293f;
    from_oklab(lightness, chroma * cosf(hue), chroma * sinf(hue), rgb);
    for (int i = 0; i < 3; i++)
        rgb[i] = rgb[i] > 0.0f ? (rgb[i] < 1.0f ? rgb[i] : 1.0f) : 0.0f;
}
