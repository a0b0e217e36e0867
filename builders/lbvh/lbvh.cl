/* LBVH, the codes: one Morton code per primitive, from the centroid of its box.
 *
 *   for each primitive i, in parallel:
 *       key[i] = morton(quantise(centroid(box[i]) in the box of all centroids)), value[i] = i
 *
 * Sorting and linking are shared: framework/primitives.h, builders/common/radix_tree.cl.
 * -DBB_KEY64: 63-bit codes in ulong keys; else 30-bit codes in uint keys.
 * Limits: 2^31 - 1 primitives. An axis on which all centroids agree gets cell 0.
 */
#include "bb_device.h"
#include "morton.clh"

#ifdef BB_KEY64
typedef ulong bb_key;
#define BB_AXIS_BITS 21u
#define BB_MORTON bb_morton_63
#else
typedef uint bb_key;
#define BB_AXIS_BITS 10u
#define BB_MORTON bb_morton_30
#endif

/* bounds[1] is the box of the centroids (bb_reduce_boxes). */
kernel void lbvh_codes(global const bb_box *restrict boxes, global const bb_box *restrict bounds,
                       uint count, global bb_key *restrict keys, global uint *restrict values)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    global const float *outer = (global const float *)(bounds + 1);
    global const float *box = (global const float *)(boxes + i);
    float4 low = vload4(0, outer);
    float4 scale = bb_morton_scale(low, vload4(1, outer), BB_AXIS_BITS);
    float4 centroid = 0.5f * vload4(0, box) + 0.5f * vload4(1, box);
    keys[i] = BB_MORTON(bb_morton_cells(centroid, low, scale, BB_AXIS_BITS));
    values[i] = i;
}
