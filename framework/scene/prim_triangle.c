/* Triangles: three indices of vertices. */
#include "framework/exact/exact.h"
#include "framework/scene/prim.h"

#include <math.h>
#include <string.h>

static void corners_of(const bb_scene *scene, uint32_t i, const float *corners[3])
{
    for (uint32_t k = 0; k < 3; k++)
        corners[k] = bb_scene_vertex(scene, i, k);
}

static bb_status bounds(const bb_scene *scene, uint32_t i, bb_box *box)
{
    const uint32_t *indices = bb_scene_indices(scene);
    const float *corner[3];
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t index = indices[3 * (size_t)i + k];
        if (index >= scene->vertex_count)
            return bb_fail(BB_INVALID, "%s: triangle %u: index %u is beyond its %u vertices",
                           scene->name, i, index, scene->vertex_count);
        corner[k] = scene->vertices + 3 * (size_t)index;
    }
    for (int axis = 0; axis < 3; axis++) {
        float a = corner[0][axis], b = corner[1][axis], c = corner[2][axis];
        float low = a < b ? a : b, high = a < b ? b : a;
        box->lo[axis] = c < low ? c : low;
        box->hi[axis] = c > high ? c : high;
        if (!isfinite(a) || !isfinite(b) || !isfinite(c))
            return bb_fail(BB_INVALID, "%s: triangle %u has a vertex that is not finite (%g %g %g)",
                           scene->name, i, (double)a, (double)b, (double)c);
    }
    return BB_OK;
}

/* Twice the area is its length. */
static void cross(const bb_scene *scene, uint32_t i, double normal[3])
{
    const float *v[3];
    corners_of(scene, i, v);
    for (int axis = 0; axis < 3; axis++) {
        int j = (axis + 1) % 3, k = (axis + 2) % 3;
        normal[axis] = ((double)v[1][j] - v[0][j]) * ((double)v[2][k] - v[0][k]) -
                       ((double)v[1][k] - v[0][k]) * ((double)v[2][j] - v[0][j]);
    }
}

static double product(const bb_scene *scene, uint32_t i)
{
    double n[3];
    cross(scene, i, n);
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Is a * b equal to c * d? Exact unless a product underflows; the differences that come in are
 * exact doubles unless their operands are 2^29 apart in size. */
static bool equal_products(double a, double b, double c, double d)
{
    double left = a * b, right = c * d;
    return left == right && fma(a, b, -left) == fma(c, d, -right);
}

static bool is_flat(const bb_scene *scene, uint32_t i)
{
    const float *v[3];
    double e[2][3];
    corners_of(scene, i, v);
    for (int k = 0; k < 2; k++)
        for (int axis = 0; axis < 3; axis++)
            e[k][axis] = (double)v[k + 1][axis] - (double)v[0][axis];
    return equal_products(e[0][1], e[1][2], e[0][2], e[1][1]) &&
           equal_products(e[0][2], e[1][0], e[0][0], e[1][2]) &&
           equal_products(e[0][0], e[1][1], e[0][1], e[1][0]);
}

static double area(const bb_scene *scene, uint32_t i)
{
    return 0.5 * product(scene, i);
}

static void normal(const bb_scene *scene, uint32_t i, const double point[3], double out[3])
{
    (void)point;
    cross(scene, i, out);
}

/* On a plane of constant coordinate the point is exactly on it. */
static void sample(const bb_scene *scene, uint32_t i, bb_random *random, double point[3],
                   double out[3])
{
    const float *v[3];
    corners_of(scene, i, v);
    double a = bb_random_unit(random), b = bb_random_unit(random);
    if (a + b > 1.0) {
        a = 1.0 - a;
        b = 1.0 - b;
    }
    cross(scene, i, out);
    double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    for (int axis = 0; axis < 3; axis++) {
        point[axis] = v[0][axis] + (a * ((double)v[1][axis] - v[0][axis]) +
                                    b * ((double)v[2][axis] - v[0][axis]));
        out[axis] = length > 0.0 ? out[axis] / length : 0.0;
    }
}

/* ---- what of it is in a box ---- */

enum { POLYGON_MAX = 16 }; /* a triangle cut by six planes has at most nine corners */

/* Keeps the part of the polygon with sign * x[axis] <= sign * plane; returns the number of corners
 * left. */
static int clip(double (*polygon)[3], int count, int axis, double plane, double sign)
{
    double kept[POLYGON_MAX][3];
    int kept_count = 0;
    for (int i = 0; i < count; i++) {
        const double *a = polygon[i], *b = polygon[(i + 1) % count];
        double da = sign * (plane - a[axis]), db = sign * (plane - b[axis]);
        if (da >= 0.0)
            memcpy(kept[kept_count++], a, sizeof kept[0]);
        if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
            double t = da / (da - db);
            for (int k = 0; k < 3; k++)
                kept[kept_count][k] = a[k] + t * (b[k] - a[k]);
            kept[kept_count++][axis] = plane;
        }
    }
    memcpy(polygon, kept, (size_t)kept_count * sizeof kept[0]);
    return kept_count;
}

/* As a polygon (Sutherland and Hodgman 1974). */
static bool shrink(const bb_scene *scene, uint32_t i, double lo[3], double hi[3])
{
    double polygon[POLYGON_MAX][3];
    int count = 3;
    for (uint32_t corner = 0; corner < 3; corner++)
        for (int axis = 0; axis < 3; axis++)
            polygon[corner][axis] = bb_scene_vertex(scene, i, corner)[axis];
    for (int axis = 0; axis < 3 && count > 0; axis++) {
        count = clip(polygon, count, axis, hi[axis], 1.0);
        if (count > 0)
            count = clip(polygon, count, axis, lo[axis], -1.0);
    }
    for (int axis = 0; axis < 3 && count > 0; axis++) {
        double least = polygon[0][axis], most = least;
        for (int k = 1; k < count; k++) {
            least = fmin(least, polygon[k][axis]);
            most = fmax(most, polygon[k][axis]);
        }
        /* An interpolated corner may have been rounded out of the box, which must never grow. */
        double low = lo[axis], high = hi[axis];
        lo[axis] = fmin(fmax(least, low), high);
        hi[axis] = fmin(fmax(most, low), high);
    }
    return count > 0;
}

/* ---- for the judge ---- */

static double reach(const bb_scene *scene, uint32_t i, const double o[3])
{
    const float *v[3];
    double largest = 0.0;
    corners_of(scene, i, v);
    for (int corner = 0; corner < 3; corner++)
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs((double)v[corner][k] - o[k]));
    return largest;
}

static float height(const bb_scene *scene, uint32_t i)
{
    const float *v[3];
    double longest = 0.0, twice = 0.0;
    corners_of(scene, i, v);
    for (int a = 0; a < 3; a++) {
        int j = (a + 1) % 3, k = (a + 2) % 3;
        double side = 0.0;
        for (int axis = 0; axis < 3; axis++)
            side = hypot(side, (double)v[j][axis] - v[a][axis]);
        longest = fmax(longest, side);
        twice = hypot(twice, ((double)v[1][j] - v[0][j]) * ((double)v[2][k] - v[0][k]) -
                                 ((double)v[1][k] - v[0][k]) * ((double)v[2][j] - v[0][j]));
    }
    return twice > 0.0 ? (float)(twice / longest) : 0.0f;
}

static int extended(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                    double t[2])
{
    const float *v[3];
    corners_of(scene, i, v);
    return bb_exact_plane_t(o, d, v[0], v[1], v[2], &t[0]) ? 1 : 0;
}

static int nearby(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                  double eps, double t[2])
{
    (void)eps;
    return extended(scene, i, o, d, t);
}

static int hits(const bb_scene *scene, uint32_t i, const double o[3], const float d[3], double t[2])
{
    const float *v[3];
    corners_of(scene, i, v);
    return bb_exact_meets_triangle(o, d, v[0], v[1], v[2]) &&
                   bb_exact_plane_t(o, d, v[0], v[1], v[2], &t[0])
               ? 1
               : 0;
}

static bb_passing pass(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                       double to)
{
    const float *v[3];
    corners_of(scene, i, v);
    return bb_pass_polygon(frame, v, 3, from, to);
}

static uint32_t outlines(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                         double to, bb_outline out[BB_OUTLINES_MAX])
{
    const float *v[3];
    corners_of(scene, i, v);
    bb_see_polygon(frame, v, 3, from, to, &out[0]);
    return out[0].count > 0 ? 1 : 0;
}

extern const bb_prim_kind bb_prim_triangle;
const bb_prim_kind bb_prim_triangle = {
    .name = "triangle",
    .plural = "triangles",
    .is_mesh = true,
    .extended = extended,
    BB_PRIM_FUNCTIONS,
};
