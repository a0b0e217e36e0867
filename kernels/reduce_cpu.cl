/* Union of boxes and of their centroids, form for CPU devices: one work-item per chunk, no local
 * memory, no barriers.
 *
 * Source: the blocked reduction of Blelloch, Prefix Sums and Their Applications (CMU-CS-90-190,
 * 1990), section 1.2.
 *
 *     reduce_boxes:     for each chunk: partials[chunk] = union of its boxes, union of their
 *                       centroids
 *     reduce_partials:  one item: out = union of the partials
 *
 * Limits: at least one box; boxes are finite.
 */
#include "bb_device.h"
#include "scene_bounds.clh"

/* Launched on one work-item per chunk, in groups of one; the last chunk may be shorter. */
__kernel void reduce_boxes(__global const bb_box *boxes,
                           const uint count,
                           const uint chunk,          /* boxes in a chunk */
                           __global bb_box *partials) /* two per chunk */
{
    const uint c = get_global_id(0);
    const uint begin = c * chunk;
    const uint end = begin + min(chunk, count - begin);
    scene_bounds bounds = scene_bounds_empty();
    for (uint i = begin; i < end; i++)
        bounds = scene_bounds_union(bounds, scene_bounds_of(&boxes[i]));
    scene_bounds_store(bounds, &partials[2 * c]);
}

/* Launched on one work-item. */
__kernel void reduce_partials(__global const bb_box *partials,
                              const uint count,
                              __global bb_box *out)
{
    scene_bounds bounds = scene_bounds_empty();
    for (uint i = 0; i < count; i++)
        bounds = scene_bounds_union(bounds, scene_bounds_load(&partials[2 * i]));
    scene_bounds_store(bounds, out);
}
