/* A part of a tree, shared by host and device (parts.h). */
#ifndef BB_PARTS_SHARED_H
#define BB_PARTS_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

#define BB_PART_LEAVES 256u /* fixed, so that trees are the same everywhere */
#define BB_PART_BINS 8u     /* for splitting a range of leaves: split.clh */

typedef struct bb_part {
    bb_u32 root;    /* place of its root */
    bb_u32 begin;   /* start of its inner nodes in the list of all */
    bb_u32 inner;   /* their number; a part has one leaf more */
    bb_u32 height;  /* levels below its root */
    bb_u32 rebuilt; /* whether the last rebuild changed it */
    float cost;     /* sum of the half areas of its inner nodes */
    float area;     /* half area of its root */
} bb_part;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_part) == 28, "bb_part");
#endif

#endif
