/* Union of boxes and of their centroids, form for GPU devices: work-groups co-operate through local
 * memory.
 *
 * Source: Harris, Optimizing Parallel Reduction in CUDA (NVIDIA 2007), without its unsynchronised
 * last steps.
 *
 *     reduce_boxes:     each item: bounds = union of boxes[item], boxes[item + items], ...
 *                       each group: halve the number of bounds, through local memory, until one is
 *                       left: partials[group]
 *     reduce_partials:  one group does the same with the partials
 *
 * Limits: BB_GROUP (the local size) is any power of two; at least one box; boxes are finite; no
 * group waits for another.
 */
#include "bb_device.h"
#include "scene_bounds.clh"

/* Union over the group, in every item. Called in uniform control flow. */
static scene_bounds group_union(scene_bounds bounds, __local scene_bounds *shared)
{
    const uint item = get_local_id(0);
    shared[item] = bounds;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint half_size = BB_GROUP / 2; half_size > 0; half_size /= 2) {
        if (item < half_size)
            shared[item] = scene_bounds_union(shared[item], shared[item + half_size]);
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    return shared[0];
}

/* Launched on any number of groups. */
__kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void reduce_boxes(__global const bb_box *boxes,
                  const uint count,
                  __global bb_box *partials) /* two per group */
{
    __local scene_bounds shared[BB_GROUP];
    const uint items = get_global_size(0);
    scene_bounds bounds = scene_bounds_empty();
    for (ulong i = get_global_id(0); i < count; i += items)
        bounds = scene_bounds_union(bounds, scene_bounds_of(&boxes[i]));
    bounds = group_union(bounds, shared);
    if (get_local_id(0) == 0)
        scene_bounds_store(bounds, &partials[2 * get_group_id(0)]);
}

/* Launched on one group. */
__kernel __attribute__((reqd_work_group_size(BB_GROUP, 1, 1)))
void reduce_partials(__global const bb_box *partials,
                     const uint count,
                     __global bb_box *out)
{
    __local scene_bounds shared[BB_GROUP];
    scene_bounds bounds = scene_bounds_empty();
    for (uint i = get_local_id(0); i < count; i += BB_GROUP)
        bounds = scene_bounds_union(bounds, scene_bounds_load(&partials[2 * i]));
    bounds = group_union(bounds, shared);
    if (get_local_id(0) == 0)
        scene_bounds_store(bounds, out);
}
