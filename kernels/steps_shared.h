/* Steps of a ray's search, which the recording variant of a kernel writes and host code replays in
 * lockstep (framework/simulate/). A step is an iteration of one of the kernel's loops that reads a
 * node, a record of a leaf or a stack entry, or writes one. */
#ifndef BB_STEPS_SHARED_H
#define BB_STEPS_SHARED_H

enum {
    BB_STEP_NODE,    /* tests the boxes of a node; its index */
    BB_STEP_PUSH,    /* puts an entry on the stack, after a node; 0 */
    BB_STEP_PRIMS,   /* tests a primitive of a leaf, or a block of them; the index of it */
    BB_STEP_POP,     /* takes an entry from the stack, whether it is obsolete or not; 0 */
    BB_STEP_RESTART, /* goes back to the root, for lack of a stack entry; 0 */
    BB_STEP_KINDS
};

/* A step is one word: its kind, and below it the index. */
#define BB_STEP_INDEX_BITS 29
#define BB_STEP_INDEX_MASK ((1u << BB_STEP_INDEX_BITS) - 1u)

#endif
