/* Stack traversal of pair nodes, while-while.
 *
 *   link = root
 *   loop: while link is a pair node: test both boxes; go to the nearer, push the farther with its
 *   distance
 *         test the primitives of the leaf; pop until an entry is nearer than the hit
 *
 * Aila and Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs", the per-ray
 * while-while loop, without speculation. Pro: few steps, children in order. Con: a stack per ray,
 * of BB_STACK_SIZE entries; the host sizes it from what the tree needs, up to a limit, and an
 * overflow leaves the hit poisoned, so that it can't pass for an answer.
 *
 *   BB_STACK_SIZE   entries
 *   and those of search.clh
 */
#include "bb_device.h"
#include "search.clh"

#ifndef BB_STACK_SIZE
#define BB_STACK_SIZE 64
#endif

void trace_ray(uint id, global const float *pairs, /* bb_pair[] */
               global const float *leaf_prims,        /* leaf primitives */
               uint root,                          /* link */
               const bb_prim_ends *ends, float scale, global const bb_ray *rays,
               global bb_result *results BB_COUNTS_ARGUMENT)
{
    bb_ray_setup setup;
    bb_ray_setup_make(&setup, &rays[id], scale);
    bb_slab slab = bb_slab_of(setup.o, setup.d);
    bb_search search;
    bb_search_start(&search, &setup, &rays[id]);

    uint stack_links[BB_STACK_SIZE];
    float stack_entries[BB_STACK_SIZE];
    uint top = 0;
    uint link = root;
    bool overflow = false;
    for (;;) {
        while ((link & BB_LEAF_BIT) == 0) {
            global const float *pair = pairs + 16ul * link;
            float2 entry, exit;
            bb_box_distances(&slab, pair, search.tmin, search.tmax, &entry, &exit);
            uint2 links = vload2(6, (global const uint *)pair);
            bool meets0 = entry.x <= exit.x, meets1 = entry.y <= exit.y;
            search.boxes += 2;
            if (meets0 && meets1) {
                bool swap = entry.y < entry.x;
                if (top == BB_STACK_SIZE) {
                    overflow = true;
                    goto done;
                }
                stack_links[top] = swap ? links.x : links.y;
                stack_entries[top] = swap ? entry.x : entry.y;
                top++;
                link = swap ? links.y : links.x;
            } else if (meets0 || meets1) {
                link = meets0 ? links.x : links.y;
            } else {
                goto pop;
            }
        }
        if (bb_search_leaf(&search, &setup, &slab, leaf_prims, link, ends))
            goto done;
    pop:
        do {
            if (top == 0)
                goto done;
            top--;
        } while (stack_entries[top] > search.tmax);
        link = stack_links[top];
    }
done:
    if (!overflow)
        bb_search_write(&search, &setup, &results[id]);
#if BB_COUNTING
    bb_search_count(&search, overflow, &counts[id]);
#endif
}

BB_TRACE_KERNEL(float)
