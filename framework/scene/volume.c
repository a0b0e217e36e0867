/* Bricks of volumes, and which of them are visible. */
#include "framework/scene/volume.h"

#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "framework/base/threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

/* ---- voxels ---- */

static uint32_t bricks_along(uint32_t dim, uint32_t side)
{
    return (dim - 2) / side + 1;
}

static uint64_t brick_bytes(uint32_t side, uint32_t bytes)
{
    return (uint64_t)bb_brick_voxels(side) * bytes;
}

bb_status bb_voxels_reserve(const char *name, uint32_t side, bb_voxels *voxels)
{
    const uint32_t *dims = voxels->dims;
    uint64_t values = 1, bricks = 1;
    for (int k = 0; k < 3; k++) {
        if (dims[k] < 2)
            return bb_fail(BB_INVALID,
                           "%s: has %u voxels along %c: values are interpolated between voxels, so "
                           "it takes 2",
                           name, dims[k], "xyz"[k]);
        if (bricks_along(dims[k], side) > BB_BRICKS_ALONG_MAX)
            return bb_fail(BB_REFUSED,
                           "%s: has %u voxels along %c: bricks of %u cells, %d of them, hold %u; "
                           "take larger ones (brick=)",
                           name, dims[k], "xyz"[k], side, BB_BRICKS_ALONG_MAX,
                           BB_BRICKS_ALONG_MAX * side + 1);
        if (!(voxels->spacing[k] > 0) || !(voxels->spacing[k] * dims[k] < 1e30) ||
            !(voxels->spacing[k] > 1e-30))
            return bb_fail(BB_INVALID,
                           "%s: voxels along %c are %g apart: it must be above 1e-30, and all of "
                           "them within 1e30",
                           name, "xyz"[k], voxels -> spacing[k]);
        values *= dims[k];
        bricks *= bricks_along(dims[k], side);
    }
    uint64_t bytes = values * voxels->bytes,
             all = bytes + bricks * brick_bytes(side, voxels->bytes);
    if (all > bb_host_limit() || bricks >= UINT32_MAX / 2)
        return bb_fail(BB_REFUSED,
                       "%s: its voxels and bricks need %llu bytes, three quarters of %s "
                       "are %llu: take a smaller one",
                       name, (unsigned long long)all, bb_memory_limit_by(),
                       (unsigned long long)bb_host_limit());
    return bb_host_alloc(NULL, (size_t)bytes, "voxels", &voxels->values);
}

void bb_voxels_free(bb_voxels *voxels)
{
    bb_host_free(voxels->values);
    voxels->values = NULL;
}

/* ---- bricks ---- */

typedef struct job {
    const bb_voxels *voxels;
    bb_volume *volume;
} job;

static void place_of(const bb_volume_grid *grid, uint32_t brick, uint32_t place[3])
{
    place[0] = brick % grid->bricks[0];
    place[1] = brick / grid->bricks[0] % grid->bricks[1];
    place[2] = brick / grid->bricks[0] / grid->bricks[1];
}

static uint32_t value_at(const void *values, uint32_t bytes, size_t i)
{
    return bytes == 1 ? ((const uint8_t *)values)[i] : ((const uint16_t *)values)[i];
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static void copy_row(const bb_voxels *voxels, const uint32_t from[3], uint32_t count, void *to)
{
    const uint32_t *dims = voxels->dims, bytes = voxels->bytes;
    size_t row =
        ((size_t)least(from[2], dims[2] - 1) * dims[1] + least(from[1], dims[1] - 1)) * dims[0];
    uint32_t there = least(count, dims[0] - from[0]);
    const char *values = voxels->values;
    memcpy(to, values + (row + from[0]) * bytes, (size_t)there * bytes);
    for (uint32_t i = there; i < count; i++)
        memcpy((char *)to + (size_t)i * bytes, values + (row + dims[0] - 1) * bytes, bytes);
}

static void make_brick(const job *job, uint32_t brick)
{
    bb_volume *volume = job->volume;
    const uint32_t side = volume->grid.side, along = side + 1, bytes = volume->bytes;
    char *to = (char *)volume->bricks + brick * brick_bytes(side, bytes);
    uint32_t place[3];
    place_of(&volume->grid, brick, place);
    for (uint32_t z = 0; z < along; z++)
        for (uint32_t y = 0; y < along; y++) {
            const uint32_t from[3] = {place[0] * side, place[1] * side + y, place[2] * side + z};
            copy_row(job->voxels, from, along, to + (size_t)(z * along + y) * along * bytes);
        }
    uint32_t lo = volume->grid.white, hi = 0;
    for (uint32_t i = 0; i < bb_brick_voxels(side); i++) {
        uint32_t value = value_at(to, bytes, i);
        lo = least(lo, value);
        hi = value > hi ? value : hi;
    }
    volume->ranges[brick] = lo | hi << 16;
}

static void make_bricks(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    for (size_t brick = begin; brick < end; brick++)
        make_brick(context, (uint32_t)brick);
}

static void set_grid(const bb_voxels *voxels, uint32_t side, bb_volume *volume)
{
    bb_volume_grid *grid = &volume->grid;
    float largest = 0;
    *grid = (bb_volume_grid){.side = side, .white = voxels->bytes == 1 ? 255 : 65535};
    volume->bytes = voxels->bytes;
    volume->brick_count = 1;
    for (int k = 0; k < 3; k++) {
        grid->cell[k] = (float)voxels->spacing[k];
        grid->per_cell[k] = 1 / grid->cell[k];
        grid->cells[k] = voxels->dims[k] - 1;
        grid->bricks[k] = bricks_along(voxels->dims[k], side);
        volume->brick_count *= grid->bricks[k];
        largest = fmaxf(largest, grid->cell[k] * (float)grid->cells[k]);
    }
    /* a sample's place is off by less than 16 u of that: framework/tasks/README.md */
    grid->margin = largest * 0x1p-20f;
}

static void set_hash(bb_volume *volume)
{
    volume->bricks_hash = XXH3_64bits(volume->bricks, (size_t)bb_volume_bytes(volume));
    XXH64_hash_t parts[2] = {
        XXH3_64bits(&volume->grid, sizeof volume->grid),
        volume->bricks_hash,
    };
    volume->hash = XXH3_64bits(parts, sizeof parts);
}

static bb_status fill(const bb_voxels *voxels, bb_volume *volume)
{
    bb_pool *pool;
    BB_TRY(bb_host_alloc(NULL, (size_t)bb_volume_bytes(volume), "bricks of a volume",
                         &volume->bricks));
    BB_TRY(bb_host_alloc(NULL, (size_t)volume->brick_count * sizeof *volume->ranges,
                         "ranges of bricks", &volume->ranges));
    BB_TRY(bb_pool_create(0, &pool));
    bb_parallel_for(pool, volume->brick_count, 64, make_bricks, &(job){voxels, volume});
    bb_pool_destroy(pool);
    set_hash(volume);
    return BB_OK;
}

bb_status bb_volume_make(const char *name, const bb_voxels *voxels, uint32_t side, bb_volume **out)
{
    bb_volume *volume = calloc(1, sizeof *volume);
    if (volume == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory for a volume", name);
    set_grid(voxels, side, volume);
    bb_status status = fill(voxels, volume);
    if (status != BB_OK) {
        bb_volume_free(volume);
        return status;
    }
    *out = volume;
    return BB_OK;
}

/* Reads voxel (x, y, z) from one of the bricks that store it. */
static size_t place_in_bricks(const bb_volume_grid *grid, const uint32_t voxel[3])
{
    const uint32_t along = grid->side + 1;
    uint32_t brick[3], in[3];
    for (int k = 0; k < 3; k++) {
        brick[k] = least(voxel[k] / grid->side, grid->bricks[k] - 1);
        in[k] = voxel[k] - brick[k] * grid->side;
    }
    size_t number = ((size_t)brick[2] * grid->bricks[1] + brick[1]) * grid->bricks[0] + brick[0];
    return number * bb_brick_voxels(grid->side) + ((size_t)in[2] * along + in[1]) * along + in[0];
}

bb_status bb_volume_turn(const bb_volume *volume, const char *name, bb_volume **out)
{
    const bb_volume_grid *grid = &volume->grid;
    bb_voxels turned = {.bytes = volume->bytes};
    for (int k = 0; k < 3; k++) {
        turned.dims[k] = grid->cells[k] + 1;
        turned.spacing[k] = (double)grid->cell[k];
    }
    BB_TRY(bb_voxels_reserve(name, grid->side, &turned));
    char *to = turned.values;
    uint32_t v[3];
    for (v[2] = turned.dims[2]; v[2]-- > 0;)
        for (v[1] = turned.dims[1]; v[1]-- > 0;)
            for (v[0] = turned.dims[0]; v[0]-- > 0; to += volume->bytes)
                memcpy(to, (const char *)volume->bricks + place_in_bricks(grid, v) * volume->bytes,
                       volume->bytes);
    bb_status status = bb_volume_make(name, &turned, grid->side, out);
    bb_voxels_free(&turned);
    if (status == BB_OK)
        bb_volume_set_transfer(*out, &volume->transfer);
    return status;
}

void bb_volume_free(bb_volume *volume)
{
    if (volume == NULL)
        return;
    bb_host_free(volume->bricks);
    bb_host_free(volume->ranges);
    free(volume);
}

uint64_t bb_volume_bytes(const bb_volume *volume)
{
    return volume->brick_count * brick_bytes(volume->grid.side, volume->bytes);
}

/* ---- visible bricks ---- */

double bb_volume_voxel(const bb_volume *volume)
{
    const float *cell = volume->grid.cell;
    return fminf(cell[0], fminf(cell[1], cell[2]));
}

void bb_volume_set_transfer(bb_volume *volume, const bb_transfer *transfer)
{
    bb_transfer_entry table[BB_TRANSFER_STEPS];
    volume->transfer = *transfer;
    bb_transfer_table(transfer, bb_volume_voxel(volume), table);
    volume->seen[0] = 0;
    for (uint32_t i = 0; i < BB_TRANSFER_STEPS; i++)
        volume->seen[i + 1] = volume->seen[i] + (table[i].extinction > 0);
}

uint32_t bb_volume_active(const bb_volume *volume, uint32_t *active)
{
    uint32_t count = 0;
    for (uint32_t brick = 0; brick < volume->brick_count; brick++) {
        uint32_t range = volume->ranges[brick];
        if (bb_volume_sees(volume, range & 0xFFFF, range >> 16))
            active[count++] = brick;
    }
    return count;
}

void bb_volume_brick_box(const bb_volume_grid *grid, uint32_t brick, float corners[6])
{
    uint32_t place[3];
    place_of(grid, brick, place);
    for (int k = 0; k < 3; k++) {
        corners[k] = bb_brick_lo(place[k], grid->side, grid->cell[k], grid->margin);
        corners[3 + k] =
            bb_brick_hi(place[k], grid->side, grid->cells[k], grid->cell[k], grid->margin);
    }
}
