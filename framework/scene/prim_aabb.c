/* Axis-aligned boxes: lower and upper corner. Rays meet the surface; a box may be flat. */
#include "framework/scene/expansion.h"
#include "framework/scene/prim.h"

#include <float.h>
#include <math.h>

enum { FACES = 6 }; /* face f is perpendicular to axis f / 2, at its lower end if f is even */

static const float *aabb_of(const bb_scene *scene, uint32_t i)
{
    return bb_scene_floats(scene, BB_AABB) + 6 * (size_t)i;
}

static double side(const float b[6], int axis)
{
    return (double)b[axis + 3] - (double)b[axis];
}

static bb_status bounds(const bb_scene *scene, uint32_t i, bb_box *box)
{
    const float *b = aabb_of(scene, i);
    bool good = true;
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = b[axis];
        box->hi[axis] = b[axis + 3];
        good = good && isfinite(b[axis]) && isfinite(b[axis + 3]) && b[axis] <= b[axis + 3];
    }
    if (!good)
        return bb_fail(BB_INVALID,
                       "%s: box %u (%g %g %g to %g %g %g) must be finite, its lower corner not "
                       "beyond the upper one",
                       scene->name, i, (double)b[0], (double)b[1], (double)b[2], (double)b[3],
                       (double)b[4], (double)b[5]);
    return BB_OK;
}

/* The device's test only has quotients of lengths. */
static double product(const bb_scene *scene, uint32_t i)
{
    (void)scene, (void)i;
    return 0.0;
}

static double face_area(const float b[6], int axis)
{
    return side(b, (axis + 1) % 3) * side(b, (axis + 2) % 3);
}

static double area(const bb_scene *scene, uint32_t i)
{
    const float *b = aabb_of(scene, i);
    return 2.0 * (face_area(b, 0) + face_area(b, 1) + face_area(b, 2));
}

static bool is_flat(const bb_scene *scene, uint32_t i)
{
    const float *b = aabb_of(scene, i);
    return (b[0] == b[3]) + (b[1] == b[4]) + (b[2] == b[5]) >= 2;
}

static void sample(const bb_scene *scene, uint32_t i, bb_random *random, double point[3],
                   double out[3])
{
    const float *b = aabb_of(scene, i);
    double left = 0.5 * area(scene, i) * bb_random_unit(random);
    int axis = 0;
    while (axis < 2 && left >= face_area(b, axis))
        left -= face_area(b, axis++);
    bool upper = (bb_random_u64(random) >> 63) != 0;
    for (int k = 0; k < 3; k++) {
        point[k] = b[k] + side(b, k) * bb_random_unit(random);
        out[k] = 0.0;
    }
    point[axis] = upper ? b[axis + 3] : b[axis];
    if (!is_flat(scene, i))
        out[axis] = upper ? 1.0 : -1.0;
}

/* Returns the normal of the nearest face. */
static void normal(const bb_scene *scene, uint32_t i, const double point[3], double out[3])
{
    const float *b = aabb_of(scene, i);
    double nearest = (double)INFINITY;
    out[0] = out[1] = out[2] = 0.0;
    for (int face = 0; face < FACES && !is_flat(scene, i); face++) {
        int axis = face / 2;
        double distance = fabs(point[axis] - b[face % 2 == 0 ? axis : axis + 3]);
        if (distance >= nearest || face_area(b, axis) == 0.0)
            continue;
        nearest = distance;
        out[0] = out[1] = out[2] = 0.0;
        out[axis] = face % 2 == 0 ? -1.0 : 1.0;
    }
}

/* Shrinks towards the part of the solid box; a region inside of it contains no surface. */
static bool shrink(const bb_scene *scene, uint32_t i, double lo[3], double hi[3])
{
    const float *b = aabb_of(scene, i);
    bool inside = true;
    for (int axis = 0; axis < 3; axis++) {
        if (lo[axis] > b[axis + 3] || hi[axis] < b[axis])
            return false;
        inside = inside && lo[axis] > b[axis] && hi[axis] < b[axis + 3];
        lo[axis] = fmax(lo[axis], b[axis]);
        hi[axis] = fmin(hi[axis], b[axis + 3]);
    }
    return !inside;
}

/* ---- for the judge ---- */

static double reach(const bb_scene *scene, uint32_t i, const double o[3])
{
    const float *b = aabb_of(scene, i);
    double largest = 0.0;
    for (int k = 0; k < 6; k++)
        largest = fmax(largest, fabs((double)b[k] - o[k % 3]));
    return largest;
}

/* A box without thickness counts as a rectangle. */
static float height(const bb_scene *scene, uint32_t i)
{
    const float *b = aabb_of(scene, i);
    double least = (double)INFINITY;
    for (int axis = 0; axis < 3; axis++)
        if (side(b, axis) > 0.0)
            least = fmin(least, side(b, axis));
    return is_flat(scene, i) ? 0.0f : (float)least;
}

/* Returns the sign of (p - o_j) |d_k| sign(d_j) - (q - o_k) |d_j| sign(d_k): of the time of
 * crossing plane p of axis j minus that of crossing plane q of axis k. */
static double order(const double o[3], const float d[3], int j, float p, int k, float q)
{
    double a = d[j] < 0 ? -fabs((double)d[k]) : fabs((double)d[k]);
    double b = d[k] < 0 ? fabs((double)d[j]) : -fabs((double)d[j]);
    double x = ((double)p - o[j]) * a, y = ((double)q - o[k]) * b;
    if (fabs(x + y) > 4.0 * DBL_EPSILON * (fabs(x) + fabs(y)))
        return x + y;
    two from = two_sum((double)p, -o[j]), to = two_sum((double)q, -o[k]);
    expansion sum;
    sum.count = 0;
    add_product(&sum, from.lo, a);
    add_product(&sum, from.hi, a);
    add_product(&sum, to.lo, b);
    add_product(&sum, to.hi, b);
    return value_of(&sum);
}

/* The line meets the box if it enters no pair of planes after leaving another. t itself is rounded
 * once per step: differences, then quotients. */
static int hits(const bb_scene *scene, uint32_t i, const double o[3], const float d[3], double t[2])
{
    const float *aabb = aabb_of(scene, i);
    float near[3], far[3];
    t[0] = -(double)INFINITY;
    t[1] = (double)INFINITY;
    for (int k = 0; k < 3; k++) {
        near[k] = aabb[d[k] < 0 ? k + 3 : k];
        far[k] = aabb[d[k] < 0 ? k : k + 3];
        if (d[k] == 0 && ((double)aabb[k] > o[k] || (double)aabb[k + 3] < o[k]))
            return 0;
        if (d[k] == 0)
            continue;
        t[0] = fmax(t[0], ((double)near[k] - o[k]) / (double)d[k]);
        t[1] = fmin(t[1], ((double)far[k] - o[k]) / (double)d[k]);
    }
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++)
            if (j != k && d[j] != 0 && d[k] != 0 && order(o, d, j, near[j], k, far[k]) > 0.0)
                return 0;
    t[0] = fmin(t[0], t[1]); /* each is rounded */
    return 2;
}

/* The box is enlarged by eps; rounded, like everything that is compared with a margin. */
static int nearby(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                  double eps, double t[2])
{
    const float *b = aabb_of(scene, i);
    t[0] = -(double)INFINITY;
    t[1] = (double)INFINITY;
    for (int k = 0; k < 3; k++) {
        double lo = b[k] - eps - o[k], hi = b[k + 3] + eps - o[k];
        if (d[k] == 0 && (lo > 0.0 || hi < 0.0))
            return 0;
        if (d[k] == 0)
            continue;
        t[0] = fmax(t[0], fmin(lo / (double)d[k], hi / (double)d[k]));
        t[1] = fmin(t[1], fmax(lo / (double)d[k], hi / (double)d[k]));
    }
    return t[0] <= t[1] ? 2 : 0;
}

/* Gets the corners of a face, in order around it. */
static void face_of(const float b[6], int face, float corners[4][3])
{
    int axis = face / 2, j = (axis + 1) % 3, k = (axis + 2) % 3;
    for (int c = 0; c < 4; c++) {
        corners[c][axis] = b[face % 2 == 0 ? axis : axis + 3];
        corners[c][j] = b[c == 1 || c == 2 ? j + 3 : j];
        corners[c][k] = b[c >= 2 ? k + 3 : k];
    }
}

static bb_passing pass(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                       double to)
{
    bb_passing all = {(double)INFINITY, (double)INFINITY, -(double)INFINITY};
    for (int face = 0; face < FACES; face++) {
        float c[4][3];
        const float *const corners[4] = {c[0], c[1], c[2], c[3]};
        face_of(aabb_of(scene, i), face, c);
        bb_passing p = bb_pass_polygon(frame, corners, 4, from, to);
        all.distance = fmin(all.distance, p.distance);
        all.t_low = fmin(all.t_low, p.t_low);
        all.t_high = fmax(all.t_high, p.t_high);
    }
    return all;
}

/* Gets the faces turned towards the line's start; all faces if that is inside. */
static uint32_t outlines(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                         double to, bb_outline out[BB_OUTLINES_MAX])
{
    const float *b = aabb_of(scene, i);
    uint32_t count = 0;
    bool inside = true;
    for (int k = 0; k < 3; k++) {
        double at = frame->o[k] + from * frame->d[k];
        inside = inside && at >= (double)b[k] && at <= (double)b[k + 3];
    }
    for (int face = 0; face < FACES; face++) {
        float c[4][3];
        const float *const corners[4] = {c[0], c[1], c[2], c[3]};
        double d = frame->d[face / 2];
        if (d == 0.0 || ((d > 0.0) != (face % 2 == 0) && !inside))
            continue;
        face_of(b, face, c);
        bb_see_polygon(frame, corners, 4, from, to, &out[count]);
        count += out[count].count > 0;
    }
    return count;
}

static void mirror(bb_scene *scene, uint32_t i, int axis, float lo, float hi)
{
    float *from = &bb_scene_floats(scene, BB_AABB)[6 * (size_t)i + (size_t)axis];
    const float first = from[0];
    from[0] = bb_mirrored(from[3], lo, hi);
    from[3] = bb_mirrored(first, lo, hi);
}

extern const bb_prim_kind bb_prim_aabb;
const bb_prim_kind bb_prim_aabb = {
    .name = "box",
    .plural = "boxes",
    .extended = hits,
    .mirror = mirror,
    BB_PRIM_FUNCTIONS,
};
