/* Finds which cells of the `octree` layout that list no boundary primitive are inside of the mesh,
 * and which are outside.
 *
 * No part of the mesh's boundary is in such a cell, so the whole cell is on the same side as any of
 * its points: inside if a tetrahedron certainly contains the point, outside if none does. (Such
 * cells can be outside, since cells list primitives by their boxes.) If rounding leaves the answer
 * open, the cell is marked as neither; therefore the point is not the centre, which in regular
 * meshes is on faces of tetrahedra.
 *
 * Launched for all cells of a grid of 2^part a side, or of the tree's grid if that is coarser; each
 * work-item walks to the leaves within its cell.
 *
 *   -D: those of locate_points.cl, with BB_LOCATE_OCTREE
 */
#include "bb_device.h"
#include "locate.clh"

typedef struct bb_visitor {
    const bb_locate_tree *tree;
    global uint2 *out;
} bb_visitor;

#include "octree_walk.clh"

bool bb_visit_cell(bb_visitor *visitor, uint index, uint2 node, uint3 cell)
{
    const bb_locate_tree *tree = visitor->tree;
    const bb_cell_grid *grid = &tree->grid;
    if ((node.y & BB_OCTREE_BOUNDARY) != 0u)
        return false;
    float3 lo = (float3)(bb_cell_plane(grid, 0, cell.x), bb_cell_plane(grid, 1, cell.y),
                         bb_cell_plane(grid, 2, cell.z));
    float3 hi = (float3)(bb_cell_plane(grid, 0, cell.x + 1u), bb_cell_plane(grid, 1, cell.y + 1u),
                         bb_cell_plane(grid, 2, cell.z + 1u));
    bb_location found;
    found.tet = BB_NONE;
    found.tests = 0;
    const float3 part = (float3)(0.37f, 0.41f, 0.59f);
    float3 point = (1.0f - part) * lo + part * hi;
    bool inside = bb_locate_leaf(tree, node.x, point * tree->args.scale, &found);
    if (inside)
        visitor->out[index].y = node.y | BB_OCTREE_INSIDE;
    else if (found.tet == BB_NONE)
        visitor->out[index].y = node.y | BB_OCTREE_OUTSIDE;
    return false;
}

kernel void octree_inside(global uint2 *nodes, global const float *leaf_prims,
                          global const bb_cell_grid *grid, bb_locate_args args,
                          global const uint *flags, uint part)
{
    uint id = (uint)get_global_id(0), visited = 0, bits = min(part, grid->bits);
    if (id >> 3u * bits != 0u)
        return;
    bb_locate_tree tree;
    bb_visitor visitor;
    tree.nodes = nodes;
    tree.leaf_prims = leaf_prims;
    tree.flags = flags;
    tree.args = args;
    tree.grid = *grid;
    visitor.tree = &tree;
    visitor.out = nodes;
    uint mask = (1u << bits) - 1u, shift = tree.grid.bits - bits;
    uint3 lo = (uint3)(id & mask, id >> bits & mask, id >> 2u * bits) << shift;
    uint3 hi = lo + ((1u << shift) - 1u);
    bb_octree_walk(nodes, args.root, &tree.grid, lo, hi, &visitor, &visited);
}
