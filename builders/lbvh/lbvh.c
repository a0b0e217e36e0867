/* LBVH: the binary radix tree over Morton codes of the primitives' centroids, on the device; or a
 * tree of 8 children straight from the codes, without a binary one.
 *
 * Lauterbach et al. 2009; Karras 2012; Apetrei 2014. Shares all its code with the other builders
 * that sort by a code: builders/common/linear_bvh.h.
 */
#include "builders/common/linear_bvh.h"

static const bb_option options[] = {
    BB_CODE_OPTIONS("mc32"), BB_LINK_OPTION, BB_ARITY_OPTIONS, BB_UPDATE_OPTION, {.name = NULL},
};

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "lbvh,lbvh:bits=63"},
    {BB_FOR_ALL, BB_ROLE_MOVING, "lbvh"},
    {BB_FOR_ALL, BB_ROLE_YARDSTICK, "lbvh"},
    {BB_FOR_ALL, BB_ROLE_USUAL, "lbvh"},
    {BB_FOR_ALL, BB_ROLE_VOLUMES, "lbvh"},
    {BB_FOR_ALL, BB_ROLE_MESHES, "lbvh"},
    {BB_FOR_ALL, BB_ROLE_TRIED, "lbvh:arity=8"},
    {BB_FOR_ALL, BB_ROLE_LEAST, "lbvh:bits=auto"},
    {BB_FOR_ALL, BB_ROLE_GENEROUS, "lbvh:bits=63"},
    {0},
};

const bb_builder bb_builder_lbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "lbvh",
    .summary = "binary radix tree over Morton codes",
    .paper = "Karras 2012; Apetrei 2014; Lauterbach et al. 2009",
    .options = options,
    .variants = variants,
    BB_LINEAR_BUILDER,
};
