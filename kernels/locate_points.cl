/* Finds the tetrahedra that contain many points, and the scalar field at these points.
 *
 *   -D: those of locate.clh and tet_point.clh, and BB_COUNTING
 */
#include "bb_device.h"
#include "locate.clh"

kernel void locate_points(BB_LOCATE_PARAMETERS, global const uint *data,
                          bb_prim_ends ends, global const float *field, global const float *points,
                          uint count, global bb_located *results
#if BB_COUNTING
                          ,
                          global bb_count *counts
#endif
)
{
    uint i = (uint)get_global_id(0);
    if (i >= count)
        return;
    bb_locate_tree tree;
    bb_location found;
    BB_LOCATE_TREE(tree);
    bb_locate(&tree, vload3(i, points), &found);
    results[i].prim = found.tet;
    results[i].value = 0.0f;
    if (found.tet != BB_NONE) {
        uint kind;
        global const uint *corners = bb_prim_data(data, found.tet, &ends, &kind);
        float values[4];
        for (uint c = 0; c < 4; c++)
            values[c] = field[corners[c]];
        results[i].value = bb_tet_value(&found.weights, values);
    }
#if BB_COUNTING
    counts[i].nodes = found.nodes;
    counts[i].prims = found.tests;
    counts[i].overflow = 0;
    counts[i].restarts = 0;
#endif
}
