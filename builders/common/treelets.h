/* Optimisers that rebuild treelets of a binary tree from the bottom up, in rounds (TRBVH, ATRBVH):
 * what they share on the host. How a treelet is rebuilt is the optimiser's own .cl file, which ends
 * with treelet_rounds.clh; how treelets are formed: treelets.clh.
 *
 *   pairs: one of each inner node, with both children's boxes        (treelets.cl, pair_shared.h)
 *   each round: all pairs of at least gamma leaves, by levels, children first; gamma doubles
 *   the common tree of the pairs, numbered anew                       (pair_tree.h)
 *
 * Everything goes by launches: no work-group hands over to another inside of one, on any device. A
 * pair's treelet depends on what is below that pair alone, so the tree does not depend on the order
 * in a level. On CPUs a work-item does a whole subtree of up to 4096 leaves first, which stays in
 * the cache, eight treelets of a depth side by side; then what is above goes by levels. On GPUs a
 * work-item does one treelet.
 */
#ifndef BB_TREELETS_H
#define BB_TREELETS_H

#include "framework/builder/builder.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Makes an optimiser, which the other hooks get: reads the options rounds, treelet (3 to
 * `treelet_most`) and gamma, and compiles `source`. BB_INVALID for options out of range. After a
 * failure *out, if it was set, is to be destroyed. */
bb_status bb_treelets_create(const bb_builder_context *context, const bb_source *source,
                             uint32_t treelet_most, void **out);

/* ---- the other hooks of such a builder ---- */

void bb_treelets_destroy(void *opaque); /* NULL is allowed */

/* Room for trees of one leaf per primitive: 94 bytes per primitive beside the tree, on GPUs 120. */
bb_status bb_treelets_prepare(void *opaque, const bb_scene *scene, bb_tree *tree);

/* Phases "pairs", "count", "treelets" and "order", or "copy" for a tree of fewer leaves than gamma;
 * events "treelets" and "improved". BB_UNSUPPORTED for a tree with inner nodes of another number of
 * children than two. */
bb_status bb_treelets_build(void *opaque, const bb_scene *scene, const bb_tree *input,
                            bb_tree *tree, bb_phases *phases);

/* Treelets rebuilt of those looked at, their leaves and the rounds made: of the last build. */
bb_status bb_treelets_describe(void *opaque, const bb_scene *scene, char *text, size_t capacity);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
