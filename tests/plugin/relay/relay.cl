/* relay: a tree as it was, node by node and reference by reference. */
#include "bb_device.h"

kernel void relay_copy(global const bb_node *from_nodes, uint nodes, global const uint *from_refs,
                       uint refs, global const bb_tree_info *from_info, global bb_node *to_nodes,
                       global uint *to_refs, global bb_tree_info *to_info)
{
    uint i = get_global_id(0);
    if (i < nodes)
        to_nodes[i] = from_nodes[i];
    if (i < refs)
        to_refs[i] = from_refs[i];
    if (i == 0)
        *to_info = *from_info;
}
