/* strips: the nodes above the leaves.
 *
 *   for each strip, in parallel: the box of its leaves      (level 1)
 *   then by one work-item: the root, the box of the strips  (level 0)
 */
#include "strips.clh"

/* The box of `count` nodes from `first` on, and links. */
void make_node(global bb_node *nodes, uint index, uint first, uint count, uint skip)
{
    bb_node node = nodes[first];
    for (uint i = 1; i < count; i++)
        for (uint axis = 0; axis < 3; axis++) {
            node.lo[axis] = BB_MIN(nodes[first + i].lo[axis], node.lo[axis]);
            node.hi[axis] = BB_MAX(nodes[first + i].hi[axis], node.hi[axis]);
        }
    node.first = first;
    node.skip = skip;
    nodes[index] = node;
}

kernel void strips_inner(uint count, global bb_node *nodes)
{
    uint strip = get_global_id(0), begin = strip * STRIPS_WIDTH;
    if (begin >= count)
        return;
    make_node(nodes, strip_node(strip), leaf_node(begin, count),
              min(count - begin, (uint)STRIPS_WIDTH), strip_skip(strip, count));
}

kernel void strips_root(uint count, global bb_node *nodes, global bb_tree_info *info)
{
    uint strips = STRIPS_COUNT(count);
    if (get_global_id(0) > 0)
        return;
    make_node(nodes, 0, strip_node(0), strips, BB_NONE);
    info->root = 0;
    info->node_count = 1 + strips + count;
    info->leaf_count = count;
    info->ref_count = count;
    info->arity = max(strips, min(count, (uint)STRIPS_WIDTH));
    info->depth = 2;
}
