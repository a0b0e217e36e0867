/* Stack traversal of compressed nodes (bb_cwbvh): visits a node's children in the order of the
 * ray's octant, with a single stack entry for all remaining children of a node.
 *
 *   group = the root
 *   loop: if the group has a node left:
 *             take the first; push the group if it has more
 *             test its boxes: the nodes met become the group; the primitives met are
 *             tested one by one
 *         if the group has no node left: pop one
 *
 * Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
 * BVHs", whose text was not at hand. Not implemented: postponing primitives until enough rays of a
 * group have some, which needs votes within the group. Pro: 80 bytes for 8 boxes, little private
 * memory. Con: children come only roughly from near to far, and stack entries are not culled by
 * distance. Overflow and equal distances as in stack.cl.
 *
 *   BB_STACK_SIZE   entries
 *   and those of trace.clh
 */
#include "bb_device.h"

#define BB_WIDTH 8
#include "search.clh"

#include "cwbvh.clh"

#ifndef BB_STACK_SIZE
#define BB_STACK_SIZE 16
#endif

/* A group of nodes met: the first node, and bits as bb_cwbvh_meet() returns them, the lowest eight
 * of which say which places have nodes. */
#define BB_GROUP_NODES 0xFF000000u

/* Takes the first node out of the group. */
static uint take_node(uint2 *group, uint turn)
{
    uint bit = 31u - clz((*group).y), place = (bit - 24u) ^ turn;
    (*group).y ^= 1u << bit;
    return (*group).x + (uint)popcount((*group).y & ((1u << place) - 1u));
}

static uint count_boxes(global const bb_cwbvh *node)
{
    uint count = 0;
    for (uint c = 0; c < 8u; c++)
        count += node->meta[c] != 0u ? 1u : 0u;
    return count;
}

static bool trace_ray(bb_search *search, const bb_ray_setup *setup, const bb_slab *slab,
                      global const bb_cwbvh *nodes, global const float *leaf_prims, uint root,
                      const bb_prim_ends *ends)
{
    uint2 stack[BB_STACK_SIZE];
    uint top = 0;
    const float3 d = setup->d;
    const uint turn = (d.x < 0.0f ? 0u : 1u) | (d.y < 0.0f ? 0u : 2u) | (d.z < 0.0f ? 0u : 4u);
    /* if the tree is a single leaf the link contains its number of primitives */
    const bool leaf = (root & BB_LEAF_BIT) != 0;
    uint2 group = leaf ? (uint2)(0u) : (uint2)(root, 1u << (24u + turn));
    uint prims = leaf ? (1u << (root & BB_INDEX_MASK)) - 1u : 0u, first_prim = 0;
    for (;;) {
        if ((group.y & BB_GROUP_NODES) != 0u) {
            uint n = take_node(&group, turn), inner;
            uint2 base;
            BB_STEP(search, BB_STEP_NODE, n);
            if ((group.y & BB_GROUP_NODES) != 0u) {
                if (top == BB_STACK_SIZE)
                    return false;
                stack[top++] = group;
                BB_STEP(search, BB_STEP_PUSH, 0);
            }
            uint met = bb_cwbvh_meet(slab, nodes + n, turn, search->tmin, search->tmax, &inner,
                                     &base);
#if BB_COUNTING
            search->boxes += count_boxes(nodes + n);
#endif
            group = (uint2)(base.x, (met & BB_GROUP_NODES) | inner);
            prims = met & ~BB_GROUP_NODES;
            first_prim = base.y;
        }
        for (; prims != 0u; prims &= prims - 1u) {
            uint prim = 31u - clz(prims & (0u - prims));
            if (bb_search_leaf(search, setup, slab, leaf_prims, first_prim + prim, ends))
                return true;
        }
        if ((group.y & BB_GROUP_NODES) == 0u) {
            if (top == 0u)
                return true;
            group = stack[--top];
            BB_STEP(search, BB_STEP_POP, 0);
        }
    }
}

#define BB_TRACE_NODE bb_cwbvh
#include "trace.clh"
