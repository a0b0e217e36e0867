/* Cuts a reference in two by a plane.
 *
 *   triangle, tetrahedron: on each side, the box of the corners there and of the points where
 *                          edges cross the plane, within the box that is cut
 *   box:                   on each side, the box's part
 *
 * Crossings are computed in double, with an error below 2^-50 of the edge's largest coordinate M.
 * Rounding to a float adds half of its last place, 2^-24 M, or 2^-150 where floats are denormal. So
 * with a margin of 2^-23 M + 2^-149 on each side no point of the primitive is lost.
 */
#include "sbvh_split.h"

#include <math.h>

static float least(float a, float b)
{
    return a < b ? a : b;
}

static float most(float a, float b)
{
    return a > b ? a : b;
}

/* Returns where the edge from a to b crosses the plane, which is strictly between its ends. */
static inline sb_bounds cross(const float *a, const float *b, int axis, float plane)
{
    sb_bounds box;
    double t = ((double)plane - a[axis]) / ((double)b[axis] - a[axis]);
    for (int k = 0; k < 3; k++) {
        double at = a[k] + t * ((double)b[k] - a[k]);
        double slack = 0x1p-23 * most(fabsf(a[k]), fabsf(b[k])) + 0x1p-149;
        box.lo[k] = most((float)(at - slack), least(a[k], b[k]));
        box.hi[k] = least((float)(at + slack), most(a[k], b[k]));
    }
    box.lo[axis] = box.hi[axis] = plane;
    return box;
}

static void cut_corners(const float *const *corners, int count, int axis, float plane,
                        sb_bounds sides[2])
{
    for (int i = 0; i < count; i++) {
        const float *a = corners[i];
        sb_bounds corner = {{a[0], a[1], a[2]}, {a[0], a[1], a[2]}};
        if (a[axis] <= plane)
            sb_grow(&sides[0], &corner);
        if (a[axis] >= plane)
            sb_grow(&sides[1], &corner);
        for (int j = 0; j < i; j++) {
            const float *b = corners[j];
            if ((a[axis] < plane) == (b[axis] < plane) || a[axis] == plane || b[axis] == plane)
                continue;
            sb_bounds crossing =
                a[axis] < plane ? cross(a, b, axis, plane) : cross(b, a, axis, plane);
            sb_grow(&sides[0], &crossing);
            sb_grow(&sides[1], &crossing);
        }
    }
}

/* Intersects a side with `box`; turns -0 into +0. */
static void keep_within(sb_bounds *side, const sb_bounds *box)
{
    bool some = true;
    for (int k = 0; k < 3; k++) {
        side->lo[k] = most(side->lo[k], box->lo[k]) + 0.0f;
        side->hi[k] = least(side->hi[k], box->hi[k]) + 0.0f;
        some = some && side->lo[k] <= side->hi[k];
    }
    if (!some)
        *side = sb_nothing();
}

void sb_cut(const bb_scene *scene, const sb_ref *ref, int axis, float plane, sb_bounds sides[2])
{
    const bb_prims *triangles = &scene->prims[BB_TRIANGLE];
    const bb_prims *tets = &scene->prims[BB_TETRAHEDRON];
    const bool tet = ref->prim - tets->first < tets->count;
    sides[0] = sides[1] = sb_nothing();
    if (tet || ref->prim < triangles->count) {
        const int count = tet ? 4 : 3;
        const float *corners[4];
        const uint32_t *indices =
            tet ? (const uint32_t *)tets->data + 4 * (size_t)(ref->prim - tets->first)
                : (const uint32_t *)triangles->data + 3 * (size_t)ref->prim;
        for (int c = 0; c < count; c++)
            corners[c] = scene->vertices + 3 * (size_t)indices[c];
        cut_corners(corners, count, axis, plane, sides);
    } else {
        sides[0] = sides[1] = ref->box;
    }
    sides[0].hi[axis] = least(sides[0].hi[axis], plane);
    sides[1].lo[axis] = most(sides[1].lo[axis], plane);
    keep_within(&sides[0], &ref->box);
    keep_within(&sides[1], &ref->box);
}
