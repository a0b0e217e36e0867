/* strips: a leaf per primitive. */
#include "strips.clh"

kernel void strips_leaves(global const bb_box *boxes, uint count, global bb_node *nodes,
                          global uint *refs)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    bb_node leaf;
    for (uint axis = 0; axis < 3; axis++) {
        leaf.lo[axis] = boxes[i].lo[axis];
        leaf.hi[axis] = boxes[i].hi[axis];
    }
    bool last = i % STRIPS_WIDTH == STRIPS_WIDTH - 1 || i == count - 1;
    leaf.first = BB_LEAF_BIT | i;
    leaf.skip = last ? strip_skip(i / STRIPS_WIDTH, count) : leaf_node(i + 1, count);
    nodes[leaf_node(i, count)] = leaf;
    refs[i] = i | BB_LAST_BIT;
}
