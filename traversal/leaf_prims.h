/* Leaf primitives: the data of primitives for most kernels, expanded in the order of the leaves
 * (bb_leaf_prim_words() in kernels/bb_shared.h; device code in kernels/leaf_prims.cl). */
#ifndef BB_LEAF_PRIMS_H
#define BB_LEAF_PRIMS_H

#include "traversal/traversal.h"

typedef struct bb_leaf_prims bb_leaf_prims;

/* Compiles the kernel. The caller owns *out. */
bb_status bb_leaf_prims_create(bb_device *device, bb_account *account, bb_leaf_prims **out);
void bb_leaf_prims_destroy(bb_leaf_prims *leaf_prims); /* NULL is allowed */

/* Makes record i for refs[i]. `refs` has all references of the source's tree, with their last-bits.
 * Triangles are in `format` (BB_FORMAT_...), lengths are multiplied by the scene's scale. `closed`:
 * appends a record of the primitive BB_NONE, which nothing hits. Reserves `out` on the account and
 * adds its size to *bytes. Enqueued, not waited for. */
bb_status bb_leaf_prims_make(bb_leaf_prims *leaf_prims, const bb_layout_source *source,
                             const bb_buffer *refs, uint32_t format, bool closed, bb_buffer *out,
                             uint64_t *bytes);

#endif
