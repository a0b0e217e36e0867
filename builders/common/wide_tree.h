/* A wide tree straight from sorted keys (wide_tree.cl): nodes of up to 8 children, leaves of a few
 * references, in the common format. For builders that sort by a code. */
#ifndef BB_WIDE_TREE_H
#define BB_WIDE_TREE_H

#include "framework/builder/tree.h"
#include "framework/device/device.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_wide_tree bb_wide_tree;

/* Compiles, for keys of 4 or 8 bytes and leaves of up to `leaf` >= 1 references. Scratch is booked
 * on `account`. */
bb_status bb_wide_tree_create(bb_device *device, bb_account *account, uint32_t key_bytes,
                              uint32_t leaf, bb_wide_tree **out);
void bb_wide_tree_destroy(bb_wide_tree *wide); /* NULL is allowed */

/* Returns the most nodes over `count` references. */
size_t bb_wide_tree_nodes(const bb_wide_tree *wide, uint32_t count);

/* Reserves scratch for up to `count` references, and room in `tree` (on the device). */
bb_status bb_wide_tree_reserve(bb_wide_tree *wide, uint32_t count, bb_tree *tree);

/* Makes the tree over `count` >= 1 sorted keys; values[] are their primitives, boxes[] the
 * primitives' boxes (bb_box). Fills tree, d_info included. In the form for CPUs it is enqueued, not
 * waited for; in that for GPUs the host asks now and then whether there is a further level. */
bb_status bb_wide_tree_make(bb_wide_tree *wide, const bb_buffer *keys, const bb_buffer *values,
                            const bb_buffer *boxes, uint32_t count, bb_tree *tree);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
