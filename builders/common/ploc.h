/* The part of PLOC and H-PLOC that they share on the host: primitives in the order of their codes,
 * lists of clusters, and the tree from pairs. Their merge step on the device is ploc_cluster.clh,
 * with ploc_list.clh for CPUs and ploc_group.clh for GPUs.
 */
#ifndef BB_PLOC_H
#define BB_PLOC_H

#include "builders/common/pair_tree.h"
#include "builders/common/sorted_codes.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

enum { BB_PLOC_RADIUS_MAX = 127 };

/* Clusters on the device: six planes of `stride` floats, and a uint4 for each cluster. */
typedef struct bb_ploc_list {
    bb_buffer planes;
    bb_buffer tags;
} bb_ploc_list;

typedef struct bb_ploc {
    bb_device *device;
    bb_account *account;
    uint32_t radius;
    bb_sorted_codes sorted;
    bb_pair_tree *pairs;
    bb_ploc_list lists[2];
    uint32_t stride;
} bb_ploc;

/* For a builder with BB_CODE_OPTIONS and an option `radius`; `ploc` is zero before. Must be
 * released even after a failure. */
bb_status bb_ploc_create(const bb_builder_context *context, bb_ploc *ploc);
void bb_ploc_release(bb_ploc *ploc); /* a zeroed one is allowed */

/* Resolves the code's `auto` options, and reserves everything for `lists` lists of as many clusters
 * as the scene has primitives. */
bb_status bb_ploc_prepare(bb_ploc *ploc, const bb_scene *scene, uint32_t lists, bb_tree *tree);

/* Phase "order": makes the tree from the pairs. Ends the phases. */
bb_status bb_ploc_finish(bb_ploc *ploc, const bb_scene *scene, bb_tree *tree, bb_phases *phases);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
