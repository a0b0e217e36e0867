/* Stackless traversal by skip pointers, on the nodes of the tree itself.
 *
 *   node = root
 *   while there is a node:
 *       if the ray misses its box:  node = skip(node)
 *       if it is an inner node:     node = first(node)
 *       if it is a leaf:            test its primitives; node = skip(node)
 *
 * Smits 1998, "Efficiency Issues for Ray Tracing" (skip pointers); Gu, Jendersie, Grosch 2018,
 * "Fast and Dynamic Construction of Bounding Volume Hierarchies based on Loose Octrees" (first and
 * next pointers, nodes of any number of children). Pro: a single link as state, any arity, any
 * depth. Con: children come in the tree's order, not the ray's, so a hit found late culls little;
 * one box at a time.
 *
 *   -D: those of trace.clh
 */
#include "bb_device.h"
#include "search.clh"

static bool trace_ray(bb_search *search, const bb_ray_setup *setup, const bb_slab *slab,
                      global const float *nodes, /* bb_node[], in preorder */
                      global const float *leaf_prims, uint root, const bb_prim_ends *ends)
{
    uint link = root;
    while (link != BB_NONE) {
        global const float *node = nodes + 8ul * link;
        BB_STEP(search, BB_STEP_NODE, link);
#if BB_GPU_FORM
        uint first = bb_word(node, 3u), skip = bb_word(node, 7u);
#else
        uint first = as_uint(node[3]), skip = as_uint(node[7]);
#endif
        search->boxes++;
        if (!bb_meets_node(slab, node, search->tmin, search->tmax)) {
            link = skip;
        } else if ((first & BB_LEAF_BIT) == 0) {
            link = first;
        } else {
            if (bb_search_leaf(search, setup, slab, leaf_prims, first, ends))
                break;
            link = skip;
        }
    }
    return true;
}

#define BB_TRACE_NODE float
#include "trace.clh"
