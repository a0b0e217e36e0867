/* A part of a tree, as host and device know it (parts.h). */
#ifndef BB_PARTS_SHARED_H
#define BB_PARTS_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

#define BB_PART_LEAVES 256u /* most of a part; the same everywhere, so that trees are */
#define BB_PART_BINS 8u     /* in which the leaves of a range are counted: split.clh */

typedef struct bb_part {
    bb_u32 root;    /* place of its root */
    bb_u32 begin;   /* where its inner nodes begin, in the list of all */
    bb_u32 inner;   /* how many they are: it has one leaf more */
    bb_u32 height;  /* levels below its root */
    bb_u32 rebuilt; /* the last rebuild has changed it */
    float cost;     /* sum of the half areas of its inner nodes */
    float area;     /* half that of its root */
} bb_part;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_part) == 28, "bb_part");
#endif

#endif
