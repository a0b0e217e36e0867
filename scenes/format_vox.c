/* MagicaVoxel: one of the file's models, without the scene graph and materials that later versions
 * add. A voxel's value is its index in the palette, 1 to 255; 0 is empty. A layer of empty voxels
 * is added around the model, so that bodies are closed.
 *
 * Format: ephtracy, voxel-model, MagicaVoxel-file-format-vox.txt. No library in Debian reads it. */
#include "framework/base/file.h"
#include "framework/base/memory.h"
#include "scenes/volume_scene.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_MAX = 256, HEADER = 12 }; /* positions are bytes */

static const bb_option options_table[] = {
    {"model", "1", NULL, "which of the file's models, from 1"},
    BB_VOLUME_OPTIONS,
    {0},
};

/* The rest of a file. */
typedef struct cursor {
    const char *path;
    const unsigned char *at, *end;
} cursor;

typedef struct chunk {
    char id[5];
    const unsigned char *data;
    uint32_t size, children;
} chunk;

static uint32_t read_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static size_t left(const cursor *c)
{
    return (size_t)(c->end - c->at);
}

static bb_status read_chunk(cursor *c, chunk *chunk)
{
    if (left(c) < HEADER)
        return bb_fail(BB_INVALID, "%s: is truncated: a chunk's header is cut off", c->path);
    memcpy(chunk->id, c->at, 4);
    chunk->id[4] = '\0';
    chunk->size = read_u32(c->at + 4);
    chunk->children = read_u32(c->at + 8);
    c->at += HEADER;
    if (chunk->size > left(c))
        return bb_fail(BB_INVALID,
                       "%s: is truncated: chunk %s claims %" PRIu32 " bytes, %zu are left", c->path,
                       chunk->id, chunk->size, left(c));
    chunk->data = c->at;
    c->at += chunk->size;
    return BB_OK;
}

/* Finds the two chunks of model `number`, which follow each other. */
static bb_status find_model(cursor *c, uint64_t number, chunk *size, chunk *voxels)
{
    uint64_t models = 0;
    while (left(c) > 0) {
        chunk next;
        BB_TRY(read_chunk(c, &next));
        if (strcmp(next.id, "SIZE") == 0)
            *size = next;
        if (strcmp(next.id, "XYZI") != 0)
            continue;
        if (size->id[0] == '\0')
            return bb_fail(BB_INVALID, "%s: chunk XYZI comes without a SIZE before it", c->path);
        if (++models == number) {
            *voxels = next;
            return BB_OK;
        }
        size->id[0] = '\0';
    }
    return models == 0 ? bb_fail(BB_INVALID, "%s: has no model", c->path)
                       : bb_fail(BB_INVALID,
                                 "%s: has %" PRIu64 " models: model=%" PRIu64 " is none of them",
                                 c->path, models, number);
}

static bb_status check_model(const char *path, const chunk *size, const chunk *voxels,
                             uint32_t dims[3])
{
    if (size->size < 12)
        return bb_fail(BB_INVALID, "%s: chunk SIZE has %" PRIu32 " bytes, it must have 12", path,
                       size->size);
    for (int k = 0; k < 3; k++) {
        dims[k] = read_u32(size->data + 4 * k);
        if (dims[k] == 0 || dims[k] > SIDE_MAX)
            return bb_fail(BB_INVALID, "%s: has %" PRIu32 " voxels along %c: it must be 1 to %d",
                           path, dims[k], "xyz"[k], SIDE_MAX);
    }
    uint64_t count = voxels->size >= 4 ? read_u32(voxels->data) : 0;
    if (voxels->size < 4 || 4 * count > voxels->size - 4)
        return bb_fail(BB_INVALID,
                       "%s: is truncated: chunk XYZI of %" PRIu32 " bytes claims %" PRIu64
                       " voxels",
                       path, voxels->size, count);
    return BB_OK;
}

/* z is up in the file and y here: (x, y, z) becomes (x, z, -y). */
static bb_status fill(const char *path, const chunk *chunk, const uint32_t dims[3],
                      const bb_voxels *voxels)
{
    uint8_t *values = voxels->values;
    const uint32_t *d = voxels->dims;
    memset(values, 0, (size_t)d[0] * d[1] * d[2]);
    uint32_t count = read_u32(chunk->data);
    for (uint32_t i = 0; i < count; i++) {
        const unsigned char *v = chunk->data + 4 + 4 * (size_t)i;
        for (int k = 0; k < 3; k++)
            if (v[k] >= dims[k])
                return bb_fail(BB_INVALID,
                               "%s: voxel %" PRIu32
                               " is at %u along %c, the model ends at %" PRIu32,
                               path, i, v[k], "xyz"[k], dims[k]);
        uint32_t x = v[0] + 1u, y = v[2] + 1u, z = dims[1] - v[1];
        values[((size_t)z * d[1] + y) * d[0] + x] = v[3];
    }
    return BB_OK;
}

static bb_status load_model(const char *path, const bb_spec *spec, const char *data, size_t size,
                            bb_scene *scene)
{
    const unsigned char *bytes = (const unsigned char *)data;
    cursor c = {path, bytes + 8, bytes + size};
    chunk main_chunk, shape = {"", NULL, 0, 0}, list = shape;
    uint64_t model;
    uint32_t dims[3];
    BB_TRY(bb_spec_u64(spec, options_table, "model", 1, UINT32_MAX, &model));
    if (size < 8 || memcmp(data, "VOX ", 4) != 0)
        return bb_fail(BB_INVALID, "%s: is no MagicaVoxel file: it does not begin with 'VOX '",
                       path);
    BB_TRY(read_chunk(&c, &main_chunk));
    if (strcmp(main_chunk.id, "MAIN") != 0)
        return bb_fail(BB_INVALID, "%s: its first chunk is not MAIN", path);
    BB_TRY(find_model(&c, model, &shape, &list));
    BB_TRY(check_model(path, &shape, &list, dims));
    bb_voxels voxels = {{dims[0] + 2, dims[2] + 2, dims[1] + 2}, {1, 1, 1}, 1, NULL};
    BB_TRY(bb_volume_scene_reserve(scene, spec, options_table, &voxels));
    bb_status status = fill(path, &list, dims, &voxels);
    if (status == BB_OK)
        return bb_volume_scene_make(spec, options_table, &voxels, scene);
    bb_voxels_free(&voxels);
    return status;
}

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    char *data;
    size_t size;
    BB_TRY(bb_file_read(path, (size_t)bb_host_limit(), "volume", &data, &size));
    bb_status status = load_model(path, spec, data, size, scene);
    free(data);
    return status;
}

static const char *const endings[] = {".vox", NULL};

extern const bb_scene_format bb_scene_format_vox;
const bb_scene_format bb_scene_format_vox = {
    .name = "vox",
    .endings = endings,
    .load = load,
    .options = options_table,
};
