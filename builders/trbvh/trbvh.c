/* TRBVH: an optimiser of binary trees that makes each treelet optimal, on the device.
 *
 *   rounds times, doubling gamma: for each node of at least gamma leaves, children first:
 *       replace the treelet by the binary tree of smallest area over its leaves, if that is smaller
 *
 * Karras and Aila 2013, "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies".
 * The paper's text was not at hand: this was made from its abstract and from what the code of
 * ATRBVH's authors says of the method, and derived again. README.md lists the departures. trbvh.cl
 * has the table of subsets, builders/common/treelets.h the rounds and levels.
 */
#include "builders/common/treelets.h"

BB_DEVICE_SOURCE(trbvh);

enum { TREELET_MOST = 8 }; /* the table has 3^8 steps */

static const bb_option options[] = {
    {"rounds", "3", NULL, "most rounds over all nodes, 1 to 30; ends when gamma exceeds the tree"},
    {"treelet", "7", NULL, "leaves of a treelet, 3 to 8"},
    {"gamma", NULL, NULL,
     "fewest leaves below a treelet's root in the first round, doubling with each: from treelet "
     "(the default) to 2^30"},
    {.name = NULL},
};

static bb_status create(const bb_builder_context *context, void **out)
{
    return bb_treelets_create(context, &bb_source_trbvh, TREELET_MOST, out);
}

const bb_builder bb_builder_trbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "trbvh",
    .summary = "optimiser: makes each small treelet of a binary tree the best there is",
    .paper = "Karras, Aila 2013",
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
