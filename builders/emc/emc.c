/* EMC: LBVH over extended Morton codes, which separate large primitives from small ones and follow
 * the shape of the scene.
 *
 * Vinkler, Bittner, Havran 2017, "Extended Morton Codes for High Performance Bounding Volume
 * Hierarchy Construction". builders/common/codes.h has the codes.
 */
#include "builders/common/linear_bvh.h"

static const bb_option options[] = {
    BB_CODE_OPTIONS("emc64-var"),
    BB_LINK_OPTION,
    BB_UPDATE_OPTION,
    {.name = NULL},
};

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "emc,emc:code=emc64-cell"},
    {BB_FOR_ALL, BB_ROLE_LEAST,
     "emc:bits=auto,size-bits=auto,emc:code=emc64-cell,bits=auto,size-bits=auto"},
    {BB_FOR_ALL, BB_ROLE_GENEROUS, "emc:bits=64,size-bits=24"},
    {0},
};

const bb_builder bb_builder_emc = {
    .abi_version = BB_ABI_VERSION,
    .name = "emc",
    .summary = "binary radix tree over extended Morton codes; as published with box=scene",
    .paper = "Vinkler, Bittner, Havran 2017",
    .options = options,
    .variants = variants,
    BB_LINEAR_BUILDER,
};
