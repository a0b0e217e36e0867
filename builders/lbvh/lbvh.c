/* LBVH: the binary radix tree over Morton codes of the primitives' centroids, on the device.
 *
 * Lauterbach et al. 2009; Karras 2012; Apetrei 2014. All of it is shared with the other builders
 * that sort by a code: builders/common/linear_bvh.h.
 */
#include "builders/common/linear_bvh.h"

static const bb_option options[] = {
    BB_CODE_OPTIONS("mc32"),
    BB_LINK_OPTION,
    BB_UPDATE_OPTION,
    {.name = NULL},
};

const bb_builder bb_builder_lbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "lbvh",
    .summary = "binary radix tree over Morton codes",
    .paper = "Karras 2012; Apetrei 2014; Lauterbach et al. 2009",
    .options = options,
    .compared = "lbvh,lbvh:bits=63",
    .moving = "lbvh",
    .yardstick = true,
    .usual = true,
    .volumes = "lbvh",
    .meshes = "lbvh",
    .least = "lbvh:bits=auto",
    .generous = "lbvh:bits=63",
    BB_LINEAR_BUILDER,
};
