/* Powers, roots, sines and arctangents whose last bit is the same on every machine, from operations
 * that IEEE 754 rounds correctly. (pow, cbrt, sin and atan are not: C libraries differ.) */
#ifndef BB_REPEATABLE_H
#define BB_REPEATABLE_H

#include <math.h>
#include <stdint.h>

enum { BB_POWER_BITS = 16 };

/* Returns ratio^u for ratio >= 1 and u = 0.b1 b2 ... b16: the product of the repeated square roots
 * whose bits are set. All bits set stands for u = 1. */
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

/* Returns the cube root of 1e-20 < x < 1e20, to the last bits: Newton's method from above, which
 * falls by a third per step at first. */
static inline double bb_cube_root(double x)
{
    double root = x > 1 ? x : 1;
    for (int i = 0; i < 200; i++)
        root = (2 * root + x / (root * root)) / 3;
    return root;
}

/* Returns sin(x) for |x| < 1e6, to about 1e-10, since pi times 1e6 turns is no more accurate; for
 * |x| <= pi/2 with a relative error of 1e-15. Taylor's series on a quarter of a turn to either
 * side. */
static inline double bb_sine(double x)
{
    static const double pi = 3.14159265358979323846;
    double turns = x / (2 * pi);
    double r = 2 * pi * (turns - floor(turns + 0.5)), sum = 0; /* -pi .. pi */
    if (fabs(r) > pi / 2)
        r = r > 0 ? pi - r : -pi - r;
    for (int k = 11; k >= 1; k--) /* 1 - r^2/(2 3) (1 - r^2/(4 5) (...)) */
        sum = r * r / ((2 * k) * (2 * k + 1)) * (1 - sum);
    return r * (1 - sum);
}

static inline double bb_cosine(double x)
{
    return bb_sine(x + 1.57079632679489661923);
}

/* Returns atan(x) for 0 <= x <= 1, with a relative error of 1e-15. The angle is halved twice, which
 * leaves less than 0.2 to the series: atan(x) = 2 atan(x / (1 + sqrt(1 + x^2))). */
static inline double bb_arctangent(double x)
{
    double sum = 0;
    for (int i = 0; i < 2; i++)
        x /= 1 + sqrt(1 + x * x);
    for (int k = 12; k >= 1; k--) /* x^2 (1/3 - x^2 (1/5 - x^2 (...))) */
        sum = x * x * (1.0 / (2 * k + 1) - sum);
    return 4 * (x - x * sum);
}

#endif
