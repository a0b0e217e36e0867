/* A refit on the device that keeps books of a binary tree and applies rotations (turns.cl). */
#ifndef BB_TURNS_H
#define BB_TURNS_H

#include "builders/common/subtrees.h"
#include "framework/device/levels.h"
#include "turns_shared.h"

typedef struct bb_turner {
    bb_device *device;
    bb_account *account;
    bool rotates, costs, spreads; /* the books to keep; `rotates`: heights and sizes */
    cl_program program;
    cl_kernel subtrees_kernel;             /* hand-over by a fence */
    cl_kernel leaves_kernel, level_kernel; /* hand-over by levels */
    bb_subtrees subtrees;
    bb_buffer heights, costs_of, spreads_of; /* per node; one entry if not kept */
    bb_buffer next;                          /* like subtrees.roots */
    bb_buffer totals_there;
    bb_levels levels;
    bb_turn_totals totals; /* of the last pass */
} bb_turner;

/* Compiles into a zeroed object with device, account and the books set. Scratch is booked on the
 * account. Must be released even if it fails. */
bb_status bb_turner_create(bb_turner *turner);
void bb_turner_release(bb_turner *turner);

/* Prepares for a binary tree on the device whose info has been fetched. */
bb_status bb_turner_plan(bb_turner *turner, const bb_tree *tree);

/* Computes new boxes for the planned tree. may_turn: also rotates, which needs `rotates`. Declares
 * what has changed in the tree. Waits for the device. */
bb_status bb_turner_pass(bb_turner *turner, const bb_buffer *boxes, bool may_turn, bb_tree *tree);

#endif
