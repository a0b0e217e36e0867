/* Integrates the light along rays through tetrahedra with a scalar field: absorption and emission,
 * from front to back, as in march.clh.
 *
 *   sample k is at t = (k + 1/2) step on each ray, for any tree
 *   for each sample between the ray's entry and exit: which tetrahedron contains it (locate.clh)?
 *       none: it is outside and does not count
 *   value of the field there; entry of the transfer function's table; a = 1 - exp(-extinction step)
 *   light += left a rgb;  left *= 1 - a
 *
 * Samples are the same, bit for bit, for all ways of finding them, and so are the pictures of
 * meshes that do not overlap themselves.
 *
 *   BB_TET_INTERVAL   1: only where the ray may be inside, by boundary cells
 *                     (octree_interval.clh, olbvh_interval.clh; BB_LOCATE_OCTREE or
 *                     BB_LOCATE_OLBVH); 0: between the bounds of the mesh
 *   and those of locate_points.cl
 */
#include "bb_device.h"
#include "locate.clh"
#include "octree_interval.clh"
#include "olbvh_interval.clh"
#include "volume_shared.h"

#ifndef BB_TET_INTERVAL
#define BB_TET_INTERVAL 0
#endif
kernel void tet_march(BB_LOCATE_PARAMETERS, global const uint *data,
                      bb_prim_ends ends, global const float *field, global const float4 *table,
                      bb_tet_march_args march, global const bb_ray *rays, uint count,
                      global bb_light *lights
#if BB_COUNTING
                      ,
                      global bb_count *counts BB_RECORD_ARGUMENTS
#endif
)
{
    uint id = (uint)get_global_id(0);
    if (id >= count)
        return;
    bb_locate_tree tree;
    BB_LOCATE_TREE(tree);
    BB_LOCATE_RECORD(tree, id);
    float3 o = vload3(0, rays[id].o), d = vload3(0, rays[id].d);
    float entry = rays[id].tmin, exit = BB_MIN(FLT_MAX, rays[id].tmax);
    float dt = march.step / sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    uint visited = 0, restarts = 0, samples = 0;
    bb_interval_box(vload3(0, march.lo), vload3(0, march.hi), o, d, &entry, &exit);
#if !BB_HAS_REGIONS
#elif BB_TET_INTERVAL && BB_LOCATE_OCTREE
    if (entry <= exit)
        bb_octree_interval(tree.nodes, tree.args.root, &tree.grid, o, d, &entry, &exit,
                           &visited BB_RECORDER_AT(&tree));
#elif BB_TET_INTERVAL && BB_LOCATE_OLBVH
    if (entry <= exit)
        bb_olbvh_interval(&tree.olbvh, o, d, &entry, &exit, &visited, &restarts);
#endif
    float3 light = (float3)(0.0f);
    float left = 1.0f;
    /* rather one sample too many at either end */
    float from = entry / dt - 1.5f, to = exit / dt + 0.5f;
    uint k = from > 0.0f ? (uint)from : 0u, end = entry <= exit && to > 0.0f ? (uint)to + 1u : 0u;
    for (; k < end; k++) {
        float t = ((float)k + 0.5f) * dt;
        if (t <= rays[id].tmin || t >= rays[id].tmax)
            continue;
        bb_location found;
        BB_STEP_BY(tree.recorder, BB_STEP_AGAIN, 0);
        bb_locate(&tree, o + t * d, &found);
        visited += found.nodes;
        if (found.tet == BB_NONE)
            continue;
        uint kind;
        global const uint *corners = bb_prim_data(data, found.tet, &ends, &kind);
        float values[4];
        for (uint c = 0; c < 4; c++)
            values[c] = field[corners[c]];
        samples++;
        float x = (bb_tet_value(&found.weights, values) - march.field_lo) * march.per_field;
        x = BB_MIN((float)(BB_TRANSFER_STEPS - 1), BB_MAX(0.0f, x));
        uint i = min((uint)x, BB_TRANSFER_STEPS - 2u);
        BB_STEP_BY(tree.recorder, BB_STEP_LOOKUP, i);
        float4 seen = table[i];
        seen += (table[i + 1u] - seen) * (x - (float)i);
        if (seen.w <= 0.0f)
            continue;
        float through = exp(-seen.w * march.step);
        light += left * (1.0f - through) * seen.xyz;
        left *= through;
        if (left < march.cutoff)
            break;
    }
    vstore3(light, 0, lights[id].rgb);
    lights[id].left = left;
#if BB_COUNTING
    counts[id].nodes = visited;
    counts[id].prims = samples;
    counts[id].overflow = 0;
    counts[id].restarts = restarts;
    BB_LOCATE_RECORDED(id);
#endif
}
