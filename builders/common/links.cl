/* Skips and depths from siblings, for trees of any shape.
 *
 *   state(n) = { up: parent, distance to it,
 *                heir: n if it has a sibling after it, else its parent }
 *   repeat until nothing changes, from one list of states to the other:             (links_jump)
 *       distance(n) += distance(up(n)); up(n) = up(up(n)); heir(n) = heir(heir(n))
 *   skip(n) = skip(heir(n)): that of the nearest node, from n up, that has a sibling  (links_write)
 *
 * Pointer jumping: Wyllie 1979, "The Complexity of Parallel Computations". Log2 of the depth
 * rounds, each over all nodes; no order between work-groups is asked for inside of a round. Limits:
 * 32 bytes per node, and a round for what turns out to be done.
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

/* changed[0]: 0 before. */
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

/* info: zeroed before, but for what the host knows. An heir's skip is written by nobody. */
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

/* Before the skips are written. */
kernel void links_arity(global const bb_node *nodes, uint count, volatile global bb_tree_info *info)
{
    uint n = get_global_id(0), arity = 0;
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) != 0)
        return;
    for (uint c = nodes[n].first; c != BB_NONE; c = nodes[c].skip)
        arity++;
    atomic_max(&info->arity, arity);
}
