/* Traversal by packets of 8 or 16 rays, of pair or wide nodes, with a stack.
 *
 *   for each packet of the batch:
 *     loop: while link is a node:
 *               which of its boxes may the packet's intervals meet? (one test of all boxes)
 *               test each of these with all rays; none met: pop
 *               go to the nearest, push the others with the rays' distances, the farthest first
 *           test each primitive of the leaf with all rays
 *           pop until some ray's distance is nearer than its hit
 *           few such rays: trace each on its own from there, as stack and stack8 do; pop again
 *
 * Wald, Slusallek, Benthin, Wagner 2001, "Interactive Rendering with Coherent Ray Tracing";
 * Reshetov, Soupikov, Hurley 2005, "Multi-Level Ray Tracing Algorithm" and Boulos et al. 2006 (the
 * intervals); Benthin et al. 2012, "Combining Single and Packet-Ray Tracing for Arbitrary Ray
 * Distributions on the Intel MIC Architecture" (few rays on their own). Pro: coherent rays share
 * the loads, the branches and the stack, and one box of all is one test for many rays. Con: rays
 * that part company waste lanes; the packet's order is not every ray's. For CPUs.
 *
 *   BB_WIDTH        2, 4 or 8: the nodes
 *   BB_FEW          so many rays are traced on their own
 *   BB_SORT         no: packets of successive rays; batch: of rays of equal octant and main axis in
 *                   a batch, whose order remains
 *   BB_STACK_SIZE   entries
 *   and those of packet.clh, trace.clh
 */
#if BB_WIDTH == 2
#include "stack_pair.clh"
#define BB_PLANES_OF(node) (node)
#else
#include "stack_wide.clh"
#define BB_PLANES_OF(node) (node)->planes
#endif
#include "packet.clh"

#ifndef BB_FEW
#define BB_FEW 2
#endif
#define BB_SORT_no 0
#define BB_SORT_batch 1
#ifndef BB_SORT
#define BB_SORT no
#endif

#if defined(BB_QUERY_INTERVAL) || defined(BB_QUERY_MARCH)
#define BB_HITS_TOGETHER 0
#else
#define BB_HITS_TOGETHER BB_TRIANGLES_TOGETHER
#endif

typedef struct bb_packet_waiting {
    bb_floats entry; /* where each ray enters the box; INFINITY: it does not */
    uint link;
    float nearest;
} bb_packet_waiting;

/* One ray of a packet in the form of the tests for one ray. */
typedef struct bb_lone {
    bb_ray_setup setup;
    bb_slab slab;
    bb_search search;
} bb_lone;

void bb_lone_of(const bb_packet *p, uint ray, bb_lone *lone)
{
    lone->slab = bb_slab_of((float3)(bb_lane_of(&p->o[0], ray), bb_lane_of(&p->o[1], ray), bb_lane_of(&p->o[2], ray)),
                           (float3)(bb_lane_of(&p->d[0], ray), bb_lane_of(&p->d[1], ray), bb_lane_of(&p->d[2], ray)));
    bb_ray_setup *s = &lone->setup;
    s->o = lone->slab.o;
    s->d = (float3)(bb_lane_of(&p->d[0], ray), bb_lane_of(&p->d[1], ray), bb_lane_of(&p->d[2], ray));
    s->power = ((const int *)&p->power)[ray];
    s->kz = ((const uint *)&p->kz)[ray];
    s->kx = s->kz == 2u ? 0u : s->kz + 1u;
    s->ky = s->kx == 2u ? 0u : s->kx + 1u;
    s->ox = bb_lane_of(&p->along[0], ray);
    s->oy = bb_lane_of(&p->along[1], ray);
    s->oz = bb_lane_of(&p->along[2], ray);
    s->sx = bb_lane_of(&p->slope[0], ray);
    s->sy = bb_lane_of(&p->slope[1], ray);
    s->sz = bb_lane_of(&p->slope[2], ray);
    bb_search *search = &lone->search;
    search->tmin = bb_lane_of(&p->tmin, ray);
    search->tmax = bb_lane_of(&p->tmax, ray);
    search->found.best = bb_lane_of(&p->best, ray);
    search->found.prim = ((const uint *)&p->prim)[ray];
    search->boxes = search->prims = 0;
}

void bb_lone_return(bb_packet *p, uint ray, const bb_lone *lone)
{
    float tmax = BB_FOUND_ENOUGH(&lone->search.found) ? -INFINITY : lone->search.tmax;
    ((float *)&p->tmax)[ray] = tmax;
    ((float *)&p->best)[ray] = lone->search.found.best;
    ((uint *)&p->prim)[ray] = lone->search.found.prim;
#if BB_COUNTING
    ((uint *)&p->boxes)[ray] += lone->search.boxes;
    ((uint *)&p->prims)[ray] += lone->search.prims;
#endif
}

#define BB_TRACE_NODE_OF_WIDTH bb_wide
#if BB_WIDTH == 2
typedef float bb_packet_node;
#define BB_NODE_STRIDE 16ul
#else
typedef bb_wide bb_packet_node;
#define BB_NODE_STRIDE 1ul
#endif

static bool bb_leave_packet(bb_packet *p, uint rays_alone, global const bb_packet_node *nodes,
                            global const float *leaf_prims, uint link, const bb_prim_ends *ends)
{
    bool enough = true;
    while (rays_alone != 0u) {
        uint ray = 31u - clz(rays_alone);
        rays_alone ^= 1u << ray;
        bb_lone lone;
        bb_lone_of(p, ray, &lone);
        enough &= trace_ray(&lone.search, &lone.setup, &lone.slab, nodes, leaf_prims, link, ends);
        bb_lone_return(p, ray, &lone);
    }
    return enough;
}

static void bb_packet_leaf(bb_packet *p, bb_ints active, global const float *leaf_prims, uint link,
                           const bb_prim_ends *ends)
{
    global const float *leaf_prim = leaf_prims + (ulong)BB_WORDS * (link & BB_INDEX_MASK);
    uint tagged;
    do {
        global const uint *prims = (global const uint *)leaf_prim + BB_ID;
        tagged = prims[0];
        for (uint lane = 0; lane < BB_LANES; lane++) {
            if (prims[lane] == BB_NONE)
                break;
            bb_packet_triangle(p, leaf_prim + lane, prims[lane] & BB_INDEX_MASK, active);
#if BB_COUNTING
            p->prims += active ? (bb_uints)(1u) : (bb_uints)(0u);
#endif
        }
        leaf_prim += BB_WORDS;
    } while ((tagged & BB_LAST_BIT) == 0u);
    p->bundle.tmax = bb_most_of(p->tmax);
}

static bool bb_trace_packet(bb_packet *p, global const bb_packet_node *nodes,
                            global const float *leaf_prims, uint root, const bb_prim_ends *ends)
{
    bb_packet_waiting stack[BB_STACK_SIZE];
    uint top = 0;
    uint link = root;
    bb_floats near = p->tmin <= p->tmax ? p->tmin : (bb_floats)(INFINITY);
    for (;;) {
        while ((link & BB_LEAF_BIT) == 0) {
            global const bb_packet_node *node = nodes + BB_NODE_STRIDE * link;
            global const float *planes = BB_PLANES_OF(node);
            uint met = (1u << BB_WIDTH) - 1u;
            if (p->bounded) {
                bb_boxes leave, enter = bb_bundle_entries(&p->bundle, planes, &leave);
                met = BB_VECTOR(bb_bits, BB_WIDTH)(enter <= leave);
            }
            uint bottom = top;
            while (met != 0u) {
                uint child = 31u - clz(met);
                met ^= 1u << child;
                bb_floats entry;
                bool any = bb_packet_meets(p, planes, child, &entry);
#if BB_COUNTING
                p->boxes += near <= p->tmax ? (bb_uints)(1u) : (bb_uints)(0u);
#endif
                if (!any)
                    continue;
                if (top == BB_STACK_SIZE)
                    return false;
                float nearest = bb_least_of(entry);
#if BB_WIDTH == 2
                uint other = ((global const uint *)planes)[12 + child];
#else
                uint other = node->links[child];
#endif
                uint at = top;
                for (; at > bottom && stack[at - 1u].nearest < nearest; at--)
                    stack[at] = stack[at - 1u];
                stack[at].entry = entry;
                stack[at].link = other;
                stack[at].nearest = nearest;
                top++;
            }
            if (top == bottom)
                goto pop;
            top--;
            link = stack[top].link;
            near = stack[top].entry;
            uint active = BB_BITS(near <= p->tmax);
            if (popcount(active) <= BB_FEW) {
                if (!bb_leave_packet(p, active, nodes, leaf_prims, link, ends))
                    return false;
                p->bundle.tmax = bb_most_of(p->tmax);
                goto pop;
            }
        }
        bb_packet_leaf(p, near <= p->tmax, leaf_prims, link, ends);
    pop:
        for (;;) {
            if (top == 0)
                return true;
            top--;
            near = stack[top].entry;
            uint active = BB_BITS(near <= p->tmax);
            if (active == 0u)
                continue;
            link = stack[top].link;
            if (popcount(active) > BB_FEW)
                break;
            if (!bb_leave_packet(p, active, nodes, leaf_prims, link, ends))
                return false;
            p->bundle.tmax = bb_most_of(p->tmax);
        }
    }
}

/* Not inlined: a driver that runs a group's work-items in a loop might keep the packets of each. */
__attribute__((noinline)) static void
trace_batch(uint first, uint count, global const bb_packet_node *nodes, global const float *leaf_prims,
            uint root, const bb_prim_ends *ends, float scale, global const bb_ray *rays,
            global bb_result *results BB_COUNTS_ARGUMENT BB_QUERY_ARGUMENTS)
{
    for (uint at = 0; at < count; at += BB_RAYS) {
        uint ids[BB_RAYS], taken = min(count - at, (uint)BB_RAYS);
        for (uint i = 0; i < BB_RAYS; i++)
            ids[i] = first + at + min(i, taken - 1u);
        bb_packet p;
        uint odd = bb_packet_make(&p, rays, ids, taken, scale);
        bool enough = bb_trace_packet(&p, nodes, leaf_prims, root, ends);
        if (!enough)
            continue;
        bb_floats t = bb_times_powers(p.prim != BB_NONE ? p.best : (bb_floats)(INFINITY), -p.power);
        for (uint i = 0; i < taken; i++) {
            results[ids[i]].t = ((const float *)&t)[i];
            results[ids[i]].prim = ((const uint *)&p.prim)[i];
#if BB_COUNTING
            counts[ids[i]].nodes = ((const uint *)&p.boxes)[i];
            counts[ids[i]].prims = ((const uint *)&p.prims)[i];
            counts[ids[i]].overflow = counts[ids[i]].restarts = 0;
#endif
        }
    }
}

#define BB_TRACE_NODE bb_packet_node
#include "trace.clh"
