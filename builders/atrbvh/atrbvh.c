/* ATRBVH: an optimiser of binary trees that rebuilds treelets greedily, on the device.
 *
 *   rounds times, doubling gamma: for each node of at least gamma leaves, children first:
 *       build the tree over the treelet's leaves that merges the nearest first
 *       replace the treelet by it if its area is smaller
 *
 * Domingues and Pedrini 2015, "Bounding Volume Hierarchy Optimization through Agglomerative Treelet
 * Restructuring". The paper's text was not at hand: this was made from its abstract and the
 * authors' code, and derived again. README.md lists the departures. atrbvh.cl has the merging,
 * builders/common/treelets.h the rounds and levels. The tree's leaves stay as they are.
 */
#include "builders/common/treelets.h"

BB_DEVICE_SOURCE(atrbvh);

enum { TREELET_MOST = 20 }; /* so that the distances of all pairs stay in the cache */

static const bb_option options[] = {
    {"rounds", "2", NULL, "most rounds over all nodes, 1 to 30; ends when gamma exceeds the tree"},
    {"treelet", "9", NULL, "leaves of a treelet, 3 to 20"},
    {"gamma", NULL, NULL,
     "fewest leaves below a treelet's root in the first round, doubling with each: from treelet "
     "(the default) to 2^30"},
    {.name = NULL},
};

static bb_status create(const bb_builder_context *context, void **out)
{
    return bb_treelets_create(context, &bb_source_atrbvh, TREELET_MOST, out);
}

const bb_builder bb_builder_atrbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "atrbvh",
    .summary = "optimiser: rebuilds small treelets of a binary tree by merging nearest leaves",
    .paper = "Domingues, Pedrini 2015",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_TREE,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .variants = BB_NO_VARIANTS,
    .create = create,
    .prepare = bb_treelets_prepare,
    .build = bb_treelets_build,
    .describe = bb_treelets_describe,
    .destroy = bb_treelets_destroy,
};
