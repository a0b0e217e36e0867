/* Shared by the wide layouts (kernels/layout_wide.cl), each of which is declared in its own
 * layout_NAME.c. */
#ifndef BB_WIDE_H
#define BB_WIDE_H

#include "traversal/traversal.h"

/* How nodes store boxes; compressed ones (bb_cwbvh) also store everything else differently. */
typedef enum bb_wide_form { BB_WIDE_FLOATS, BB_WIDE_QUANTISED, BB_WIDE_COMPRESSED } bb_wide_form;

/* Makes a layout of nodes with up to `width` children (4 or 8; only 8 except as floats), for the
 * hooks below. `name` is the layout's. `device`, `account` and `name` must outlive it. *self
 * must be destroyed even after a failure. */
bb_status bb_wide_create(bb_device *device, bb_account *account, const char *name, uint32_t width,
                         bb_wide_form form, void **self);

/* The hooks of bb_layout. make() fills two buffers, nodes and records, which the caller releases
 * with `data`. BB_UNSUPPORTED if the layout does not accept the tree, BB_REFUSED if there is no
 * memory. collapses() is true for trees whose nodes are made without pairs (wide_direct.h). */
bb_status bb_wide_make(void *self, const bb_layout_source *source, bb_layout_data *data);
bool bb_wide_collapses(const void *self, const bb_tree *tree);
void bb_wide_destroy(void *self); /* NULL is allowed */

/* Members of such a layout's struct after name and summary; create() is in its own file. */
#define BB_WIDE_LAYOUT(places)                                                                     \
    .width = (places), .block = BB_BLOCK_LANES, .keeps_nodes = true, .create = create,             \
    .make = bb_wide_make, .collapses = bb_wide_collapses, .destroy = bb_wide_destroy

#endif
