/* Moves of subtrees: chooses which of the found ones to make, and makes them (reinsert_moves.cl).
 */
#ifndef BB_REINSERT_MOVES_H
#define BB_REINSERT_MOVES_H

#include "families.h"
#include "framework/device/levels.h"

typedef struct bb_mover {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel open, clear, bid, tie, settle, make, undo, arrive;
    cl_kernel refit;                    /* hand-over by a fence */
    cl_kernel refit_first, refit_level; /* hand-over by levels */
    bb_buffer states;                   /* u32 per move */
    bb_buffer bids, holders, taken;     /* u32 per family; only set where a move needs them */
    bb_buffer missing;                  /* u32 per family; 0 between passes */
    bb_buffer made;
    bb_levels levels;
} bb_mover;

/* Compiles into a zeroed object. Scratch is booked on `account`. Must be released even if it
 * fails. */
bb_status bb_mover_create(bb_device *device, bb_account *account, bb_mover *mover);
void bb_mover_release(bb_mover *mover);

/* Prepares for a tree of `count` families. */
bb_status bb_mover_reserve(bb_mover *mover, uint32_t count);

/* Moves found for one state of the tree: entries [begin, end) of a buffer. */
typedef struct bb_moves {
    const bb_buffer *buffer; /* bb_move */
    uint32_t begin, end;
} bb_moves;

/* Chooses moves that do not conflict, the largest gain first, in up to BB_MOVE_ROUNDS rounds.
 * *made: their number. Waits for the device. */
enum { BB_MOVE_ROUNDS = 3 };
bb_status bb_mover_choose(bb_mover *mover, bb_moves moves, uint32_t *made);

/* Makes the chosen moves, and updates the boxes. */
bb_status bb_mover_make(bb_mover *mover, bb_family_tree *tree, bb_moves moves);

/* Undoes the chosen moves: the tree is as before. With several batches, undo the last one first. */
bb_status bb_mover_undo(bb_mover *mover, bb_family_tree *tree, bb_moves moves);

#endif
