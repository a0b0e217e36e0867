/* A tree cut into subtrees, one per work-item, with the parents and counts that bottom-up passes
 * need.
 *
 * The roots of the cut are the nodes with at most BB_SUBTREE_MOST nodes below them, themselves
 * included, whose parents have more. One work-item for each saves an atomic operation and two
 * fences per node, which are most of the time of a pass by leaves. If work-groups hand over by
 * levels there is no cut, only parents and missing children.
 */
#ifndef BB_SUBTREES_H
#define BB_SUBTREES_H

#include "builders/common/compact.h"
#include "framework/builder/tree.h"
#include "framework/device/device.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_subtrees {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel parents_kernel, sizes_kernel, mark_kernel;
    bb_primitives *primitives;
    bb_compaction *compaction;
    bb_buffer parents; /* u32 per node; BB_NONE for the root */
    bb_buffer missing; /* u32 per inner node: children that a pass has not seen yet */
    /* not by levels: */
    bb_buffer sizes; /* u32 per node: nodes below it, itself included */
    bb_buffer marks;
    bb_buffer roots;      /* u32: roots of the `found` subtrees, ascending */
    bb_buffer root_count; /* the same number, on the device */
    uint32_t found;
} bb_subtrees;

/* Writes the compiler options for device code that uses subtrees: BB_SUBTREE_MOST and those of
 * handover.clh. */
enum { BB_SUBTREES_DEFINES = 160 };
void bb_subtrees_defines(const bb_device *device, char text[BB_SUBTREES_DEFINES]);

/* Compiles into a zeroed object, which must be released even if this fails. Scratch is booked on
 * `account`. */
bb_status bb_subtrees_create(bb_device *device, bb_account *account, bb_subtrees *subtrees);
void bb_subtrees_release(bb_subtrees *subtrees); /* a zeroed object is allowed */

/* Reserves room for trees of up to `nodes` nodes: 24 bytes each; if work-groups hand over by
 * levels, 8. */
bb_status bb_subtrees_reserve(bb_subtrees *subtrees, size_t nodes);

/* Finds parents, missing children and the cut of a tree on the device; tree->info must have been
 * fetched. Waits for the device, except by levels. */
bb_status bb_subtrees_plan(bb_subtrees *subtrees, const bb_tree *tree);

/* Finds the cut again after the caller has updated parents and sizes. */
bb_status bb_subtrees_cut(bb_subtrees *subtrees, const bb_tree *tree);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
