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
#define BB_SPREAD bb_morton_spread21
#else
typedef uint bb_key;
#define BB_AXIS_BITS 10u
#define BB_SPREAD bb_morton_spread10
#endif

/* bounds[1] is the box of the centroids (bb_reduce_boxes). */
kernel void lbvh_codes(global const bb_box *boxes, global const bb_box *bounds, uint count,
                       global bb_key *keys, global uint *values)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    bb_key key = 0;
    for (uint axis = 0; axis < 3; axis++) {
        float low = bounds[1].lo[axis];
        float extent = bounds[1].hi[axis] - low;
        float scale = extent > 0.0f ? (float)(1u << BB_AXIS_BITS) / extent : 0.0f;
        /* a denormal extent overflows the scale: such an axis separates nothing */
        scale = scale <= FLT_MAX ? scale : 0.0f;
        float centroid = 0.5f * boxes[i].lo[axis] + 0.5f * boxes[i].hi[axis];
        bb_key cell = bb_morton_cell(centroid, low, scale, BB_AXIS_BITS);
        key |= BB_SPREAD(cell) << (2u - axis);
    }
    keys[i] = key;
    values[i] = i;
}
