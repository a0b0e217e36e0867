/* Exact decisions of line against triangle and sphere. Doubles with a proven error bound decide
 * first, and expansions where they cannot. There is no tolerance. */
#ifndef BB_EXACT_H
#define BB_EXACT_H

#include <stdbool.h>

/* Lines are o + t * d with d not zero. Coordinates are floats; o may also be any double of
 * magnitude 0 or 2^-200 .. 2^140, so that a moved ray has exact coordinates too. */

/* Returns whether the line meets the closed triangle, edges and vertices included. It does not meet
 * a triangle of zero area, or one in a plane with the line. */
bool bb_exact_meets_triangle(const double o[3], const float d[3], const float a[3],
                             const float b[3], const float c[3]);

/* Computes t at which the line meets the triangle's plane, to a relative error below 2^-32. Returns
 * false if the line is parallel to it. */
bool bb_exact_plane_t(const double o[3], const float d[3], const float a[3], const float b[3],
                      const float c[3], double *t);

/* Returns whether the line meets the closed ball `sphere` (centre, radius >= 0). */
bool bb_exact_meets_sphere(const double o[3], const float d[3], const float sphere[4]);

/* Computes both t at which the line meets the sphere, t[0] <= t[1], to a relative error below
 * 2^-32. Returns false if it does not. */
bool bb_exact_sphere_t(const double o[3], const float d[3], const float sphere[4], double t[2]);

/* Returns on which side of the plane through a, b, c the point p lies: the sign of (p - a) . ((b -
 * a) cross (c - a)). 0: on it, or a, b and c lie on one line. */
int bb_exact_side(const double p[3], const float a[3], const float b[3], const float c[3]);

#endif
