/* Orders configurations that are about equally fast by their needs. The first difference decides:
 *
 *   1. bytes of the tree, its scratch memory and the layout, in steps of 2 %: a smaller difference
 *      is not worth a longer code
 *   2. bits of the code
 *   3. entries of the stack
 *   4. kinds of primitives compiled in
 *   5. children of a node of the kernel's layout: 2, 4, 8
 *   6. the intersector: a more careful one is less
 *   7. time
 *   8. the place in the list of contenders, so that the order is total
 */
#ifndef BB_LEASTNESS_H
#define BB_LEASTNESS_H

#include <stdint.h>

typedef struct bb_extent {
    double bytes;
    uint32_t code_bits; /* 0: no code */
    uint32_t stack;     /* 0: no stack */
    uint32_t kinds;
    uint32_t width;
    uint32_t doubt; /* index of the intersector's preset */
    double ms;
    uint32_t place;
} bb_extent;

/* Returns a number below 0 if a is less than b, above 0 if it is more. The order is total. */
int bb_extent_compare(const bb_extent *a, const bb_extent *b);

/* Returns the deciding difference in words, such as "memory"; "nothing" for equals. */
const char *bb_extent_reason(const bb_extent *a, const bb_extent *b);

#endif
