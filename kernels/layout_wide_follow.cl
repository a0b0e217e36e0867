/* Gives wide nodes new boxes when the tree has kept its links: children keep the places that
 * layout_wide.cl gave them, and no pair nodes are needed.
 *
 *   once: find the source of each place: from its side of a pair               (wide_sources)
 *                                     or from its node of the tree       (wide_nodes_sources)
 *   then: the union of the sources' boxes, scaled and padded                    (wide_follow)
 *
 * The choice of pairs that a node absorbs and of children's places remains the best one for the
 * boxes at the time the layout was made.
 */
#include "bb_device.h"

#include "padding.clh"
#include "siblings.clh"
#include "wide_boxes.clh"

/* of_sides: per side of a pair (pair_sides). sides, sources: per place of a node. */
kernel void wide_sources(global const uint *sides, uint count,
                         global const bb_siblings *of_sides, global bb_siblings *sources)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    bb_siblings none = {BB_NONE, 0};
    sources[i] = sides[i] != BB_NONE ? of_sides[sides[i]] : none;
}

/* The same if `sides` has nodes of the tree (layout_wide_direct_write.cl). */
kernel void wide_nodes_sources(global const uint *sides, uint count, global bb_siblings *sources)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    bb_siblings siblings = {sides[i], sides[i] != BB_NONE ? 1u : 0u};
    sources[i] = siblings;
}

/* `reach`: per node of the tree, used if has_reach; otherwise a box's own longest side is used. */
kernel void wide_follow(global const bb_node *tree, global const bb_siblings *sources, uint count,
                        float scale, global const float *reach, uint has_reach,
                        global bb_wide *nodes)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    bb_wide_boxes boxes;
    bb_wide_clear(&boxes);
    for (uint c = 0; c < BB_WIDTH; c++) {
        bb_siblings siblings = sources[(ulong)n * BB_WIDTH + c];
        if (siblings.count == 0u)
            continue;
        float lo[3], hi[3], longest;
        bb_siblings_box(tree, has_reach != 0 ? reach : NULL, siblings, lo, hi, &longest);
        bb_scale_and_pad(lo, hi, scale, has_reach != 0 ? longest : -1.0f);
        for (uint axis = 0; axis < 3; axis++) {
            boxes.planes[2u * axis * BB_WIDTH + c] = lo[axis];
            boxes.planes[(2u * axis + 1u) * BB_WIDTH + c] = hi[axis];
        }
        boxes.places |= 1u << c;
    }
    bb_wide_write(&boxes, nodes + n);
}
