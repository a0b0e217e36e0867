/* Keys by which rays are sorted before they are traced, so that neighbours start in the same place
 * and go the same way (Aila and Laine 2009, section 5; Meister, Boksansky, Guthe, Bittner 2020, "On
 * Ray Reordering Techniques for Faster GPU Ray Tracing").
 */
#include "bb_device.h"
#include "morton.clh"
#include "ray_order_shared.h"

/* Gets the key of each ray, and its number. The key: the octant of its direction, then the Morton
 * code of the cell of its origin. `lo`: the least corner of the scene's box; `cells`: cells per
 * length, on each axis. Origins outside the box are in the cell nearest to them, NaN in the first.
 */
kernel void ray_order_keys(global const bb_ray *restrict rays, uint count, float4 lo, float4 cells,
                           global uint *restrict keys, global uint *restrict ids)
{
    uint id = get_global_id(0);
    if (id >= count)
        return;
    global const float4 *halves = (global const float4 *)(rays + id);
    float3 cell = (halves[0].xyz - lo.xyz) * cells.xyz, d = halves[1].xyz;
    cell = fmin(fmax(cell, 0.0f), (float)((1 << BB_RAY_CELL_BITS) - 1));
    uint octant = (d.x < 0.0f ? 4u : 0u) | (d.y < 0.0f ? 2u : 0u) | (d.z < 0.0f ? 1u : 0u);
    uint place = bb_morton_30((uint4)(convert_uint3(cell), 0u));
    keys[id] = octant << 3 * BB_RAY_CELL_BITS | place;
    ids[id] = id;
}
