/* Finds which leaves of an OLBVH that list no boundary primitive are inside of the mesh, and which
 * are outside (bb_locate_cell()); sets bits of BF. The paper takes all of them as inside (section
 * 4.4). Launched for all leaves.
 *
 *   -D: those of locate_points.cl, with BB_LOCATE_OLBVH
 */
#include "bb_device.h"
#include "locate.clh"

kernel void olbvh_inside(BB_LOCATE_PARAMETERS)
{
    bb_locate_tree tree;
    BB_LOCATE_TREE(tree);
    const bb_olbvh *olbvh = &tree.olbvh;
    uint leaf = (uint)get_global_id(0) + (olbvh->levels > 0u ? olbvh->no[olbvh->levels - 1u] : 0u);
    if (leaf >= olbvh->no[olbvh->levels])
        return;
    uchar flags = olbvh->bf[leaf] & BB_OLBVH_BOUNDARY;
    bb_location found;
    if (flags == 0) {
        bool inside = bb_locate_cell(&tree, leaf, vload3(2u * leaf, olbvh->bv),
                                     vload3(2u * leaf + 1u, olbvh->bv), &found);
        flags |= inside ? BB_OLBVH_INSIDE : found.tet == BB_NONE ? BB_OLBVH_OUTSIDE : 0u;
    }
    locate_bf[leaf] = flags;
}
