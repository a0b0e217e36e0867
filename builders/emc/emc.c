/* EMC: LBVH over extended Morton codes, which tell large primitives from small ones and follow the
 * shape of the scene.
 *
 * Vinkler, Bittner, Havran 2017, "Extended Morton Codes for High Performance Bounding Volume
 * Hierarchy Construction". The codes and their traps: builders/common/codes.h.
 */
#include "builders/common/linear_bvh.h"

static const bb_option options[] = {
    BB_CODE_OPTIONS("emc64-var"),
    BB_LINK_OPTION,
    BB_UPDATE_OPTION,
    {.name = NULL},
};

const bb_builder bb_builder_emc = {
    .abi_version = BB_ABI_VERSION,
    .name = "emc",
    .summary = "binary radix tree over extended Morton codes",
    .paper = "Vinkler, Bittner, Havran 2017",
    .options = options,
    .compared = "emc,emc:code=emc64-cell",
    .least = "emc:bits=auto,size-bits=auto,emc:code=emc64-cell,bits=auto,size-bits=auto",
    .generous = "emc:bits=64,size-bits=24",
    BB_LINEAR_BUILDER,
};
