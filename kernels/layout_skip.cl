/* The `skip` layout: the common tree's nodes in preorder, in which the stackless traversal reads
 * them.
 *
 *   next(n) = first(n) of an inner node, skip(n) of a leaf: a list of all nodes, in preorder
 *   position(n) = place of n in that list:
 *       every stride-th node, and the root, is a splitter: walks to the next one and counts
 *                                                                                   (skip_walk)
 *       the splitters' own positions, one after the other                          (skip_rank)
 *       each splitter walks again and numbers the nodes on its way                 (skip_place)
 *   out[position(n)] = node n with renumbered links and its box scaled and padded (padding.clh)
 *                                                                                  (skip_nodes)
 *
 * Smits 1998, "Efficiency Issues for Ray Tracing" (the order); Helman, JaJa 1999, "Designing
 * Practical Efficient Algorithms for Symmetric Multiprocessors" (list ranking). Accepts any tree of
 * any arity; nodes with one child stay. Limits: the work is always two walks over the list, but a
 * numbering that keeps all splitters together leaves it to one work-item.
 */
#include "bb_device.h"
#include "padding.clh"

/* Returns the splitter at node n, BB_NONE if there is none. The last one is the root's. */
uint skip_splitter(uint n, uint root, uint stride, uint splitters)
{
    return n == root ? splitters - 1u : n % stride == 0 ? n / stride : BB_NONE;
}

uint skip_start(uint s, uint root, uint stride, uint splitters)
{
    return s == splitters - 1u ? root : s * stride;
}

uint skip_next(global const bb_node *nodes, uint n)
{
    uint first = nodes[n].first;
    return (first & BB_LEAF_BIT) != 0 ? nodes[n].skip : first;
}

kernel void skip_walk(global const bb_node *nodes,
                      uint root,
                      uint stride,
                      uint splitters,
                      global uint *lengths, /* nodes from the splitter to the next one */
                      global uint *after)   /* the next splitter */
{
    uint s = get_global_id(0);
    if (s >= splitters)
        return;
    uint n = skip_start(s, root, stride, splitters);
    uint length = 0, next = BB_NONE;
    /* otherwise it is the root, which has its own splitter */
    if (skip_splitter(n, root, stride, splitters) == s)
        do {
            length++;
            n = skip_next(nodes, n);
            next = n != BB_NONE ? skip_splitter(n, root, stride, splitters) : BB_NONE;
        } while (n != BB_NONE && next == BB_NONE);
    lengths[s] = length;
    after[s] = next;
}

kernel void skip_rank(uint splitters, global uint *lengths, global const uint *after)
{
    uint at = 0;
    for (uint s = splitters - 1u; s != BB_NONE; s = after[s]) {
        uint length = lengths[s];
        lengths[s] = at;
        at += length;
    }
}

kernel void skip_place(global const bb_node *nodes,
                       uint root,
                       uint stride,
                       uint splitters,
                       global const uint *starts, /* positions of the splitters */
                       global uint *positions)
{
    uint s = get_global_id(0);
    if (s >= splitters)
        return;
    uint n = skip_start(s, root, stride, splitters);
    uint at = starts[s];
    if (skip_splitter(n, root, stride, splitters) == s)
        do {
            positions[n] = at++;
            n = skip_next(nodes, n);
        } while (n != BB_NONE && skip_splitter(n, root, stride, splitters) == BB_NONE);
}

/* `reach`: see layout_pair.cl. */
kernel void skip_nodes(global const bb_node *nodes, uint count, global const uint *positions,
                       float scale, global const float *reach, uint has_reach,
                       global bb_node *out)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    bb_node node = nodes[n];
    uint at = positions[n];
    if ((node.first & BB_LEAF_BIT) == 0)
        node.first = at + 1u;
    if (node.skip != BB_NONE)
        node.skip = positions[node.skip];
    bb_scale_and_pad(node.lo, node.hi, scale, has_reach != 0 ? reach[n] : -1.0f);
    out[at] = node;
}
