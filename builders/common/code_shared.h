/* A Morton code made ready for a scene, as host and device share it (codes.h, codes.clh). */
#ifndef BB_CODE_SHARED_H
#define BB_CODE_SHARED_H

#ifdef __OPENCL_VERSION__
#include "bb_shared.h"
typedef ulong bb_u64;
#else
#include "kernels/bb_shared.h"
typedef uint64_t bb_u64;
#endif

#define BB_CODE_STEPS 6      /* of the expansion: moves by 32, 16, 8, 4, 2, 1 */
#define BB_CODE_SIZES 32     /* the most size bits */
#define BB_CODE_CHUNK_BITS 8 /* of a cell per look-up */
#define BB_CODE_CHUNKS 3     /* per axis: cells have up to 24 bits */

/* Lanes 0 to 2 are the axes x, y, z, lane 3 is the size. */
typedef struct bb_code_plan {
    float low[4];   /* of the box that is quantised */
    float scale[4]; /* cells per unit; lane 3: per unit of the size measure; 0: no cells */
    float last[4];  /* largest cell: 2^bits - 1, exact */
    bb_u64 moved[4][BB_CODE_STEPS]; /* where bits are after the step that moved them there */
    bb_u64 kept[4];                 /* where they are in the end */
    bb_u64 flip;       /* bits that are negated: axes along which the view looks backwards */
    float unit;        /* 1 / longest side: sizes are measured in it, so that no square overflows */
    bb_u32 size_count; /* with sizes told by the cell: how many size bits */
    float size_least[BB_CODE_SIZES]; /* the square of the size from which on the bit is set */
    bb_u64 size_bit[BB_CODE_SIZES];
} bb_code_plan;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_code_plan) == 48 + 32 * BB_CODE_STEPS + 48 + 12 * BB_CODE_SIZES,
                 "bb_code_plan");
#endif

#endif
