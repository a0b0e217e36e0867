/* Scan, reduction and sort of both forms against plain host code, bit for bit.
 *
 * BVHBENCH_TEST_SEED=N takes another seed than the fixed one. BVHBENCH_TEST_SMALL=1 keeps all
 * counts at 2000 or less, for runs under oclgrind, which must leave FILE empty:
 *
 *     BVHBENCH_TEST_SMALL=1 oclgrind --log FILE --data-races --uninitialized test_primitives
 *
 * oclgrind 21.10 takes a write to part of a buffer, a fill, and a buffer that has the number of a
 * smaller one released before for uninitialised. So buffers are written whole, and a small run
 * makes all scratch at the start and skips the tests that are about growing.
 */
#include "framework/base/random.h"
#include "framework/device/primitives.h"
#include "kernels/bb_shared.h"
#include "tests/device_fixture.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT_SMALL = 2000, GUARD = 16 };
static const uint32_t guard_pattern = 0xA5A5A5A5u;

/* What is tested: a form with the group size that the device gives, or with a smaller one. */
typedef struct subject {
    const char *name;
    bb_form form;
    size_t group; /* 0: the device's own */
    uint32_t count_max;
    bb_device *device;
    bb_account account;
    bb_primitives *primitives;
} subject;

static subject subjects[] = {
    {.name = "cpu form", .form = BB_FORM_CPU, .count_max = 1000003},
    {.name = "gpu form", .form = BB_FORM_GPU, .count_max = 65537},
    {.name = "gpu form, groups of 8", .form = BB_FORM_GPU, .group = 8, .count_max = 5000},
    {.name = "gpu form, groups of 1", .form = BB_FORM_GPU, .group = 1, .count_max = 1000},
};
enum { SUBJECTS = sizeof subjects / sizeof subjects[0] };

static bool small;

#define require_ok(expression)                                                                     \
    do {                                                                                           \
        if ((expression) != BB_OK)                                                                 \
            fail_msg("%s: %s", #expression, bb_message());                                         \
    } while (0)

static bool too_big(const subject *s, uint32_t count)
{
    return count > s->count_max || (small && count > COUNT_SMALL);
}

static void *allocate(size_t bytes)
{
    void *pointer = malloc(bytes + 1);
    assert_non_null(pointer);
    return pointer;
}

/* Makes all the scratch that counts up to `count` need. */
static void grow_scratch(const subject *s, uint32_t count)
{
    uint32_t *zeros = calloc(count, sizeof *zeros);
    assert_non_null(zeros);
    bb_buffer buffer = {0};
    require_ok(bb_primitives_reserve(s->primitives, count, 8));
    require_ok(bb_buffer_reserve(s->device, NULL, count * sizeof *zeros, "test", &buffer));
    require_ok(bb_buffer_write(&buffer, 0, count * sizeof *zeros, zeros));
    require_ok(bb_scan_u32(s->primitives, &buffer, &buffer, count, NULL));
    bb_buffer_release(&buffer);
    free(zeros);
}

static int open_subjects(void **state)
{
    (void)state;
    seed = seed_or(20240607);
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    print_message("seed %llu%s\n", (unsigned long long)seed, small ? ", small" : "");
    for (subject *s = subjects; s < subjects + SUBJECTS; s++) {
        require_ok(open_test_device(s->form, NULL, &s->device));
        if (s->group != 0)
            s->device->max_group_size = s->group;
        require_ok(bb_primitives_create(s->device, &s->account, &s->primitives));
        if (small)
            grow_scratch(s, COUNT_SMALL);
    }
    return 0;
}

/* Everything goes back: the accounts end at 0. */
static int close_subjects(void **state)
{
    (void)state;
    int left = 0;
    for (subject *s = subjects; s < subjects + SUBJECTS; s++) {
        bb_primitives_destroy(s->primitives);
        left += s->account.bytes != 0 || s->device->bytes != 0;
        bb_device_close(s->device);
    }
    return left;
}

/* A buffer of `bytes` of `source` and a guard behind them. */
static bb_buffer upload(const subject *s, const void *source, size_t bytes)
{
    const size_t whole = bytes + GUARD * sizeof guard_pattern;
    char *data = allocate(whole);
    memcpy(data, source, bytes);
    for (size_t at = bytes; at < whole; at += sizeof guard_pattern)
        memcpy(data + at, &guard_pattern, sizeof guard_pattern);
    bb_buffer buffer = {0};
    require_ok(bb_buffer_reserve(s->device, NULL, whole, "test", &buffer));
    require_ok(bb_buffer_write(&buffer, 0, whole, data));
    free(data);
    return buffer;
}

/* Reads back what upload() made and releases it; false if the guard was written to. */
static bool download(bb_buffer *buffer, void *target, size_t bytes)
{
    uint32_t guard[GUARD];
    require_ok(bb_buffer_read(buffer, 0, bytes, target));
    require_ok(bb_buffer_read(buffer, bytes, sizeof guard, guard));
    bb_buffer_release(buffer);
    for (uint32_t i = 0; i < GUARD; i++)
        if (guard[i] != guard_pattern)
            return false;
    return true;
}

/* ---- sort ---- */

typedef enum pattern {
    RANDOM,
    ALL_EQUAL,
    SORTED,
    REVERSED,
    FEW_DISTINCT,
    ALL_ZERO,
    ALL_ONES,
    EXTREMES, /* 0 and all ones in `bits`, mixed */
    LOW_BIT,  /* differ in the lowest bit only */
    HIGH_BIT, /* differ in the highest bit only */
    ONE_FAR,  /* all but one in the lower half of the bits: one bucket holds the others */
    HALVES,   /* few values of the upper half of the bits, any of the lower: long runs */
    LADDER,   /* buckets of growing sizes: every length up to what the count allows */
    CLUSTERS, /* two, far apart, of keys that differ in the lowest bits only */
    CROWDED,  /* few values of the highest bits, any of the others: large buckets, long keys */
    PATTERNS,
} pattern;

static const char *const pattern_names[PATTERNS] = {
    "random",   "all equal", "sorted",   "reversed", "few distinct",
    "all zero", "all ones",  "extremes", "low bit",  "high bit",
    "one far",  "halves",    "ladder",   "clusters", "crowded",
};

typedef struct pair {
    uint64_t key;
    uint32_t index;
    uint32_t value;
} pair;

static int compare_pairs(const void *a, const void *b)
{
    const pair *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->index < y->index ? -1 : x->index > y->index;
}

static uint64_t make_key(pattern pattern, uint32_t bits, uint32_t i, uint32_t count,
                         bb_random *random)
{
    const uint64_t ones = UINT64_MAX >> (64 - bits);
    const uint64_t any = bb_random_u64(random);
    switch (pattern) {
    case ALL_EQUAL:
        return 0x5DEECE66D1234567u & ones;
    case SORTED:
        return ones / count * i;
    case REVERSED:
        return ones / count * (count - 1 - i);
    case FEW_DISTINCT:
        return bb_random_mix(any % 5) & ones;
    case ALL_ZERO:
        return 0;
    case ALL_ONES:
        return ones;
    case EXTREMES:
        return any >> 63 ? ones : 0;
    case LOW_BIT:
        return (0x5DEECE66D1234566u | any >> 63) & ones;
    case HIGH_BIT:
        return ones & (0x5DEECE66D1234567u >> (64 - bits) | (any >> 63) << (bits - 1));
    case ONE_FAR:
        return i == count / 2 ? ones : any & ones >> bits / 2;
    case HALVES:
        return (any & ones >> bits / 2) | ((bb_random_mix(any >> 61) & ones) & ~(ones >> bits / 2));
    case LADDER: { /* the upper half counts 1, 2, 2, 3, 3, 3 ... */
        uint64_t step = (uint64_t)sqrt(2.0 * i);
        return (bits > 24 ? step << (bits - 12) : step) & ones & ~(any & ones >> bits / 2);
    }
    case CLUSTERS:
        return (any >> 63) << (bits - 1) | (any & ones >> (bits - (bits + 7) / 8));
    case CROWDED:
        return bits > 12 ? any & ones & ~(UINT64_C(0x1FF) << (bits - 12)) : any & ones;
    case RANDOM:
    case PATTERNS:
        break;
    }
    return any & ones;
}

static void sort_on_device(const subject *s, uint32_t key_bytes, bb_buffer *keys, bb_buffer *values,
                           uint32_t count, uint32_t bits)
{
    if (key_bytes == 8)
        require_ok(bb_sort_u64(s->primitives, keys, values, count, bits));
    else
        require_ok(bb_sort_u32(s->primitives, keys, values, count, bits));
}

static void *narrow_keys(const pair *pairs, uint32_t count, uint32_t key_bytes)
{
    void *keys = allocate((size_t)count * key_bytes);
    for (uint32_t i = 0; i < count; i++)
        if (key_bytes == 8)
            ((uint64_t *)keys)[i] = pairs[i].key;
        else
            ((uint32_t *)keys)[i] = (uint32_t)pairs[i].key;
    return keys;
}

/* Sorts these keys, with random values. */
static void check_keys(const subject *s, uint32_t key_bytes, const char *what, uint32_t bits,
                       uint32_t count, const uint64_t *wide)
{
    bb_random random = bb_random_make(seed, count);
    pair *pairs = allocate(count * sizeof *pairs);
    uint32_t *values = allocate(count * sizeof *values);
    for (uint32_t i = 0; i < count; i++) {
        values[i] = (uint32_t)bb_random_u64(&random);
        pairs[i] = (pair){wide[i], i, values[i]};
    }
    void *keys = narrow_keys(pairs, count, key_bytes);
    bb_buffer keys_device = upload(s, keys, (size_t)count * key_bytes);
    bb_buffer values_device = upload(s, values, count * sizeof *values);
    free(keys);
    sort_on_device(s, key_bytes, &keys_device, &values_device, count, bits);

    qsort(pairs, count, sizeof *pairs, compare_pairs);
    void *expected = narrow_keys(pairs, count, key_bytes);
    keys = allocate((size_t)count * key_bytes);
    bool guarded = download(&keys_device, keys, (size_t)count * key_bytes);
    guarded &= download(&values_device, values, count * sizeof *values);
    bool right = memcmp(keys, expected, (size_t)count * key_bytes) == 0;
    uint32_t at = 0;
    while (at < count && values[at] == pairs[at].value)
        at++;
    free(keys);
    free(expected);
    free(values);
    free(pairs);
    if (!guarded || !right || at < count)
        fail_msg("sort, %s: %s, %u-byte keys, %u bits, count %u, seed %llu: keys %s, first wrong "
                 "value %u, %s the end",
                 s->name, what, key_bytes, bits, count, (unsigned long long)seed,
                 right ? "right" : "wrong", at,
                 guarded ? "nothing written beyond" : "wrote beyond");
}

static void check_sort(const subject *s, uint32_t key_bytes, pattern pattern, uint32_t bits,
                       uint32_t count)
{
    bb_random random = bb_random_make(seed, (uint64_t)pattern << 48 | (uint64_t)bits << 40 | count);
    uint64_t *wide = allocate(count * sizeof *wide);
    for (uint32_t i = 0; i < count; i++)
        wide[i] = make_key(pattern, bits, i, count, &random);
    check_keys(s, key_bytes, pattern_names[pattern], bits, count, wide);
    free(wide);
}

static void sorts_like_a_stable_host_sort(void **state)
{
    (void)state;
    static const uint32_t all_counts[] = {0,     1,     2,     3,     63,    64,     65,
                                          255,   256,   257,   1000,  2049,  8192,   8193,
                                          16385, 16449, 32768, 32769, 65537, 1000003};
    static const uint32_t some_counts[] = {0, 1, 65, 257, 700};
    static const uint32_t all_bits[] = {1, 8, 9, 30, 31, 32, 63, 64};
    static const uint32_t some_bits[] = {1, 9, 32};
    const uint32_t *counts = small ? some_counts : all_counts;
    const uint32_t *bits = small ? some_bits : all_bits;
    const uint32_t counts_count = small ? 5 : sizeof all_counts / sizeof *all_counts,
                   bits_count = small ? 3 : 8;
    for (const subject *s = subjects; s < subjects + SUBJECTS; s++)
        for (uint32_t c = 0; c < counts_count; c++)
            for (uint32_t b = 0; b < bits_count; b++)
                for (uint32_t p = 0; p < PATTERNS; p++) {
                    bool large = counts[c] > 100000; /* takes long on the host */
                    bool quick = p <= FEW_DISTINCT || p >= ONE_FAR;
                    if (too_big(s, counts[c]) || (large && (bits[b] % 32 < 30 || !quick)))
                        continue;
                    if (small && (p != (bits[b] < 32 ? EXTREMES : RANDOM) ||
                                  (s->group == 1 && counts[c] > 257)))
                        continue;
                    if (bits[b] <= 32)
                        check_sort(s, 4, (pattern)p, bits[b], counts[c]);
                    if (!large || bits[b] > 32)
                        check_sort(s, 8, (pattern)p, bits[b], counts[c]);
                }
    if (small) /* the many passes of long keys, once per form */
        for (const subject *s = subjects; s < subjects + 2; s++)
            check_sort(s, 8, RANDOM, 63, COUNT_SMALL);
}

static void sorts_again_with_other_counts(void **state)
{
    (void)state;
    for (const subject *s = subjects; s < subjects + SUBJECTS; s++) {
        bb_random random = bb_random_make(seed, 1);
        for (uint32_t round = 0; round < (small ? 4u : 40u); round++) {
            uint32_t most = small ? 600 : s->count_max < 20000 ? s->count_max : 20000;
            uint32_t count = bb_random_below(&random, most);
            uint32_t key_bytes = round % 2 ? 8 : 4;
            uint32_t bits = 1 + bb_random_below(&random, 8 * key_bytes);
            check_sort(s, key_bytes, RANDOM, bits, count);
        }
    }
}

/* Buckets whose sizes are next to those at which another way is taken, and counts likewise; of the
 * lower bits a run of any length differs, none, or one digit of several. */
static void sorts_buckets_of_all_sizes(void **state)
{
    (void)state;
    static const uint32_t borders[] = {1, 1023, 1024, 1025, 2048, 8191, 8192, 8193, 16384, 16385};
    enum { BORDERS = sizeof borders / sizeof borders[0] };
    if (small)
        skip();
    for (uint32_t round = 0; round < 60; round++) {
        bb_random random = bb_random_make(seed, 1000 + round);
        const uint32_t key_bytes = round % 2 ? 8 : 4,
                       bits = 1 + bb_random_below(&random, 8 * key_bytes),
                       top = bits < 12 ? bits : 12, low = bits - top,
                       count = borders[bb_random_below(&random, BORDERS)] *
                                   (1 + bb_random_below(&random, 6)) +
                               bb_random_below(&random, 3) - 1;
        uint64_t *wide = allocate(((size_t)count + 1) * sizeof *wide);
        uint64_t bucket = 0, fixed = 0, differ = 0;
        for (uint32_t i = 0, left = 0; i < count; i++, left--) {
            if (left == 0) {
                left = borders[bb_random_below(&random, BORDERS)];
                bucket += 1 + bb_random_below(&random, 3);
                fixed = bb_random_u64(&random);
                differ = bb_random_u64(&random) >> bb_random_below(&random, 64)
                                                       << bb_random_below(&random, 64);
                if (bb_random_below(&random, 2) == 0)
                    differ &= 0xFF801ull << bb_random_below(&random, 40);
            }
            uint64_t any = (fixed & ~differ) | (bb_random_u64(&random) & differ);
            any &= low == 0 ? 0 : UINT64_MAX >> (64 - low);
            wide[i] = (bucket & ((1u << top) - 1)) << low | any;
        }
        if (bb_random_below(&random, 2) == 0) /* else in the order of their buckets */
            for (uint32_t i = count; i > 1; i--) {
                const uint32_t k = bb_random_below(&random, i);
                const uint64_t other = wide[i - 1];
                wide[i - 1] = wide[k];
                wide[k] = other;
            }
        for (const subject *s = subjects; s < subjects + SUBJECTS; s++)
            if (!too_big(s, count))
                check_keys(s, key_bytes, "buckets", bits, count, wide);
        free(wide);
    }
}

/* Scratch grows between launches that are still under way. */
static void grows_while_work_is_enqueued(void **state)
{
    (void)state;
    if (small)
        skip();
    enum { SORTS = 6 };
    for (const subject *s = subjects; s < subjects + SUBJECTS; s++) {
        bb_account account = {0};
        bb_primitives *primitives;
        require_ok(bb_primitives_create(s->device, &account, &primitives));
        bb_buffer keys[SORTS], values[SORTS];
        uint32_t counts[SORTS];
        for (uint32_t k = 0; k < SORTS; k++) {
            counts[k] = 150 * (k + 1) * (k + 1);
            if (too_big(s, counts[k]))
                counts[k] = 1000;
            uint32_t *descending = allocate(counts[k] * sizeof *descending);
            for (uint32_t i = 0; i < counts[k]; i++)
                descending[i] = counts[k] - 1 - i;
            keys[k] = upload(s, descending, counts[k] * sizeof *descending);
            values[k] = upload(s, descending, counts[k] * sizeof *descending);
            free(descending);
        }
        for (uint32_t k = 0; k < SORTS; k++)
            require_ok(bb_sort_u32(primitives, &keys[k], &values[k], counts[k], 20));
        for (uint32_t k = 0; k < SORTS; k++) {
            uint32_t *sorted = allocate(counts[k] * sizeof *sorted);
            for (uint32_t half = 0; half < 2; half++) {
                bb_buffer *buffer = half == 0 ? &keys[k] : &values[k];
                assert_true(download(buffer, sorted, counts[k] * sizeof *sorted));
                for (uint32_t i = 0; i < counts[k]; i++)
                    if (sorted[i] != i)
                        fail_msg("%s: sort %u of %u pairs, place %u holds %u", s->name, k,
                                 counts[k], i, sorted[i]);
            }
            free(sorted);
        }
        bb_primitives_destroy(primitives);
        assert_int_equal(account.bytes, 0);
    }
}

static void reserves_all_that_a_sort_needs(void **state)
{
    (void)state;
    if (small)
        skip();
    for (const subject *s = subjects; s < subjects + SUBJECTS; s++) {
        const uint32_t count = 1000;
        bb_account account = {0};
        bb_primitives *primitives;
        require_ok(bb_primitives_create(s->device, &account, &primitives));
        require_ok(bb_primitives_reserve(primitives, 0, 8));
        require_ok(bb_primitives_reserve(primitives, count, 8));
        const uint64_t reserved = account.bytes;
        assert_true(reserved >= count * 12);
        uint64_t *zeros = calloc(count, sizeof *zeros);
        assert_non_null(zeros);
        bb_buffer keys = upload(s, zeros, count * sizeof *zeros);
        bb_buffer values = upload(s, zeros, count * sizeof(uint32_t));
        require_ok(bb_sort_u64(primitives, &keys, &values, count, 63));
        require_ok(bb_sort_u32(primitives, &keys, &values, count, 30));
        assert_int_equal(account.bytes, reserved);
        assert_true(download(&keys, zeros, count * sizeof *zeros));
        assert_true(download(&values, zeros, count * sizeof(uint32_t)));
        free(zeros);
        bb_primitives_destroy(primitives);
        assert_int_equal(account.bytes, 0);
    }
}

/* ---- scan ---- */

/* In place, and with or without a total, by turns. */
static void check_scan(const subject *s, uint32_t count, uint32_t mask, bool in_place,
                       bool with_total)
{
    bb_random random = bb_random_make(seed, (uint64_t)mask << 32 | count);
    uint32_t *values = allocate(count * sizeof *values);
    uint32_t *result = allocate(count * sizeof *result);
    for (uint32_t i = 0; i < count; i++)
        values[i] = mask == UINT32_MAX - 1 ? UINT32_MAX : (uint32_t)bb_random_u64(&random) & mask;
    uint32_t total = 12345;
    bb_buffer in = upload(s, values, count * sizeof *values);
    bb_buffer out = in_place ? in : upload(s, values, count * sizeof *values);
    bb_buffer total_device = upload(s, &total, sizeof total);
    require_ok(bb_scan_u32(s->primitives, &in, &out, count, with_total ? &total_device : NULL));

    bool guarded = download(&out, result, count * sizeof *result);
    guarded &= download(&total_device, &total, sizeof total);
    uint32_t running = 0, at = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (at == i && result[i] == running)
            at++;
        running += values[i];
    }
    bool kept = true;
    if (!in_place) {
        guarded &= download(&in, result, count * sizeof *result);
        kept = memcmp(result, values, count * sizeof *result) == 0;
    }
    free(values);
    free(result);
    if (!guarded || !kept || at < count || total != (with_total ? running : 12345))
        fail_msg("scan, %s: count %u, mask %#x, %s, %s total, seed %llu: first wrong at %u, total "
                 "%u instead of %u, input %s, %s the end",
                 s->name, count, mask, in_place ? "in place" : "apart",
                 with_total ? "with" : "without", (unsigned long long)seed, at, total, running,
                 kept ? "kept" : "changed", guarded ? "nothing written beyond" : "wrote beyond");
}

static void scans_like_the_host(void **state)
{
    (void)state;
    static const uint32_t counts[] = {0,    1,    2,    3,    7,    8,     9,     63,    64,
                                      65,   255,  256,  257,  511,  513,   1000,  2047,  2048,
                                      2049, 4096, 5000, 8191, 8193, 16384, 16385, 65537, 1000003};
    static const uint32_t masks[] = {1, 0xFFFF, UINT32_MAX, UINT32_MAX - 1 /* all ones */};
    for (const subject *s = subjects; s < subjects + SUBJECTS; s++)
        for (uint32_t c = 0; c < sizeof counts / sizeof counts[0]; c++)
            for (uint32_t m = 0; m < 4; m++)
                if (!too_big(s, counts[c])) {
                    check_scan(s, counts[c], masks[m], m % 2 == 0, m < 2);
                    if (!small)
                        check_scan(s, counts[c], masks[m], m % 2 != 0, m >= 2);
                }
}

/* ---- reduction ---- */

typedef enum box_kind { UNIT, HUGE_BOXES, DENORMAL, NEGATIVE, SIGNED_ZERO, BOX_KINDS } box_kind;

static float make_coordinate(box_kind kind, bb_random *random)
{
    const float unit = (float)bb_random_range(random, -1, 1);
    switch (kind) {
    case HUGE_BOXES:
        return bb_random_below(random, 8) == 0 ? copysignf(FLT_MAX, unit) : unit * FLT_MAX;
    case DENORMAL:
        return copysignf((float)bb_random_below(random, 9) * 0x1p-149f, unit);
    case NEGATIVE:
        return -1000.0f + unit;
    case SIGNED_ZERO:
        return copysignf(0.0f, unit);
    case UNIT:
    case BOX_KINDS:
        break;
    }
    return unit;
}

static bb_box make_box(box_kind kind, bb_random *random)
{
    /* The pads hold NaN: nothing may depend on them. */
    bb_box box = {.pad0 = 0x7FC00001u, .pad1 = 0xFFC00001u};
    for (int axis = 0; axis < 3; axis++) {
        float a = make_coordinate(kind, random), b = make_coordinate(kind, random);
        box.lo[axis] = a < b ? a : b;
        box.hi[axis] = a < b ? b : a;
    }
    return box;
}

static void include(bb_box *box, int axis, float lo, float hi)
{
    box->lo[axis] = lo < box->lo[axis] ? lo : box->lo[axis];
    box->hi[axis] = hi > box->hi[axis] ? hi : box->hi[axis];
}

static void reduce_on_host(const bb_box *boxes, uint32_t count, bb_box out[2])
{
    const bb_box empty = {.lo = {INFINITY, INFINITY, INFINITY},
                          .hi = {-INFINITY, -INFINITY, -INFINITY}};
    out[0] = out[1] = empty;
    for (uint32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float lo = boxes[i].lo[axis], hi = boxes[i].hi[axis];
            float centre = 0.5f * lo + 0.5f * hi;
            include(&out[0], axis, lo, hi);
            include(&out[1], axis, centre, centre);
        }
    for (int k = 0; k < 2; k++)
        for (int axis = 0; axis < 3; axis++) {
            out[k].lo[axis] += 0.0f; /* zeros come out as +0 */
            out[k].hi[axis] += 0.0f;
        }
}

static void check_reduce(const subject *s, box_kind kind, uint32_t count)
{
    static const char *const names[BOX_KINDS] = {"unit", "huge", "denormal", "negative",
                                                 "signed zero"};
    bb_random random = bb_random_make(seed, (uint64_t)kind << 32 | count);
    bb_box *boxes = allocate(count * sizeof *boxes);
    for (uint32_t i = 0; i < count; i++)
        boxes[i] = make_box(kind, &random);
    bb_box expected[2], result[2];
    memset(result, 0xEE, sizeof result);
    reduce_on_host(boxes, count, expected);
    bb_buffer in = upload(s, boxes, count * sizeof *boxes);
    bb_buffer out = upload(s, result, sizeof result);
    require_ok(bb_reduce_boxes(s->primitives, &in, count, &out));
    bool guarded = download(&out, result, sizeof result);
    bb_buffer_release(&in);
    free(boxes);
    for (int k = 0; k < 2; k++)
        if (!guarded || memcmp(&expected[k], &result[k], sizeof result[k]) != 0)
            fail_msg("reduction, %s: %s boxes, count %u, seed %llu: the box of the %s is "
                     "(%a %a %a) (%a %a %a), not (%a %a %a) (%a %a %a)",
                     s->name, names[kind], count, (unsigned long long)seed,
                     k == 0 ? "boxes" : "centroids", result[k].lo[0], result[k].lo[1],
                     result[k].lo[2], result[k].hi[0], result[k].hi[1], result[k].hi[2],
                     expected[k].lo[0], expected[k].lo[1], expected[k].lo[2], expected[k].hi[0],
                     expected[k].hi[1], expected[k].hi[2]);
}

static void reduces_like_the_host(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 63, 64, 65, 255, 256, 257, 1000, 5000, 65537};
    for (const subject *s = subjects; s < subjects + SUBJECTS; s++)
        for (uint32_t c = 0; c < sizeof counts / sizeof counts[0]; c++)
            for (uint32_t kind = 0; kind < BOX_KINDS; kind++)
                if (!too_big(s, counts[c]))
                    check_reduce(s, (box_kind)kind, counts[c]);
}

/* ---- what can't be done ---- */

static void refuses_what_it_can_not_do(void **state)
{
    (void)state;
    if (small)
        skip();
    for (const subject *s = subjects; s < subjects + SUBJECTS; s++) {
        uint64_t data[32] = {0};
        bb_buffer keys = upload(s, data, sizeof data), values = upload(s, data, sizeof data);
        bb_buffer empty = {0};
        const uint32_t fits = (uint32_t)(keys.bytes / 4);
        assert_int_equal(bb_sort_u32(s->primitives, &keys, &values, 8, 0), BB_INVALID);
        assert_int_equal(bb_sort_u32(s->primitives, &keys, &values, 8, 33), BB_INVALID);
        assert_int_equal(bb_sort_u64(s->primitives, &keys, &values, 8, 65), BB_INVALID);
        assert_int_equal(bb_sort_u32(s->primitives, &keys, &values, fits + 1, 8), BB_INVALID);
        assert_int_equal(bb_sort_u64(s->primitives, &keys, &values, fits, 8), BB_INVALID);
        assert_int_equal(bb_sort_u32(s->primitives, &keys, &empty, 8, 8), BB_INVALID);
        assert_int_equal(bb_scan_u32(s->primitives, &keys, &values, fits + 1, NULL), BB_INVALID);
        assert_int_equal(bb_scan_u32(s->primitives, &keys, &empty, 1, NULL), BB_INVALID);
        assert_int_equal(bb_reduce_boxes(s->primitives, &keys, 0, &values), BB_INVALID);
        assert_int_equal(bb_reduce_boxes(s->primitives, &keys, fits, &values), BB_INVALID);
        const uint64_t before = s->account.bytes;
        assert_int_equal(bb_primitives_reserve(s->primitives, UINT32_MAX, 8), BB_REFUSED);
        assert_true(s->account.bytes <= before);
        assert_true(download(&keys, data, sizeof data));
        assert_true(download(&values, data, sizeof data));
        check_sort(s, 8, RANDOM, 40, 500); /* and goes on */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sorts_like_a_stable_host_sort),
        cmocka_unit_test(sorts_again_with_other_counts),
        cmocka_unit_test(sorts_buckets_of_all_sizes),
        cmocka_unit_test(grows_while_work_is_enqueued),
        cmocka_unit_test(reserves_all_that_a_sort_needs),
        cmocka_unit_test(scans_like_the_host),
        cmocka_unit_test(reduces_like_the_host),
        cmocka_unit_test(refuses_what_it_can_not_do),
    };
    return cmocka_run_group_tests(tests, open_subjects, close_subjects);
}
