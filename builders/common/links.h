/* Links of the common tree, from each node's first child and next sibling.
 *
 * A child's skip is its next sibling; the last child's is its parent's skip. So builders write
 * siblings as skips, and bb_links_finish() fills in those of last children, top-down.
 */
#ifndef BB_LINKS_H
#define BB_LINKS_H

#include "framework/builder/tree.h"
#include "framework/device/device.h"

#pragma GCC visibility push(default) /* what a plug-in may call */

#ifdef __cplusplus
extern "C" {
#endif

/* Finishes a tree on the host. Its nodes have their boxes; `first` is the first child, or
 * BB_LEAF_BIT | first reference; `skip` is the next sibling, BB_NONE for a last child and for the
 * root. Sets the skips of last children, and leaf_count, arity and depth of tree->info; the caller
 * sets root, node_count and ref_count. `depths` is scratch, a u32 per node; if NULL, the caller
 * sets the depth. One pass in preorder, at any depth. BB_FAILED if a link leads nowhere, or more
 * than node_count nodes are found. */
bb_status bb_links_finish(bb_tree *tree, uint32_t *depths);

/* ---- the same on the device ---- */

typedef struct bb_links bb_links;

/* Compiles. Scratch is booked on `account`. */
bb_status bb_links_create(bb_device *device, bb_account *account, bb_links **out);
void bb_links_destroy(bb_links *links); /* NULL is allowed */

/* Scratch for trees of up to `nodes` nodes: 32 bytes each. */
bb_status bb_links_reserve(bb_links *links, size_t nodes);

/* Finishes a tree on the device, with d_nodes as for bb_links_finish(): sets the skips of last
 * children, and fills d_info from `known` (root, node_count, ref_count) and what it finds. Waits
 * for the device a few times, more often for deeper trees. All nodes must be reachable from the
 * root; otherwise the result is not a tree, which `bvhbench check` reports. */
bb_status bb_links_finish_device(bb_links *links, const bb_tree_info *known, bb_tree *tree);

#ifdef __cplusplus
}
#endif

#pragma GCC visibility pop

#endif
