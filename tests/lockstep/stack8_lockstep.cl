/* stack_wide.cl, nodes of 8 children by distance, in lockstep: lockstep.clh. */
#include "kernel.clh"
#include "lockstep.clh"
#include "lockstep_stack.clh"
#include "lockstep_leaf.clh"

#define NODE_BYTES 256u

static uint lane_visit(lane *l, lane_more *m, global const bb_wide *nodes)
{
    global const bb_wide *node = nodes + l->link;
    bb_boxes entry, exit;
    float entries[8], exits[8];
    uint pushes = 0;
    bb_box_distances(&l->slab, node->planes, l->search.tmin, l->search.tmax, &entry, &exit);
    vstore8(entry, 0, entries);
    vstore8(exit, 0, exits);
    l->state = BACK;
    /* from the last child to the first: one that is nearer than all before it is gone to, the one
     * before it pushed; the others are pushed below those that are nearer */
    float nearest = 0.0f;
    for (uint c = 8; c-- > 0u;) {
        if (!(entries[c] <= exits[c]))
            continue;
        uint link = node->links[c], at = pushes;
        float distance = entries[c];
        if (l->state == BACK) {
            l->state = GO;
            l->link = link;
            nearest = distance;
            continue;
        }
        if (distance < nearest) {
            uint other = l->link;
            float farther = nearest;
            l->link = link;
            nearest = distance;
            link = other;
            distance = farther;
        } else {
            for (; at > 0u && l->pushed_entries[at - 1u] < distance; at--) {
                l->pushed_links[at] = l->pushed_links[at - 1u];
                l->pushed_entries[at] = l->pushed_entries[at - 1u];
            }
        }
        l->pushed_links[at] = link;
        l->pushed_entries[at] = distance;
        pushes++;
    }
    return pushes;
}

#include "lockstep_trace.clh"
