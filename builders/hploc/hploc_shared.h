/* What host and device share of H-PLOC for CPUs (hploc.c, hploc.cl). */
#ifndef BB_HPLOC_SHARED_H
#define BB_HPLOC_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
#else
#include "kernels/bb_shared.h"
#endif

/* Subtrees that wait, of keys of so many bits: their levels, by key or by index, grow strictly
 * towards the bottom. */
#define HPLOC_WAITING_MAX(key_bits) ((key_bits) + 32u)
/* Maximal radix subtrees of a range of keys: such chains at both of its ends. */
#define HPLOC_PIECES_MAX(key_bits) (2u * HPLOC_WAITING_MAX(key_bits))

/* A radix subtree whose clusters are made. */
typedef struct hploc_piece {
    bb_u32 l, r;  /* its keys */
    bb_u32 count; /* of clusters */
    bb_u32 level; /* of the split to the left */
} hploc_piece;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(hploc_piece) == 16, "hploc_piece");
#endif

#endif
