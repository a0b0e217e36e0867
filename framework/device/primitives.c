/* Scan and reduction on the device: planning, scratch and launches of the kernels in
 * kernels/{scan,reduce}_{cpu,gpu}.cl, which name their sources.
 *
 * CPU form: the input is cut into a few chunks per compute unit, each the work of one work-item.
 * GPU form: the input is cut into tiles, each the work of one group of `group` work-items.
 * In both, everything is enqueued at once: sizes depend on the count alone, never on the data.
 */
#include "framework/device/primitives_private.h"
#include "framework/device/tally.h"

#include "kernels/bb_shared.h"

#include <stdio.h>

enum {
    CHUNKS_PER_UNIT = 4,     /* enough that one slow core does not delay the others */
    CHUNK_SMALLEST = 2048,   /* elements: fewer are not worth a work-item */
    CHUNK_ALIGNMENT = 64,    /* elements: chunks don't share cache lines */
    SCAN_SERIAL_MAX = 32768, /* elements that one work-item scans faster than two more launches */
    SCAN_ITEMS = 8,          /* of scan_gpu.cl */
    SCAN_ALONE_MAX = 65536,  /* elements that one group scans faster than two more launches */
    GROUP_MAX = 256,
    REDUCE_GROUPS_PER_UNIT = 8,
};

/* ---- how the input is cut ---- */

chunking bb_primitives_cut(const bb_primitives *self, uint32_t count)
{
    uint32_t chunks = bb_divide_up(count, CHUNK_SMALLEST);
    uint32_t most = CHUNKS_PER_UNIT * self->device->compute_units;
    if (chunks > most)
        chunks = most;
    uint32_t size = bb_divide_up(count, chunks);
    size = bb_divide_up(size, CHUNK_ALIGNMENT) * CHUNK_ALIGNMENT;
    return (chunking){size, bb_divide_up(count, size)};
}

/* Returns the number of chunks or groups of a reduction, each of which leaves a partial result. */
static uint32_t reduce_groups_max(const bb_primitives *self)
{
    return (self->gpu ? REDUCE_GROUPS_PER_UNIT : CHUNKS_PER_UNIT) * self->device->compute_units;
}

bb_status bb_primitives_expect(const bb_buffer *buffer, uint64_t bytes, const char *what)
{
    if (buffer->mem != NULL && buffer->bytes >= bytes)
        return BB_OK;
    return bb_fail(BB_INVALID, "%s: the buffer has %zu bytes, %llu are needed", what, buffer->bytes,
                   (unsigned long long)bytes);
}

bb_status bb_primitives_scratch(bb_primitives *self, uint64_t bytes, const char *what,
                                bb_buffer *buffer)
{
    return bb_buffer_reserve(self->device, self->account, (size_t)bytes, what, buffer);
}

/* ---- create, destroy ---- */

/* Returns the largest power of two that fits the device's groups and local memory. */
static uint32_t choose_group(const bb_device *device)
{
    /* The kernel with the highest demand is sort_scatter with 64-bit keys: pairs, ranks and sums
     * per item, moves.
     */
    const uint64_t bytes_per_item = SORT_ITEMS * 12 + (1 << DIGIT_BITS_GPU) * 2 + 4;
    const uint64_t bytes_fixed = (1 << DIGIT_BITS_GPU) * 4;
    uint32_t group = GROUP_MAX;
    while (group > 1 && (group > device->max_group_size ||
                         group * bytes_per_item + bytes_fixed > device->local_bytes))
        group /= 2;
    return group;
}

bb_status bb_primitives_compile(bb_primitives *self, const char *stem, const char *key,
                                cl_program *program)
{
    char name[32], defines[64];
    snprintf(name, sizeof name, "%s_%s.cl", stem, self->gpu ? "gpu" : "cpu");
    snprintf(defines, sizeof defines, "-DBB_GROUP=%uu -DBB_KEY=%s", self->group, key);
    const bb_source *source = bb_source_find(name);
    if (source == NULL)
        return bb_fail(BB_FAILED, "the device source %s is not in the library", name);
    return bb_program_build(self->device, source, defines, program);
}

static bb_status create_scan(bb_primitives *self)
{
    BB_TRY(bb_primitives_compile(self, "scan", "uint", &self->scan_program));
    if (self->gpu) {
        BB_TRY(bb_kernel_get(self->scan_program, "scan_tiles", &self->scan_tiles));
        return bb_kernel_get(self->scan_program, "scan_add", &self->scan_add);
    }
    BB_TRY(bb_kernel_get(self->scan_program, "scan_sums", &self->scan_sums));
    BB_TRY(bb_kernel_get(self->scan_program, "scan_serial", &self->scan_serial));
    return bb_kernel_get(self->scan_program, "scan_chunks", &self->scan_chunks);
}

static bb_status create_all(bb_primitives *self)
{
    BB_TRY(create_scan(self));
    BB_TRY(bb_primitives_compile(self, "reduce", "uint", &self->reduce_program));
    BB_TRY(bb_kernel_get(self->reduce_program, "reduce_boxes", &self->reduce_boxes));
    BB_TRY(bb_kernel_get(self->reduce_program, "reduce_partials", &self->reduce_partials));
    BB_TRY(bb_primitives_create_sort(self, "uint", &self->sort32));
    BB_TRY(bb_primitives_create_sort(self, "ulong", &self->sort64));
    BB_TRY(bb_primitives_scratch(self, (uint64_t)reduce_groups_max(self) * 2 * sizeof(bb_box),
                                 "a reduction's partials", &self->partials));
    return bb_primitives_scratch(self, sizeof(uint32_t), "the scan's total", &self->unwanted);
}

bb_status bb_primitives_create(bb_device *device, bb_account *account, bb_primitives **out)
{
    bb_primitives *self = NULL;
    BB_TRY(bb_host_alloc(account, sizeof *self, "the parallel primitives", &self));
    *self = (bb_primitives){
        .device = device,
        .account = account,
        .gpu = device->form == BB_FORM_GPU,
        .group = choose_group(device),
    };
    bb_status status = create_all(self);
    if (status != BB_OK) {
        bb_primitives_destroy(self);
        return status;
    }
    *out = self;
    return BB_OK;
}

void bb_primitives_destroy(bb_primitives *self)
{
    if (self == NULL)
        return;
    bb_kernel_release(self->scan_sums);
    bb_kernel_release(self->scan_serial);
    bb_kernel_release(self->scan_chunks);
    bb_kernel_release(self->scan_tiles);
    bb_kernel_release(self->scan_add);
    bb_program_release(self->scan_program);
    bb_kernel_release(self->reduce_boxes);
    bb_kernel_release(self->reduce_partials);
    bb_program_release(self->reduce_program);
    bb_primitives_destroy_sort(&self->sort32);
    bb_primitives_destroy_sort(&self->sort64);
    bb_buffer_release(&self->unwanted);
    for (uint32_t level = 0; level < SCAN_LEVELS_MAX; level++)
        bb_buffer_release(&self->scan_level[level]);
    bb_buffer_release(&self->partials);
    bb_buffer_release(&self->counts);
    bb_buffer_release(&self->way);
    bb_buffer_release(&self->keys);
    bb_buffer_release(&self->values);
    bb_host_free(self);
}

/* ---- scan ---- */

bb_status bb_primitives_reserve_scan(bb_primitives *self, uint32_t count)
{
    if (!self->gpu)
        return bb_primitives_scratch(
            self, (uint64_t)bb_primitives_cut(self, count).count * sizeof(uint32_t),
            "a scan's sums", &self->scan_level[0]);
    uint32_t tiles = count;
    for (uint32_t level = 0; level < SCAN_LEVELS_MAX; level++) {
        tiles = bb_divide_up(tiles, self->group * SCAN_ITEMS);
        if (tiles == 1)
            break;
        BB_TRY(bb_primitives_scratch(self, (uint64_t)tiles * sizeof(uint32_t), "a scan's sums",
                                     &self->scan_level[level]));
    }
    return BB_OK;
}

static bb_status scan_by_chunks(bb_primitives *self, const bb_buffer *in, bb_buffer *out,
                                uint32_t count, bb_buffer *total)
{
    bb_device *device = self->device;
    if (count <= SCAN_SERIAL_MAX)
        return bb_launch(device, self->scan_serial, 1, 1, BB_MEM(*in), BB_MEM(*out),
                         BB_VALUE(count), BB_MEM(*total));
    chunking chunks = bb_primitives_cut(self, count);
    bb_buffer *sums = &self->scan_level[0];
    BB_TRY(bb_launch(device, self->scan_sums, chunks.count, 1, BB_MEM(*in), BB_VALUE(count),
                     BB_VALUE(chunks.size), BB_MEM(*sums)));
    BB_TRY(bb_launch(device, self->scan_serial, 1, 1, BB_MEM(*sums), BB_MEM(*sums),
                     BB_VALUE(chunks.count), BB_MEM(*total)));
    return bb_launch(device, self->scan_chunks, chunks.count, 1, BB_MEM(*in), BB_MEM(*out),
                     BB_VALUE(count), BB_VALUE(chunks.size), BB_MEM(*sums));
}

/* Scans down the levels until a level is one tile, whose sum is the total, then adds back up. */
static bb_status scan_by_tiles(bb_primitives *self, const bb_buffer *in, bb_buffer *out,
                               uint32_t count, bb_buffer *total)
{
    bb_device *device = self->device;
    uint32_t counts[SCAN_LEVELS_MAX + 1] = {count};
    uint32_t level = 0;
    for (;; level++) {
        uint32_t tiles = bb_divide_up(counts[level], self->group * SCAN_ITEMS), each = 1;
        if (counts[level] <= SCAN_ALONE_MAX) {
            each = tiles;
            tiles = 1;
        }
        bb_buffer *sums = tiles > 1 ? &self->scan_level[level] : total;
        const bb_buffer *from = level == 0 ? in : &self->scan_level[level - 1];
        const bb_buffer *to = level == 0 ? out : &self->scan_level[level - 1];
        BB_TRY(bb_launch(bb_tally_pass(device), self->scan_tiles, (size_t)tiles * self->group,
                         self->group, BB_MEM(*from), BB_MEM(*to), BB_VALUE(counts[level]),
                         BB_VALUE(each), BB_MEM(*sums)));
        if (tiles == 1)
            break;
        counts[level + 1] = tiles;
    }
    while (level-- > 0) {
        const bb_buffer *to = level == 0 ? out : &self->scan_level[level - 1];
        BB_TRY(bb_launch(bb_tally_pass(device), self->scan_add,
                         (size_t)counts[level + 1] * self->group, self->group, BB_MEM(*to),
                         BB_VALUE(counts[level]), BB_MEM(self->scan_level[level])));
    }
    return BB_OK;
}

bb_status bb_scan_u32(bb_primitives *self, const bb_buffer *in, bb_buffer *out, uint32_t count,
                      bb_buffer *total)
{
    if (total == NULL)
        total = &self->unwanted;
    BB_TRY(bb_primitives_expect(total, sizeof(uint32_t), "total of a scan"));
    if (count == 0)
        return bb_buffer_fill(total, sizeof(uint32_t), 0);
    BB_TRY(bb_primitives_expect(in, (uint64_t)count * sizeof(uint32_t), "input of a scan"));
    BB_TRY(bb_primitives_expect(out, (uint64_t)count * sizeof(uint32_t), "output of a scan"));
    BB_TRY(bb_primitives_reserve_scan(self, count));
    return self->gpu ? scan_by_tiles(self, in, out, count, total)
                     : scan_by_chunks(self, in, out, count, total);
}

/* ---- reduction ---- */

static bb_status reduce_by_chunks(bb_primitives *self, const bb_buffer *boxes, uint32_t count,
                                  bb_buffer *out)
{
    chunking chunks = bb_primitives_cut(self, count);
    BB_TRY(bb_launch(self->device, self->reduce_boxes, chunks.count, 1, BB_MEM(*boxes),
                     BB_VALUE(count), BB_VALUE(chunks.size), BB_MEM(self->partials)));
    return bb_launch(self->device, self->reduce_partials, 1, 1, BB_MEM(self->partials),
                     BB_VALUE(chunks.count), BB_MEM(*out));
}

static bb_status reduce_by_groups(bb_primitives *self, const bb_buffer *boxes, uint32_t count,
                                  bb_buffer *out)
{
    uint32_t groups = bb_divide_up(count, self->group);
    if (groups > reduce_groups_max(self))
        groups = reduce_groups_max(self);
    BB_TRY(bb_launch(bb_tally_pass(self->device), self->reduce_boxes, (size_t)groups * self->group,
                     self->group, BB_MEM(*boxes), BB_VALUE(count), BB_MEM(self->partials)));
    return bb_launch(bb_tally_pass(self->device), self->reduce_partials, self->group, self->group,
                     BB_MEM(self->partials), BB_VALUE(groups), BB_MEM(*out));
}

bb_status bb_reduce_boxes(bb_primitives *self, const bb_buffer *boxes, uint32_t count,
                          bb_buffer *out)
{
    if (count == 0)
        return bb_fail(BB_INVALID, "a reduction needs at least one box");
    BB_TRY(bb_primitives_expect(boxes, (uint64_t)count * sizeof(bb_box), "boxes of a reduction"));
    BB_TRY(bb_primitives_expect(out, 2 * sizeof(bb_box), "output of a reduction"));
    return self->gpu ? reduce_by_groups(self, boxes, count, out)
                     : reduce_by_chunks(self, boxes, count, out);
}
