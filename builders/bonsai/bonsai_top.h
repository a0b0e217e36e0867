/* The top tree of bonsai, on the device. */
#ifndef BB_BONSAI_TOP_H
#define BB_BONSAI_TOP_H

#include "bonsai_shared.h"
#include "framework/builder/builder.h"
#include "framework/device/primitives.h"

typedef struct bn_top bn_top;

/* Items that the top tree is built over. */
typedef struct bn_leaves {
    const bb_buffer *items; /* bn_item, in the order of their references */
    uint32_t count;
    uint32_t refs;           /* number of references of all items */
    const bb_buffer *levels; /* u8 per reference: level of its leaf in its mini-tree */
    float unit;              /* bb_scene_unit() */
} bn_leaves;

/* Compiles. by_prims: an item weighs as much as it has primitives, else 1. Memory is booked on
 * `account`. */
bb_status bn_top_create(bb_device *device, bb_account *account, bool by_prims, bn_top **out);
void bn_top_destroy(bn_top *top); /* NULL is allowed */

/* Reserves scratch for up to `items` items; it grows with their number. */
bb_status bn_top_reserve(bn_top *top, uint32_t items);

/* Writes the nodes above the items, including the items' roots, into the tree, which has all other
 * nodes, and its d_info. Enqueued, not waited for. */
bb_status bn_top_make(bn_top *top, bb_primitives *primitives, const bn_leaves *leaves,
                      bb_tree *tree);

#endif
