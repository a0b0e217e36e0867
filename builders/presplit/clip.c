/* Clips a triangle to a box, conservatively.
 *
 *   polygon = the triangle, in double
 *   for each of the six planes, moved out by a margin: clip it there (Sutherland, Hodgman 1974)
 *   box of its corners: grow it by the margin, round it outwards to floats
 *   cut off what is outside of the box itself
 *
 * Why nothing is lost: let M be the largest coordinate. A computed corner on a plane is within 8 *
 * 2^-53 M of the point where the edge meets that plane, since each distance to the plane is rounded
 * once, and the side of the plane that a corner is on is exact. So after k planes each point that
 * is inside of all of them by more than 8k * 2^-53 M is at most that far from the computed polygon.
 * A point in the box is inside of the moved planes by the margin, 2^-44 M, which is more than 48 *
 * 2^-53 M; so it is in the result.
 */
#include "clip.h"

#include <math.h>
#include <string.h>

enum { CORNERS_MAX = 9 }; /* three, and one more for each plane */

typedef struct polygon {
    int count;
    double corners[CORNERS_MAX + 1][3];
} polygon;

/* Keeps the part of the polygon with sign * x[axis] <= sign * plane. */
static void clip(polygon *p, int axis, double plane, double sign)
{
    polygon kept = {.count = 0};
    for (int i = 0; i < p->count; i++) {
        const double *a = p->corners[i], *b = p->corners[(i + 1) % p->count];
        double da = sign * (plane - a[axis]), db = sign * (plane - b[axis]);
        if (da >= 0)
            memcpy(kept.corners[kept.count++], a, sizeof kept.corners[0]);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
            double t = da / (da - db), *corner = kept.corners[kept.count++];
            for (int k = 0; k < 3; k++)
                corner[k] = a[k] + t * (b[k] - a[k]);
            corner[axis] = plane;
        }
    }
    *p = kept;
}

static float round_down(double x)
{
    float y = (float)x;
    return (double)y > x ? nextafterf(y, -INFINITY) : y;
}

static float round_up(double x)
{
    float y = (float)x;
    return (double)y < x ? nextafterf(y, INFINITY) : y;
}

/* Turns -0 into +0, as in all boxes. */
static void shrink(bb_box *box, const polygon *p, double margin)
{
    for (int k = 0; k < 3; k++) {
        double lo = INFINITY, hi = -INFINITY;
        for (int i = 0; i < p->count; i++) {
            lo = fmin(lo, p->corners[i][k]);
            hi = fmax(hi, p->corners[i][k]);
        }
        float low = round_down(lo - margin), high = round_up(hi + margin);
        box->lo[k] = (low > box->lo[k] ? low : box->lo[k]) + 0.0f;
        box->hi[k] = (high < box->hi[k] ? high : box->hi[k]) + 0.0f;
    }
}

void bb_clip_primitive(const bb_scene *scene, uint32_t prim, bb_box *box)
{
    polygon p = {.count = 3};
    double most = 0;
    if (prim >= scene->prims[BB_TRIANGLE].count)
        return;
    for (uint32_t corner = 0; corner < 3; corner++)
        for (int k = 0; k < 3; k++) {
            p.corners[corner][k] = bb_scene_vertex(scene, prim, corner)[k];
            most = fmax(most, fabs(p.corners[corner][k]));
        }
    double margin = 0x1p-44 * most;
    for (int axis = 0; axis < 3 && p.count > 0; axis++) {
        clip(&p, axis, box->hi[axis] + margin, 1);
        if (p.count > 0)
            clip(&p, axis, box->lo[axis] - margin, -1);
    }
    /* The polygon is empty if, for example, the triangle only touches the plane of a half; the box
     * then stays. */
    if (p.count > 0)
        shrink(box, &p, margin);
}
