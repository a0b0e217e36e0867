/* Exclusive prefix sum of u32, form for CPU devices: one work-item per chunk, no local memory, no
 * barriers.
 *
 * Source: the blocked scan of Blelloch, Prefix Sums and Their Applications (CMU-CS-90-190, 1990),
 * section 1.2.
 *
 *     scan_sums:    for each chunk: sums[chunk] = sum of in[chunk]
 *     scan_serial:  one item: sums = exclusive prefix sum of sums
 *     scan_chunks:  for each chunk: running = sums[chunk]; for i in chunk: out[i] = running,
 *                   running += in[i]
 *
 * Short inputs use scan_serial alone.
 */
#include "bb_device.h"

/* Launched on one work-item per chunk, in groups of one; the last chunk may be shorter. */
__kernel void scan_sums(__global const uint *in,
                        const uint count,
                        const uint chunk, /* elements in a chunk */
                        __global uint *sums)
{
    const uint c = get_global_id(0);
    const uint begin = c * chunk;
    const uint end = begin + min(chunk, count - begin);
    uint sum = 0;
    for (uint i = begin; i < end; i++)
        sum += in[i];
    sums[c] = sum;
}

/* Launched on one work-item. */
__kernel void scan_serial(__global const uint *in,
                          __global uint *out,
                          const uint count,
                          __global uint *total)
{
    uint running = 0;
    for (uint i = 0; i < count; i++) {
        const uint value = in[i];
        out[i] = running;
        running += value;
    }
    total[0] = running;
}

/* Launched as scan_sums. */
__kernel void scan_chunks(__global const uint *in,
                          __global uint *out,
                          const uint count,
                          const uint chunk,
                          __global const uint *sums)
{
    const uint c = get_global_id(0);
    const uint begin = c * chunk;
    const uint end = begin + min(chunk, count - begin);
    uint running = sums[c];
    for (uint i = begin; i < end; i++) {
        const uint value = in[i];
        out[i] = running;
        running += value;
    }
}
