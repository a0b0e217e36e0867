/* Exact predicates: a floating-point filter first, then expansions (expansion.h).
 *
 * Every decision about a triangle is the sign of a determinant z . (x cross y), of degree 3 in the
 * input; about a sphere, of |d|^2 r^2 - |d cross c|^2, of degree 4 (Lagrange's identity makes it
 * the discriminant). The coordinates are floats or doubles of at most 2^140 with no bit below
 * 2^-253, so that no term over- or underflows.
 */
#include "framework/scene/exact.h"

#include "framework/scene/expansion.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#define HALF_ULP (0.5 * DBL_EPSILON) /* 2^-53, the unit of the error bounds */
#define PRECISION 0x1p-34            /* relative error allowed in the terms of t */

/* sum += sign * a * b * c. Most differences of floats fit one double, with lower parts of 0. */
static void add_triple(expansion *sum, double sign, two a, two b, two c)
{
    const double as[2] = {a.lo, a.hi}, bs[2] = {b.lo, b.hi}, cs[2] = {c.lo, c.hi};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            if (as[i] == 0.0 || bs[j] == 0.0)
                continue;
            two product = two_product(as[i], bs[j]);
            for (int k = 0; k < 2; k++) {
                if (cs[k] == 0.0)
                    continue;
                if (product.lo != 0.0)
                    add_product(sum, product.lo, sign * cs[k]);
                add_product(sum, product.hi, sign * cs[k]);
            }
        }
}

static double exact_determinant(const two z[3], const two x[3], const two y[3])
{
    expansion sum;
    sum.count = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        add_triple(&sum, 1.0, z[i], x[j], y[k]);
        add_triple(&sum, -1.0, z[i], x[k], y[j]);
    }
    return value_of(&sum);
}

/* ---- determinants with a filter ---- */

/* Returns z . (x cross y). Each operand may be off by one rounding (a difference): a term takes at
 * most seven roundings, hence |error| < 8 u * (sum of the terms' magnitudes), which 10 u times its
 * computed value covers. */
static double determinant(const double z[3], const double x[3], const double y[3], double *error)
{
    double sum = 0.0, magnitude = 0.0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double p = x[j] * y[k], q = x[k] * y[j];
        sum += z[i] * (p - q);
        magnitude += fabs(z[i]) * (fabs(p) + fabs(q));
    }
    *error = 10.0 * HALF_ULP * magnitude;
    return sum;
}

static void subtract(const float v[3], const double o[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)v[i] - o[i];
}

static void subtract_exactly(const float v[3], const double o[3], two out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = two_sum((double)v[i], -o[i]);
}

static void widen(const float v[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)v[i];
}

/* Returns d . ((p - o) cross (q - o)) with its exact sign: the side of the edge p q on which the
 * line passes. */
static double side(const double o[3], const float d[3], const float p[3], const float q[3])
{
    double dd[3], x[3], y[3], error;
    widen(d, dd);
    subtract(p, o, x);
    subtract(q, o, y);
    double value = determinant(dd, x, y, &error);
    if (fabs(value) > error)
        return value;
    two z[3], xx[3], yy[3];
    const double origin[3] = {0.0, 0.0, 0.0};
    subtract_exactly(d, origin, z);
    subtract_exactly(p, o, xx);
    subtract_exactly(q, o, yy);
    return exact_determinant(z, xx, yy);
}

bool bb_exact_meets_triangle(const double o[3], const float d[3], const float a[3],
                             const float b[3], const float c[3])
{
    double u = side(o, d, b, c);
    double v = side(o, d, c, a);
    if ((u < 0.0 && v > 0.0) || (u > 0.0 && v < 0.0))
        return false;
    double w = side(o, d, a, b);
    if (u == 0.0 && v == 0.0 && w == 0.0)
        return false; /* their sum is d . normal: the line is parallel to the plane */
    return (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
}

int bb_exact_side(const double p[3], const float a[3], const float b[3], const float c[3])
{
    double da[3], z[3], x[3], y[3], error;
    widen(a, da);
    for (int i = 0; i < 3; i++)
        z[i] = p[i] - da[i];
    subtract(b, da, x);
    subtract(c, da, y);
    double value = determinant(z, x, y, &error);
    if (!(fabs(value) > error)) {
        two zz[3], xx[3], yy[3];
        for (int i = 0; i < 3; i++)
            zz[i] = two_sum(p[i], -da[i]);
        subtract_exactly(b, da, xx);
        subtract_exactly(c, da, yy);
        value = exact_determinant(zz, xx, yy);
    }
    return value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
}

/* Returns normal . vector, for the normal (b - a) cross (c - a) and the vector p - o or, if o is
 * NULL, p. The relative error is below PRECISION. */
static double along_normal(const float p[3], const double *o, const float a[3], const float b[3],
                           const float c[3])
{
    const double origin[3] = {0.0, 0.0, 0.0};
    double da[3], z[3], x[3], y[3], error;
    widen(a, da);
    subtract(p, o != NULL ? o : origin, z);
    subtract(b, da, x);
    subtract(c, da, y);
    double value = determinant(z, x, y, &error);
    if (error <= PRECISION * fabs(value))
        return value;
    two zz[3], xx[3], yy[3];
    subtract_exactly(p, o != NULL ? o : origin, zz);
    subtract_exactly(b, da, xx);
    subtract_exactly(c, da, yy);
    return exact_determinant(zz, xx, yy);
}

bool bb_exact_plane_t(const double o[3], const float d[3], const float a[3], const float b[3],
                      const float c[3], double *t)
{
    double below = along_normal(d, NULL, a, b, c);
    if (below == 0.0)
        return false;
    *t = along_normal(a, o, a, b, c) / below;
    return true;
}

/* ---- spheres; c is the centre relative to o ---- */

static double exact_discriminant(const two c[3], const float d[3], float radius)
{
    expansion sum;
    sum.count = 0;
    double square = (double)radius * (double)radius; /* exact for any float */
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        add_product(&sum, (double)d[i] * (double)d[i], square);
        expansion cross;
        cross.count = 0;
        add_product(&cross, d[j], c[k].lo);
        add_product(&cross, d[j], c[k].hi);
        add_product(&cross, -(double)d[k], c[j].lo);
        add_product(&cross, -(double)d[k], c[j].hi);
        for (int m = 0; m < cross.count; m++)
            for (int n = 0; n < cross.count; n++)
                add_product(&sum, -cross.terms[m], cross.terms[n]);
    }
    return value_of(&sum);
}

/* Returns |d|^2 r^2 - |d cross c|^2. The sign is exact; if `precise`, the relative error is below
 * PRECISION. */
static double discriminant(const double o[3], const float d[3], const float sphere[4], bool precise)
{
    double c[3], sum = 0.0, magnitude = 0.0;
    double square = (double)sphere[3] * (double)sphere[3];
    subtract(sphere, o, c);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double p = (double)d[j] * c[k], q = (double)d[k] * c[j];
        double own = (double)d[i] * (double)d[i] * square;
        sum += own - (p - q) * (p - q);
        magnitude += own + (fabs(p) + fabs(q)) * (fabs(p) + fabs(q));
    }
    /* A squared component is off by at most 9 u of its magnitude; three additions follow. */
    double error = 20.0 * HALF_ULP * magnitude;
    if (precise ? error <= PRECISION * fabs(sum) : fabs(sum) > error)
        return sum;
    two cc[3];
    subtract_exactly(sphere, o, cc);
    return exact_discriminant(cc, d, sphere[3]);
}

bool bb_exact_meets_sphere(const double o[3], const float d[3], const float sphere[4])
{
    return discriminant(o, d, sphere, false) >= 0.0;
}

/* Returns d . c to PRECISION. */
static double projection(const double o[3], const float d[3], const float sphere[4])
{
    double c[3], sum = 0.0, magnitude = 0.0;
    subtract(sphere, o, c);
    for (int i = 0; i < 3; i++) {
        sum += (double)d[i] * c[i];
        magnitude += fabs((double)d[i] * c[i]);
    }
    if (6.0 * HALF_ULP * magnitude <= PRECISION * fabs(sum))
        return sum;
    two cc[3];
    expansion exact;
    exact.count = 0;
    subtract_exactly(sphere, o, cc);
    for (int i = 0; i < 3; i++) {
        add_product(&exact, d[i], cc[i].lo);
        add_product(&exact, d[i], cc[i].hi);
    }
    return value_of(&exact);
}

/* Returns |c|^2 - r^2 to PRECISION: the power of the origin, the product of both roots times
 * |d|^2. */
static double power(const double o[3], const float sphere[4])
{
    double c[3], square = (double)sphere[3] * (double)sphere[3], sum = -square, magnitude = square;
    subtract(sphere, o, c);
    for (int i = 0; i < 3; i++) {
        sum += c[i] * c[i];
        magnitude += c[i] * c[i];
    }
    if (8.0 * HALF_ULP * magnitude <= PRECISION * fabs(sum))
        return sum;
    two cc[3];
    expansion exact;
    exact.count = 0;
    subtract_exactly(sphere, o, cc);
    add(&exact, -square);
    for (int i = 0; i < 3; i++) {
        add_product(&exact, cc[i].lo, cc[i].lo);
        add_product(&exact, cc[i].lo, 2.0 * cc[i].hi);
        add_product(&exact, cc[i].hi, cc[i].hi);
    }
    return value_of(&exact);
}

bool bb_exact_sphere_t(const double o[3], const float d[3], const float sphere[4], double t[2])
{
    double under_root = discriminant(o, d, sphere, true);
    if (under_root < 0.0)
        return false;
    double square =
        (double)d[0] * (double)d[0] + (double)d[1] * (double)d[1] + (double)d[2] * (double)d[2];
    double root = sqrt(under_root), middle = projection(o, d, sphere);
    /* The larger root in magnitude has no cancellation; the product of both gives the other. */
    double larger = middle < 0.0 ? middle - root : middle + root;
    double first = larger / square;
    double second = larger == 0.0 ? 0.0 : power(o, sphere) / larger;
    t[0] = fmin(first, second);
    t[1] = fmax(first, second);
    return true;
}
