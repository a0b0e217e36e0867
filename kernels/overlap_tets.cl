/* Finds the tetrahedra of one mesh that share a point with one of another. Those without volume are
 * left out; touching counts (Stroeter, Mueller-Roemer, Stork, Fellner 2020, section 4.4).
 *
 *   for each tetrahedron of the first mesh:
 *       for each of the other mesh whose box meets its box: do they meet (solids.clh)?
 *           yes: done, one suffices
 *   with BB_OVERLAP_FLAGS:
 *       in a cell that is entirely inside of the other mesh (octree_inside.cl, olbvh_inside.cl) it
 *       suffices to have
 *           a corner there, which is tested first, or to contain the cell's centre
 *       in a cell that is entirely outside there is nothing to find
 *
 *   BB_OVERLAP_FLAGS   1 or 0; 1 only with BB_LOCATE_OCTREE or BB_LOCATE_OLBVH
 *   and those of locate_points.cl, and BB_LOCATE_ALL
 */
#include "bb_device.h"
#include "locate.clh"
#include "solids.clh"

#ifndef BB_OVERLAP_FLAGS
#define BB_OVERLAP_FLAGS 0
#endif

typedef struct bb_visitor {
    float3 lo, hi, from; /* tet_walk.clh: of the first mesh's tetrahedron */
    float3 corners[4]; /* the same */
    uint flags;
    uint tests;
    const bb_locate_tree *tree;
} bb_visitor;

#include "tet_walk.clh"

/* Returns whether one certainly contains a corner of the other, as in most pairs that meet. */
bool bb_overlap_corner(const bb_visitor *visitor, uint flags, const float3 corners[4])
{
    bb_tet_weights weights;
    for (uint c = 0; c < 4; c++)
        if ((bb_tet_point_of(corners[0], corners[1], corners[2], corners[3], flags,
                             visitor->corners[c], &weights) &&
             weights.strict) ||
            (bb_tet_point_of(visitor->corners[0], visitor->corners[1], visitor->corners[2],
                             visitor->corners[3], visitor->flags, corners[c], &weights) &&
             weights.strict))
            return true;
    return false;
}

bool bb_visit_tet(bb_visitor *visitor, uint prim, uint flags, const float3 corners[4])
{
    (void)prim;
    if ((flags & BB_TET_FLAT) != 0u)
        return false;
    float3 origin = visitor->corners[0], side = (float3)(0.0f);
    for (uint c = 0; c < 4; c++)
        side = BB_MAX(side, BB_MAX(fabs(corners[c] - origin), fabs(visitor->corners[c] - origin)));
    BB_STEP_BY(visitor->tree->recorder, BB_STEP_EXACT, 0);
#if !BB_HAS_EXACT
    return side.x > corners[0].x;
#endif
    bb_real unit = bb_solid_unit(side);
    bb_solid own = bb_solid_tet(visitor->corners, origin, unit);
    bb_solid other = bb_solid_tet(corners, origin, unit);
    visitor->tests++;
    if (bb_overlap_corner(visitor, flags, corners))
        return true;
    BB_STEP_BY(visitor->tree->recorder, BB_STEP_FURTHER, 0);
#if !BB_HAS_FURTHER
    return side.x > corners[0].x;
#endif
    return bb_tets_meet(&own, &other);
}

/* Returns whether it certainly contains the centre of a cell. */
bool bb_overlap_cell(const bb_visitor *visitor, float3 lo, float3 hi)
{
    bb_tet_weights weights;
    return bb_tet_point_of(visitor->corners[0], visitor->corners[1], visitor->corners[2],
                           visitor->corners[3], visitor->flags,
                           (0.5f * lo + 0.5f * hi) * visitor->tree->args.scale, &weights) &&
           weights.strict;
}

#if BB_LOCATE_OCTREE
bool bb_visit_cell(bb_visitor *visitor, uint index, uint2 node, uint3 cell)
{
    (void)index;
#if BB_OVERLAP_FLAGS
    const bb_cell_grid *grid = &visitor->tree->grid;
    if ((node.y & BB_OCTREE_OUTSIDE) != 0u)
        return false;
    if ((node.y & BB_OCTREE_INSIDE) != 0u &&
        bb_overlap_cell(visitor, bb_cell_corner(grid, cell), bb_cell_corner(grid, cell + 1u)))
        return true;
#else
    (void)cell;
#endif
    return bb_walk_cell(visitor->tree, node, visitor);
}
#elif BB_LOCATE_OLBVH
bool bb_visit_leaf(bb_visitor *visitor, uint leaf)
{
#if BB_OVERLAP_FLAGS
    const bb_olbvh *tree = &visitor->tree->olbvh;
    if ((tree->bf[leaf] & BB_OLBVH_OUTSIDE) != 0)
        return false;
    if ((tree->bf[leaf] & BB_OLBVH_INSIDE) != 0 &&
        bb_overlap_cell(visitor, vload3(2u * leaf, tree->bv), vload3(2u * leaf + 1u, tree->bv)))
        return true;
#endif
    return bb_walk_leaf(visitor->tree, leaf, visitor);
}
#endif

#if BB_OVERLAP_FLAGS
/* Returns whether a point is in a cell that is entirely inside. */
bool bb_overlap_inside(const bb_locate_tree *tree, float3 point, uint *visited)
{
    BB_STEP_BY(tree->recorder, BB_STEP_AGAIN, 0);
#if BB_LOCATE_OLBVH
    uint leaf = bb_olbvh_leaf(&tree->olbvh, point, visited);
    return leaf != BB_NONE && (tree->olbvh.bf[leaf] & BB_OLBVH_INSIDE) != 0;
#else
    uint2 leaf = bb_octree_leaf(tree->nodes, tree->args.root, &tree->grid, point,
                                visited BB_RECORDER_AT(tree));
    return (leaf.y & BB_OCTREE_INSIDE) != 0u;
#endif
}
#endif

/* `own_...`: of the first mesh; everything else is of the other. */
kernel void overlap_tets(BB_LOCATE_PARAMETERS,
                         global const uint *own_flags, global const uint *own_data,
                         bb_prim_ends own_ends, global const float *own_vertices, uint own_first,
                         uint own_count, global uint *results
#if BB_COUNTING
                         ,
                         global bb_count *counts BB_RECORD_ARGUMENTS
#endif
)
{
    uint i = (uint)get_global_id(0), kind;
    if (i >= own_count)
        return;
    bb_locate_tree tree;
    bb_visitor visitor;
    bb_location counted;
    counted.nodes = counted.restarts = 0;
    BB_LOCATE_TREE(tree);
    BB_LOCATE_RECORD(tree, i);
    visitor.tree = &tree;
    visitor.tests = 0;
    visitor.flags = own_flags[i];
    global const uint *corners = bb_prim_data(own_data, own_first + i, &own_ends, &kind);
    float3 places[4];
    for (uint c = 0; c < 4; c++) {
        places[c] = vload3(corners[c], own_vertices);
        visitor.corners[c] = places[c] * tree.args.scale;
    }
    float3 lo = BB_MIN(BB_MIN(places[0], places[1]), BB_MIN(places[2], places[3]));
    float3 hi = BB_MAX(BB_MAX(places[0], places[1]), BB_MAX(places[2], places[3]));
    visitor.lo = lo * tree.args.scale;
    visitor.hi = hi * tree.args.scale;
    bool meets = false, flat = (visitor.flags & BB_TET_FLAT) != 0u;
#if BB_OVERLAP_FLAGS
    for (uint c = 0; c < 4 && !meets && !flat && BB_HAS_POINTS; c++)
        meets = bb_overlap_inside(&tree, places[c], &counted.nodes);
#endif
    meets = meets || (!flat && bb_walk(&tree, lo, hi, &visitor, &counted));
    results[i] = meets ? 1u : 0u;
#if BB_COUNTING
    counts[i].nodes = counted.nodes;
    counts[i].prims = visitor.tests;
    counts[i].overflow = 0;
    counts[i].restarts = counted.restarts;
    BB_LOCATE_RECORDED(i);
#endif
}
