/* Stack traversal of pair nodes, while-while.
 *
 *   link = root
 *   loop: while link is a pair node: test both boxes; go to the nearer, push the farther with its distance
 *         test the primitives of the leaf; pop until an entry is nearer than the hit
 *
 * Aila and Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs", the per-ray while-while loop, without
 * speculation. Pro: few steps, children in order. Con: a stack per ray, of BB_STACK_SIZE entries; the host sizes it from what
 * the tree needs, up to a limit, and an overflow leaves the hit poisoned, so that it can't pass for an answer.
 * Of hits at one distance the lowest primitive wins, so that the answer does not depend on the tree, but for distances that differ by
 * rounding alone: there the nearer box may cull the other.
 *
 *   BB_STACK_SIZE   entries
 *   BB_ANY_HIT      1: stop at the first hit
 *   BB_COUNTING     1: count the tests
 *   and those of intersect.clh
 */
#include "bb_device.h"
#include "intersect.clh"

#ifndef BB_STACK_SIZE
#define BB_STACK_SIZE 64
#endif
#ifndef BB_ANY_HIT
#define BB_ANY_HIT 0
#endif
#ifndef BB_COUNTING
#define BB_COUNTING 0
#endif

kernel void trace(global const float *pairs,     /* bb_pair[] */
                  global const float *records,   /* primitive records */
                  uint root,                     /* link */
                  uint triangle_count,
                  global const bb_ray *rays,
                  uint count,
                  global bb_hit *hits
#if BB_COUNTING
                  , global bb_count *counts
#endif
)
{
    uint id = get_global_id(0);
    if (id >= count)
        return;
    float3 o = vload3(0, rays[id].o), d = vload3(0, rays[id].d);
    float tmin = rays[id].tmin;
    float tmax = rays[id].tmax;
    bb_slab slab = bb_slab_of(o, d);
    bb_ray_setup setup = bb_ray_setup_of(o, d);
    float best = tmin; /* distance of the hit; until there is one, a value that no hit can have */
    uint best_prim = BB_NONE;
#if BB_COUNTING
    uint nodes_tested = 0, prims_tested = 0;
#endif

    uint stack_links[BB_STACK_SIZE];
    float stack_entries[BB_STACK_SIZE];
    uint top = 0;
    uint link = root;
    bool overflow = false;
    for (;;) {
        while ((link & BB_LEAF_BIT) == 0) {
            global const float *pair = pairs + 16ul * link;
            float2 entry, exit;
            bb_box_distances(&slab, pair, tmin, tmax, &entry, &exit);
            uint2 links = vload2(6, (global const uint *)pair);
            bool meets0 = entry.x <= exit.x, meets1 = entry.y <= exit.y;
#if BB_COUNTING
            nodes_tested += 2;
#endif
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
        {
            global const float *record = records + (ulong)BB_WORDS * (link & BB_INDEX_MASK);
            uint tagged;
            do {
                tagged = as_uint(record[BB_ID]);
                uint prim = tagged & BB_INDEX_MASK;
                float t = bb_primitive(&setup, record, prim, triangle_count, tmin);
#if BB_COUNTING
                prims_tested++;
#endif
                if (t > tmin && (t < tmax || (t == best && prim < best_prim))) {
                    tmax = t;
                    best = t;
                    best_prim = prim;
#if BB_ANY_HIT
                    goto done;
#endif
                }
                record += BB_WORDS;
            } while ((tagged & BB_LAST_BIT) == 0);
        }
    pop:
        do {
            if (top == 0)
                goto done;
            top--;
        } while (stack_entries[top] > tmax);
        link = stack_links[top];
    }
done:
    if (!overflow) {
        hits[id].t = best_prim != BB_NONE ? best : INFINITY;
        hits[id].prim = best_prim;
    }
#if BB_COUNTING
    counts[id].nodes = nodes_tested;
    counts[id].prims = prims_tested;
    counts[id].overflow = overflow ? 1u : 0u;
#endif
}
