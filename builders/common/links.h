/* Links of the common tree from what builders have: a node's first child and its next sibling.
 *
 * A child's skip is its next sibling; the last child's is its parent's. So a builder that knows the
 * siblings writes those as skips, and the last ones' follow from the top down.
 */
#ifndef BB_LINKS_H
#define BB_LINKS_H

#include "framework/device/device.h"
#include "framework/tree/tree.h"

#pragma GCC visibility push(default) /* what a plug-in may call */

#ifdef __cplusplus
extern "C" {
#endif

/* Finishes a tree on the host whose nodes have their boxes and, as `first`, their first child or
 * BB_LEAF_BIT | first reference; as `skip` their next sibling, BB_NONE for the last of a family and
 * for the root. Sets the last ones' skips, and leaf_count, arity and depth of tree->info; root,
 * node_count and ref_count are the caller's. `depths` is scratch, a u32 per node; NULL leaves the
 * depth to the caller. One pass in preorder, whatever the depth. BB_FAILED if a node is linked to
 * that does not exist, or more than node_count are met. */
bb_status bb_links_finish(bb_tree *tree, uint32_t *depths);

/* ---- the same on the device ---- */

typedef struct bb_links bb_links;

/* Compiles. Scratch is booked on `account`. */
bb_status bb_links_create(bb_device *device, bb_account *account, bb_links **out);
void bb_links_destroy(bb_links *links); /* NULL is allowed */

/* Scratch for trees of up to `nodes` nodes: 32 bytes each. */
bb_status bb_links_reserve(bb_links *links, size_t nodes);

/* Finishes a tree on the device, whose d_nodes are as bb_links_finish() takes them: sets the last
 * children's skips, and fills d_info from `known` (root, node_count, ref_count) and what it finds.
 * Waits for the device a few times, the more the deeper the tree. All nodes hang from the root, or
 * the result is no tree, which `bvhbench check` says. */
bb_status bb_links_finish_device(bb_links *links, const bb_tree_info *known, bb_tree *tree);

#ifdef __cplusplus
}
#endif

#pragma GCC visibility pop

#endif
