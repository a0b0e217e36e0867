/* The `olbvh` layout: the six arrays of an OLBVH as published (Stroeter, Mueller-Roemer, Stork,
 * Fellner 2020, section 3.1), without anything else.
 *
 *   BV  float[6 nodes]    lower and upper corner
 *   P   uint[references]  primitives, by Morton code
 *   CO  uint[inner + 1]   children of node i: those from CO[i] + 1 to CO[i + 1]
 *   PO  uint[nodes + 1]   primitives of node i: those from PO[i] to PO[i + 1] - 1; from 0 where a
 *                         level begins
 *   BF  uchar[nodes]      1: lists a boundary primitive
 *   NO  uint[levels]      number of nodes down to each level
 */
#include "bb_device.h"
#include "cell_grid_shared.h"

kernel void olbvh_layout_nodes(global const bb_node *nodes, global const uint *cells,
                               global const uint *tree_co, global const uint *tree_po, uint count,
                               uint refs, global float *bv, global uint *co, global uint *po,
                               global uchar *bf)
{
    uint n = (uint)get_global_id(0);
    if (n >= count)
        return;
    vstore3(vload3(0, nodes[n].lo), 2u * n, bv);
    vstore3(vload3(0, nodes[n].hi), 2u * n + 1u, bv);
    bf[n] = cells[n] >> BB_CELL_MARKED_SHIFT > 0u ? 1 : 0;
    po[n] = tree_po[n];
    if (n + 1u == count)
        po[count] = refs;
    if ((nodes[n].first & BB_LEAF_BIT) == 0u) {
        co[n] = tree_co[n];
        if ((nodes[n + 1u].first & BB_LEAF_BIT) != 0u)
            co[n + 1u] = count - 1u;
    }
}

kernel void olbvh_layout_refs(global const uint *refs, uint count, global uint *p)
{
    uint i = (uint)get_global_id(0);
    if (i < count)
        p[i] = refs[i] & BB_INDEX_MASK;
}

/* The last child of a level's last node is the next level's last node. */
kernel void olbvh_layout_levels(global const uint *co, uint levels, global uint *no)
{
    if (get_global_id(0) != 0)
        return;
    no[0] = 1;
    for (uint level = 1; level < levels; level++)
        no[level] = co[no[level - 1u]] + 1u;
}
