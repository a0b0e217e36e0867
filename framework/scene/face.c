/* Plane geometry of one triangle. */
#include "framework/scene/face.h"

#include <math.h>
#include <string.h>

void bb_face_normal(const bb_face *face, double normal[3])
{
    const float *const *v = face->v;
    for (int axis = 0; axis < 3; axis++) {
        int j = (axis + 1) % 3, k = (axis + 2) % 3;
        normal[axis] = ((double)v[1][j] - v[0][j]) * ((double)v[2][k] - v[0][k]) -
                       ((double)v[1][k] - v[0][k]) * ((double)v[2][j] - v[0][j]);
    }
}

double bb_face_twice_area(const bb_face *face)
{
    double n[3];
    bb_face_normal(face, n);
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Returns whether a * b equals c * d, exactly unless a product underflows; the differences passed
 * in are exact doubles unless their operands are 2^29 apart in size. */
static bool equal_products(double a, double b, double c, double d)
{
    double left = a * b, right = c * d;
    return left == right && fma(a, b, -left) == fma(c, d, -right);
}

bool bb_face_is_flat(const bb_face *face)
{
    const float *const *v = face->v;
    double e[2][3];
    for (int k = 0; k < 2; k++)
        for (int axis = 0; axis < 3; axis++)
            e[k][axis] = (double)v[k + 1][axis] - (double)v[0][axis];
    return equal_products(e[0][1], e[1][2], e[0][2], e[1][1]) &&
           equal_products(e[0][2], e[1][0], e[0][0], e[1][2]) &&
           equal_products(e[0][0], e[1][1], e[0][1], e[1][0]);
}

void bb_face_sample(const bb_face *face, bb_random *random, double point[3], double normal[3])
{
    const float *const *v = face->v;
    double a = bb_random_unit(random), b = bb_random_unit(random);
    if (a + b > 1.0) {
        a = 1.0 - a;
        b = 1.0 - b;
    }
    bb_face_normal(face, normal);
    double length = bb_face_twice_area(face);
    for (int axis = 0; axis < 3; axis++) {
        point[axis] = v[0][axis] + (a * ((double)v[1][axis] - v[0][axis]) +
                                    b * ((double)v[2][axis] - v[0][axis]));
        normal[axis] = length > 0.0 ? normal[axis] / length : 0.0;
    }
}

/* ---- the part in a box ---- */

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

/* Clips the face as a polygon (Sutherland and Hodgman 1974). */
bool bb_face_shrink(const bb_face *face, double lo[3], double hi[3])
{
    double polygon[POLYGON_MAX][3];
    int count = 3;
    for (int corner = 0; corner < 3; corner++)
        for (int axis = 0; axis < 3; axis++)
            polygon[corner][axis] = face->v[corner][axis];
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
        /* Rounding may have moved an interpolated corner out of the box, which must never grow. */
        double low = lo[axis], high = hi[axis];
        lo[axis] = fmin(fmax(least, low), high);
        hi[axis] = fmin(fmax(most, low), high);
    }
    return count > 0;
}

/* ---- for the judge ---- */

float bb_face_height(const bb_face *face)
{
    const float *const *v = face->v;
    double longest = 0.0, twice = 0.0;
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

double bb_corners_reach(const float *const v[], int count, const double o[3])
{
    double largest = 0.0;
    for (int corner = 0; corner < count; corner++)
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs((double)v[corner][k] - o[k]));
    return largest;
}
