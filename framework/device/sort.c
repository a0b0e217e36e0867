/* Radix sort on the device: planning, scratch and launches of the kernels in
 * kernels/sort_{cpu,gpu}.cl, which name their sources.
 *
 * GPU form: from the lowest digit up (LSD), everything enqueued at once. CPU form: into buckets by
 * the highest digit, then each bucket from its lowest digit up, in the cache of one compute unit. A
 * pass over all keys mostly waits for memory; passes over a bucket do not, and skip digits in which
 * its keys do not differ. If a bucket is so large that the other units would wait for the one that
 * sorts it (a small dense object in a large scene), the sort is LSD over all keys. The result of a
 * stable sort is the same either way. The device decides, and both ways are enqueued: launches
 * without work cost less than a query.
 */
#include "framework/device/primitives_private.h"
#include "framework/device/tally.h"

#include "kernels/sort_shared.h"

enum {
    DIGIT_BITS_CPU = 8, /* for passes over all keys */
    TOP_BITS = 12,      /* of the highest digit */
    TILE = 8192,   /* places whose buckets one work-item sorts: many fit the second-level cache */
    ALONE = 32768, /* pairs that one unit sorts faster than two units and several launches */
    BUCKET_SMALL = 16384, /* pairs that one unit sorts faster than several units start */
    PASSES_MAX = 16,
};

bb_status bb_primitives_create_sort(bb_primitives *self, const char *key, sort_kernels *sort)
{
    BB_TRY(bb_primitives_compile(self, "sort", key, &sort->program));
    BB_TRY(bb_kernel_get(sort->program, "sort_count", &sort->count));
    BB_TRY(bb_kernel_get(sort->program, "sort_scatter", &sort->scatter));
    if (self->gpu)
        return BB_OK;
    BB_TRY(bb_kernel_get(sort->program, "sort_choose", &sort->choose));
    BB_TRY(bb_kernel_get(sort->program, "sort_buckets", &sort->buckets));
    return bb_kernel_get(sort->program, "sort_alone", &sort->alone);
}

void bb_primitives_destroy_sort(sort_kernels *sort)
{
    bb_kernel_release(sort->count);
    bb_kernel_release(sort->scatter);
    bb_kernel_release(sort->choose);
    bb_kernel_release(sort->buckets);
    bb_kernel_release(sort->alone);
    bb_program_release(sort->program);
}

typedef struct sort_pass {
    uint32_t shift;
    uint32_t mask;
    uint32_t only; /* CPU form: SORT_... */
} sort_pass;

/* Plans an even number of passes, so that the result ends in place, with digits as equal as
 * possible. */
static uint32_t plan_passes(uint32_t bits, uint32_t widest, sort_pass passes[PASSES_MAX])
{
    uint32_t count = bb_divide_up(bits, widest);
    count += count % 2;
    for (uint32_t i = 0, shift = 0; i < count; i++) {
        uint32_t digit = bits / count + (i < bits % count);
        passes[i] = (sort_pass){shift, (1u << digit) - 1, SORT_PASSES};
        shift += digit;
    }
    return count;
}

/* Chunks or tiles of a sort. */
static chunking cut_sort(const bb_primitives *self, uint32_t count)
{
    if (!self->gpu)
        return bb_primitives_cut(self, count);
    uint32_t size = self->group * SORT_ITEMS;
    return (chunking){size, bb_divide_up(count, size)};
}

bb_status bb_primitives_reserve(bb_primitives *self, uint32_t count, uint32_t key_bytes)
{
    if (count == 0)
        return BB_OK;
    uint64_t digit_values = 1u << (self->gpu ? DIGIT_BITS_GPU : TOP_BITS);
    uint64_t counts = cut_sort(self, count).count * digit_values;
    if (counts > UINT32_MAX)
        return bb_fail(BB_REFUSED, "a sort of %u pairs in groups of %u needs %llu counters", count,
                       self->group, (unsigned long long)counts);
    BB_TRY(bb_primitives_scratch(self, (uint64_t)count * key_bytes, "a sort's keys", &self->keys));
    BB_TRY(bb_primitives_scratch(self, (uint64_t)count * sizeof(uint32_t), "a sort's values",
                                 &self->values));
    BB_TRY(
        bb_primitives_scratch(self, counts * sizeof(uint32_t), "a sort's counts", &self->counts));
    if (!self->gpu)
        BB_TRY(bb_primitives_scratch(self, sizeof(uint32_t), "a sort's way", &self->way));
    return bb_primitives_reserve_scan(self, (uint32_t)counts);
}

/* Pairs on the device. */
typedef struct pairs {
    const bb_buffer *keys;
    const bb_buffer *values;
} pairs;

/* Computes the places of each chunk's or tile's keys for each digit value: self->counts. */
static bb_status count_digit(bb_primitives *self, const sort_kernels *kernels, sort_pass pass,
                             uint32_t count, const bb_buffer *keys)
{
    bb_device *device = self->device;
    chunking chunks = cut_sort(self, count);
    size_t local = self->gpu ? self->group : 1;
    size_t global = chunks.count * local;
    if (self->gpu)
        BB_TRY(bb_launch(bb_tally_pass(device), kernels->count, global, local, BB_MEM(*keys),
                         BB_VALUE(count), BB_VALUE(pass.shift), BB_VALUE(pass.mask),
                         BB_MEM(self->counts)));
    else
        BB_TRY(bb_launch(device, kernels->count, global, local, BB_MEM(*keys), BB_VALUE(count),
                         BB_VALUE(chunks.size), BB_VALUE(pass.shift), BB_VALUE(pass.mask),
                         BB_VALUE(pass.only), BB_MEM(self->way), BB_MEM(self->counts)));
    return bb_scan_u32(self, &self->counts, &self->counts, chunks.count * (pass.mask + 1), NULL);
}

/* Moves the pairs to these places. */
static bb_status scatter(bb_primitives *self, const sort_kernels *kernels, sort_pass pass,
                         uint32_t count, pairs from, pairs to)
{
    bb_device *device = self->device;
    chunking chunks = cut_sort(self, count);
    if (self->gpu)
        return bb_launch(bb_tally_pass(device), kernels->scatter,
                         (size_t)chunks.count * self->group, self->group, BB_MEM(*from.keys),
                         BB_MEM(*from.values), BB_VALUE(count), BB_VALUE(pass.shift),
                         BB_VALUE(pass.mask), BB_MEM(self->counts), BB_MEM(*to.keys),
                         BB_MEM(*to.values));
    return bb_launch(device, kernels->scatter, chunks.count, 1, BB_MEM(*from.keys),
                     BB_MEM(*from.values), BB_VALUE(count), BB_VALUE(chunks.size),
                     BB_VALUE(pass.shift), BB_VALUE(pass.mask), BB_VALUE(pass.only),
                     BB_MEM(self->way), BB_MEM(self->counts), BB_MEM(*to.keys), BB_MEM(*to.values));
}

static bb_status sort_by_passes(bb_primitives *self, const sort_kernels *kernels, pairs place,
                                pairs scratch, uint32_t count, uint32_t bits)
{
    sort_pass passes[PASSES_MAX];
    uint32_t pass_count = plan_passes(bits, self->gpu ? DIGIT_BITS_GPU : DIGIT_BITS_CPU, passes);
    for (uint32_t i = 0; i < pass_count; i++) {
        pairs from = i % 2 == 0 ? place : scratch, to = i % 2 == 0 ? scratch : place;
        BB_TRY(count_digit(self, kernels, passes[i], count, from.keys));
        BB_TRY(scatter(self, kernels, passes[i], count, from, to));
        bb_tally_sort_pass(self->device);
    }
    return BB_OK;
}

/* Sorts `scratch`, which is in the order of its `buckets` buckets, into `place`. */
static bb_status sort_buckets(bb_primitives *self, const sort_kernels *kernels, pairs place,
                              pairs scratch, uint32_t count, uint32_t buckets)
{
    uint32_t chunks = cut_sort(self, count).count, tile = TILE;
    return bb_launch(self->device, kernels->buckets, bb_divide_up(count, TILE), 1,
                     BB_MEM(*scratch.keys), BB_MEM(*scratch.values), BB_VALUE(count),
                     BB_VALUE(tile), BB_MEM(self->counts), BB_VALUE(chunks), BB_VALUE(buckets),
                     BB_MEM(self->way), BB_MEM(*place.keys), BB_MEM(*place.values));
}

static bb_status sort_by_buckets(bb_primitives *self, const sort_kernels *kernels, pairs place,
                                 pairs scratch, uint32_t count, uint32_t bits)
{
    if (count <= ALONE)
        return bb_launch(self->device, kernels->alone, 1, 1, BB_MEM(*place.keys),
                         BB_MEM(*place.values), BB_VALUE(count), BB_MEM(*scratch.keys),
                         BB_MEM(*scratch.values));
    uint32_t top_bits = bits < TOP_BITS ? bits : TOP_BITS;
    sort_pass top = {bits - top_bits, (1u << top_bits) - 1, SORT_ANY};
    uint32_t chunks = cut_sort(self, count).count, buckets = top.mask + 1;
    uint32_t share = count / (2 * self->device->compute_units);
    uint32_t small_enough = share > BUCKET_SMALL ? share : BUCKET_SMALL;
    BB_TRY(count_digit(self, kernels, top, count, place.keys));
    BB_TRY(bb_launch(self->device, kernels->choose, 1, 1, BB_MEM(self->counts), BB_VALUE(count),
                     BB_VALUE(chunks), BB_VALUE(buckets), BB_VALUE(small_enough),
                     BB_MEM(self->way)));
    top.only = SORT_BUCKETS;
    BB_TRY(scatter(self, kernels, top, count, place, scratch));
    BB_TRY(sort_buckets(self, kernels, place, scratch, count, buckets));
    return count > small_enough ? sort_by_passes(self, kernels, place, scratch, count, bits)
                                : BB_OK;
}

static bb_status sort(bb_primitives *self, bb_buffer *keys, bb_buffer *values, uint32_t count,
                      uint32_t bits, uint32_t key_bytes)
{
    if (bits < 1 || bits > 8 * key_bytes)
        return bb_fail(BB_INVALID, "a sort by %u bits: keys of %u bytes have 1 to %u", bits,
                       key_bytes, 8 * key_bytes);
    if (count <= 1)
        return BB_OK;
    BB_TRY(bb_primitives_expect(keys, (uint64_t)count * key_bytes, "keys of a sort"));
    BB_TRY(bb_primitives_expect(values, (uint64_t)count * sizeof(uint32_t), "values of a sort"));
    BB_TRY(bb_primitives_reserve(self, count, key_bytes));

    const sort_kernels *kernels = key_bytes == 8 ? &self->sort64 : &self->sort32;
    pairs place = {keys, values}, scratch = {&self->keys, &self->values};
    if (self->gpu)
        return sort_by_passes(self, kernels, place, scratch, count, bits);
    return sort_by_buckets(self, kernels, place, scratch, count, bits);
}

bb_status bb_sort_u32(bb_primitives *primitives, bb_buffer *keys, bb_buffer *values, uint32_t count,
                      uint32_t bits)
{
    return sort(primitives, keys, values, count, bits, sizeof(uint32_t));
}

bb_status bb_sort_u64(bb_primitives *primitives, bb_buffer *keys, bb_buffer *values, uint32_t count,
                      uint32_t bits)
{
    return sort(primitives, keys, values, count, bits, sizeof(uint64_t));
}

bb_status bb_sort_keys(bb_primitives *primitives, uint32_t key_bytes, bb_buffer *keys,
                       bb_buffer *values, uint32_t count, uint32_t bits)
{
    if (bits == 0)
        return BB_OK;
    return key_bytes == 8 ? bb_sort_u64(primitives, keys, values, count, bits)
                          : bb_sort_u32(primitives, keys, values, count, bits);
}
