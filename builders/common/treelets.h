/* Optimisers that rebuild treelets of a binary tree bottom-up, in rounds (TRBVH, ATRBVH): their
 * common host side. The optimiser's own .cl file, which ends with treelet_rounds.clh, rebuilds a
 * treelet; treelets.clh forms it.
 *
 *   pairs: one per inner node, with both children's boxes            (treelets.cl, pair_shared.h)
 *   each round: all pairs of at least gamma leaves, by levels, children first; gamma doubles
 *   the common tree from the pairs, renumbered                       (pair_tree.h)
 *
 * All work is ordered by launches: no work-group hands over to another within one, on any device. A
 * pair's treelet depends only on what is below that pair, so the tree does not depend on the order
 * in a level. On CPUs a work-item first does a whole subtree of up to 4096 leaves, which stays in
 * the cache, eight treelets of a depth at once; the pairs above go by levels. On GPUs a work-item
 * does one treelet.
 */
#ifndef BB_TREELETS_H
#define BB_TREELETS_H

#include "framework/builder/builder.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Makes an optimiser, the object of the other hooks: reads the options rounds, treelet (3 to
 * `treelet_most`) and gamma, and compiles `source`. BB_INVALID for options out of range. If *out
 * was set, it must be destroyed even after a failure. */
bb_status bb_treelets_create(const bb_builder_context *context, const bb_source *source,
                             uint32_t treelet_most, void **out);

/* ---- the other hooks of such a builder ---- */

void bb_treelets_destroy(void *opaque); /* NULL is allowed */

/* Reserves room for trees of one leaf per primitive: 94 bytes per primitive beside the tree, on
 * GPUs 120. */
bb_status bb_treelets_prepare(void *opaque, const bb_scene *scene, bb_tree *tree);

/* Phases "pairs", "count", "treelets" and "order", or "copy" for a tree of fewer leaves than gamma;
 * events "treelets" and "improved". BB_UNSUPPORTED if an inner node has other than two children. */
bb_status bb_treelets_build(void *opaque, const bb_scene *scene, const bb_tree *input,
                            bb_tree *tree, bb_phases *phases);

/* Of the last build: treelets rebuilt and examined, their leaves, and the rounds made. */
bb_status bb_treelets_describe(void *opaque, const bb_scene *scene, char *text, size_t capacity);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
