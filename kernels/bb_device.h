/* Included first by every kernel: no contraction, the shared types, small helpers.
 *
 * Contraction (fusing a*b+c) loses hits at edges of boxes and triangles, so it is off everywhere;
 * where fusion is wanted, fma() is written.
 */
#ifndef BB_DEVICE_CL_H
#define BB_DEVICE_CL_H

#ifndef BB_CONTRACT
#pragma OPENCL FP_CONTRACT OFF
#endif

#include "bb_shared.h"

/* 1: the form for GPUs, which loads nodes and primitives 16 bytes at a time and selects from these.
 * On CPUs computing the address costs less. */
#ifndef BB_GPU_FORM
#define BB_GPU_FORM 0
#endif

/* Returns word i, a compile-time constant, of words that begin at a multiple of 16 bytes, by a load
 * of 16 bytes. */
uint bb_word(global const float *words, uint i)
{
    uint4 four = ((global const uint4 *)words)[i / 4u];
    uint2 two = (i & 2u) != 0u ? four.hi : four.lo;
    return (i & 1u) != 0u ? two.y : two.x;
}

/* OpenCL's fmin and fmax must handle NaN in both arguments, which costs three instructions on CPUs.
 * These take one, and return the second argument if the first is NaN. */
#define BB_MIN(a, b) ((a) < (b) ? (a) : (b))
#define BB_MAX(a, b) ((a) > (b) ? (a) : (b))

/* Returns half the surface area of a box with these sides. */
float bb_half_area(float x, float y, float z)
{
    return x * y + y * z + z * x;
}

/* The same for sides that may be infinite, whose product with 0 would be NaN. */
float bb_finite_half_area(float x, float y, float z)
{
    return bb_half_area(BB_MIN(x, FLT_MAX), BB_MIN(y, FLT_MAX), BB_MIN(z, FLT_MAX));
}

/* OpenCL allows an error of 2.5 ulp in a quotient. All divisions of the `exact` intersector go
 * through this macro, so that a test can add that error on a device that divides exactly. */
#ifndef BB_DIVIDE
#define BB_DIVIDE(a, b) ((a) / (b))
#endif

#endif
