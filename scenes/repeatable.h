/* Powers and roots whose last bit is the same on every machine, from operations that IEEE 754
 * rounds correctly. (pow and cbrt are not: C libraries differ.) */
#ifndef BB_REPEATABLE_H
#define BB_REPEATABLE_H

#include <math.h>
#include <stdint.h>

enum { BB_POWER_BITS = 16 };

/* ratio^u for ratio >= 1 and u = 0.b1 b2 ... b16: the product of the repeated square roots whose
 * bits are set. All bits set stands for u = 1. */
static inline double bb_power(double ratio, uint32_t bits)
{
    if (bits == (1u << BB_POWER_BITS) - 1)
        return ratio;
    double out = 1, root = ratio;
    for (int i = BB_POWER_BITS - 1; i >= 0; i--) {
        root = sqrt(root);
        if ((bits >> i & 1) != 0)
            out *= root;
    }
    return out;
}

/* The cube root of 1e-20 < x < 1e20, to the last bits: Newton from above, which falls by a third a
 * step at first. */
static inline double bb_cube_root(double x)
{
    double root = x > 1 ? x : 1;
    for (int i = 0; i < 200; i++)
        root = (2 * root + x / (root * root)) / 3;
    return root;
}

#endif
