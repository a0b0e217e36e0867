/* A group of rays that run in lockstep, as a GPU's warps do, replayed from the steps of each.
 *
 * All rays of a group that have the next step of one kind take it together; the others wait. In
 * which order the kinds have their turns is the kernel's control structure (bb_control), whose
 * loops the group leaves only when its last ray does:
 *
 *   loop: nodes: while a ray that has not left this loop is at a node: these take it, then push
 *                (if-if, if-else: once)
 *         primitives: while a ray is at one (by leaf: once): these, then those that test it
 *                exactly, then those that go on with that
 *         samples: while a ray takes one: these take it, then look its values up
 *                  (by leaf: on to primitives, while a ray is at one)
 *         pops: while a ray pops or restarts: these pop, then those restart (if-else: once those
 *               pop that began the iteration with it)
 *   again: (if-else, until leaf: all look up what they have found) all rays that need another
 *          search begin it, with samples if they take some first
 *
 * Until each ray has a leaf, or no node is left (until leaf):
 *
 *   loop: nodes: while a ray is at one: these take it; while one of them has a child to test: a box
 *                of each that has; while one of them pushes: these push; those that pop or restart
 *                do so once
 *         all that have a leaf go to it; primitives: while a ray is at one, as above
 *
 * A group may hold several packets, whose rays follow each other. Those that are together with
 * their packet take its steps, of which they are active in some; those that have left it are as
 * above:
 *
 *   loop: a pop of each packet
 *         primitives: while a packet is at one
 *         a node of each packet that is at one; while it has boxes to test: one, then its push
 *         rays on their own, until all have come back
 *
 * Aila and Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs": while-while and
 * if-if; SIMD efficiency is the share of the lanes that are active, over all that is issued.
 */
#ifndef BB_WARP_H
#define BB_WARP_H

#include "framework/simulate/footing.h"
#include "framework/simulate/steps.h"

enum {
    BB_WARP_MOST = 64,  /* lanes */
    BB_ENTRY_WORDS = 2, /* words of private memory for a stack entry in each lane, at most */
};

/* Kinds of what is issued: those of steps, and a ray's beginning and end. */
enum { BB_ISSUE_BEGIN = BB_STEP_KINDS, BB_ISSUE_END, BB_ISSUE_KINDS };

/* What a group does at a time: the same step for all active lanes. */
typedef struct bb_issue {
    uint32_t kind;
    uint64_t lanes; /* bit i: lane i is active */
    /* of each active lane: the node, the primitive, the place of the stack entry, the ray; of a
     * box apart as BB_STEP_CHILD() has it */
    uint32_t index[BB_WARP_MOST];
    /* of a stack entry: the lanes whose first word is read or written, and whose second one. Of a
     * packet the first words are all distances, active or not; the second ones of its first two
     * lanes are its link and its least distance. */
    uint64_t words[BB_ENTRY_WORDS];
} bb_issue;

typedef struct bb_warp {
    const bb_steps *steps;
    const bb_footing *footing;
    uint32_t first, lanes;             /* its rays */
    uint32_t turn;                     /* kind whose turn it is */
    bool in_region;                    /* its search is for what meets a region */
    uint64_t at[BB_STEP_KINDS];        /* lanes whose next step is of this kind, and their own */
    uint64_t of_packet[BB_STEP_KINDS]; /* likewise, their packet's */
    uint64_t together;                 /* lanes that are with their packet */
    uint64_t active;                   /* of these, those that visit what was popped last */
    uint64_t pushing;                  /* lanes of the last node */
    uint64_t popping;                  /* if-else: lanes that pop in this iteration */
    uint64_t restarting; /* lanes that restart in this iteration of the loop of pops */
    uint32_t next[BB_WARP_MOST], end[BB_WARP_MOST]; /* each lane's steps */
    uint32_t top[BB_WARP_MOST];                     /* of each lane's stack */
} bb_warp;

/* Begins with rays first to first + lanes - 1; lanes is at most BB_WARP_MOST. The footing must last
 * as long as the group. */
void bb_warp_start(bb_warp *warp, const bb_steps *steps, const bb_footing *footing, uint32_t first,
                   uint32_t lanes);
/* Gets what the group does next; returns false if all of its rays have ended. */
bool bb_warp_next(bb_warp *warp, bb_issue *issue);

/* Returns the steps that its rays have not taken: of one that has ended, those that do not fit the
 * kernel's loops. */
uint64_t bb_warp_left(const bb_warp *warp);

/* Returns whether what is issued is a test of boxes. */
static inline bool bb_is_at_node(uint32_t kind)
{
    return kind == BB_STEP_NODE || kind == BB_STEP_BOX;
}

#endif
