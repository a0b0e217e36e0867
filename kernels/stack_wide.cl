/* Stack traversal of wide nodes: tests all children's boxes at once, and primitives in blocks of
 * BB_LANES.
 *
 *   link = root
 *   loop: while link is a node:
 *             test its boxes
 *             none met: pop
 *             else: go to the nearest, push the others, the farthest first
 *         test the blocks of the leaf
 *         pop until an entry is nearer than the hit
 *
 * Wald, Benthin, Boulos 2008, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
 * Multi-Branching BVHs"; Dammertz, Hanika, Keller 2008, "Shallow Bounding Volume Hierarchies for
 * Fast SIMD Ray Tracing of Incoherent Rays". Pro: one ray keeps the vector units busy, so rays need
 * not be coherent. Con: on devices that run work-items in lockstep the vectors are unrolled.
 * Overflow and equal distances as in stack.cl.
 *
 *   BB_WIDTH, BB_QUANTISED  the node: wide.clh
 *   BB_ORDER        sorted: children by distance; octant: by their places, which the layout assigns
 *                   for this: saves the sorting but is only roughly right (nodes of 8)
 *   BB_STACK_SIZE   entries
 *   and those of trace.clh
 */
#include "bb_device.h"
#include "wide.clh"

#if BB_QUANTISED
#define BB_NODE global const bb_wide *
#define BB_PLANE_STEP BB_WIDTH
#if BB_GPU_FORM
#define BB_ABREAST 2
#define BB_PLANES(node, axis, plane, part)                                                         \
    BB_DEQUANTISE(node, axis, quantised_planes(node, axis, plane, part))
/* All planes of an axis are 16 bytes, so all calls share one load. */
float2 quantised_planes(global const bb_wide *node, uint axis, uint plane, uint part)
{
    uint4 planes = ((global const uint4 *)node->planes)[axis];
    uint2 eight = (plane & BB_PLANE_STEP) != 0u ? planes.hi : planes.lo;
    uint four = (part & 2u) != 0u ? eight.y : eight.x;
    return convert_float2(as_uchar2((ushort)(four >> 16u * (part & 1u))));
}
#else
#define BB_PLANES(node, axis, plane, part)                                                         \
    BB_DEQUANTISE(node, axis, convert_float8(*(global const uchar8 *)((node)->planes + (plane))))
#endif
#define BB_NODE_OF(wide) (wide)
#define BB_PLACES(wide) (wide)->places
#else
#define BB_NODE_OF(wide) (wide)->planes
#define BB_PLACES(wide) ~0u
#endif
#ifndef BB_LANES
#define BB_LANES BB_BLOCK_LANES
#endif
#include "search.clh"

#ifndef BB_STACK_SIZE
#define BB_STACK_SIZE 64
#endif
/* Prefetches a child that will be visited later. */
#define BB_PREFETCH_CHILD(link)                                                                    \
    BB_PREFETCH(((link)&BB_LEAF_BIT) != 0 ? blocks + (ulong)BB_WORDS * ((link)&BB_INDEX_MASK)      \
                                          : (global const float *)(nodes + (link)))

/* Option `order`; its words arrive here unchanged. */
#define BB_ORDER_sorted 0
#define BB_ORDER_octant 1
#ifndef BB_ORDER
#define BB_ORDER sorted
#endif
#define BB_BY_OCTANT BB_JOIN(BB_ORDER_, BB_ORDER)

#if BB_BY_OCTANT
/* Returns the bits of `met`, with bit p ^ octant moved to bit p. */
uint places_of(uint met, uint octant)
{
    if ((octant & 1u) != 0u)
        met = (met & 0x55u) << 1 | (met >> 1 & 0x55u);
    if ((octant & 2u) != 0u)
        met = (met & 0x33u) << 2 | (met >> 2 & 0x33u);
    if ((octant & 4u) != 0u)
        met = (met & 0x0Fu) << 4 | (met >> 4 & 0x0Fu);
    return met;
}
#endif

static bool trace_ray(bb_search *search, const bb_ray_setup *setup, const bb_slab *slab,
                      global const bb_wide *nodes, global const float *blocks, /* of primitives */
                      uint root, const bb_prim_ends *ends)
{
    bb_waiting stack[BB_STACK_SIZE];
    uint top = 0;
    uint link = root;
#if BB_BY_OCTANT
    const float3 d = setup->d;
    uint octant = (d.x < 0.0f ? 1u : 0u) | (d.y < 0.0f ? 2u : 0u) | (d.z < 0.0f ? 4u : 0u);
#endif
    for (;;) {
        while ((link & BB_LEAF_BIT) == 0) {
            global const bb_wide *node = nodes + link;
            bb_boxes entry;
            uint met = bb_boxes_met(slab, BB_NODE_OF(node), search->tmin, search->tmax, &entry) &
                       BB_PLACES(node);
#if BB_COUNTING
            search->boxes += node->count;
#endif
            if (met == 0u)
                goto pop;
            uint child = 31u - clz(met);
            link = node->links[child];
            met ^= 1u << child;
            if (met == 0u)
                continue;
            if (top + BB_WIDTH - 1u > BB_STACK_SIZE && top + popcount(met) > BB_STACK_SIZE)
                return false;
            float entries[BB_WIDTH];
            BB_VECTOR(vstore, BB_WIDTH)(entry, 0, entries);
#if BB_BY_OCTANT
            met = places_of(met | 1u << child, octant);
            for (uint place = 31u - clz(met); met != 1u << place; place = 31u - clz(met)) {
                met ^= 1u << place;
                uint other = node->links[place ^ octant];
                BB_PREFETCH_CHILD(other);
                stack[top].link = other;
                stack[top].entry = entries[place ^ octant];
                top++;
            }
            link = node->links[(31u - clz(met)) ^ octant];
#else
            /* insertion sort into this node's entries; the nearest child is kept out */
            float nearest = entries[child];
            uint bottom = top;
            do {
                child = 31u - clz(met);
                met ^= 1u << child;
                uint other = node->links[child];
                BB_PREFETCH_CHILD(other);
                float distance = entries[child];
                if (distance < nearest) {
                    stack[top].link = link;
                    stack[top].entry = nearest;
                    link = other;
                    nearest = distance;
                } else {
                    uint at = top;
                    for (; at > bottom && stack[at - 1u].entry < distance; at--) {
                        stack[at] = stack[at - 1u];
                    }
                    stack[at].link = other;
                    stack[at].entry = distance;
                }
                top++;
            } while (met != 0u);
#endif
        }
        if (bb_search_leaf(search, setup, slab, blocks, link, ends))
            return true;
    pop:
        do {
            if (top == 0u)
                return true;
            top--;
        } while (stack[top].entry > search->tmax);
        link = stack[top].link;
    }
}

#define BB_TRACE_NODE bb_wide
#include "trace.clh"
