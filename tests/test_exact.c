/* Exact predicates against MPFR with enough bits that nothing is rounded: random and adversarial
 * lines, triangles and spheres. A few seconds. */
#include "framework/base/random.h"
#include "framework/scene/exact.h"
#include "tests/fixture.h"

#include <math.h>
#include <mpfr.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { BITS = 2400, CASES = 60000 };
static const uint64_t seed = 20240229;

/* ---- the reference ---- */

static mpfr_t pool[40];

static void subtract(mpfr_t *out, const float v[3], const double o[3])
{
    for (int k = 0; k < 3; k++) {
        mpfr_set_flt(out[k], v[k], MPFR_RNDN);
        mpfr_sub_d(out[k], out[k], o[k], MPFR_RNDN);
    }
}

/* out = z . (x cross y); uses pool[30..32] */
static void determinant(mpfr_t out, mpfr_t *z, mpfr_t *x, mpfr_t *y)
{
    mpfr_set_zero(out, 1);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpfr_mul(pool[30], x[j], y[k], MPFR_RNDN);
        mpfr_mul(pool[31], x[k], y[j], MPFR_RNDN);
        mpfr_sub(pool[30], pool[30], pool[31], MPFR_RNDN);
        mpfr_mul(pool[30], pool[30], z[i], MPFR_RNDN);
        mpfr_add(out, out, pool[30], MPFR_RNDN);
    }
}

static void dot(mpfr_t out, mpfr_t *x, mpfr_t *y)
{
    mpfr_set_zero(out, 1);
    for (int k = 0; k < 3; k++) {
        mpfr_mul(pool[30], x[k], y[k], MPFR_RNDN);
        mpfr_add(out, out, pool[30], MPFR_RNDN);
    }
}

/* Meets it? *parallel: no t; else t in pool[20]. By the sub-volumes seen from o, as in the
 * definition. */
static bool reference_triangle(const double o[3], const float d[3], float v[3][3], bool *parallel)
{
    const double zero[3] = {0, 0, 0}, first[3] = {v[0][0], v[0][1], v[0][2]};
    mpfr_t *dd = &pool[0], *a = &pool[3], *b = &pool[6], *c = &pool[9], *e = &pool[12],
           *f = &pool[15];
    subtract(dd, d, zero);
    subtract(a, v[0], o);
    subtract(b, v[1], o);
    subtract(c, v[2], o);
    subtract(e, v[1], first);
    subtract(f, v[2], first);
    determinant(pool[21], dd, b, c);
    determinant(pool[22], dd, c, a);
    determinant(pool[23], dd, a, b);
    determinant(pool[24], dd, e, f);
    determinant(pool[25], a, e, f);
    *parallel = mpfr_zero_p(pool[24]);
    if (*parallel)
        return false;
    mpfr_div(pool[20], pool[25], pool[24], MPFR_RNDN);
    int u = mpfr_sgn(pool[21]), w = mpfr_sgn(pool[22]), x = mpfr_sgn(pool[23]);
    return (u >= 0 && w >= 0 && x >= 0) || (u <= 0 && w <= 0 && x <= 0);
}

/* Meets it? t in pool[20] and pool[21]. */
static bool reference_sphere(const double o[3], const float d[3], const float sphere[4])
{
    const double zero[3] = {0, 0, 0};
    mpfr_t *dd = &pool[0], *c = &pool[3];
    subtract(dd, d, zero);
    subtract(c, sphere, o);
    dot(pool[6], dd, dd);
    dot(pool[7], dd, c);
    dot(pool[8], c, c);
    mpfr_set_flt(pool[9], sphere[3], MPFR_RNDN);
    mpfr_sqr(pool[9], pool[9], MPFR_RNDN);
    mpfr_sub(pool[8], pool[8], pool[9], MPFR_RNDN);  /* |c|^2 - r^2 */
    mpfr_sqr(pool[10], pool[7], MPFR_RNDN);          /* (d.c)^2 */
    mpfr_mul(pool[11], pool[6], pool[8], MPFR_RNDN); /* |d|^2 (|c|^2 - r^2) */
    mpfr_sub(pool[10], pool[10], pool[11], MPFR_RNDN);
    if (mpfr_sgn(pool[10]) < 0)
        return false;
    mpfr_sqrt(pool[10], pool[10], MPFR_RNDN);
    mpfr_sub(pool[20], pool[7], pool[10], MPFR_RNDN);
    mpfr_div(pool[20], pool[20], pool[6], MPFR_RNDN);
    mpfr_add(pool[21], pool[7], pool[10], MPFR_RNDN);
    mpfr_div(pool[21], pool[21], pool[6], MPFR_RNDN);
    return true;
}

/* Within 2^-32 of the exact value, and the same sign. A root that should be 0 may carry MPFR's own
 * rounding. */
static bool close_to(double t, mpfr_t exact)
{
    if (mpfr_zero_p(exact) || mpfr_get_exp(exact) < -1074)
        return fabs(t) < 1e-300;
    mpfr_set_d(pool[35], t, MPFR_RNDN);
    mpfr_sub(pool[35], pool[35], exact, MPFR_RNDN);
    mpfr_div(pool[35], pool[35], exact, MPFR_RNDN);
    return fabs(mpfr_get_d(pool[35], MPFR_RNDN)) < 0x1p-32;
}

/* ---- cases ---- */

enum {
    PLAIN,
    GRID,
    AT_EDGE,
    AT_VERTEX,
    NEEDLE,
    COPLANAR,
    FAR_OFF,
    TINY,
    HUGE_ONE,
    DENORMAL,
    MIXED,
    TOUCHING, /* an origin in doubles, from which the line meets an edge or touches the sphere but
                 for their rounding */

    FAMILIES
};

static float spread(bb_random *random)
{
    double magnitude = ldexp(1.0, (int)bb_random_below(random, 270) - 145);
    return (float)(bb_random_range(random, -1, 1) * fmin(magnitude, 0x1p125));
}

static void fill(bb_random *random, int family, float *values, int count, double scale)
{
    for (int i = 0; i < count; i++) {
        if (family == GRID || family == COPLANAR)
            values[i] = (float)((int)bb_random_below(random, 9) - 4);
        else if (family == MIXED)
            values[i] = spread(random);
        else
            values[i] = (float)(scale * bb_random_range(random, -1, 1));
        if (family == FAR_OFF)
            values[i] += 123456.0f;
    }
}

typedef struct line_case {
    float o[3], d[3], v[3][3], sphere[4];
    double from[3]; /* o, moved by a little in half of the cases */
} line_case;

static void aim(line_case *c, const double target[3])
{
    for (int k = 0; k < 3; k++)
        c->d[k] = (float)(target[k] - c->o[k]);
}

/* A unit vector perpendicular to d; 0 if d is. */
static void tangent(const line_case *c, bb_random *random, double side[3])
{
    double along = 0, square = 0, length = 0;
    bb_random_direction(random, side);
    for (int k = 0; k < 3; k++) {
        along += side[k] * c->d[k];
        square += (double)c->d[k] * c->d[k];
    }
    for (int k = 0; k < 3; k++) {
        side[k] -= square > 0 ? along / square * c->d[k] : side[k];
        length += side[k] * side[k];
    }
    for (int k = 0; k < 3; k++)
        side[k] /= length > 0 ? sqrt(length) : 1;
}

static void make_case(bb_random *random, int family, line_case *c)
{
    static const double scales[FAMILIES] = {[TINY] = 1e-20, [HUGE_ONE] = 1e37, [DENORMAL] = 1e-41};
    double scale = scales[family] > 0 ? scales[family] : 1.0, target[3];
    fill(random, family, c->o, 3, scale);
    fill(random, family, c->d, 3, family == HUGE_ONE ? 1e37 : scale);
    fill(random, family, &c->v[0][0], 9, scale);
    fill(random, family, c->sphere, 4, scale);
    c->sphere[3] = fabsf(c->sphere[3]);
    if (family == FAR_OFF) {
        fill(random, PLAIN, c->d, 3, 1.0);
        fill(random, PLAIN, &c->sphere[3], 1, 1.0);
        c->sphere[3] = fabsf(c->sphere[3]);
    }
    double s = bb_random_unit(random), r = bb_random_unit(random);
    if (family == NEEDLE) /* all but on the line from corner 0 to corner 1 */
        for (int k = 0; k < 3; k++)
            c->v[2][k] = (float)(c->v[0][k] + s * ((double)c->v[1][k] - c->v[0][k]));
    if (family == COPLANAR) {
        c->o[2] = c->v[0][2] = c->v[1][2] = c->v[2][2] = c->sphere[2] = 2.0f;
        c->d[2] = 0.0f;
    }
    if (family == AT_EDGE || family == AT_VERTEX || family == NEEDLE || family == TINY ||
        family == FAR_OFF) {
        for (int k = 0; k < 3; k++)
            target[k] = family == AT_VERTEX ? c->v[0][k]
                                            : c->v[0][k] + r * ((double)c->v[1][k] - c->v[0][k]);
        aim(c, target);
        /* And a sphere that the line all but touches: its centre moved off the target by about r.
         */
        double side[3];
        tangent(c, random, side);
        for (int k = 0; k < 3; k++)
            c->sphere[k] = (float)(target[k] + c->sphere[3] * side[k]);
    }
    if (c->d[0] == 0 && c->d[1] == 0 && c->d[2] == 0)
        c->d[1] = 1.0f;
    if (family == TOUCHING) {
        bool edge = bb_random_below(random, 2) == 1;
        double side[3];
        tangent(c, random, side);
        for (int k = 0; k < 3; k++)
            c->from[k] = r * c->d[k] + (edge ? c->v[0][k] + s * ((double)c->v[1][k] - c->v[0][k])
                                             : c->sphere[k] + c->sphere[3] * side[k]);
        return;
    }
    bool moved = bb_random_below(random, 2) == 1;
    for (int k = 0; k < 3; k++) {
        double step = 1e-6 * scale * bb_random_range(random, -1, 1);
        step = fabs(step) > 0x1p-190 ? step : 0;
        c->from[k] = (double)c->o[k] + (moved ? step : 0.0);
    }
}

static void test_against_mpfr(void **state)
{
    (void)state;
    uint32_t hits = 0, parallels = 0, touches = 0, grazes = 0;
    bb_random random = bb_random_make(seed, 1);
    for (int i = 0; i < CASES; i++) {
        line_case c;
        int family = i % FAMILIES;
        make_case(&random, family, &c);
        bool parallel;
        bool expected = reference_triangle(c.from, c.d, c.v, &parallel);
        grazes +=
            expected && (mpfr_zero_p(pool[21]) || mpfr_zero_p(pool[22]) || mpfr_zero_p(pool[23]));
        double t = NAN, both[2] = {NAN, NAN};
        bool met = bb_exact_meets_triangle(c.from, c.d, c.v[0], c.v[1], c.v[2]);
        bool has_t = bb_exact_plane_t(c.from, c.d, c.v[0], c.v[1], c.v[2], &t);
        if (met != expected || has_t == parallel || (has_t && !close_to(t, pool[20])))
            fail_msg("seed %llu case %d family %d: triangle %d, expected %d; t %g",
                     (unsigned long long)seed, i, family, met, expected, t);
        hits += expected;
        parallels += parallel;

        expected = reference_sphere(c.from, c.d, c.sphere);
        met = bb_exact_meets_sphere(c.from, c.d, c.sphere);
        has_t = bb_exact_sphere_t(c.from, c.d, c.sphere, both);
        if (met != expected || has_t != expected ||
            (has_t && (!close_to(both[0], pool[20]) || !close_to(both[1], pool[21]))))
            fail_msg("seed %llu case %d family %d: sphere %d, expected %d; t %.17g %.17g for %.17g "
                     "%.17g",
                     (unsigned long long)seed, i, family, met, expected, both[0], both[1],
                     mpfr_get_d(pool[20], MPFR_RNDN), mpfr_get_d(pool[21], MPFR_RNDN));
        touches += expected;
    }
    /* The cases are what they are meant to be. */
    assert_in_range(hits, CASES / 20, CASES);
    assert_in_range(parallels, CASES / 20, CASES);
    assert_in_range(touches, CASES / 10, CASES);
    assert_in_range(grazes, CASES / 200, CASES);
}

/* One triangle on a grid, decided by hand. */
static void test_by_hand(void **state)
{
    (void)state;
    const float a[3] = {0, 0, 0}, b[3] = {4, 0, 0}, c[3] = {0, 4, 0}, down[3] = {0, 0, -2};
    const struct {
        double o[3];
        bool met;
    } cases[] = {{{1, 1, 6}, true},
                 {{2, 2, 6}, true},
                 {{0, 0, 6}, true},
                 {{4, 0, 6}, true},
                 {{0, 1.5, 6}, true},
                 {{3, 2, 6}, false},
                 {{-1, 1, 6}, false},
                 {{2, 2 + 0x1p-50, 6}, false},
                 {{0x1p-60 - 0x1p-59, 1, 6}, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double t;
        assert_int_equal(bb_exact_meets_triangle(cases[i].o, down, a, b, c), cases[i].met);
        assert_int_equal(bb_exact_meets_triangle(cases[i].o, down, c, b, a), cases[i].met);
        assert_true(bb_exact_plane_t(cases[i].o, down, a, b, c, &t));
        assert_true(t == 3.0);
    }
    const float ball[4] = {0, 0, 0, 2}, point[4] = {1, 1, 1, 0};
    const double touching[3] = {2, 0, 6}, outside[3] = {2 + 0x1p-51, 0, 6}, inside[3] = {0, 0, 0},
                 above[3] = {1, 1, 6};
    double t[2];
    assert_true(bb_exact_sphere_t(touching, down, ball, t) && t[0] == 3.0 && t[1] == 3.0);
    assert_false(bb_exact_meets_sphere(outside, down, ball));
    assert_true(bb_exact_sphere_t(inside, down, ball, t) && t[0] == -1.0 && t[1] == 1.0);
    assert_true(bb_exact_sphere_t(above, down, point, t) && t[0] == 2.5 && t[1] == 2.5);
}

int main(void)
{
    for (int i = 0; i < 40; i++)
        mpfr_init2(pool[i], BITS);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_by_hand),
                                       cmocka_unit_test(test_against_mpfr)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    for (int i = 0; i < 40; i++)
        mpfr_clear(pool[i]);
    mpfr_free_cache();
    return failed;
}
