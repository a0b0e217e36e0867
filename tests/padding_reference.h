/* What layouts make of a box (kernels/padding.clh), by the rounding modes of the host. */
#ifndef PADDING_REFERENCE_H
#define PADDING_REFERENCE_H

#include "kernels/bb_shared.h"

#include <fenv.h>
#include <math.h>

/* The box padded for primitives of up to its own longest side, in layouts of scale 1. */
static inline bb_box padded_box(const bb_box *box)
{
    bb_box out = *box;
    volatile float longest = 0.0f;
    for (int k = 0; k < 3; k++)
        longest = fmaxf(longest, box->hi[k] - box->lo[k]);
    volatile float pad = 0x1.4p-20f * longest;
    for (int k = 0; k < 3; k++) {
        /* rounded twice the same way is rounded once */
        fesetround(FE_DOWNWARD);
        volatile double low = (double)box->lo[k] - (double)pad;
        out.lo[k] = (float)low;
        fesetround(FE_UPWARD);
        volatile double high = (double)box->hi[k] + (double)pad;
        out.hi[k] = (float)high;
        fesetround(FE_TONEAREST);
    }
    return out;
}

#endif
