/* Leaf collapse by SAH on the device: one pass for all builders and layouts
 * (kernels/collapse.cl). */
#ifndef BB_COLLAPSE_H
#define BB_COLLAPSE_H

#include "framework/builder/tree.h"

typedef struct bb_collapse bb_collapse;

/* Returns the cost of a node of `width` children, with Ct = BB_COST_TRAVERSAL per pair of them. */
double bb_collapse_node_cost(uint32_t width);

/* Returns Ct per pair of children for a layout whose nodes of up to `width` children cost `node`
 * each; such a node replaces width - 1 binary ones. */
float bb_collapse_traversal(double node, uint32_t width);

/* Compiles the kernels. Scratch and the resulting tree are booked on `account`. The caller owns
 * *out. */
bb_status bb_collapse_create(bb_device *device, bb_account *account, bb_collapse **out);
void bb_collapse_destroy(bb_collapse *collapse); /* NULL is allowed */

/* Makes a copy of `tree`, which is on the device, in which each subtree of at most `max_leaf`
 * references (1 to BB_LEAF_MAX) becomes one leaf, unless that raises the SAH. A leaf costs Ci = 1
 * per started block of `block` references; an inner node `traversal` per pair of children
 * (bb_collapse_traversal()). Areas are those of boxes times `scale`, the scene's. A primitive that
 * several leaves of a subtree reference is referenced once by the new leaf. Leaves of more than
 * `most` references (0: no limit) become binary trees of leaves of at most that many, all with the
 * leaf's box. *out is on the device, belongs to `collapse`, and is valid until the next call. Its
 * info has been fetched. */
bb_status bb_collapse_make(bb_collapse *collapse, const bb_tree *tree, float scale,
                           uint32_t max_leaf, float traversal, uint32_t block, uint32_t most,
                           bb_tree **out);

/* The same for the tree of the last call, with other boxes and the same links: collapses the same
 * subtrees again. */
bb_status bb_collapse_again(bb_collapse *collapse, const bb_tree *tree, bb_tree **out);

#endif
