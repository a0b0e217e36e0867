/* The top tree of HLBVH: binned SAH over clusters, on the device. */
#ifndef BB_HLBVH_TOP_H
#define BB_HLBVH_TOP_H

#include "framework/builder/builder.h"
#include "hlbvh_shared.h"

typedef struct hl_top hl_top;

/* The clusters, at least two, that the top tree is built over. */
typedef struct hl_clusters {
    uint32_t count;
    const bb_buffer *starts; /* u32: first key of each cluster, and the number of keys */
    bb_buffer *items;        /* hl_item per cluster; gets reordered */
    const bb_buffer *roots;  /* hl_root per cluster */
    bb_box bounds[2];        /* of the clusters' boxes; of their centroids */
} hl_clusters;

/* Compiles for `bins` bins per axis, 2 to 64. by_prims: a cluster weighs as much as it has
 * primitives. Memory is booked on `account`. */
bb_status hl_top_create(bb_device *device, bb_account *account, uint32_t bins, bool by_prims,
                        hl_top **out);
void hl_top_destroy(hl_top *top); /* NULL is allowed */

/* Reserves scratch for up to `clusters` clusters: little more than an hl_item per cluster, and on
 * GPUs the bins of a chunk for every so many clusters. */
bb_status hl_top_reserve(hl_top *top, uint32_t clusters);

/* Writes the nodes above the clusters, including the clusters' roots, into the tree, which holds
 * the radix tree over all keys. Raises the depth in its d_info, which is 0 before. *levels: number
 * of levels that were split by many work-items. Waits for the device once per such level. */
bb_status hl_top_make(hl_top *top, const hl_clusters *clusters, bb_tree *tree, uint32_t *levels);

#endif
