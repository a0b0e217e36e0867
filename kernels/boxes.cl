/* The boxes of a scene's primitives, from its geometry: the input of most builders.
 *
 * Limits: none. The host computes the same boxes, bit for bit, when it loads a scene.
 */
#include "bb_device.h"

#include "prims.clh"

kernel void make_boxes(global const float *vertices, global const uint *data, bb_prim_ends ends,
                       uint count, global bb_box *boxes)
{
    uint i = get_global_id(0), kind;
    if (i >= count)
        return;
    float3 lo = (float3)(0.0f), hi = lo;
    global const uint *one = bb_prim_data(data, i, &ends, &kind);
#define BB_BOX(NAME, name, words, kept)                                                            \
    if (kind == BB_##NAME)                                                                         \
        bb_##name##_box(one, vertices, &lo, &hi);
    BB_PRIM_KINDS(BB_BOX)
#undef BB_BOX
    vstore4((float4)(lo, 0.0f), 0, (global float *)(boxes + i));
    vstore4((float4)(hi, 0.0f), 1, (global float *)(boxes + i));
}
