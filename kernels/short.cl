/* Traversal with a short stack, or none, and a bit trail (trail.clh) to find the way back.
 *
 *   node = root, level = 0, retrace = 0
 *   loop: while node is inner:
 *             met = the children that the ray meets, nearest first
 *             at = level < retrace ? place(level) : 0
 *             at is past the last of them: go to next
 *             push met[at + 1 ...], the farthest first
 *             place(level) = at, open(level) = whether there is one after it
 *             node = met[at], level = level + 1
 *         test the primitives of the leaf
 *   next: l = the deepest open level, its place advanced by one; none: done
 *         the stack is empty: node = root, level = 0, retrace = l + 1
 *         else: node = popped entry, level = l + 1, retrace = 0
 *               node is farther than the hit: go to next
 *
 * Vaidyanathan, Woop, Benthin 2019, "Wide BVH Traversal with a Short Stack"; without entries Laine
 * 2010, "Restart Trail for Stackless BVH Traversal". Pro: children in order, with a few words of
 * state per ray. Con: dropped entries are found again by a walk from the root, which tests its
 * boxes again. Limits: trees of up to BB_LEVELS levels; in a deeper one the hit is left poisoned
 * and counted as an overflow, as with the full stack.
 *
 *   -D: those of wide.clh, trail.clh and trace.clh
 */
#include "bb_device.h"
#ifndef BB_WIDTH
#define BB_WIDTH 2
#endif
#include "wide.clh"
#if BB_WIDTH > 2 && !defined(BB_LANES)
#define BB_LANES BB_BLOCK_LANES
#endif
#include "search.clh"
#define BB_CHILDREN BB_WIDTH
#include "trail.clh"

/* Finds the children of a node that the ray meets, nearest first, ties in order; returns their
 * number. */
uint short_children(const bb_search *search, const bb_slab *slab, global const bb_wide *node,
                    uint *met,
                    float *distances)
{
    bb_boxes entry, exit;
    float entries[BB_WIDTH], exits[BB_WIDTH];
    bb_box_distances(slab, node->planes, search->tmin, search->tmax, &entry, &exit);
    BB_VECTOR(vstore, BB_WIDTH)(entry, 0, entries);
    BB_VECTOR(vstore, BB_WIDTH)(exit, 0, exits);
    uint many = 0;
    for (uint child = 0; child < BB_WIDTH; child++) {
        float distance = entries[child];
        if (!(distance <= exits[child]))
            continue;
        uint at = many++;
        for (; at > 0 && distances[at - 1u] > distance; at--) {
            met[at] = met[at - 1u];
            distances[at] = distances[at - 1u];
        }
        met[at] = BB_LINK(node, child);
        distances[at] = distance;
    }
    return many;
}

static bool trace_ray(bb_search *search, const bb_ray_setup *setup, const bb_slab *slab,
                      global const bb_wide *nodes,
                      global const float *leaf_prims, /* primitives, or blocks of them */
                      uint root, const bb_prim_ends *ends)
{
    bb_trail trail;
    bb_trail_start(&trail);
#if BB_ENTRIES > 0
    bb_short_stack stack;
    bb_short_stack_start(&stack);
#endif

    uint link = root, level = 0, retrace = 0;
    for (;;) {
        while ((link & BB_LEAF_BIT) == 0) {
            if (level == BB_LEVELS)
                return false;
            BB_STEP(search, BB_STEP_NODE, link);
            uint met[BB_CHILDREN];
            float distances[BB_CHILDREN];
            uint many = short_children(search, slab, nodes + link, met, distances);
            uint at = level < retrace ? bb_trail_place(&trail, level) : 0;
#if BB_WIDTH == 2
            search->boxes += 2;
#else
            search->boxes += nodes[link].count;
#endif
            if (at >= many)
                goto next;
#if BB_ENTRIES > 0
            for (uint i = many - 1u; i > at; i--) {
                bb_short_stack_push(&stack, met[i], distances[i], i == many - 1u);
                BB_STEP(search, BB_STEP_PUSH, 0);
            }
#endif
            bb_trail_take(&trail, level, at, at + 1u < many);
            link = met[at];
            level++;
        }
        if (bb_search_leaf(search, setup, slab, leaf_prims, link, ends))
            return true;
    next:
        for (;;) {
            uint open = bb_trail_next(&trail, level);
            if (open == BB_NONE)
                return true;
#if BB_ENTRIES > 0
            if (stack.size > 0) {
                float distance;
                bool last;
                link = bb_short_stack_pop(&stack, &distance, &last);
                BB_STEP(search, BB_STEP_POP, 0);
                if (last)
                    bb_trail_close(&trail, open);
                level = open + 1u;
                retrace = 0;
                if (distance > search->tmax)
                    continue;
                break;
            }
#endif
            BB_STEP(search, BB_STEP_RESTART, 0);
            link = root;
            level = 0;
            retrace = open + 1u;
            break;
        }
    }
}

#define BB_TRACE_NODE bb_wide
#include "trace.clh"
