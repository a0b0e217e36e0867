/* The pass of a refit that keeps books of a binary tree on the device, and rotates (turns.cl). */
#ifndef BB_TURNS_H
#define BB_TURNS_H

#include "builders/common/subtrees.h"
#include "framework/device/levels.h"
#include "turns_shared.h"

typedef struct bb_turner {
    bb_device *device;
    bb_account *account;
    bool rotates, costs, spreads; /* the books that are kept: heights and sizes for rotations */
    cl_program program;
    cl_kernel subtrees_kernel;             /* by a fence */
    cl_kernel leaves_kernel, level_kernel; /* by levels */
    bb_subtrees subtrees;
    bb_buffer heights, costs_of, spreads_of; /* per node; of one entry if they are not kept */
    bb_buffer next;                          /* as subtrees.roots */
    bb_buffer totals_there;
    bb_levels levels;
    bb_turn_totals totals; /* of the last pass */
} bb_turner;

/* Compiles into a zeroed object, in which device, account and the books are set. Scratch is booked
 * on the account. To be released also if it fails. */
bb_status bb_turner_create(bb_turner *turner);
void bb_turner_release(bb_turner *turner);

/* Gets ready for a tree on the device, binary, whose info is fetched. */
bb_status bb_turner_plan(bb_turner *turner, const bb_tree *tree);

/* New boxes for the tree that was planned; may_turn: with rotations, which are kept as books. The
 * tree is declared changed, as far as it is. Waits for the device. */
bb_status bb_turner_pass(bb_turner *turner, const bb_buffer *boxes, bool may_turn, bb_tree *tree);

#endif
