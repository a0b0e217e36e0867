/* Stackless traversal by skip pointers, on the nodes of the tree itself.
 *
 *   node = root
 *   while there is a node:
 *       the ray meets its box?  no: node = skip(node)
 *                               yes, inner: node = first(node)
 *                               yes, leaf: test its primitives; node = skip(node)
 *
 * Smits 1998, "Efficiency Issues for Ray Tracing" (skip pointers); Gu, Jendersie, Grosch 2018,
 * "Fast and Dynamic Construction of Bounding Volume Hierarchies based on Loose Octrees" (first and
 * next pointers, nodes of any number of children). Pro: no state but one link, any arity, any
 * depth. Con: children come in the tree's order, not the ray's, so that a far hit culls little of
 * what comes before the near one; one box at a time.
 *
 *   -D: those of search.clh
 */
#include "bb_device.h"
#include "search.clh"

void trace_ray(uint id, global const float *nodes, /* bb_node[], in preorder */
               global const float *leaf_prims,        /* leaf primitives */
               uint root,                          /* node */
               const bb_prim_ends *ends, float scale, global const bb_ray *rays,
               global bb_result *results BB_COUNTS_ARGUMENT)
{
    bb_ray_setup setup;
    bb_ray_setup_make(&setup, &rays[id], scale);
    bb_slab slab = bb_slab_of(setup.o, setup.d);
    bb_search search;
    bb_search_start(&search, &setup, &rays[id]);

    uint link = root;
    while (link != BB_NONE) {
        global const float *node = nodes + 8ul * link;
        uint first = as_uint(node[3]), skip = as_uint(node[7]);
        search.boxes++;
        if (!bb_meets_node(&slab, node, search.tmin, search.tmax)) {
            link = skip;
        } else if ((first & BB_LEAF_BIT) == 0) {
            link = first;
        } else {
            if (bb_search_leaf(&search, &setup, &slab, leaf_prims, first, ends))
                break;
            link = skip;
        }
    }
    bb_search_write(&search, &setup, &results[id]);
#if BB_COUNTING
    bb_search_count(&search, false, &counts[id]);
#endif
}

BB_TRACE_KERNEL(float)
