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

#include "builders/common/pair_tree.h"
#include "framework/builder/builder.h"
#include "framework/device/levels.h"

typedef struct bb_treelet_optimiser {
    bb_device *device;
    bb_account *account;
    uint32_t rounds;  /* at most */
    uint32_t treelet; /* leaves */
    uint32_t gamma;   /* leaves below a treelet's root, at least, in the first round */
    cl_program program, rounds_program;
    cl_kernel marks, make, count, start, leaves, level;
    cl_kernel subtrees; /* of CPUs */
    bb_primitives *primitives;
    bb_pair_tree *pairs;
    bb_levels levels;
    bb_buffer places;           /* u32 per node: its pair, if it is inner */
    bb_buffer parents, missing; /* u32 per pair: the one above; pairs below that are to come */
    bb_buffer held;             /* u32 per pair: leaves below */
    bb_buffer tasks;            /* u32: roots of subtrees; of CPUs */
    bb_buffer totals;           /* u32: treelets, and those that were rebuilt */
    /* of the last build */
    uint32_t rounds_made;
    uint32_t seen, rebuilt;
} bb_treelet_optimiser;

/* Reads the options rounds, treelet (3 to `treelet_most`) and gamma, and compiles `source`. `self`
 * is zeroed, and to be released even after a failure. */
bb_status bb_treelets_create(const bb_builder_context *context, const bb_source *source,
                             uint32_t treelet_most, bb_treelet_optimiser *self);
void bb_treelets_release(bb_treelet_optimiser *self);

/* Room for trees of one leaf per primitive: 94 bytes per primitive beside the tree, on GPUs 120. */
bb_status bb_treelets_prepare(bb_treelet_optimiser *self, const bb_scene *scene, bb_tree *tree);

/* Phases "pairs", "count", "treelets" and "order", or "copy" for a tree of fewer leaves than gamma;
 * events "treelets" and "improved". BB_UNSUPPORTED for a tree with inner nodes of another number of
 * children than two. */
bb_status bb_treelets_build(bb_treelet_optimiser *self, const bb_tree *input, bb_tree *tree,
                            bb_phases *phases);

/* One line on the last build. */
void bb_treelets_describe(const bb_treelet_optimiser *self, char *text, size_t capacity);

#endif
