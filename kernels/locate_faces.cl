/* Which tetrahedra hold points, and the scalar field there, by the nearest face on a ray from each
 * point (Wald, Usher, Morrical, Lediaev, Pascucci 2019): the point is in the tetrahedron on that
 * side of the face from which the ray comes.
 *
 * All rays go along +x, so the side is the sign of the x of the face's normal.
 *
 *   -DBB_HAS_DOUBLES=0|1
 */
#include "bb_device.h"
#include "prims.clh"
#include "tet_point.clh"

kernel void locate_faces(global const uint *data, bb_prim_ends ends, global const float *vertices,
                         global const float *field, global const uint *flags, uint first,
                         float scale, global const uint *face_data, bb_prim_ends face_ends,
                         global const bb_face_sides *sides, global const float *points,
                         global const bb_hit *hits, uint count, global bb_located *results)
{
    uint i = (uint)get_global_id(0), kind;
    if (i >= count)
        return;
    results[i].prim = BB_NONE;
    results[i].value = 0.0f;
    uint face = hits[i].prim;
    if (face == BB_NONE)
        return;
    global const uint *abc = bb_prim_data(face_data, face, &face_ends, &kind);
    bb_real3 a = BB_REAL3(vload3(abc[0], vertices)), b = BB_REAL3(vload3(abc[1], vertices)) - a,
             c = BB_REAL3(vload3(abc[2], vertices)) - a;
    uint tet = b.y * c.z < b.z * c.y ? sides[face].above : sides[face].below;
    if (tet == BB_NONE)
        return;
    global const uint *corners = bb_prim_data(data, first + tet, &ends, &kind);
    bb_tet_weights weights;
    float3 v[4];
    float values[4];
    for (uint k = 0; k < 4; k++) {
        v[k] = vload3(corners[k], vertices) * scale;
        values[k] = field[corners[k]];
    }
    results[i].prim = first + tet;
    if (bb_tet_point_of(v[0], v[1], v[2], v[3], flags[tet], vload3(i, points) * scale, &weights))
        results[i].value = bb_tet_value(&weights, values);
}
