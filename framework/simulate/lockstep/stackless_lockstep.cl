/* stackless.cl in lockstep: lockstep.clh. A lane that is on its way back goes to `skip`. */
#include "kernel.clh"
#include "lockstep.clh"

typedef struct lane_more {
    uint skip, prim;
    bool leaf;
} lane_more;

#define NODE_BYTES 32u
#define PLACE(entry) (entry)
#define ROOM (~0u)
#define ONCE 1
#define RESTARTS 0

static void lane_start(lane *l, lane_more *m)
{
    m->leaf = false;
}

static uint lane_node(const lane *l, const lane_more *m)
{
    return l->link;
}

static void go_on(lane *l, uint link)
{
    l->link = link;
    l->state = link == BB_NONE ? DONE : GO;
}

static uint lane_visit(lane *l, lane_more *m, global const float *nodes)
{
    global const float *node = nodes + 8ul * l->link;
    const uint first = as_uint(node[3]);
    m->skip = as_uint(node[7]);
    if (!bb_meets_node(&l->slab, node, l->search.tmin, l->search.tmax)) {
        go_on(l, m->skip);
    } else if ((first & BB_LEAF_BIT) == 0u) {
        l->link = first;
    } else {
        m->leaf = true;
        m->prim = first & BB_INDEX_MASK;
    }
    return 0u;
}

static void lane_push(lane *l, lane_more *m, uint k)
{
}

static bool lane_at_prim(const lane *l, const lane_more *m)
{
    return l->state == GO && m->leaf;
}

static uint lane_prim(const lane *l, const lane_more *m)
{
    return m->prim;
}

static void lane_next_prim(lane *l, lane_more *m, bool last)
{
    m->prim++;
    if (!last)
        return;
    m->leaf = false;
    go_on(l, m->skip);
}

static bool lane_pops(const lane *l, const lane_more *m)
{
    return false;
}

static void lane_pop(lane *l, lane_more *m)
{
}

#include "lockstep_kernel.clh"
