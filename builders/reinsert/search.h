/* Chooses the subtrees to search for, and finds a better place for each (reinsert_search.cl). */
#ifndef BB_REINSERT_SEARCH_H
#define BB_REINSERT_SEARCH_H

#include "builders/common/compact.h"
#include "families.h"

typedef struct bb_reinsert_search {
    bb_device *device;
    bb_account *account;
    bb_primitives *primitives; /* owned by the tree */
    bb_compaction *compaction;
    cl_program program;
    cl_kernel sample, mark, find;
    bb_buffer samples; /* float */
    float *samples_here;
    bb_buffer marks; /* u32 per place */
    bb_buffer list;  /* u32: places, ascending */
    bb_buffer listed;
    bb_buffer moves; /* bb_move per entry of the list */
    uint32_t count;  /* of the list */
} bb_reinsert_search;

/* Compiles into a zeroed object; a search visits at most `most` families. `primitives` must outlive
 * it. Scratch is booked on `account`. Must be released even if it fails. */
bb_status bb_reinsert_search_create(bb_device *device, bb_account *account,
                                    bb_primitives *primitives, uint32_t most,
                                    bb_reinsert_search *search);
void bb_reinsert_search_release(bb_reinsert_search *search);

/* Reserves scratch for trees of `count` families. */
bb_status bb_reinsert_search_reserve(bb_reinsert_search *search, uint32_t count);

/* Lists about `share` of all subtrees, the largest first; subtrees of equal area are all listed or
 * all left out. Waits for the device. */
bb_status bb_reinsert_choose(bb_reinsert_search *search, const bb_family_tree *tree, double share);

/* Finds moves for one of the `parts` equal parts of the list: moves[begin .. *end). */
bb_status bb_reinsert_find(bb_reinsert_search *search, const bb_family_tree *tree, uint32_t part,
                           uint32_t parts, uint32_t begin, uint32_t *end);

#endif
