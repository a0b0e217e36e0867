/* Leaf collapse by SAH, on the device, the same pass for all builders and layouts (kernels/collapse.cl). */
#ifndef BB_COLLAPSE_H
#define BB_COLLAPSE_H

#include "framework/tree.h"

typedef struct bb_collapse bb_collapse;

/* Compiles the kernels. Scratch and the resulting tree are booked on `account`. Owned by the caller. */
bb_status bb_collapse_create(bb_device *device, bb_account *account, bb_collapse **out);
void bb_collapse_destroy(bb_collapse *collapse); /* NULL is allowed */

/* The tree, which is on the device, with leaves of up to `max_leaf` references (1 to BB_LEAF_MAX): a subtree of no more becomes one
 * leaf where that does not cost more. Ci = 1 per `block` references that a leaf begins. Ct = 1.2 * children / 2 per inner node, times
 * width / 2 / (width - 1): a node of `width` children costs so much more than one of two and stands for so many of them. A primitive that several leaves of the subtree reference is referenced once by the new leaf. *out lies on the device and
 * belongs to `collapse`; it holds until the next call. Its info is there when this returns. */
bb_status bb_collapse_make(bb_collapse *collapse, const bb_tree *tree, uint32_t max_leaf,
                           uint32_t width, uint32_t block, bb_tree **out);

#endif
