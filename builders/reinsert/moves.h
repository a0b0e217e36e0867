/* Moves of subtrees: which of those that were found are made, and making them (reinsert_moves.cl).
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
    cl_kernel refit;                    /* by a fence */
    cl_kernel refit_first, refit_level; /* by levels */
    bb_buffer states;                   /* u32 per move */
    bb_buffer bids, holders, taken;     /* u32 per family; set where a move needs them */
    bb_buffer missing;                  /* u32 per family; 0 between passes */
    bb_buffer made;
    bb_levels levels;
} bb_mover;

/* Compiles into a zeroed object. Scratch is booked on `account`. To be released also if it
 * fails. */
bb_status bb_mover_create(bb_device *device, bb_account *account, bb_mover *mover);
void bb_mover_release(bb_mover *mover);

/* Gets ready for a tree of `count` families. */
bb_status bb_mover_reserve(bb_mover *mover, uint32_t count);

/* Moves of one state of a tree, entries [begin, end) of a buffer. */
typedef struct bb_moves {
    const bb_buffer *buffer; /* bb_move */
    uint32_t begin, end;
} bb_moves;

/* Chooses moves that do not conflict, the largest gain first, in up to BB_MOVE_ROUNDS
 * rounds; *made: how many. Waits for the device. */
enum { BB_MOVE_ROUNDS = 3 };
bb_status bb_mover_choose(bb_mover *mover, bb_moves moves, uint32_t *made);

/* Makes those that were chosen, and brings boxes up to date. */
bb_status bb_mover_make(bb_mover *mover, bb_family_tree *tree, bb_moves moves);

/* Takes them back: the tree is as it was. Of several lots the last one first. */
bb_status bb_mover_undo(bb_mover *mover, bb_family_tree *tree, bb_moves moves);

#endif
