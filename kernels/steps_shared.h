/* Steps of a ray's search, which the recording variant of a kernel writes and host code replays in
 * lockstep (framework/simulate/). A step is an iteration of one of the kernel's loops that reads a
 * node, a record of a leaf, a stack entry or a volume, or writes an entry.
 *
 * A ray begins alone. A packet's rays come together and go on alone as marks say, and while they
 * are together all of them have the same steps, those too that are idle. A pop says whether a ray
 * takes part until the packet's next one. */
#ifndef BB_STEPS_SHARED_H
#define BB_STEPS_SHARED_H

enum {
    BB_STEP_NODE,    /* tests the boxes of a node; its index */
    BB_STEP_PUSH,    /* puts an entry on the stack, after a node; 0 */
    BB_STEP_PRIMS,   /* tests a primitive of a leaf, or a block of them; the index of it */
    BB_STEP_POP,     /* takes an entry from the stack, whether it is obsolete or not; 0 */
    BB_STEP_RESTART, /* goes back to the root, for lack of a stack entry; 0 */
    BB_STEP_BOX,     /* tests one box of a node with all rays of a packet; the node's index. Or of
                      * a node whose children's boxes are apart: BB_STEP_CHILD() */
    BB_STEP_SAMPLE,  /* interpolates a volume's values; the first of the eight voxels */
    BB_STEP_LOOKUP,  /* interpolates entries of a table, after a sample; the first of the two */
    BB_STEP_AGAIN,   /* begins another search, after all rays of a group have ended one; 1: for what
                      * meets a region, a box or a ray; or else 0 */
    BB_STEP_LEAF,    /* goes to a leaf, one of those that a node has; its index */
    BB_STEP_EXACT,   /* tests a primitive at length, whose box did not suffice; 0 */
    BB_STEP_FURTHER, /* goes on with an exact test whose first part did not suffice; 0 */
    BB_STEP_KINDS,
    BB_STEP_MARK /* no step: 1: the ray joins its packet, 0: it leaves it */
};

/* Of a packet's push and pop the index is the entry's place, and in the last bit whether the ray
 * has met the box that is pushed, or visits what is popped. */
#define BB_STEP_ENTRY(place, met) ((place) << 1 | (met))

/* The last bit: its box is read; if not, what its flags say suffices. */
#define BB_STEP_CHILD(child, read) ((child) << 1 | (read))

/* A step is one word: its kind, and below it the index. */
#define BB_STEP_INDEX_BITS 28
#define BB_STEP_INDEX_MASK ((1u << BB_STEP_INDEX_BITS) - 1u)

#endif
