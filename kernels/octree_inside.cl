/* Finds which cells of the `octree` layout that list no boundary primitive are inside of the mesh,
 * and which are outside.
 *
 * See bb_locate_cell(); cells of which the answer is open are marked as neither.
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
    float3 lo = bb_cell_corner(grid, cell), hi = bb_cell_corner(grid, cell + 1u);
    bb_location found;
    bool inside = bb_locate_cell(tree, node.x, lo, hi, &found);
    if (inside)
        visitor->out[index].y = node.y | BB_OCTREE_INSIDE;
    else if (found.tet == BB_NONE)
        visitor->out[index].y = node.y | BB_OCTREE_OUTSIDE;
    return false;
}

kernel void octree_inside(BB_LOCATE_PARAMETERS, uint part)
{
    bb_locate_tree tree;
    bb_visitor visitor;
    BB_LOCATE_TREE(tree);
    uint id = (uint)get_global_id(0), visited = 0, bits = min(part, tree.grid.bits);
    if (id >> 3u * bits != 0u)
        return;
    visitor.tree = &tree;
    visitor.out = locate_nodes;
    uint mask = (1u << bits) - 1u, shift = tree.grid.bits - bits;
    uint3 lo = (uint3)(id & mask, id >> bits & mask, id >> 2u * bits) << shift;
    uint3 hi = lo + ((1u << shift) - 1u);
    bb_octree_walk(tree.nodes, tree.args.root, &tree.grid, lo, hi, &visitor, &visited);
}
