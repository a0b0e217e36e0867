/* A slice of a mesh of tetrahedra, as for a 3D printer: material in each voxel that shares a point
 * with a tetrahedron with a volume (Stroeter, Mueller-Roemer, Stork, Fellner 2020, section 4.3).
 *
 *   a tetrahedron contains the voxel's centre         the field there
 *   else the nearest to the centre of those that      its linear field extrapolated to the centre,
 *   lie on the mesh's boundary and meet the voxel     clamped to the range of the whole field
 *   no such tetrahedron                               no material
 *
 * A voxel whose centre is outside meets the mesh only if it meets a boundary tetrahedron, in a cell
 * that lists it. Among tetrahedra at the same distance the lowest is taken.
 *
 *   BB_WALK_BOUNDARY   1: the second search visits only boundary cells; 0: all
 *   and those of locate_points.cl, and BB_LOCATE_ALL
 */
#include "bb_device.h"
#include "locate.clh"
#include "solids.clh"

typedef struct bb_visitor {
    float3 lo, hi, from; /* tet_walk.clh: of the voxel */
    float3 centre;
    bb_real least;         /* smallest squared distance so far */
    uint nearest, tests;
    const bb_locate_tree *tree;
} bb_visitor;

#include "tet_walk.clh"

#if BB_HAS_DOUBLES
/* Returns the squared distance of the tetrahedron's box from the centre: except for rounding, not
 * more than the tetrahedron's own. */
bb_real bb_box_distance(const bb_visitor *visitor, const float3 corners[4])
{
    bb_real3 lo = BB_REAL3(BB_MIN(BB_MIN(corners[0], corners[1]), BB_MIN(corners[2], corners[3])));
    bb_real3 hi = BB_REAL3(BB_MAX(BB_MAX(corners[0], corners[1]), BB_MAX(corners[2], corners[3])));
    bb_real3 centre = BB_REAL3(visitor->centre);
    bb_real3 beyond = BB_MAX(BB_MAX(lo - centre, centre - hi), (bb_real3)(0));
    return dot(beyond, beyond);
}
#endif

bool bb_visit_tet(bb_visitor *visitor, uint prim, uint flags, const float3 corners[4])
{
    if ((flags & BB_TET_BOUNDARY) == 0u || (flags & BB_TET_FLAT) != 0u || prim == visitor->nearest)
        return false;
    float3 side = BB_MAX(visitor->hi - visitor->lo, fabs(corners[0] - visitor->centre));
    for (uint c = 1; c < 4; c++)
        side = BB_MAX(side, fabs(corners[c] - visitor->centre));
    bb_real unit = bb_solid_unit(side);
#if BB_HAS_DOUBLES
    /* Tetrahedra that are certainly farther away are skipped. Floats are never certain. */
    if (bb_box_distance(visitor, corners) * 0.999 > visitor->least)
        return false;
#endif
    BB_STEP_BY(visitor->tree->recorder, BB_STEP_EXACT, 0);
#if !BB_HAS_EXACT
    visitor->least = side.x;
    visitor->nearest = prim;
    return false;
#endif
    bb_solid tet = bb_solid_tet(corners, visitor->centre, unit);
    bb_real distance = bb_tet_distance(&tet) / (unit * unit);
    visitor->tests++;
    if (distance > visitor->least || (distance == visitor->least && prim > visitor->nearest))
        return false;
    BB_STEP_BY(visitor->tree->recorder, BB_STEP_FURTHER, 0);
#if !BB_HAS_FURTHER
    visitor->least = distance;
    visitor->nearest = prim;
    return false;
#endif
    bb_solid box = bb_solid_box(visitor->lo, visitor->hi, visitor->centre, unit);
    if (!bb_tet_meets_box(&tet, &box))
        return false;
    visitor->least = distance;
    visitor->nearest = prim;
    return false;
}

#if BB_LOCATE_OLBVH
bool bb_visit_leaf(bb_visitor *visitor, uint leaf)
{
    bb_walk_from(visitor->tree, vload3(2u * leaf, visitor->tree->olbvh.bv), visitor);
    return bb_walk_leaf(visitor->tree, leaf, visitor);
}
#elif BB_LOCATE_OCTREE
bool bb_visit_cell(bb_visitor *visitor, uint index, uint2 node, uint3 cell)
{
    (void)index;
    bb_walk_from(visitor->tree, bb_cell_corner(&visitor->tree->grid, cell), visitor);
    return bb_walk_cell(visitor->tree, node, visitor);
}
#endif

float bb_slice_plane(const bb_slice_args *args, uint axis, uint i)
{
    float at = args->lo[axis] + args->step[axis] * (float)i;
    return i >= args->size[axis] ? args->hi[axis] : BB_MIN(args->hi[axis], at);
}

float3 bb_slice_point(const bb_slice_args *args, float u, float v, float n)
{
    return args->axis == 0u   ? (float3)(n, u, v)
           : args->axis == 1u ? (float3)(u, n, v)
                              : (float3)(u, v, n);
}

/* Returns the tetrahedron's field at a point, which may be outside of it, by its weights. */
float bb_slice_field(global const uint *corners, global const float *vertices,
                     global const float *field, float3 point, const bb_slice_args *args)
{
    float3 places[4];
    bb_real error, sum = 0, value = 0;
    for (uint c = 0; c < 4; c++)
        places[c] = vload3(corners[c], vertices);
    float3 side = fabs(places[0] - point);
    for (uint c = 1; c < 4; c++)
        side = BB_MAX(side, fabs(places[c] - point));
    bb_solid tet = bb_solid_tet(places, point, bb_solid_unit(side));
    bb_real3 a = tet.corners[0], b = tet.corners[1], c = tet.corners[2], d = tet.corners[3];
    bb_real weights[4] = {bb_triple(d, b, c, &error), -bb_triple(d, a, c, &error),
                          bb_triple(d, a, b, &error), -bb_triple(a, b, c, &error)};
    for (uint i = 0; i < 4; i++) {
        sum += weights[i];
        value += weights[i] * (bb_real)field[corners[i]];
    }
    value = sum != 0 ? value / sum : (bb_real)field[corners[0]];
    return (float)BB_MAX((bb_real)args->field_lo, BB_MIN((bb_real)args->field_hi, value));
}

kernel void slice_tets(BB_LOCATE_PARAMETERS, global const uint *data,
                       bb_prim_ends ends, global const float *vertices, global const float *field,
                       bb_slice_args args, global bb_sliced *voxels
#if BB_COUNTING
                       ,
                       global bb_count *counts BB_RECORD_ARGUMENTS
#endif
)
{
    uint u = (uint)get_global_id(0), v = u / args.size[0];
    uint i = u;
    u -= v * args.size[0];
    if (v >= args.size[1])
        return;
    bb_locate_tree tree;
    BB_LOCATE_TREE(tree);
    BB_LOCATE_RECORD(tree, i);
    float u0 = bb_slice_plane(&args, 0, u), u1 = bb_slice_plane(&args, 0, u + 1u);
    float v0 = bb_slice_plane(&args, 1, v), v1 = bb_slice_plane(&args, 1, v + 1u);
    float3 lo = bb_slice_point(&args, u0, v0, args.below);
    float3 hi = bb_slice_point(&args, u1, v1, args.above);
    float3 centre = 0.5f * lo + 0.5f * hi;
    bb_location found;
    bb_locate(&tree, centre, &found);
    bb_sliced voxel;
    voxel.prim = found.tet;
    voxel.value = 0.0f;
    voxel.inside = found.tet != BB_NONE;
    if (found.tet == BB_NONE) {
        bb_visitor visitor;
        visitor.lo = lo * tree.args.scale;
        visitor.hi = hi * tree.args.scale;
        visitor.centre = centre * tree.args.scale;
        visitor.least = INFINITY;
        visitor.nearest = BB_NONE;
        visitor.tests = 0;
        visitor.tree = &tree;
        bb_walk(&tree, lo, hi, &visitor, &found);
        found.tests += visitor.tests;
        voxel.prim = visitor.nearest;
    }
    if (voxel.prim != BB_NONE) {
        uint kind;
        global const uint *corners = bb_prim_data(data, voxel.prim, &ends, &kind);
        float values[4];
        for (uint c = 0; c < 4; c++)
            values[c] = field[corners[c]];
        voxel.value = voxel.inside ? bb_tet_value(&found.weights, values)
                                   : bb_slice_field(corners, vertices, field, centre, &args);
    }
    voxels[i] = voxel;
#if BB_COUNTING
    counts[i].nodes = found.nodes;
    counts[i].prims = found.tests;
    counts[i].overflow = 0;
    counts[i].restarts = found.restarts;
    BB_LOCATE_RECORDED(i);
#endif
}
