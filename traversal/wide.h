/* Shared by the wide layouts (kernels/layout_wide.cl), each of which is declared in its own
 * layout_NAME.c. */
#ifndef BB_WIDE_H
#define BB_WIDE_H

#include "traversal/traversal.h"

/* A layout of nodes with up to `width` children (4 or 8; quantised: 8), called `name`. */
bb_status bb_wide_create(bb_device *device, bb_account *account, const char *name, uint32_t width,
                         bool quantised, void **self);
bb_status bb_wide_make(void *self, const bb_layout_source *source, bb_layout_data *data);
bool bb_wide_collapses(const void *self, const bb_tree *tree);
void bb_wide_destroy(void *self);

/* What the struct of such a layout says after name and summary; create() is the file's own. */
#define BB_WIDE_LAYOUT(places)                                                                     \
    .width = (places), .block = BB_BLOCK_LANES, .create = create, .make = bb_wide_make,            \
    .collapses = bb_wide_collapses, .destroy = bb_wide_destroy

#endif
