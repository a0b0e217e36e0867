/* Raw volumes: only values, x fastest; plain, or compressed by zstd. Dimensions and type are
 * options after the name, or the name itself ends in them: NAME_WxHxD_TYPE.raw. */
#include "framework/base/number.h"
#include "scenes/volume_scene.h"
#include "scenes/voxel_file.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static const bb_option options_table[] = {
    {"dims", NULL, NULL, "voxels along x, y and z, as WxHxD; default: as the name says"},
    {"type", NULL, "uint8|uint16", "of a voxel; default: as the name says"},
    {"endian", "little", "little|big", "byte order of uint16"},
    {"spacing", "1x1x1", NULL, "distances of neighbours along x, y and z, as AxBxC"},
    BB_VOLUME_OPTIONS,
    {0},
};

/* Splits NAME_WxHxD_TYPE.raw into its last two parts. */
static bool split_name(const char *path, char dims[40], char type[16])
{
    const char *slash = strrchr(path, '/'), *name = slash != NULL ? slash + 1 : path;
    const char *end = strcasestr(name, ".raw");
    char parts[2][40];
    for (int part = 1; part >= 0; part--) {
        const char *at = end;
        while (at != NULL && at > name && at[-1] != '_')
            at--;
        if (at == NULL || at <= name || end - at >= 40)
            return false;
        memcpy(parts[part], at, (size_t)(end - at));
        parts[part][end - at] = '\0';
        end = at - 1;
    }
    snprintf(dims, 40, "%s", parts[0]);
    snprintf(type, 16, "%.15s", parts[1]);
    return true;
}

static bb_status read_shape(const char *path, const bb_spec *spec, bb_voxels *voxels)
{
    char dims[40] = "", type[16] = "";
    const char *given_dims = bb_spec_value(spec, options_table, "dims");
    const char *given_type = bb_spec_value(spec, options_table, "type");
    split_name(path, dims, type);
    if (given_dims != NULL)
        snprintf(dims, sizeof dims, "%.39s", given_dims);
    if (given_type != NULL)
        snprintf(type, sizeof type, "%.15s", given_type);
    if (!bb_read_dims(dims, voxels->dims))
        return bb_fail(BB_INVALID,
                       "%s: how many voxels? Put dims=WxHxD behind it (FILE:dims=256x256x128), or "
                       "name it NAME_WxHxD_TYPE.raw",
                       path);
    if (strcmp(type, "uint8") != 0 && strcmp(type, "uint16") != 0)
        return bb_fail(BB_INVALID,
                       "%s: which type has a voxel? Put type=uint8 or type=uint16 behind it "
                       "(FILE:type=uint8), or name it NAME_WxHxD_TYPE.raw",
                       path);
    voxels->bytes = strcmp(type, "uint8") == 0 ? 1 : 2;
    return BB_OK;
}

static bb_status read_spacing(const char *path, const bb_spec *spec, double spacing[3])
{
    char text[96], *rest = NULL, *part;
    int k = 0;
    snprintf(text, sizeof text, "%s", bb_spec_value(spec, options_table, "spacing"));
    for (part = strtok_r(text, "x", &rest); part != NULL && k < 3;
         part = strtok_r(NULL, "x", &rest))
        if (!bb_read_real(part, &spacing[k++]))
            break;
    return k == 3 && part == NULL
               ? BB_OK
               : bb_fail(BB_INVALID, "%s: spacing=%s is not AxBxC, three numbers", path,
                         bb_spec_value(spec, options_table, "spacing"));
}

static bool is_big_endian(void)
{
    const uint16_t one = 1;
    return *(const unsigned char *)&one == 0;
}

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    bb_voxels voxels = {.values = NULL};
    BB_TRY(read_shape(path, spec, &voxels));
    BB_TRY(read_spacing(path, spec, voxels.spacing));
    BB_TRY(bb_volume_scene_reserve(scene, spec, options_table, &voxels));
    size_t length = strlen(path);
    bool packed = length > 4 && strcasecmp(path + length - 4, ".zst") == 0;
    bb_status status =
        packed ? bb_voxel_file_read_zst(path, &voxels) : bb_voxel_file_read(path, &voxels);
    if (status != BB_OK) {
        bb_voxels_free(&voxels);
        return status;
    }
    if (voxels.bytes == 2 && bb_spec_is(spec, options_table, "endian", "big") != is_big_endian())
        bb_voxels_swap(&voxels);
    return bb_volume_scene_make(spec, options_table, &voxels, scene);
}

static const char *const endings[] = {".raw", ".raw.zst", NULL};

extern const bb_scene_format bb_scene_format_raw;
const bb_scene_format bb_scene_format_raw = {
    .name = "raw",
    .endings = endings,
    .load = load,
    .options = options_table,
};
