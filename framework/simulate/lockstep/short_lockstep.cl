/* short.cl in lockstep, with entries: lockstep.clh. */
#include "kernel.clh"
#include "lockstep.clh"

typedef struct lane_more {
    bb_trail trail;
    bb_short_stack stack;
    uint level, retrace, open;
} lane_more;

#include "lockstep_leaf.clh"

#define NODE_BYTES 64u
#define PLACE(entry) ((entry) % BB_ENTRIES)
#define ROOM (~0u)
#define ONCE 0
#define RESTARTS 1

static void lane_start(lane *l, lane_more *m)
{
    bb_trail_start(&m->trail);
    bb_short_stack_start(&m->stack);
    m->level = m->retrace = 0;
    m->open = BB_NONE;
}

static uint lane_visit(lane *l, lane_more *m, global const bb_wide *nodes)
{
    uint met[BB_CHILDREN], pushes = 0;
    float distances[BB_CHILDREN];
    uint many = short_children(&l->search, &l->slab, nodes + l->link, met, distances);
    uint at = m->level < m->retrace ? bb_trail_place(&m->trail, m->level) : 0u;
    if (at >= many) {
        l->state = BACK;
        return 0u;
    }
    for (uint i = many; i-- > at + 1u; pushes++) {
        l->pushed_links[pushes] = met[i];
        l->pushed_entries[pushes] = distances[i];
        l->pushed_last[pushes] = i == many - 1u;
    }
    bb_trail_take(&m->trail, m->level, at, at + 1u < many);
    l->link = met[at];
    m->level++;
    return pushes;
}

static void lane_push(lane *l, lane_more *m, uint k)
{
    bb_short_stack_push(&m->stack, l->pushed_links[k], l->pushed_entries[k], l->pushed_last[k]);
}

/* Finds where the trail goes on, once for each way back. */
static bool finds_open(lane *l, lane_more *m)
{
    if (l->state == BACK && m->open == BB_NONE) {
        m->open = bb_trail_next(&m->trail, m->level);
        if (m->open == BB_NONE)
            l->state = DONE;
    }
    return l->state == BACK;
}

static bool lane_pops(lane *l, lane_more *m)
{
    return finds_open(l, m) && m->stack.size > 0u;
}

static void lane_pop(lane *l, lane_more *m)
{
    float distance;
    bool last;
    l->link = bb_short_stack_pop(&m->stack, &distance, &last);
    if (last)
        bb_trail_close(&m->trail, m->open);
    m->level = m->open + 1u;
    m->retrace = 0u;
    m->open = BB_NONE;
    l->state = distance > l->search.tmax ? BACK : GO;
}

static bool lane_restarts(lane *l, lane_more *m)
{
    return finds_open(l, m) && m->stack.size == 0u;
}

static void lane_restart(lane *l, lane_more *m)
{
    l->link = l->root;
    m->level = 0u;
    m->retrace = m->open + 1u;
    m->open = BB_NONE;
    l->state = GO;
}

#include "lockstep_kernel.clh"
