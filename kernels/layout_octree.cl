/* The `octree` layout: the part of an octree of cells that a descent by octants needs.
 *
 *   node n: x = first(n), a node or BB_LEAF_BIT | first leaf primitive
 *           y = bits 0 to 7: octants with a child; BB_OCTREE_BOUNDARY; of a leaf from bit
 *               BB_OCTREE_MARKED_SHIFT on: how many references to primitives of the boundary come
 *               first, at most BB_OCTREE_MARKED_MAX
 *   and the grid of the cells, whose box is the root's
 *
 * The k-th child of a node is in the k-th of its octants, so no boxes are needed.
 */
#include "bb_device.h"
#include "octree.clh"

kernel void octree_nodes(global const bb_node *nodes, global const uint *cells, uint count,
                         global uint2 *out)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    uint first = nodes[n].first, octants = 0, marked = cells[n] >> BB_CELL_MARKED_SHIFT;
    if ((first & BB_LEAF_BIT) != 0)
        octants |= min(marked, BB_OCTREE_MARKED_MAX) << BB_OCTREE_MARKED_SHIFT;
    else
        for (uint child = first; child != nodes[n].skip && octants <= 0xFFu; child++) {
            octants |= 1u << (cells[child] & BB_CELL_OCTANT);
            if (nodes[child].skip == nodes[n].skip)
                break;
        }
    if (marked > 0u)
        octants |= BB_OCTREE_BOUNDARY;
    out[n] = (uint2)(first, octants);
}

kernel void octree_grid(global const bb_node *nodes, uint root, uint bits,
                        global bb_cell_grid *grid)
{
    if (get_global_id(0) != 0)
        return;
    grid->bits = bits;
    grid->cells = 1u << bits;
    grid->pad = 0;
    for (uint axis = 0; axis < 3; axis++) {
        float lo = nodes[root].lo[axis], hi = nodes[root].hi[axis];
        float step = ldexp(hi - lo, -(int)bits);
        grid->lo[axis] = lo;
        grid->hi[axis] = hi;
        grid->step[axis] = step >= FLT_MIN ? step : 0.0f;
    }
}
