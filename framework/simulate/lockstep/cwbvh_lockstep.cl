/* cwbvh.cl in lockstep: lockstep.clh. */
#include "kernel.clh"
#include "lockstep.clh"

typedef struct lane_more {
    uint2 stack[BB_STACK_SIZE], group;
    uint turn, prims, first, prim;
} lane_more;

#define NODE_BYTES 80u
#define PLACE(entry) (entry)
#define ROOM (~0u)
#define ONCE 1
#define RESTARTS 0

/* What comes next: nodes and primitives first, then the stack. */
static void look_around(lane *l, lane_more *m)
{
    if ((m->group.y & BB_GROUP_NODES) != 0u) {
        uint2 rest = m->group;
        l->state = GO;
        l->link = take_node(&rest, m->turn);
    } else {
        l->state = BACK;
        l->link = BB_NONE;
    }
}

static void lane_start(lane *l, lane_more *m)
{
    const float3 d = l->setup.d;
    m->turn = (d.x < 0.0f ? 0u : 1u) | (d.y < 0.0f ? 0u : 2u) | (d.z < 0.0f ? 0u : 4u);
    const bool leaf = (l->root & BB_LEAF_BIT) != 0u;
    m->group = leaf ? (uint2)(0u) : (uint2)(l->root, 1u << (24u + m->turn));
    m->prims = leaf ? (1u << (l->root & BB_INDEX_MASK)) - 1u : 0u;
    m->first = m->prim = 0u;
    look_around(l, m);
}

static uint lane_node(const lane *l, const lane_more *m)
{
    return l->link;
}

/* Starts with the first of the primitives left. */
static void take_prim(lane_more *m)
{
    if (m->prims != 0u)
        m->prim = m->first + 31u - clz(m->prims & (0u - m->prims));
}

static uint lane_visit(lane *l, lane_more *m, global const bb_cwbvh *nodes)
{
    const uint node = take_node(&m->group, m->turn);
    const bool pushes = (m->group.y & BB_GROUP_NODES) != 0u;
    l->pushed_links[0] = m->group.x;
    l->pushed_links[1] = m->group.y;
    uint inner;
    uint2 base;
    uint met = bb_cwbvh_meet(&l->slab, nodes + node, m->turn, l->search.tmin, l->search.tmax,
                             &inner, &base);
    m->group = (uint2)(base.x, (met & BB_GROUP_NODES) | inner);
    m->prims = met & ~BB_GROUP_NODES;
    m->first = base.y;
    take_prim(m);
    look_around(l, m);
    return pushes ? 1u : 0u;
}

static void lane_push(lane *l, lane_more *m, uint k)
{
    m->stack[l->top] = (uint2)(l->pushed_links[0], l->pushed_links[1]);
}

static bool lane_at_prim(const lane *l, const lane_more *m)
{
    return l->state != DONE && m->prims != 0u;
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
    m->prims &= m->prims - 1u;
    take_prim(m);
}

static bool lane_pops(lane *l, const lane_more *m)
{
    if (l->state == BACK && l->top == 0u)
        l->state = DONE;
    return l->state == BACK;
}

static void lane_pop(lane *l, lane_more *m)
{
    m->group = m->stack[l->top];
    look_around(l, m);
}

#include "lockstep_kernel.clh"
