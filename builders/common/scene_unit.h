/* A unit of length in which areas of a scene's boxes neither overflow nor vanish. */
#ifndef BB_SCENE_UNIT_H
#define BB_SCENE_UNIT_H

#include "kernels/bb_shared.h"

#include <math.h>

/* Factor for coordinates: the power of two, hence exact, that makes `box` between a half and 1
 * long, or as nearly so as floats allow. */
static inline float bb_scene_unit(const bb_box *box)
{
    double longest = 0;
    for (int axis = 0; axis < 3; axis++)
        longest = fmax(longest, (double)box->hi[axis] - box->lo[axis]);
    int exponent = 0;
    frexp(longest, &exponent);
    return ldexpf(1.0f, exponent > 126 ? -126 : exponent < -126 ? 126 : -exponent);
}

#endif
