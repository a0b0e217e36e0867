/* The order of leastness: of two configurations that do the same in about the same time, which one
 * is less. The first of these that differs decides:
 *
 *   1. bytes of the tree, its scratch memory and the layout, in steps of 2 %, since memory that
 *      differs by less is not worth a longer code
 *   2. bits of the code
 *   3. entries of the stack
 *   4. kinds of primitives compiled in
 *   5. children of a node as the kernel sees it: 2, 4, 8
 *   6. the intersector, from exact to careless: less doubt
 *   7. time
 *   8. the place in the list of what is tried, so that there is always an order
 */
#ifndef BB_LEASTNESS_H
#define BB_LEASTNESS_H

#include <stdint.h>

typedef struct bb_extent {
    double bytes;
    uint32_t code_bits; /* 0: no code */
    uint32_t stack;     /* 0: no stack of the tree's size */
    uint32_t kinds;
    uint32_t width;
    uint32_t doubt; /* place of the intersector among the presets */
    double ms;
    uint32_t place;
} bb_extent;

/* Below 0 if a is less than b, above 0 if it is more. A total order. */
int bb_extent_compare(const bb_extent *a, const bb_extent *b);

/* What decided, in words: "memory", "bits of the code" ...; "nothing" for equals. */
const char *bb_extent_reason(const bb_extent *a, const bb_extent *b);

#endif
