/* The boxes of a scene's primitives, from its geometry: the input of most builders.
 *
 *   triangle: least and most of its corners' coordinates
 *   sphere: centre -+ radius, rounded outwards
 *
 * Limits: none of its own. The host makes the same boxes, bit for bit, when it loads a scene.
 */
#include "bb_device.h"
#include "padding.clh"

kernel void make_boxes(global const float *vertices, global const uint *indices,
                       global const float *spheres, uint triangle_count, uint count,
                       global bb_box *boxes)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    float4 lo = (float4)(0.0f), hi = lo;
    if (i < triangle_count) {
        uint3 corners = vload3(i, indices);
        float3 a = vload3(corners.x, vertices), b = vload3(corners.y, vertices),
               c = vload3(corners.z, vertices);
        float3 low = BB_MIN(a, b), high = BB_MAX(a, b);
        lo.xyz = BB_MIN(c, low);
        hi.xyz = BB_MAX(c, high);
    } else {
        global const float *s = spheres + 4ul * (i - triangle_count);
        lo.x = bb_subtract_down(s[0], s[3]);
        lo.y = bb_subtract_down(s[1], s[3]);
        lo.z = bb_subtract_down(s[2], s[3]);
        hi.x = -bb_subtract_down(-s[0], s[3]);
        hi.y = -bb_subtract_down(-s[1], s[3]);
        hi.z = -bb_subtract_down(-s[2], s[3]);
    }
    vstore4(lo, 0, (global float *)(boxes + i));
    vstore4(hi, 1, (global float *)(boxes + i));
}
