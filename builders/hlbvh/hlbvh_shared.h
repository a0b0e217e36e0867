/* Types and constants that host and device share for the top tree (hlbvh_top.c, hlbvh_top.cl). */
#ifndef BB_HLBVH_SHARED_H
#define BB_HLBVH_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#include <stddef.h>
#endif

#define HL_LEVELS 65 /* bits in which two keys may first differ, plus one for equal keys */

#define HL_GROUP 64 /* work-items that split a chunk or a task together on GPUs */

/* Bytes of hl_bins: two float4 per bin and axis, then `words` counts or weights per bin and axis;
 * rounded up to a multiple of a float4. hlbvh_bins.clh does not compile if its struct differs. */
#define HL_BINS_BYTES(bins, words) (3 * (bins)*2 * 16 + (3 * (bins) * (words)*4 + 15) / 16 * 16)

/* A cluster while the top tree is made: its box, its number, and its weight in the cost. The box is
 * laid out as in bb_box, so that bb_reduce_boxes() accepts it. */
typedef struct hl_item {
    float lo[3];
    bb_u32 cluster;
    float hi[3];
    bb_u32 weight;
} hl_item;

/* A cluster's root in the radix tree. */
typedef struct hl_root {
    bb_u32 first; /* as in bb_node */
    bb_u32 height;
} hl_root;

/* Items begin .. end - 1, over which a subtree is made at node `place`. */
typedef struct hl_task {
    bb_u32 begin, end;
    bb_u32 place, depth;
    bb_u32 side;        /* which of the two lists has the items */
    bb_u32 first_chunk; /* large tasks: number of the first chunk */
    bb_u32 chunk_count;
    bb_u32 pad;
    float lo[3], hi[3]; /* box of the items' centroids, in the scene's unit */
} hl_task;

/* The split of a task: before bin `bin` of `axis`; axis 3: before item `middle`. */
typedef struct hl_split {
    bb_u32 axis, bin, middle, pad;
} hl_split;

/* Items begin .. end - 1 of a task, which one work-item handles. */
typedef struct hl_chunk {
    bb_u32 task, begin, end;
    bb_u32 left_at, right_at; /* where the items of each side go */
    bb_u32 pad;
    float lo[2][3], hi[2][3]; /* box of the centroids that go left, and right */
} hl_chunk;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(hl_item) == sizeof(bb_box), "hl_item");
BB_STATIC_ASSERT(offsetof(hl_item, lo) == offsetof(bb_box, lo), "hl_item");
BB_STATIC_ASSERT(offsetof(hl_item, hi) == offsetof(bb_box, hi), "hl_item");
BB_STATIC_ASSERT(sizeof(hl_root) == 8, "hl_root");
BB_STATIC_ASSERT(sizeof(hl_task) == 56, "hl_task");
BB_STATIC_ASSERT(sizeof(hl_split) == 16, "hl_split");
BB_STATIC_ASSERT(sizeof(hl_chunk) == 72, "hl_chunk");
#endif

#endif
