/* Turns pairs of clusters into the common tree: the last step of builders that agglomerate (PLOC,
 * H-PLOC). When two clusters merge, their node's children, box and number of primitives are known;
 * its place and first reference only once the root is made.
 *
 * Nodes are numbered like those of a radix tree: with the references in the order of the leaves,
 * left to right, the children below the split between references s and s + 1 are nodes 2s + 1 and
 * 2s + 2, and the root is node 0. So siblings and small subtrees lie together, the number does not
 * depend on when or where a pair was made, and skips follow from ranges.
 */
#ifndef BB_PAIR_TREE_H
#define BB_PAIR_TREE_H

#include "builders/common/pair_shared.h"
#include "framework/builder/tree.h"
#include "framework/device/device.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_pair_tree bb_pair_tree;

/* Compiles. Memory is booked on `account`. */
bb_status bb_pair_tree_create(bb_device *device, bb_account *account, bb_pair_tree **out);
void bb_pair_tree_destroy(bb_pair_tree *pairs); /* NULL is allowed */

/* Reserves room for `count` >= 1 primitives, and in `tree` (on the device). */
bb_status bb_pair_tree_reserve(bb_pair_tree *pairs, uint32_t count, bb_tree *tree);

/* The builder fills these: `count` - 1 bb_cluster_pair, at any indices below `count`, and the last
 * cluster, a bb_pair_side. */
const bb_buffer *bb_pair_tree_pairs(const bb_pair_tree *pairs);
const bb_buffer *bb_pair_tree_root(const bb_pair_tree *pairs);

/* Fills `tree`, d_info included, for `count` primitives, top-down in time proportional to the tree.
 * On CPUs it is enqueued and not waited for; on GPUs it waits for the device now and then. */
bb_status bb_pair_tree_finish(bb_pair_tree *pairs, uint32_t count, bb_tree *tree);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
