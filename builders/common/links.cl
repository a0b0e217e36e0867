/* Skips and depths from siblings, for trees of any shape.
 *
 *   state(n) = { up: parent, distance to it,
 *                heir: n if it has a next sibling, else its parent }
 *   repeat until nothing changes, from one list of states to the other:             (links_jump)
 *       distance(n) += distance(up(n)); up(n) = up(up(n)); heir(n) = heir(heir(n))
 *   skip(n) = skip(heir(n)), the skip of the nearest node, from n up, with a sibling  (links_write)
 *
 * Pointer jumping: Wyllie 1979, "The Complexity of Parallel Computations". There are log2(depth)
 * rounds, each over all nodes; a round needs no order between work-groups. Limits: 32 bytes per
 * node, and a last round that finds nothing to do.
 */
#include "bb_device.h"

typedef struct link_state {
    uint up, distance, heir, pad;
} link_state;

kernel void links_start(global const bb_node *nodes, uint count, uint root,
                        global link_state *states)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    if (n == root) {
        link_state state = {root, 0, root, 0};
        states[n] = state;
    }
    if ((nodes[n].first & BB_LEAF_BIT) != 0)
        return;
    for (uint c = nodes[n].first; c != BB_NONE; c = nodes[c].skip) {
        link_state state = {n, 1, nodes[c].skip == BB_NONE ? n : c, 0};
        states[c] = state;
    }
}

/* changed[0] must be 0 before. */
kernel void links_jump(uint count, global const link_state *from, global link_state *to,
                       global uint *changed)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    link_state state = from[n], above = from[state.up];
    uint heir = from[state.heir].heir;
    if (above.up != state.up || heir != state.heir)
        changed[0] = 1;
    state.distance += above.distance;
    state.up = above.up;
    state.heir = heir;
    to[n] = state;
}

/* info: zero before, except for what the host knows. Nothing writes the skip of an heir. */
kernel void links_write(global const link_state *states, uint count, global bb_node *nodes,
                        volatile global bb_tree_info *info)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    uint heir = states[n].heir;
    if (heir != n)
        nodes[n].skip = nodes[heir].skip;
    if ((nodes[n].first & BB_LEAF_BIT) != 0) {
        atomic_inc(&info->leaf_count);
        atomic_max(&info->depth, states[n].distance);
    }
}

/* Must run before the skips are written. */
kernel void links_arity(global const bb_node *nodes, uint count, volatile global bb_tree_info *info)
{
    uint n = get_global_id(0), arity = 0;
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) != 0)
        return;
    for (uint c = nodes[n].first; c != BB_NONE; c = nodes[c].skip)
        arity++;
    atomic_max(&info->arity, arity);
}
