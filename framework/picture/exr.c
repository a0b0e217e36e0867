/* Loads the EXR module at first use. */
#include "framework/picture/exr.h"
#include "framework/base/beside.h"
#include "framework/base/file.h"
#include "framework/base/memory.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct exr_module {
    void *library;
    __typeof__(bb_exr_encode) *encode;
    __typeof__(bb_exr_decode) *decode;
    __typeof__(bb_exr_compare) *compare;
} exr_module;

/* The module stays loaded, since OpenImageIO cannot be unloaded. */
static bb_status exr_load(exr_module *module)
{
    char path[4096];
    if (!bb_find_beside("bvhbench-exr.so", path, sizeof path))
        return bb_fail(BB_UNSUPPORTED,
                       "EXR needs OpenImageIO: install libopenimageio-dev, configure and build "
                       "again (cmake --preset release, scripts/build release), or write .png");
    module->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (module->library == NULL)
        return bb_fail(BB_FAILED, "EXR module: %s", dlerror());
    void *encode = dlsym(module->library, "bb_exr_encode");
    void *decode = dlsym(module->library, "bb_exr_decode");
    void *compare = dlsym(module->library, "bb_exr_compare");
    if (encode == NULL || decode == NULL || compare == NULL)
        return bb_fail(BB_FAILED, "EXR module %s is of another version: reinstall both", path);
    memcpy(&module->encode, &encode, sizeof encode);
    memcpy(&module->decode, &decode, sizeof decode);
    memcpy(&module->compare, &compare, sizeof compare);
    return BB_OK;
}

bb_status bb_exr_check(void)
{
    exr_module module = {0};
    return exr_load(&module);
}

bb_status bb_exr_write(const char *path, const float *values, const char *channels, uint32_t width,
                       uint32_t height)
{
    exr_module module = {0};
    BB_TRY(exr_load(&module));
    char message[400] = "";
    unsigned char *data = NULL;
    size_t size = 0;
    if (module.encode(values, channels, width, height, &data, &size, message, sizeof message) != 0)
        return bb_fail(BB_FAILED, "picture %s: %s", path, message);
    bb_status status = bb_file_write(path, data, size, "picture");
    free(data);
    return status;
}

bb_status bb_exr_read(const char *path, const char *data, size_t size, const char *channels,
                      float **values, uint32_t *width, uint32_t *height)
{
    exr_module module = {0};
    BB_TRY(exr_load(&module));
    char message[400] = "";
    float *pixels = NULL;
    if (module.decode((const unsigned char *)data, size, channels, &pixels, width, height, message,
                      sizeof message) != 0)
        return bb_fail(BB_INVALID, "picture %s: %s", path, message);
    size_t bytes = strlen(channels) * *width * *height * sizeof(float);
    bb_status status = bb_host_alloc(NULL, bytes, "picture", values);
    if (status == BB_OK)
        memcpy(*values, pixels, bytes);
    free(pixels);
    return status;
}

bb_status bb_exr_differences(const float *a, const float *b, uint32_t channel_count, uint32_t width,
                             uint32_t height, float *difference, bb_exr_difference *found)
{
    exr_module module = {0};
    BB_TRY(exr_load(&module));
    char message[400] = "";
    if (module.compare(a, b, channel_count, width, height, difference, found, message,
                       sizeof message) != 0)
        return bb_fail(BB_FAILED, "comparison of pictures: %s", message);
    return BB_OK;
}
