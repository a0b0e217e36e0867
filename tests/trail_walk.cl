/* Walks trees by kernels/trail.clh, as kernels/short.cl does, but over a plain tree of nodes with a
 * distance each and with every step written down. One work-item per tree. */
#include "bb_device.h"
#include "trail.clh"

/* Node: first child, number of children (0: a leaf), distance; as the host has them. */
typedef struct walk_node {
    uint first, count;
    float distance, hit; /* hit: a leaf's */
} walk_node;

/* Children of n within `limit`, nearest first, the lower one first of equals. */
uint walk_children(global const walk_node *nodes, uint n, float limit, uint *met)
{
    uint many = 0;
    for (uint c = nodes[n].first; c < nodes[n].first + nodes[n].count; c++) {
        if (nodes[c].distance > limit)
            continue;
        uint at = many++;
        for (; at > 0 && nodes[met[at - 1]].distance > nodes[c].distance; at--)
            met[at] = met[at - 1];
        met[at] = c;
    }
    return many;
}

kernel void walk(global const walk_node *all, global const uint *begins, global uint *visits,
                 uint capacity)
{
    uint id = get_global_id(0);
    global const walk_node *nodes = all + begins[id];
    global uint *out = visits + (ulong)id * capacity;
    uint visited = 0;
    float limit = INFINITY;
    bb_trail trail;
    bb_trail_start(&trail);
#if BB_ENTRIES > 0
    bb_short_stack stack;
    bb_short_stack_start(&stack);
#endif
    uint n = 0, level = 0, retrace = 0;
    for (;;) {
        uint met[BB_CHILDREN], many = 0, at = 0;
        bool leaf = nodes[n].count == 0;
        if (!leaf) {
            many = walk_children(nodes, n, limit, met);
            at = level < retrace ? bb_trail_place(&trail, level) : 0;
        }
        if (!leaf && at < many) {
#if BB_ENTRIES > 0
            for (uint i = many - 1u; i > at; i--)
                bb_short_stack_push(&stack, met[i], nodes[met[i]].distance, i == many - 1u);
#endif
            bb_trail_take(&trail, level, at, at + 1u < many);
            n = met[at];
            level++;
            continue;
        }
        if (leaf) {
            if (visited == capacity)
                break;
            out[visited++] = n;
            limit = min(limit, nodes[n].hit);
        }
        for (;;) {
            uint open = bb_trail_next(&trail, level);
            if (open == BB_NONE)
                goto done;
#if BB_ENTRIES > 0
            if (stack.size > 0) {
                float distance;
                bool last;
                n = bb_short_stack_pop(&stack, &distance, &last);
                if (last)
                    bb_trail_close(&trail, open);
                level = open + 1u;
                retrace = 0;
                if (distance > limit)
                    continue;
                break;
            }
#endif
            n = 0;
            level = 0;
            retrace = open + 1u;
            break;
        }
    }
done:
    if (visited < capacity)
        out[visited] = BB_NONE;
}
