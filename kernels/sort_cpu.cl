/* Stable radix sort of key-value pairs, one digit of at most 8 bits per pass from the lowest up
 * (LSD); form for CPU devices: one work-item per chunk, no local memory, no barriers.
 *
 * Source: Zagha and Blelloch, Radix Sort for Vector Multiprocessors (Supercomputing 1991).
 *
 *     for each digit:
 *         sort_count:    for each chunk: counts[digit value][chunk] = how many of the chunk's keys
 *                        have it
 *         the scan:      counts = exclusive prefix sum of counts, digit-major: where each chunk's
 *                        keys of a value go
 *         sort_scatter:  for each chunk, in order: place = counts[digit value of key]++; out[place]
 *                        = key, value
 *
 * Limits: BB_KEY is uint or ulong. 8 bits because the 2 x 256 lines being written then fit the
 * nearest cache: wider digits save passes and lose more in each.
 */
#include "bb_device.h"

#define BUCKETS_MAX 256
#define DIGIT(key) ((uint)((key) >> shift) & mask)

/* Launched on one work-item per chunk, in groups of one; the last chunk may be shorter. */
__kernel void sort_count(__global const BB_KEY *keys,
                         const uint count,
                         const uint chunk,      /* keys in a chunk */
                         const uint shift,      /* where the digit begins */
                         const uint mask,       /* its values are 0 to mask */
                         __global uint *counts) /* (mask + 1) * chunks */
{
    uint buckets[BUCKETS_MAX];
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
                           __global const uint *places, /* the scanned counts */
                           __global BB_KEY *keys_out,
                           __global uint *values_out)
{
    uint next[BUCKETS_MAX];
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
