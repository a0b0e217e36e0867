/* stack.cl in lockstep: lockstep.clh. */
#include "kernel.clh"
#include "lockstep.clh"
#include "lockstep_stack.clh"
#include "lockstep_leaf.clh"

#define NODE_BYTES 64u

static uint lane_visit(lane *l, lane_more *m, global const float *nodes)
{
    global const float *pair = nodes + 16ul * l->link;
    float2 entry, exit;
    bb_box_distances(&l->slab, pair, l->search.tmin, l->search.tmax, &entry, &exit);
    const bool first = entry.x <= exit.x, second = entry.y <= exit.y;
    const bool swap = second && (!first || entry.y < entry.x);
    const uint a = as_uint(pair[12]), b = as_uint(pair[13]);
    l->link = swap ? b : a;
    l->state = first || second ? GO : BACK;
    l->pushed_links[0] = swap ? a : b;
    l->pushed_entries[0] = swap ? entry.x : entry.y;
    return first && second ? 1u : 0u;
}

#include "lockstep_trace.clh"
