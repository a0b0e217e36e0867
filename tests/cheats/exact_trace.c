/* Doubles with error bounds put aside what they can; mpq decides the rest:
 *
 *   for each primitive: an interval of doubles that holds its t, and whether it is surely hit
 *   keep what may be as near as the nearest sure one
 *   if that is one sure hit whose interval rounds to one float: this is it
 *   else compute hit and t of those in rationals, and compare
 */
#include "tests/cheats/exact_trace.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { NUMBERS = 12, ROOT_BITS = 512 };

/* The error of each sum of products below is less than this times the sum of their magnitudes:
 * no term goes through more than 16 roundings of 2^-53. */
static const double unit = 32 * 0x1p-53;

/* One primitive's t, or one of the two of a sphere. */
struct candidate {
    uint32_t prim;
    int root;
    bool sure;        /* hit, and within the limits */
    double low, high; /* t is between these */
};

bool workspace_init(workspace *work, const scene *scene)
{
    work->scene = scene;
    work->exact = 0;
    work->candidates = malloc(2 * (size_t)scene->prims * sizeof *work->candidates + 1);
    return work->candidates != NULL;
}

void workspace_clear(workspace *work)
{
    free(work->candidates);
}

static const float *corner(const scene *scene, uint32_t prim, int k)
{
    return scene->vertices[scene->indices[prim][k]];
}

static const float *sphere(const scene *scene, uint32_t prim)
{
    return scene->spheres[prim - scene->triangles];
}

/* ---- doubles with bounds ---- */

/* A value and what it is off by at most. */
typedef struct bounded {
    double value, error;
} bounded;

static bounded determinant(const double x[3], const double y[3], const double z[3])
{
    double value = 0, magnitude = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        value += x[i] * (y[j] * z[k] - y[k] * z[j]);
        magnitude += fabs(x[i]) * (fabs(y[j] * z[k]) + fabs(y[k] * z[j]));
    }
    return (bounded){value, unit * magnitude + DBL_MIN};
}

/* 1, -1, or 0: not known. */
static int sign_of(bounded b)
{
    return b.value > b.error ? 1 : b.value < -b.error ? -1 : 0;
}

static void widen(double *low, double *high)
{
    *low -= fabs(*low) * unit + DBL_MIN;
    *high += fabs(*high) * unit + DBL_MIN;
}

/* From -1, 0, 1 per edge (0: not known): opposite ones are a sure miss, three equal ones a hit. */
static bool may_hit(const int signs[3], bool *sure)
{
    int sum = signs[0] + signs[1] + signs[2];
    bool positive = false, negative = false;
    for (int i = 0; i < 3; i++) {
        positive |= signs[i] > 0;
        negative |= signs[i] < 0;
    }
    *sure = abs(sum) == 3;
    return !(positive && negative);
}

/* How many candidates the triangle is: 0 or 1. */
static int bound_triangle(const scene *scene, const bb_ray *ray, uint32_t prim, candidate *out)
{
    double v[3][3], e[3], f[3], d[3];
    const float *a = corner(scene, prim, 0), *b = corner(scene, prim, 1),
                *c = corner(scene, prim, 2);
    for (int k = 0; k < 3; k++) {
        d[k] = ray->d[k];
        for (int i = 0; i < 3; i++)
            v[i][k] = (double)corner(scene, prim, i)[k] - (double)ray->o[k];
        e[k] = (double)b[k] - (double)a[k];
        f[k] = (double)c[k] - (double)a[k];
    }
    int signs[3];
    for (int i = 0; i < 3; i++)
        signs[i] = sign_of(determinant(d, v[i], v[(i + 1) % 3]));
    if (!may_hit(signs, &out->sure))
        return 0;
    bounded over = determinant(v[0], e, f), under = determinant(d, e, f);
    out->prim = prim;
    out->root = 0;
    out->low = -INFINITY;
    out->high = INFINITY;
    if (sign_of(under) == 0) {
        out->sure = false;
        return 1;
    }
    double t = over.value / under.value;
    double error =
        (over.error + fabs(t) * under.error) / (fabs(under.value) - under.error) * (1 + unit);
    out->low = t - error;
    out->high = t + error;
    widen(&out->low, &out->high);
    return 1;
}

/* How many candidates the sphere is: 0 or 2. */
static int bound_sphere(const scene *scene, const bb_ray *ray, uint32_t prim, candidate out[2])
{
    const float *s = sphere(scene, prim);
    double dd = 0, dm = 0, mm = 0, dm_size = 0, r = s[3];
    for (int k = 0; k < 3; k++) {
        double d = ray->d[k], m = (double)s[k] - (double)ray->o[k];
        dd += d * d;
        dm += d * m;
        mm += m * m;
        dm_size += fabs(d * m);
    }
    double square = dm * dm - dd * (mm - r * r);
    double error = unit * (dm_size * dm_size + dd * (mm + r * r)) + DBL_MIN;
    if (square < -error)
        return 0;
    for (int root = 0; root < 2; root++)
        out[root] = (candidate){prim, root, square > error, -INFINITY, INFINITY};
    if (square <= error)
        return 2;
    double least = sqrt(square - error), most = sqrt(square + error);
    widen(&least, &most);
    double slip = unit * dm_size;
    out[0].low = (dm - most - slip) / dd;
    out[0].high = (dm - least + slip) / dd;
    out[1].low = (dm + least - slip) / dd;
    out[1].high = (dm + most + slip) / dd;
    for (int root = 0; root < 2; root++)
        widen(&out[root].low, &out[root].high);
    return 2;
}

/* ---- rationals ---- */

static void difference(mpq_t out, float a, float b)
{
    mpq_t other;
    mpq_init(other);
    mpq_set_d(out, (double)a);
    mpq_set_d(other, (double)b);
    mpq_sub(out, out, other);
    mpq_clear(other);
}

/* x . (y cross z) */
static void exact_determinant(mpq_t out, mpq_t x[3], mpq_t y[3], mpq_t z[3])
{
    mpq_t p, q;
    mpq_inits(p, q, NULL);
    mpq_set_ui(out, 0, 1);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpq_mul(p, y[j], z[k]);
        mpq_mul(q, y[k], z[j]);
        mpq_sub(p, p, q);
        mpq_mul(p, p, x[i]);
        mpq_add(out, out, p);
    }
    mpq_clears(p, q, NULL);
}

/* False if the triangle is not hit. */
static bool exact_triangle(const scene *scene, const bb_ray *ray, uint32_t prim, mpq_t t)
{
    mpq_t n[NUMBERS], over, under, side;
    mpq_t *d = n, *v[3] = {n + 3, n + 6, n + 9};
    for (int i = 0; i < NUMBERS; i++)
        mpq_init(n[i]);
    mpq_inits(over, under, side, NULL);
    for (int k = 0; k < 3; k++) {
        mpq_set_d(d[k], (double)ray->d[k]);
        for (int i = 0; i < 3; i++)
            difference(v[i][k], corner(scene, prim, i)[k], ray->o[k]);
    }
    bool positive = false, negative = false;
    for (int i = 0; i < 3; i++) {
        exact_determinant(side, d, v[i], v[(i + 1) % 3]);
        positive |= mpq_sgn(side) > 0;
        negative |= mpq_sgn(side) < 0;
        mpq_add(under, under, side); /* the sum is d times the normal */
    }
    bool hit = mpq_sgn(under) != 0 && !(positive && negative);
    if (hit) {
        exact_determinant(over, v[0], v[1], v[2]);
        mpq_div(t, over, under);
    }
    mpq_clears(over, under, side, NULL);
    for (int i = 0; i < NUMBERS; i++)
        mpq_clear(n[i]);
    return hit;
}

/* The square root of x >= 0 to more than 250 bits; exact where it is rational. */
static void square_root(mpq_t x)
{
    mpz_t product;
    mpz_init(product);
    mpz_mul(product, mpq_numref(x), mpq_denref(x));
    size_t bits = mpz_sizeinbase(product, 2);
    mp_bitcnt_t shift = bits < ROOT_BITS ? (ROOT_BITS - bits) / 2 + 1 : 0;
    mpz_mul_2exp(product, product, 2 * shift);
    mpz_sqrt(mpq_numref(x), product);
    mpz_mul_2exp(mpq_denref(x), mpq_denref(x), shift);
    mpq_canonicalize(x);
    mpz_clear(product);
}

/* False if the sphere is not hit. */
static bool exact_sphere(const scene *scene, const bb_ray *ray, uint32_t prim, int root, mpq_t t)
{
    const float *s = sphere(scene, prim);
    mpq_t dd, dm, mm, d, m, p;
    mpq_inits(dd, dm, mm, d, m, p, NULL);
    for (int k = 0; k < 3; k++) {
        mpq_set_d(d, (double)ray->d[k]);
        difference(m, s[k], ray->o[k]);
        mpq_mul(p, d, d);
        mpq_add(dd, dd, p);
        mpq_mul(p, d, m);
        mpq_add(dm, dm, p);
        mpq_mul(p, m, m);
        mpq_add(mm, mm, p);
    }
    mpq_set_d(p, (double)s[3]);
    mpq_mul(p, p, p);
    mpq_sub(mm, mm, p);
    mpq_mul(mm, mm, dd);
    mpq_mul(p, dm, dm);
    mpq_sub(p, p, mm);
    bool hit = mpq_sgn(p) >= 0;
    if (hit) {
        square_root(p);
        if (root == 0)
            mpq_neg(p, p);
        mpq_add(p, p, dm);
        mpq_div(t, p, dd);
    }
    mpq_clears(dd, dm, mm, d, m, p, NULL);
    return hit;
}

static bool exact_root(const scene *scene, const bb_ray *ray, uint32_t prim, int root, mpq_t t)
{
    return prim < scene->triangles ? exact_triangle(scene, ray, prim, t)
                                   : exact_sphere(scene, ray, prim, root, t);
}

bool exact_t(const scene *scene, const bb_ray *ray, const exact_hit *hit, mpq_t t)
{
    return exact_root(scene, ray, hit->prim, hit->root, t);
}

/* ---- floats ---- */

static float bounded_float(double t)
{
    return t > (double)FLT_MAX ? FLT_MAX : t < -(double)FLT_MAX ? -FLT_MAX : (float)t;
}

/* Of the float at hand and its neighbours the nearest to t; between two of them either. */
static float nearest_float(const mpq_t t)
{
    float guess = bounded_float(mpq_get_d(t)); /* cut off towards 0 */
    float best = guess;
    mpq_t distance, least;
    mpq_inits(distance, least, NULL);
    for (int step = -1; step <= 1; step++) {
        float f = step == 0 ? guess : nextafterf(guess, step < 0 ? -FLT_MAX : FLT_MAX);
        mpq_set_d(distance, (double)f);
        mpq_sub(distance, distance, t);
        mpq_abs(distance, distance);
        if (step == -1 || mpq_cmp(distance, least) < 0) {
            mpq_set(least, distance);
            best = f;
        }
    }
    mpq_clears(distance, least, NULL);
    return best;
}

/* ---- the nearest ---- */

static bool is_counted(const mpq_t t, const query *query)
{
    if (mpq_cmp(t, query->low) <= 0)
        return false;
    if (isinf(query->high))
        return true;
    mpq_t high;
    mpq_init(high);
    mpq_set_d(high, query->high);
    bool below = mpq_cmp(t, high) < 0;
    mpq_clear(high);
    return below;
}

/* Fills work->candidates with what may be the nearest; returns how many. */
static uint32_t collect(workspace *work, const bb_ray *ray, const query *query)
{
    const scene *scene = work->scene;
    double after = mpq_get_d(query->low), before = after, nearest = INFINITY;
    widen(&before, &after); /* the limit is between them */
    uint32_t count = 0;
    for (uint32_t prim = 0; prim < scene->prims; prim++) {
        if (query->dropped != NULL && query->dropped[prim])
            continue;
        candidate *c = work->candidates + count;
        int roots = prim < scene->triangles ? bound_triangle(scene, ray, prim, c)
                                            : bound_sphere(scene, ray, prim, c);
        for (int root = 0; root < roots; root++) {
            if (c[root].high < before || c[root].low > query->high || c[root].low > nearest)
                continue;
            c[root].sure = c[root].sure && c[root].low > after && c[root].high < query->high;
            if (c[root].sure)
                nearest = fmin(nearest, c[root].high);
            work->candidates[count++] = c[root];
        }
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++)
        if (work->candidates[i].low <= nearest)
            work->candidates[kept++] = work->candidates[i];
    return kept;
}

exact_hit trace_exactly(workspace *work, const bb_ray *ray, const query *query)
{
    exact_hit best = {BB_NONE, 0, INFINITY};
    uint32_t count = collect(work, ray, query);
    const candidate *c = work->candidates;
    if (count == 1 && c->sure && bounded_float(c->low) == bounded_float(c->high))
        return (exact_hit){c->prim, c->root, bounded_float(c->low)};
    mpq_t t, least;
    mpq_inits(t, least, NULL);
    for (; count > 0; count--, c++) {
        work->exact++;
        if (!exact_root(work->scene, ray, c->prim, c->root, t) || !is_counted(t, query) ||
            (best.prim != BB_NONE && mpq_cmp(t, least) >= 0))
            continue;
        best.prim = c->prim;
        best.root = c->root;
        mpq_set(least, t);
    }
    if (best.prim != BB_NONE)
        best.t = nearest_float(least);
    mpq_clears(t, least, NULL);
    return best;
}
