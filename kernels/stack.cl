/* Stack traversal of pair nodes, while-while.
 *
 *   link = root
 *   loop: while link is a pair node:
 *             test both boxes
 *             go to the nearer, push the farther with its distance
 *         test the primitives of the leaf
 *         pop until an entry is nearer than the hit
 *
 * Aila and Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs": the per-ray
 * while-while loop, without speculation. Pro: few steps, children in order. Con: a stack per ray of
 * BB_STACK_SIZE entries. The host sizes it by the tree's need, up to a limit; an overflow leaves
 * the hit poisoned, so that it cannot pass for an answer.
 *
 *   BB_STACK_SIZE   entries
 *   and those of trace.clh
 */
#include "bb_device.h"
#include "search.clh"

#ifndef BB_STACK_SIZE
#define BB_STACK_SIZE 64
#endif

static bool trace_ray(bb_search *search, const bb_ray_setup *setup, const bb_slab *slab,
                      global const float *pairs, /* bb_pair[] */
                      global const float *leaf_prims, uint root, const bb_prim_ends *ends)
{
    bb_waiting stack[BB_STACK_SIZE];
    uint top = 0;
    uint link = root;
    for (;;) {
        while ((link & BB_LEAF_BIT) == 0) {
            global const float *pair = pairs + 16ul * link;
            float2 entry, exit;
            bb_box_distances(slab, pair, search->tmin, search->tmax, &entry, &exit);
            uint2 links = ((global const uint4 *)pair)[3].xy;
            bool meets0 = entry.x <= exit.x, meets1 = entry.y <= exit.y;
            search->boxes += 2;
            if (meets0 && meets1) {
                bool swap = entry.y < entry.x;
                if (top == BB_STACK_SIZE)
                    return false;
                stack[top].link = swap ? links.x : links.y;
                stack[top].entry = swap ? entry.x : entry.y;
                top++;
                link = swap ? links.y : links.x;
            } else if (meets0 || meets1) {
                link = meets0 ? links.x : links.y;
            } else {
                goto pop;
            }
        }
        if (bb_search_leaf(search, setup, slab, leaf_prims, link, ends))
            return true;
    pop:
        do {
            if (top == 0)
                return true;
            top--;
        } while (stack[top].entry > search->tmax);
        link = stack[top].link;
    }
}

#define BB_TRACE_NODE float
#include "trace.clh"
