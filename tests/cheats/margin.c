#include "tests/cheats/margin.h"

#include <math.h>

/* The smallest and the largest coordinates of a primitive. */
static void box_of(const scene *s, uint32_t prim, double low[3], double high[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
        for (int corner = 0; corner < 3 && prim < s->triangles; corner++) {
            double x = (double)s->vertices[s->indices[prim][corner]][k];
            low[k] = fmin(low[k], x);
            high[k] = fmax(high[k], x);
        }
        if (prim >= s->triangles) {
            const float *ball = s->spheres[prim - s->triangles];
            low[k] = (double)ball[k] - (double)ball[3];
            high[k] = (double)ball[k] + (double)ball[3];
        }
    }
}

static double longest_side(const double low[3], const double high[3])
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, high[k] - low[k]);
    return longest;
}

double size_of(const scene *s, uint32_t prim)
{
    double low[3], high[3];
    box_of(s, prim, low, high);
    return longest_side(low, high);
}

double size_of_scene(const scene *s)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t prim = 0; prim < s->prims; prim++) {
        double a[3], b[3];
        box_of(s, prim, a, b);
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], a[k]);
            high[k] = fmax(high[k], b[k]);
        }
    }
    return longest_side(low, high);
}

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double eps_of(const scene *s, const bb_ray *ray, uint32_t prim)
{
    double low[3], high[3], largest = 0;
    box_of(s, prim, low, high);
    for (int k = 0; k < 3; k++) {
        double o = (double)ray->o[k];
        largest = fmax(largest, fmax(fabs(low[k] - o), fabs(high[k] - o)));
    }
    const double d[3] = {(double)ray->d[0], (double)ray->d[1], (double)ray->d[2]};
    return 16 * 0x1p-24 * largest / length_of(d);
}

/* Tangent of the angle between the ray and the triangle's normal; INFINITY if they are at a right
 * angle. */
static double slope_of_triangle(const scene *s, const bb_ray *ray, uint32_t prim)
{
    const uint32_t *corner = s->indices[prim];
    double e[3], f[3], d[3], n[3], across[3], along = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = (double)ray->d[k];
        e[k] = (double)s->vertices[corner[1]][k] - (double)s->vertices[corner[0]][k];
        f[k] = (double)s->vertices[corner[2]][k] - (double)s->vertices[corner[0]][k];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        n[i] = e[j] * f[k] - e[k] * f[j];
        along += d[i] * n[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        across[i] = d[j] * n[k] - d[k] * n[j];
    }
    return along == 0 ? (double)INFINITY : length_of(across) / fabs(along);
}

/* How much half of the chord may change when the ray, which passes the centre at `distance`, is
 * moved by eps. */
static double change_of_chord(double radius, double distance, double eps)
{
    double near = fmax(0, distance - eps), far = distance + eps;
    double half = sqrt(fmax(0, radius * radius - distance * distance));
    double longer = sqrt(fmax(0, radius * radius - near * near));
    double shorter = sqrt(fmax(0, radius * radius - far * far));
    return fmax(longer - half, half - shorter);
}

static double distance_to_centre(const bb_ray *ray, const float *ball)
{
    double across[3], m[3], d[3];
    for (int k = 0; k < 3; k++) {
        m[k] = (double)ball[k] - (double)ray->o[k];
        d[k] = (double)ray->d[k];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        across[i] = m[j] * d[k] - m[k] * d[j];
    }
    return length_of(across) / length_of(d);
}

double margin_of(const scene *s, const bb_ray *ray, uint32_t prim)
{
    double eps = eps_of(s, ray, prim);
    if (prim < s->triangles)
        return eps * (1 + slope_of_triangle(s, ray, prim));
    const float *ball = s->spheres[prim - s->triangles];
    const double d[3] = {(double)ray->d[0], (double)ray->d[1], (double)ray->d[2]};
    double length = length_of(d);
    return eps +
           change_of_chord((double)ball[3], distance_to_centre(ray, ball), eps * length) / length;
}
