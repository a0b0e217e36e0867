/* Shared by the wide layouts (kernels/layout_wide.cl), each of which is declared in its own
 * layout_NAME.c. */
#ifndef BB_WIDE_H
#define BB_WIDE_H

#include "traversal/traversal.h"

/* How nodes keep boxes; compressed ones (bb_cwbvh) keep all else their own way too. */
typedef enum bb_wide_form { BB_WIDE_FLOATS, BB_WIDE_QUANTISED, BB_WIDE_COMPRESSED } bb_wide_form;

/* Makes a layout of nodes with up to `width` children (4 or 8; but as floats: 8), which the hooks
 * below get. `device`, `account` and `name`, as which memory is booked, outlive it. After a failure
 * *self is to be destroyed too. */
bb_status bb_wide_create(bb_device *device, bb_account *account, const char *name, uint32_t width,
                         bb_wide_form form, void **self);

/* The hooks of bb_layout. make() fills two buffers, nodes and records, which the caller releases
 * with `data`; BB_UNSUPPORTED for what the layout does not take, BB_REFUSED where there is no
 * memory. collapses() is true for trees of which nodes are made without pairs of children in
 * between (wide_direct.h). */
bb_status bb_wide_make(void *self, const bb_layout_source *source, bb_layout_data *data);
bool bb_wide_collapses(const void *self, const bb_tree *tree);
void bb_wide_destroy(void *self); /* NULL is allowed */

/* What the struct of such a layout says after name and summary; create() is the file's own. */
#define BB_WIDE_LAYOUT(places)                                                                     \
    .width = (places), .block = BB_BLOCK_LANES, .create = create, .make = bb_wide_make,            \
    .collapses = bb_wide_collapses, .destroy = bb_wide_destroy

#endif
