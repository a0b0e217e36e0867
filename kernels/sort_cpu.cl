/* Stable radix sort of key-value pairs; form for CPU devices: one work-item per chunk or tile, no
 * local memory, no barriers.
 *
 * Sources: Zagha and Blelloch, Radix Sort for Vector Multiprocessors (Supercomputing 1991), for the
 * passes over all keys; McIlroy, Bostic, McIlroy, Engineering Radix Sort (Computing Systems 6(1),
 * 1993), for buckets by the highest digit first.
 *
 *     sort_count:    for each chunk: counts[digit value][chunk] = number of the chunk's keys with
 *                    it
 *     the scan:      counts = exclusive prefix sum of counts, digit-major: the place of each
 *                    chunk's first key of a value
 *     sort_scatter:  for each chunk, in order: place = counts[digit value of key]++; out[place] =
 *                    key, value
 *
 *     by buckets: these three, once, by the highest digit, with, before the last,
 *     sort_choose:   one item: are all buckets small enough? else by passes; and then
 *     sort_buckets:  for each tile of places: find the bits that differ among the keys of the
 *                    buckets that begin in it; sort by these bits, a digit at a time from the
 *                    lowest up: scatter as above, and count the next digit on the way. If the
 *                    bits are many, sort only by the highest ones, which leave hardly a pair out
 *                    of order, and move these back to their places
 *
 *     by passes: these three, for each digit of 8 bits from the lowest up
 *
 *     few pairs: one item sorts them as a bucket                                     (sort_alone)
 *
 * Both ways are launched, since only the device knows which one is taken: way[0]. A kernel of the
 * other way, SORT_..., does nothing.
 *
 * Limits: BB_KEY is uint or ulong. Passes over all keys use 8 bits because the 2 x 256 cache lines
 * being written then fit the first-level cache; buckets use 12 bits, since the next cache holds a
 * whole bucket, and 14 if they have more keys than such digits have values. The highest digit has
 * 12 bits, since keys come in the order of the scene and few lines are being written at a time.
 */
#include "bb_device.h"

#include "sort_shared.h"

#define BUCKETS_MAX 4096
#define SMALL 1024u  /* keys of a bucket too small to clear wide digits for ... */
#define LARGE 24576u /* ... and large enough to clear the widest ones for */
#define WIDEST_DIGIT (sizeof(BB_KEY) == 8 ? 14u : 12u)
#define LONG 32u      /* bits; for shorter keys insertion takes longer than a digit */
#define LEFT_OVER 12u /* lowest bits, in which few keys differ that agree in the others ... */
#define MOVES 2u      /* ... and most moves per pair before insertion is given up */
#define DIGIT(key) ((uint)((key) >> shift) & mask)

/* Launched on one work-item per chunk, in groups of one; the last chunk may be shorter. */
__kernel void sort_count(__global const BB_KEY *keys,
                         const uint count,
                         const uint chunk,      /* keys in a chunk */
                         const uint shift,      /* where the digit begins */
                         const uint mask,       /* its values are 0 to mask */
                         const uint only,       /* the way it belongs to; SORT_ANY: both */
                         __global const uint *way,
                         __global uint *counts) /* (mask + 1) * chunks */
{
    uint buckets[BUCKETS_MAX];
    if (only != SORT_ANY && way[0] != only)
        return;
    const uint c = get_global_id(0);
    const uint chunks = get_global_size(0);
    const uint begin = c * chunk;
    const uint end = begin + min(chunk, count - begin);
    for (uint d = 0; d <= mask; d++)
        buckets[d] = 0;
    for (uint i = begin; i < end; i++)
        buckets[DIGIT(keys[i])]++;
    for (uint d = 0; d <= mask; d++)
        counts[d * chunks + c] = buckets[d];
}

/* Launched as sort_count. */
__kernel void sort_scatter(__global const BB_KEY *keys,
                           __global const uint *values,
                           const uint count,
                           const uint chunk,
                           const uint shift,
                           const uint mask,
                           const uint only,
                           __global const uint *way,
                           __global const uint *places, /* the scanned counts */
                           __global BB_KEY *keys_out,
                           __global uint *values_out)
{
    uint next[BUCKETS_MAX];
    if (way[0] != only)
        return;
    const uint c = get_global_id(0);
    const uint chunks = get_global_size(0);
    const uint begin = c * chunk;
    const uint end = begin + min(chunk, count - begin);
    for (uint d = 0; d <= mask; d++)
        next[d] = places[d * chunks + c];
    for (uint i = begin; i < end; i++) {
        const BB_KEY key = keys[i];
        const uint place = next[DIGIT(key)]++;
        keys_out[place] = key;
        values_out[place] = values[i];
    }
}

/* Launched on one work-item. */
__kernel void sort_choose(__global const uint *places, /* the scanned counts */
                          const uint count,
                          const uint chunks,
                          const uint buckets,
                          const uint small_enough, /* keys of a bucket */
                          __global uint *way)
{
    uint most = 0;
    for (uint b = 0; b < buckets; b++) {
        const uint end = b + 1 < buckets ? places[(b + 1) * chunks] : count;
        most = max(most, end - places[b * chunks]);
    }
    way[0] = most > small_enough ? SORT_PASSES : SORT_BUCKETS;
}

/* Returns the first place from `least` on where a bucket begins; `count` if none does. Place 0
 * always begins one. */
static uint first_bucket(__global const uint *places, uint chunks, uint buckets, uint count,
                         uint least)
{
    if (least == 0)
        return 0;
    uint low = 0, high = buckets;
    while (low < high) {
        const uint middle = (low + high) / 2;
        if (places[middle * chunks] < least)
            low = middle + 1;
        else
            high = middle;
    }
    return low < buckets ? places[low * chunks] : count;
}

/* A digit of the differing bits. */
typedef struct digit {
    uint shift;
    uint mask;
} digit;

/* Returns the `which`-th of `digits` digits that share the bits `low` to `low + span - 1`. */
static digit digit_of(uint which, uint digits, uint low, uint span)
{
    const uint begin = span * which / digits, end = span * (which + 1) / digits;
    return (digit){low + begin, (1u << (end - begin)) - 1u};
}

static void clear(uint *buckets, uint mask)
{
    for (uint d = 0; d <= mask; d++)
        buckets[d] = 0;
}

static void count_digit(__global const BB_KEY *keys, uint count, digit by, uint *buckets)
{
    const uint shift = by.shift, mask = by.mask;
    clear(buckets, mask);
    for (uint i = 0; i < count; i++)
        buckets[DIGIT(keys[i])]++;
}

/* Turns counts into places. */
static void sum_up(uint *buckets, uint mask)
{
    uint running = 0;
    for (uint d = 0; d <= mask; d++) {
        const uint here = buckets[d];
        buckets[d] = running;
        running += here;
    }
}

typedef struct pairs {
    __global BB_KEY *keys;
    __global uint *values;
} pairs;

static void scatter(pairs from, pairs to, uint count, digit by, uint *places)
{
    const uint shift = by.shift, mask = by.mask;
    for (uint i = 0; i < count; i++) {
        const BB_KEY key = from.keys[i];
        const uint place = places[DIGIT(key)]++;
        to.keys[place] = key;
        to.values[place] = from.values[i];
    }
}

/* The same, and counts the next digit: the order of keys does not matter to counts. */
static void scatter_counting(pairs from, pairs to, uint count, digit by, uint *places, digit next,
                             uint *buckets)
{
    const uint shift = by.shift, mask = by.mask;
    clear(buckets, next.mask);
    for (uint i = 0; i < count; i++) {
        const BB_KEY key = from.keys[i];
        const uint place = places[DIGIT(key)]++;
        buckets[(uint)(key >> next.shift) & next.mask]++;
        to.keys[place] = key;
        to.values[place] = from.values[i];
    }
}

/* Returns the bits in which any two of the keys differ. */
static BB_KEY differing_bits(__global const BB_KEY *keys, uint count)
{
    const BB_KEY first = keys[0];
    BB_KEY differ = 0;
    for (uint i = 1; i < count; i++)
        differ |= keys[i] ^ first;
    return differ;
}

/* Sorts `a` by `digits` digits of the bits `low` to `low + span - 1`, with `b` as scratch; returns
 * whether the result is in b. Not inlined, since it has large arrays. */
__attribute__((noinline)) static bool sort_digits(pairs a, pairs b, uint count, uint low, uint span,
                                                  uint digits)
{
    uint counts[2][1 << WIDEST_DIGIT];
    bool swapped = false;
    digit by = digit_of(0, digits, low, span);
    count_digit(a.keys, count, by, counts[0]);
    for (uint d = 0; d < digits; d++) {
        uint *here = counts[d % 2u], *there = counts[(d + 1u) % 2u];
        const pairs from = swapped ? b : a, to = swapped ? a : b;
        const bool last = d + 1u == digits;
        const digit next = digit_of(last ? d : d + 1u, digits, low, span);
        if (here[(uint)(from.keys[0] >> by.shift) & by.mask] == count) {
            if (!last) /* all keys have this value */
                count_digit(from.keys, count, next, there);
        } else {
            sum_up(here, by.mask);
            if (last)
                scatter(from, to, count, by, here);
            else
                scatter_counting(from, to, count, by, here, next, there);
            swapped = !swapped;
        }
        by = next;
    }
    return swapped;
}

/* Sorts pairs that are nearly in order; `to` may be `from`. Returns false, with all pairs still in
 * `from`, if that takes too many moves. */
static bool insert_pairs(pairs from, pairs to, uint count)
{
    uint moves = MOVES * count;
    BB_KEY highest = 0;
    for (uint i = 0; i < count; i++) {
        const BB_KEY key = from.keys[i];
        const uint value = from.values[i];
        uint place = i;
        if (key >= highest)
            highest = key;
        else
            for (; place > 0 && to.keys[place - 1u] > key; place--) {
                to.keys[place] = to.keys[place - 1u];
                to.values[place] = to.values[place - 1u];
            }
        to.keys[place] = key;
        to.values[place] = value;
        if (i - place > moves)
            return false;
        moves -= i - place;
    }
    return true;
}

/* Sorts `a`, with `b` as scratch; returns whether the result is in b. */
static bool sort_pairs(pairs a, pairs b, uint count)
{
    const BB_KEY differ = differing_bits(a.keys, count);
    if (differ == 0)
        return false;
    const uint low = (uint)popcount((differ & -differ) - 1);
    const uint span = 8u * (uint)sizeof(BB_KEY) - (uint)clz(differ) - low;
    const uint widest = count < SMALL ? 8u : count < LARGE ? 12u : WIDEST_DIGIT;
    const uint left_over = span > LONG ? min(span - LONG, LEFT_OVER) : 0u;
    const uint digits = (span - left_over + widest - 1u) / widest;
    const uint high = min(span, digits * widest);
    const bool swapped = sort_digits(a, b, count, low + span - high, high, digits);
    if (high == span)
        return swapped;
    const pairs from = swapped ? b : a;
    if (insert_pairs(from, b, count))
        return true;
    const pairs to = swapped ? a : b;
    return swapped != sort_digits(from, to, count, low, span, (span + widest - 1u) / widest);
}

static void copy_pairs(pairs from, pairs to, uint count)
{
    for (uint i = 0; i < count; i++) {
        to.keys[i] = from.keys[i];
        to.values[i] = from.values[i];
    }
}

/* Launched on one work-item: sorts few pairs in place. */
__kernel void sort_alone(__global BB_KEY *keys,
                         __global uint *values,
                         const uint count,
                         __global BB_KEY *keys_scratch,
                         __global uint *values_scratch)
{
    const pairs place = {keys, values};
    const pairs scratch = {keys_scratch, values_scratch};
    if (sort_pairs(place, scratch, count))
        copy_pairs(scratch, place, count);
}

/* Launched on one work-item per tile of places, in groups of one. The pairs come in the order of
 * their buckets. */
__kernel void sort_buckets(__global BB_KEY *keys, /* overwritten, as are the values */
                           __global uint *values,
                           const uint count,
                           const uint tile,
                           __global const uint *places, /* the scanned counts */
                           const uint chunks,
                           const uint buckets,
                           __global const uint *way,
                           __global BB_KEY *keys_out,
                           __global uint *values_out)
{
    if (way[0] != SORT_BUCKETS)
        return;
    const uint at = get_global_id(0) * tile;
    const uint begin = first_bucket(places, chunks, buckets, count, at);
    const uint end =
        count - at > tile ? first_bucket(places, chunks, buckets, count, at + tile) : count;
    if (begin >= end)
        return;
    const pairs from = {keys + begin, values + begin};
    const pairs to = {keys_out + begin, values_out + begin};
    if (!sort_pairs(from, to, end - begin))
        copy_pairs(from, to, end - begin);
}
