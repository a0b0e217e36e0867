/* The march through all of a volume without a tree: every sample from the ray's entry to its exit.
 * The baseline for trees.
 *
 *   -D: those of march.clh, and BB_COUNTING
 */
#include "bb_device.h"
#define BB_QUERY_MARCH
#include "search.clh"

/* Clips the interval to the planes of one axis. */
void march_slab(const bb_march_args *march, uint axis, float scale, float o, float d, float *entry,
                float *exit)
{
    const bb_volume_grid *grid = &march->grid;
    float lo = -grid->margin, hi = grid->cell[axis] * (float)grid->cells[axis] + grid->margin;
    bb_aabb_slab(lo * scale, hi * scale, o, d, entry, exit);
}

kernel void march_all(float scale, global const bb_ray *rays, uint count, global bb_light *lights,
#if BB_COUNTING
                      global bb_count *counts,
#endif
#if BB_RECORDING
                      global const uint *step_ends, global uint *steps, global uint *step_counts,
#endif
                      global const BB_VOXEL *voxels, global const float4 *table,
                      bb_march_args march)
{
    uint id = (uint)get_global_id(0);
    if (id >= count)
        return;
    bb_ray_setup setup;
    bb_ray_setup_make(&setup, &rays[id], scale);
    bb_search search;
    bb_search_start(&search, &setup, &rays[id]);
#if BB_RECORDING
    bb_record_start(&search.recorder, id, step_ends, steps);
#endif
    bb_march_search_start(&search, &setup, scale, voxels, table, &march);
    float entry = search.tmin, exit = search.tmax;
    march_slab(&march, 0, scale, setup.o.x, setup.d.x, &entry, &exit);
    march_slab(&march, 1, scale, setup.o.y, setup.d.y, &entry, &exit);
    march_slab(&march, 2, scale, setup.o.z, setup.d.z, &entry, &exit);
    if (entry <= exit) {
        uint first, end;
        bb_march_range(&search.found.march, entry, exit, &first, &end);
        bb_march_integrate(&search.found.march, first, end BB_RECORDER_OF(&search));
    }
    bb_search_write(&search, &setup, &lights[id]);
#if BB_COUNTING
    search.prims = search.found.march.samples;
    bb_search_count(&search, false, &counts[id]);
#if BB_RECORDING
    step_counts[id] = search.recorder.count;
#endif
#endif
}
