/* Traversal of pair or wide nodes by packets of rays, with a stack.
 *
 *   for each packet of the batch:
 *     loop: while link is a node:
 *               which of its boxes may the packet's bundle meet? (one test of all boxes)
 *               test each of these with all rays; push it with the rays' distances, the farthest
 *                   first; go to the last one
 *           test each primitive of the leaf with all rays
 *           pop until some ray's distance is not beyond its hit
 *           few such rays: trace each on its own from there, as stack and stack8 do; pop again
 *
 * Wald, Slusallek, Benthin, Wagner 2001, "Interactive Rendering with Coherent Ray Tracing"; Boulos
 * et al. 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets"; Benthin et al.
 * 2012, "Combining Single and Packet-Ray Tracing for Arbitrary Ray Distributions on the Intel MIC
 * Architecture" (few rays on their own); Haines and Greenberg 1986, "The Light Buffer" (any hit:
 * the leaf that stopped a ray is tested first with the next packet). Pro: coherent rays share
 * loads, branches and the stack, and a box of the bundle stands for many. Con: rays that part
 * company waste lanes, and the order of visit is the packet's, not each ray's. For CPUs.
 *
 *   BB_WIDTH        2, 4 or 8: places for children in a node
 *   BB_FEW          so many rays are traced on their own
 *   BB_STACK_SIZE   entries
 *   and those of packet.clh, trace.clh
 */
#if BB_WIDTH == 2
#include "stack_pair.clh"
#else
#include "stack_wide.clh"
#endif
#include "packet.clh"
#include "ray_order.clh"

#ifndef BB_FEW
#define BB_FEW 4
#endif
#ifdef BB_QUERY_ANY
#define BB_ANY_HIT 1
#else
#define BB_ANY_HIT 0
#endif
#if BB_WIDTH == 2
#define BB_TRACE_NODE float /* bb_pair[] */
#define BB_PLANES_AT(nodes, link) ((nodes) + 16ul * (link))
#define BB_LINKS_AT(nodes, link) ((global const uint *)((nodes) + 16ul * (link)) + 12)
#define BB_CHILDREN_AT(nodes, link) 3u
#else
#define BB_TRACE_NODE bb_wide
#define BB_PLANES_AT(nodes, link) (nodes)[link].planes
#define BB_LINKS_AT(nodes, link) (nodes)[link].links
#define BB_CHILDREN_AT(nodes, link) ((1u << (nodes)[link].count) - 1u)
#endif
#include "trace_alone.clh"

/* A node that waits on the stack. */
typedef struct bb_packet_waiting {
    bb_ray_floats entry; /* where each ray enters its box; INFINITY: it does not */
    float nearest;   /* the least of these */
    uint link;
} bb_packet_waiting;

/* Traces some rays of a packet, given as bits, one by one from `link` on. Returns those whose stack
 * was too short, which are traced no further. */
static uint packet_few(bb_packet *p, uint which, global const BB_TRACE_NODE *nodes,
                       global const float *leaf_prims, uint link, const bb_prim_ends *ends)
{
    uint failed = 0;
    while (which != 0u) {
        uint ray = 31u - clz(which);
        which ^= 1u << ray;
        bb_lone scratch, *lone = bb_lone_of(p, ray, &scratch);
        bool enough = trace_ray(&lone->search, &lone->setup, &lone->slab, nodes, leaf_prims, link,
                                ends);
        bb_lone_return(p, ray, lone);
        if (enough)
            continue;
        failed |= 1u << ray;
        ((float *)&p->tmax)[ray] = -INFINITY;
    }
    bb_packet_shortened(p);
    return failed;
}

/* Pushes the children of a node, given as bits, that some ray meets, the farthest first. Returns
 * false, and pushes none, if the stack is too short. */
bool packet_node(bb_packet *p, bb_ray_floats entered, global const float *planes, uint children,
                 global const uint *links, bb_packet_waiting stack[BB_STACK_SIZE + 1], uint *top)
{
    const uint bottom = *top;
    uint met = bb_packet_may_meet(p, planes) & children;
    while (met != 0u) {
        uint child = 31u - clz(met);
        met ^= 1u << child;
        BB_PACKET_BOX(p);
        bb_ray_floats entry = bb_packet_entries(p, entered, planes, child);
        float nearest = bb_least_of(entry);
        if (nearest == INFINITY)
            continue;
        if (*top > BB_STACK_SIZE) {
            *top = bottom;
            return false;
        }
        BB_PACKET_ENTRY(p, BB_STEP_PUSH, *top, BB_RAY_BITS(entry < INFINITY));
        uint at = (*top)++;
        for (; at > bottom && stack[at - 1u].nearest < nearest; at--)
            stack[at] = stack[at - 1u];
        stack[at].entry = entry;
        stack[at].nearest = nearest;
        stack[at].link = links[child];
    }
    return true;
}

/* Traces a packet. Where its stack is too short, which has to hold what any of the rays meets, each
 * goes on alone. Returns the rays whose own stack was too short, as bits. Any hit: *blocker is the
 * leaf that stopped a ray last, and is tested first; BB_NONE: there is none, or it stopped none of
 * the last packet. */
static uint trace_packet(bb_packet *p, global const BB_TRACE_NODE *nodes,
                         global const float *leaf_prims, uint root, const bb_prim_ends *ends,
                         uint *blocker)
{
    bb_packet_waiting stack[BB_STACK_SIZE + 1]; /* the node that is next is on it, too */
    uint top = 1, failed = 0;
    stack[0].entry = p->tmin <= p->tmax ? p->tmin : (bb_ray_floats)(INFINITY);
    stack[0].link = root;
    if (BB_ANY_HIT && *blocker != BB_NONE && *blocker != root) {
        stack[1].entry = stack[0].entry;
        stack[1].link = *blocker;
        top = 2;
    }
    while (top > 0u) {
        top--;
        bb_ray_floats entered = stack[top].entry;
        uint link = stack[top].link, active = BB_RAY_BITS(entered <= p->tmax);
        BB_PACKET_ENTRY(p, BB_STEP_POP, top, active);
        if (active == 0u)
            continue;
        bool alone = popcount(active) <= BB_FEW;
        if (!alone && (link & BB_LEAF_BIT) != 0) {
            bb_packet_leaf(p, entered, leaf_prims, link, ends);
            if (BB_RAY_BITS(entered <= p->tmax) != active)
                *blocker = link;
            else if (*blocker == link)
                *blocker = BB_NONE;
        } else if (!alone) {
            BB_PACKET_NODE(p, link);
            alone = !packet_node(p, entered, BB_PLANES_AT(nodes, link), BB_CHILDREN_AT(nodes, link),
                                 BB_LINKS_AT(nodes, link), stack, &top);
        }
        if (alone)
            failed |= packet_few(p, active, nodes, leaf_prims, link, ends);
    }
    return failed;
}

/* Not inlined: a driver that runs a group's work-items in a loop might keep the packets of each. */
__attribute__((noinline)) static void
trace_batch(uint first, uint count, global const BB_TRACE_NODE *nodes,
            global const float *leaf_prims, uint root, const bb_prim_ends *ends, float scale,
            global const bb_ray *rays BB_RAY_ORDER_ARGUMENT,
            global bb_result *results BB_COUNTS_ARGUMENT BB_QUERY_ARGUMENTS)
{
    uint blocker = BB_NONE;
    for (uint at = 0; at < count; at += BB_PACKET) {
        uint ids[BB_PACKET], taken = min(count - at, (uint)BB_PACKET);
        for (uint i = 0; i < BB_PACKET; i++)
            ids[i] = BB_RAY_AT(first + at + min(i, taken - 1u));
        bb_packet packet;
        uint left_out = bb_packet_make(&packet, rays, ids, taken, scale BB_QUERY_VALUES);
        for (uint rest = left_out; rest != 0u; rest &= rest - 1u)
            trace_and_write(ids[31u - clz(rest & -rest)], nodes, leaf_prims, root, ends, scale,
                            rays, results BB_COUNTS BB_QUERY_VALUES);
#if BB_RECORDING
        bb_packet_record_start(&packet, ids, taken, left_out, step_ends, steps, step_counts);
#endif
        uint failed = trace_packet(&packet, nodes, leaf_prims, root, ends, &blocker);
#if !BB_HITS_ONLY
        for (uint i = 0; i < taken; i++)
            while ((failed >> i & 1u) == 0u && BB_QUERY_AGAIN(&packet.lone[i].search))
                if (!trace_ray(&packet.lone[i].search, &packet.lone[i].setup, &packet.lone[i].slab,
                               nodes, leaf_prims, root, ends))
                    failed |= 1u << i;
#endif
        bb_packet_write(&packet, ids, ((1u << taken) - 1u) & ~left_out, failed,
                        results BB_COUNTS);
#if BB_RECORDING
        bb_packet_record_end(&packet, ids, step_counts);
#endif
    }
}

#include "trace.clh"
