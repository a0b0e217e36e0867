/* Stack traversal of nodes of 8 children with many rays in flight per work-item, which advance by
 * one step each in turn.
 *
 *   take BB_RAYS rays of the batch
 *   loop: each ray at a node: test its boxes; sort the children met, the farthest first;
 *         push all; pop; prefetch what is popped
 *         each ray at a block of a leaf: test it; go on to the leaf's next one, or pop
 *         a ray whose stack is empty: write its result; take the next ray of the batch
 *
 * With one ray after the other, as in stack_wide.cl, a CPU stalls: on loads of nodes and, more
 * often, on mispredicted branches (how many children are met, node or leaf, hit or not). Here the
 * rays of a turn do not depend on each other, loads are prefetched a turn ahead, and steps have no
 * branches: a network sorts the children; the stack takes a whole vector, whose missed children end
 * up above its top; and rays are listed as at nodes or at leaves by incrementing one of two
 * counters. What remains is one branch per turn, one per ray, and one where a hit makes stack
 * entries obsolete.
 *
 * Kocberber, Falsafi, Grot 2015, "Asynchronous Memory Access Chaining" (VLDB 9), whose searches in
 * hash tables and trees correspond to these rays; Batcher 1968, "Sorting Networks and their
 * Applications" (bitonic). Con: the state of all rays in flight is in memory, of which GPUs have
 * too little.
 *
 *   BB_RAYS         rays in flight
 *   BB_ORDER        sorted, or octant: wide.clh
 *   BB_STACK_SIZE   entries
 *   and those of trace.clh
 *
 * Stack entries are distances without their last 3 bits, which hold the child's place during
 * sorting. They are rounded down, so that nothing is culled that could still contain a hit. Queries
 * whose hits cull nothing take the children as they stand in the node, without sorting and
 * distances.
 */
#define BB_STEADY 1
#include "bb_device.h"
#include "wide.clh"

#define BB_NODE_OF(wide) (wide)->planes
#ifndef BB_LANES
#define BB_LANES BB_BLOCK_LANES
#endif
#include "ray_order.clh"
#include "search.clh"

#ifndef BB_RAYS
#define BB_RAYS 32
#endif
#ifndef BB_STACK_SIZE
#define BB_STACK_SIZE 64
#endif
#define BB_PLACE_BITS 7u /* the bits of an entry that hold its child */
/* 1: hits shorten the ray, so that it pays to visit near children first */
#if defined(BB_QUERY_ANY) || defined(BB_QUERY_INTERVAL)
#define BB_SHORTENED 0
#else
#define BB_SHORTENED 1
#endif

typedef struct bb_flight {
    bb_slab slab;
    bb_search search;
    bb_ray_setup setup;
    uint id;
    uint link; /* the ray's position; BB_NONE: it has ended */
    bool enough; /* whether the stack had room for all children met */
#if BB_BY_OCTANT
    uint farthest; /* the place of a node's farthest child by octant */
#endif
    uint top; /* of the stack: entries 0 to top - 1; the first is BB_NONE and never obsolete */
    uint links[BB_STACK_SIZE + 9]; /* up to 8 above the top are written */
#if BB_SHORTENED
    uint entries[BB_STACK_SIZE + 9];
#endif
} bb_flight;

/* Compares each lane of k with that of `swizzle`; the lanes in `lower` keep the smaller one. */
#define BB_EXCHANGE(k, swizzle, lower)                                                             \
    k = select(max(k, k.swizzle), min(k, k.swizzle), (uint8)lower)

/* Sorts lanes in descending order. */
uint8 bb_sort_lanes(uint8 k)
{
    const uint L = ~0u;
    BB_EXCHANGE(k, s10325476, (0, L, 0, L, 0, L, 0, L));
    BB_EXCHANGE(k, s32107654, (0, 0, L, L, 0, 0, L, L));
    BB_EXCHANGE(k, s10325476, (0, L, 0, L, 0, L, 0, L));
    BB_EXCHANGE(k, s76543210, (0, 0, 0, 0, L, L, L, L));
    BB_EXCHANGE(k, s23016745, (0, 0, L, L, 0, 0, L, L));
    BB_EXCHANGE(k, s10325476, (0, L, 0, L, 0, L, 0, L));
    return k;
}

/* Returns the highest entry below `top` that can contain a hit nearer than tmax. */
uint bb_stack_pop(const bb_flight *f, uint top, float tmax)
{
#if BB_SHORTENED
    do {
        top--;
    } while (as_float(f->entries[top]) > tmax);
    return top;
#else
    return top - 1u;
#endif
}

/* Sends the ray to entry `top` of its stack if `pop`, else to `link`. */
void bb_flight_go(bb_flight *f, bool pop, uint top, uint link, global const bb_wide *nodes,
                  global const float *blocks)
{
    link = pop ? f->links[top] : link;
    f->top = pop ? top : f->top;
    f->link = link;
    global const char *next = (global const char *)(nodes + link);
    if ((link & BB_LEAF_BIT) != 0)
        next = (global const char *)(blocks + (ulong)BB_WORDS * (link & BB_INDEX_MASK));
    next = link == BB_NONE ? (global const char *)nodes : next;
    for (uint line = 0; line < 4u; line++)
        BB_PREFETCH(next + 64u * line);
}

/* Static: with one caller it is inlined, and so is the next one. */
static void bb_flight_at_node(bb_flight *f, global const bb_wide *nodes, global const float *blocks)
{
    global const bb_wide *node = nodes + f->link;
    bb_boxes entry, exit;
    bb_box_distances(&f->slab, BB_NODE_OF(node), f->search.tmin, f->search.tmax, &entry, &exit);
    uint8 met = as_uint8(entry <= exit);
    uint count = popcount(bb_bits8(as_int8(met))), top = f->top;
#if BB_COUNTING
    f->search.boxes += node->count;
#endif
    if (top + count > BB_STACK_SIZE + 2u) {
        f->enough = false;
        f->link = BB_NONE;
        return;
    }
#if BB_BY_OCTANT
    uint8 order = (uint8)(0, 1, 2, 3, 4, 5, 6, 7) ^ f->farthest;
    uint bits = bb_bits8(as_int8(bb_pick8(met, order)));
#if BB_SHORTENED
    vstore8(bb_compress8(bb_pick8(as_uint8(entry), order), bits), 0, f->entries + top);
#endif
    vstore8(bb_compress8(bb_pick8(vload8(0, node->links), order), bits), 0, f->links + top);
#elif !BB_SHORTENED
    vstore8(bb_compress8(vload8(0, node->links), bb_bits8(as_int8(met))), 0, f->links + top);
#else
    /* distances are above 0, so their bits have the same order, and children not met come last */
    uint8 places = (uint8)(0, 1, 2, 3, 4, 5, 6, 7);
    uint8 sorted = bb_sort_lanes(((as_uint8(entry) & ~BB_PLACE_BITS) | places) & met);
    vstore8(sorted & ~BB_PLACE_BITS, 0, f->entries + top);
    vstore8(bb_pick8(vload8(0, node->links), sorted), 0, f->links + top);
#endif
    bb_flight_go(f, true, bb_stack_pop(f, top + count, f->search.tmax), 0u, nodes, blocks);
}

static void bb_flight_at_leaf(bb_flight *f, global const bb_wide *nodes, global const float *blocks,
                              const bb_prim_ends *ends)
{
#ifdef BB_QUERY_MARCH
    bool enough = bb_search_leaf(&f->search, &f->setup, &f->slab, blocks, f->link, ends);
    uint tagged = BB_LAST_BIT;
#else
    uint tagged;
    bool enough =
        bb_search_prims(&f->search, &f->setup, &f->slab,
                        blocks + (ulong)BB_WORDS * (f->link & BB_INDEX_MASK), ends, &tagged);
#endif
    uint top = enough ? 0u : bb_stack_pop(f, f->top, f->search.tmax);
    bb_flight_go(f, enough || (tagged & BB_LAST_BIT) != 0, top, f->link + 1u, nodes, blocks);
}

void bb_flight_to_root(bb_flight *f, uint root)
{
    f->links[0] = BB_NONE;
#if BB_SHORTENED
    f->entries[0] = as_uint(-INFINITY); /* never obsolete, however short the ray becomes */
#endif
    f->top = 1;
    f->link = root;
}

void bb_flight_start(bb_flight *f, uint id, uint root, float scale,
                     global const bb_ray *rays BB_QUERY_ARGUMENTS)
{
    f->id = id;
    f->enough = true;
    bb_ray_setup_make(&f->setup, &rays[id], scale);
    f->slab = bb_slab_of(f->setup.o, f->setup.d);
#if BB_BY_OCTANT
    f->farthest = 7u ^ bb_octant_of(f->setup.d);
#endif
    bb_search_start(&f->search, &f->setup, &rays[id]);
    BB_QUERY_START(&f->search, &f->setup);
    bb_flight_to_root(f, root);
}

/* At the end of the stack: returns true if the ray starts again. */
bool bb_flight_end(bb_flight *f, uint root, global bb_result *results BB_COUNTS_ARGUMENT)
{
    if (f->enough && BB_QUERY_AGAIN(&f->search)) {
        bb_flight_to_root(f, root);
        return true;
    }
    if (f->enough)
        bb_search_write(&f->search, &f->setup, &results[f->id]);
#if BB_COUNTING
    bb_search_count(&f->search, !f->enough, &counts[f->id]);
#endif
    return false;
}

/* Not inlined: a driver that runs a group's work-items in a loop might keep the flights of each. */
__attribute__((noinline)) static void
trace_batch(uint first, uint count, global const bb_wide *nodes, global const float *blocks,
            uint root, const bb_prim_ends *ends, float scale,
            global const bb_ray *rays BB_RAY_ORDER_ARGUMENT,
            global bb_result *results BB_COUNTS_ARGUMENT BB_QUERY_ARGUMENTS)
{
    bb_flight flights[BB_RAYS];
    uint at_node[BB_RAYS + 1], at_leaf[BB_RAYS + 1]; /* numbers of rays; one more is written */
    uint nodes_left = 0, leaves_left = 0, next = 0;
    for (; next < BB_RAYS && next < count; next++) {
        bb_flight_start(&flights[next], BB_RAY_AT(first + next), root, scale, rays BB_QUERY_VALUES);
        at_leaf[leaves_left++] = next;
    }
    if ((root & BB_LEAF_BIT) == 0)
        for (; leaves_left > 0u; nodes_left++)
            at_node[nodes_left] = at_leaf[--leaves_left];
    while (nodes_left + leaves_left > 0u) {
        uint stay = 0;
        for (uint i = 0; i < nodes_left; i++) {
            uint which = at_node[i];
            bb_flight_at_node(&flights[which], nodes, blocks);
            uint leaf = flights[which].link >> 31;
            at_node[stay] = at_leaf[leaves_left] = which;
            stay += 1u - leaf;
            leaves_left += leaf;
        }
        nodes_left = stay;
        stay = 0;
        for (uint i = 0; i < leaves_left; i++) {
            uint which = at_leaf[i];
            bb_flight *f = &flights[which];
            if (f->link != BB_NONE) {
                bb_flight_at_leaf(f, nodes, blocks, ends);
            } else if (!bb_flight_end(f, root, results BB_COUNTS)) {
                if (next == count)
                    continue;
                bb_flight_start(f, BB_RAY_AT(first + next), root, scale, rays BB_QUERY_VALUES);
                next++;
            }
            uint leaf = f->link >> 31;
            at_leaf[stay] = at_node[nodes_left] = which;
            stay += leaf;
            nodes_left += 1u - leaf;
        }
        leaves_left = stay;
    }
}

#define BB_TRACE_NODE bb_wide
#include "trace.clh"
