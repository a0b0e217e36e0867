/* What every kernel includes first: no contraction, the shared types, small helpers.
 *
 * Contraction (a*b+c fused behind the writer's back) loses hits at box and triangle edges, so it is
 * off everywhere; where fusion is meant, fma() is written.
 */
#ifndef BB_DEVICE_CL_H
#define BB_DEVICE_CL_H

#ifndef BB_CONTRACT
#pragma OPENCL FP_CONTRACT OFF
#endif

#include "bb_shared.h"

/* 1: the form for GPUs, in which nodes and primitives are fetched 16 bytes at a time and chosen
 * from; on a CPU addresses are chosen, which costs less there. */
#ifndef BB_GPU_FORM
#define BB_GPU_FORM 0
#endif

/* Word i, which the compiler knows, of words that begin at a multiple of 16 bytes, out of a load of
 * 16. */
uint bb_word(global const float *words, uint i)
{
    uint4 four = ((global const uint4 *)words)[i / 4u];
    uint2 two = (i & 2u) != 0u ? four.hi : four.lo;
    return (i & 1u) != 0u ? two.y : two.x;
}

/* OpenCL's fmin and fmax must handle NaN in both arguments, which costs three instructions on CPUs.
 * These are one, and return the second argument when the first is NaN. */
#define BB_MIN(a, b) ((a) < (b) ? (a) : (b))
#define BB_MAX(a, b) ((a) > (b) ? (a) : (b))

/* Half the surface area of a box of these sides. */
float bb_half_area(float x, float y, float z)
{
    return x * y + y * z + z * x;
}

/* The same of sides that may be infinite, whose product with 0 would have no order. */
float bb_finite_half_area(float x, float y, float z)
{
    return bb_half_area(BB_MIN(x, FLT_MAX), BB_MIN(y, FLT_MAX), BB_MIN(z, FLT_MAX));
}

/* OpenCL allows a quotient to be off by 2.5 ulp. What the `exact` intersector divides goes through
 * here, so that a test can be as far off on a device that is not. */
#ifndef BB_DIVIDE
#define BB_DIVIDE(a, b) ((a) / (b))
#endif

#endif
