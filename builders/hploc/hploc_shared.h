/* Types and constants that host and device share for H-PLOC on CPUs (hploc.c, hploc.cl). */
#ifndef BB_HPLOC_SHARED_H
#define BB_HPLOC_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Most subtrees that wait, for keys of that many bits: their levels, by key or by index, strictly
 * increase towards the bottom. */
#define HPLOC_WAITING_MAX(key_bits) ((key_bits) + 32u)
/* Most maximal radix subtrees in a range of keys: one such chain at either end. */
#define HPLOC_PIECES_MAX(key_bits) (2u * HPLOC_WAITING_MAX(key_bits))

/* A radix subtree whose clusters are made. */
typedef struct hploc_piece {
    bb_u32 l, r;  /* its keys */
    bb_u32 count; /* number of clusters */
    bb_u32 level; /* of the split to the left */
} hploc_piece;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(hploc_piece) == 16, "hploc_piece");
#endif

#endif
