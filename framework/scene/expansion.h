/* Expansions: sums of doubles that do not overlap, in increasing magnitude; the sign of the last
 * one is the sign of the sum.
 *
 * Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates,
 * Discrete & Computational Geometry 18 (1997): two-sum (section 2.2), grow-expansion with zero
 * elimination (2.4), two-product. Exact where no term over- or underflows.
 */
#ifndef BB_EXPANSION_H
#define BB_EXPANSION_H

#include <math.h>

/* A sum of two doubles that do not overlap: an exact difference. */
typedef struct two {
    double hi, lo;
} two;

enum { TERMS_MAX = 512 }; /* more than any function here adds to one expansion */

typedef struct expansion {
    int count;
    double terms[TERMS_MAX];
} expansion;

static inline two two_sum(double a, double b)
{
    double sum = a + b;
    double b_part = sum - a;
    double a_part = sum - b_part;
    return (two){sum, (a - a_part) + (b - b_part)};
}

static inline two two_product(double a, double b)
{
    double product = a * b;
    return (two){product, fma(a, b, -product)};
}

static inline void add(expansion *sum, double value)
{
    int count = 0;
    for (int i = 0; i < sum->count; i++) {
        two next = two_sum(value, sum->terms[i]);
        value = next.hi;
        if (next.lo != 0.0)
            sum->terms[count++] = next.lo;
    }
    if (value != 0.0)
        sum->terms[count++] = value;
    sum->count = count;
}

static inline void add_product(expansion *sum, double a, double b)
{
    two product = two_product(a, b);
    if (product.lo != 0.0)
        add(sum, product.lo);
    if (product.hi != 0.0)
        add(sum, product.hi);
}

/* Returns the sum to within a few units in the last place, with its exact sign. */
static inline double value_of(const expansion *sum)
{
    double value = 0.0;
    for (int i = 0; i < sum->count; i++)
        value += sum->terms[i];
    return value;
}

#endif
