/* Refit: new boxes for a tree whose primitives have moved. Links and references stay.
 *
 * From the bottom up, each leaf's box becomes the union of its primitives' boxes, and each inner
 * node's that of its children: the tightest boxes, in float, without rounding. The same tree and
 * boxes give the same result, bit for bit, on the host and on the device. Trees may have any arity
 * and depth, and nodes any order. Terdiman 2001, "Memory-optimized bounding-volume hierarchies";
 * Wald, Boulos, Shirley 2007, "Ray Tracing Deformable Scenes using Dynamic Bounding Volume
 * Hierarchies".
 *
 * A tree with duplicated references is BB_UNSUPPORTED: a leaf's box may contain only a piece of a
 * primitive, and the primitive's new box does not say where that piece went. Afterwards the tree is
 * no longer declared `disjoint`, since siblings may have moved into each other; side arrays are
 * kept.
 */
#ifndef BB_REFIT_H
#define BB_REFIT_H

#include "framework/builder/builder.h"
#include "framework/builder/tree.h"
#include "framework/device/device.h"

#pragma GCC visibility push(default) /* what a plug-in may call */

#ifdef __cplusplus
extern "C" {
#endif

/* An option for the builder's table: whether its update() refits. It has no default, so that cells
 * keep their keys. */
#define BB_UPDATE_OPTION                                                                           \
    {                                                                                              \
        "update", NULL, "rebuild|refit",                                                           \
            "when primitives have moved: rebuild (the default), or refit the boxes"                \
    }

/* Refits a tree on the host to boxes[0 .. prim_count). `order` is scratch, a u32 per node. One pass
 * in preorder and one back, at any depth. BB_FAILED, before any box is written, if a link or a
 * reference leads nowhere, or more than node_count nodes are found. */
bb_status bb_refit(bb_tree *tree, const bb_box *boxes, uint32_t prim_count, uint32_t *order);

/* ---- the same on the device ---- */

typedef struct bb_refitter bb_refitter;

/* Compiles. Scratch is booked on `account`. */
bb_status bb_refitter_create(bb_device *device, bb_account *account, bb_refitter **out);
void bb_refitter_destroy(bb_refitter *refitter); /* NULL is allowed */

/* The same for a builder with BB_UPDATE_OPTION; *out is NULL if its trees are to be rebuilt. */
bb_status bb_refitter_choose(const bb_builder_context *context, bb_refitter **out);

/* Reserves scratch for trees of up to `nodes` nodes: 24 bytes each; if work-groups hand over by
 * levels, 16, and 4 per level once they are needed. A NULL refitter is allowed. */
bb_status bb_refitter_reserve(bb_refitter *refitter, size_t nodes);

/* Prepares refits of a tree on the device from its links; tree->info must have been fetched.
 * Optional: the first refit after links have changed does it. Waits for the device. */
bb_status bb_refit_plan(bb_refitter *refitter, const bb_tree *tree);

/* Refits a tree on the device to `boxes` (bb_box); tree->info must have been fetched. Enqueued, not
 * waited for; by levels it queries the device now and then. The tree must be valid: links are not
 * checked. */
bb_status bb_refit_device(bb_refitter *refitter, const bb_buffer *boxes, bb_tree *tree);

/* update() of a builder with BB_UPDATE_OPTION: a refit, phase "refit". BB_UNSUPPORTED if `refitter`
 * is NULL, since trees are to be rebuilt, or if more than positions have changed. */
bb_status bb_refit_update(bb_refitter *refitter, const bb_scene *scene, uint32_t changed,
                          bb_tree *tree, bb_phases *phases);

#ifdef __cplusplus
}
#endif

#pragma GCC visibility pop

#endif
