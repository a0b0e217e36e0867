/* Tetrahedra: four indices of vertices, in either orientation; all may be on one plane. Rays meet
 * the surface. */
#include "framework/scene/exact.h"
#include "framework/scene/face.h"
#include "framework/scene/prim.h"
#include "framework/scene/tets.h"

#include <math.h>

enum { FACES = 4 };

static void corners_of(const bb_scene *scene, uint32_t i, const float *v[4])
{
    const uint32_t *tet = bb_scene_tet(scene, i);
    for (int c = 0; c < 4; c++)
        v[c] = scene->vertices + 3 * (size_t)tet[c];
}

static void faces_of(const bb_scene *scene, uint32_t i, bb_face faces[FACES])
{
    const float *v[4];
    corners_of(scene, i, v);
    for (int f = 0; f < FACES; f++)
        for (int c = 0; c < 3; c++)
            faces[f].v[c] = v[bb_tet_faces[f][c]];
}

static bb_status bounds(const bb_scene *scene, uint32_t i, bb_box *box)
{
    const uint32_t *tet = bb_scene_tet(scene, i);
    for (int c = 0; c < 4; c++) {
        if (tet[c] >= scene->vertex_count)
            return bb_fail(BB_INVALID, "%s: tetrahedron %u: index %u is beyond its %u vertices",
                           scene->name, i, tet[c], scene->vertex_count);
        const float *v = scene->vertices + 3 * (size_t)tet[c];
        if (!isfinite(v[0]) || !isfinite(v[1]) || !isfinite(v[2]))
            return bb_fail(BB_INVALID,
                           "%s: tetrahedron %u has a vertex that is not finite (%g %g %g)",
                           scene->name, i, (double)v[0], (double)v[1], (double)v[2]);
        for (int axis = 0; axis < 3; axis++) {
            box->lo[axis] = c == 0 || v[axis] < box->lo[axis] ? v[axis] : box->lo[axis];
            box->hi[axis] = c == 0 || v[axis] > box->hi[axis] ? v[axis] : box->hi[axis];
        }
    }
    return BB_OK;
}

/* Returns the product for the smallest face with an area. */
static double product(const bb_scene *scene, uint32_t i)
{
    bb_face faces[FACES];
    double least = 0.0;
    faces_of(scene, i, faces);
    for (int f = 0; f < FACES; f++) {
        double twice = bb_face_twice_area(&faces[f]);
        if (twice > 0.0 && (least == 0.0 || twice < least))
            least = twice;
    }
    return least;
}

static bool is_flat(const bb_scene *scene, uint32_t i)
{
    bb_face faces[FACES];
    bool flat = true;
    faces_of(scene, i, faces);
    for (int f = 0; f < FACES; f++)
        flat = flat && bb_face_is_flat(&faces[f]);
    return flat;
}

static double area(const bb_scene *scene, uint32_t i)
{
    bb_face faces[FACES];
    double sum = 0.0;
    faces_of(scene, i, faces);
    for (int f = 0; f < FACES; f++)
        sum += 0.5 * bb_face_twice_area(&faces[f]);
    return sum;
}

/* Returns how far a point is on the outer side of a face's plane, times the length of `normal`,
 * which is turned to that side: away from the opposite corner. */
static double beyond(const float *const v[4], int f, const bb_face *face, const double point[3],
                     double normal[3])
{
    const double opposite[3] = {v[f][0], v[f][1], v[f][2]};
    double at = 0.0;
    bool inwards = bb_exact_side(opposite, face->v[0], face->v[1], face->v[2]) > 0;
    bb_face_normal(face, normal);
    for (int k = 0; k < 3; k++) {
        at += normal[k] * (point[k] - (double)face->v[0][k]);
        normal[k] = inwards ? -normal[k] : normal[k];
    }
    return inwards ? -at : at;
}

static void sample(const bb_scene *scene, uint32_t i, bb_random *random, double point[3],
                   double out[3])
{
    bb_face faces[FACES];
    const float *v[4];
    double normal[3], side = 0.0;
    faces_of(scene, i, faces);
    corners_of(scene, i, v);
    double left = area(scene, i) * bb_random_unit(random);
    int f = 0;
    while (f < FACES - 1 && left >= 0.5 * bb_face_twice_area(&faces[f]))
        left -= 0.5 * bb_face_twice_area(&faces[f++]);
    bb_face_sample(&faces[f], random, point, out);
    beyond(v, f, &faces[f], point, normal);
    for (int k = 0; k < 3; k++)
        side += normal[k] * out[k];
    for (int k = 0; k < 3 && side < 0.0; k++)
        out[k] = -out[k];
}

/* Returns the outward normal of the face with the nearest plane. */
static void normal(const bb_scene *scene, uint32_t i, const double point[3], double out[3])
{
    bb_face faces[FACES];
    const float *v[4];
    double nearest = (double)INFINITY;
    faces_of(scene, i, faces);
    corners_of(scene, i, v);
    out[0] = out[1] = out[2] = 0.0;
    for (int f = 0; f < FACES; f++) {
        double n[3], length = bb_face_twice_area(&faces[f]);
        double distance = fabs(beyond(v, f, &faces[f], point, n)) / length;
        if (length == 0.0 || distance >= nearest)
            continue;
        nearest = distance;
        for (int k = 0; k < 3; k++)
            out[k] = n[k];
    }
}

/* Shrinks towards the solid, not only its surface, since queries for points look for the inside:
 * the parts of the faces, and corners of the region that are inside. */
static bool shrink(const bb_scene *scene, uint32_t i, double lo[3], double hi[3])
{
    bb_face faces[FACES];
    double low[3], high[3];
    bool any = false;
    faces_of(scene, i, faces);
    for (int corner = 0; corner < 8; corner++) {
        const double at[3] = {corner & 1 ? hi[0] : lo[0], corner & 2 ? hi[1] : lo[1],
                              corner & 4 ? hi[2] : lo[2]};
        if (!bb_tet_holds(scene, i, at))
            continue;
        for (int k = 0; k < 3; k++) {
            low[k] = any ? fmin(low[k], at[k]) : at[k];
            high[k] = any ? fmax(high[k], at[k]) : at[k];
        }
        any = true;
    }
    for (int f = 0; f < FACES; f++) {
        double from[3] = {lo[0], lo[1], lo[2]}, to[3] = {hi[0], hi[1], hi[2]};
        if (!bb_face_shrink(&faces[f], from, to))
            continue;
        for (int k = 0; k < 3; k++) {
            low[k] = any ? fmin(low[k], from[k]) : from[k];
            high[k] = any ? fmax(high[k], to[k]) : to[k];
        }
        any = true;
    }
    for (int k = 0; k < 3 && any; k++) {
        lo[k] = low[k];
        hi[k] = high[k];
    }
    return any;
}

/* ---- for the judge ---- */

static double reach(const bb_scene *scene, uint32_t i, const double o[3])
{
    const float *v[4];
    corners_of(scene, i, v);
    return bb_corners_reach(v, 4, o);
}

static float height(const bb_scene *scene, uint32_t i)
{
    bb_face faces[FACES];
    float least = 0.0f;
    faces_of(scene, i, faces);
    for (int f = 0; f < FACES; f++) {
        float h = bb_face_height(&faces[f]);
        if (h > 0.0f && (least == 0.0f || h < least))
            least = h;
    }
    return least;
}

/* Finds the first and the last of the faces that the line meets; a line within a face's plane meets
 * the other faces at its edges. */
static int hits(const bb_scene *scene, uint32_t i, const double o[3], const float d[3], double t[2])
{
    bb_face faces[FACES];
    int count = 0;
    faces_of(scene, i, faces);
    for (int f = 0; f < FACES; f++) {
        const float *const *v = faces[f].v;
        double at;
        if (!bb_exact_meets_triangle(o, d, v[0], v[1], v[2]) ||
            !bb_exact_plane_t(o, d, v[0], v[1], v[2], &at))
            continue;
        t[0] = count == 0 ? at : fmin(t[0], at);
        t[1] = count == 0 ? at : fmax(t[1], at);
        count = 2;
    }
    return count;
}

/* Gets the interval from the first corner along the line to the last, slightly enlarged. */
static void extent(const float *const v[4], const double o[3], const float d[3], double eps,
                   double t[2])
{
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (double)d[k] * (double)d[k];
    t[0] = (double)INFINITY;
    t[1] = -(double)INFINITY;
    for (int c = 0; c < 4; c++) {
        double along = 0.0;
        for (int k = 0; k < 3; k++)
            along += ((double)v[c][k] - o[k]) * (double)d[k];
        t[0] = fmin(t[0], along / square);
        t[1] = fmax(t[1], along / square);
    }
    t[0] -= 2.0 * eps / sqrt(square);
    t[1] += 2.0 * eps / sqrt(square);
}

/* The faces are moved outwards by eps, within the extent along the line; rounded, like everything
 * that is compared with a margin. Without a volume there is no outside, and a line along a face may
 * be near all of it: 0. */
static int nearby(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                  double eps, double t[2])
{
    bb_face faces[FACES];
    const float *v[4];
    faces_of(scene, i, faces);
    corners_of(scene, i, v);
    if (bb_tet_side(v) == 0)
        return 0;
    extent(v, o, d, eps, t);
    const double long_way = t[1] - t[0];
    for (int f = 0; f < FACES; f++) {
        double n[3], slope = 0.0, grown = eps * bb_face_twice_area(&faces[f]);
        double out = beyond(v, f, &faces[f], o, n) - grown;
        for (int k = 0; k < 3; k++)
            slope += n[k] * (double)d[k];
        if (fabs(slope) * long_way <= 4.0 * grown)
            return 0;
        if (slope < 0.0)
            t[0] = fmax(t[0], -out / slope);
        if (slope > 0.0)
            t[1] = fmin(t[1], -out / slope);
    }
    return t[0] <= t[1] ? 2 : 0;
}

static bb_passing pass(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                       double to)
{
    bb_face faces[FACES];
    bb_passing all = {(double)INFINITY, (double)INFINITY, -(double)INFINITY};
    faces_of(scene, i, faces);
    for (int f = 0; f < FACES; f++) {
        bb_passing p = bb_pass_polygon(frame, faces[f].v, 3, from, to);
        all.distance = fmin(all.distance, p.distance);
        all.t_low = fmin(all.t_low, p.t_low);
        all.t_high = fmax(all.t_high, p.t_high);
    }
    return all;
}

/* Gets all faces: each visible one hides what is behind it. */
static uint32_t outlines(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                         double to, bb_outline out[BB_OUTLINES_MAX])
{
    bb_face faces[FACES];
    uint32_t count = 0;
    faces_of(scene, i, faces);
    for (int f = 0; f < FACES; f++) {
        bb_see_polygon(frame, faces[f].v, 3, from, to, &out[count]);
        count += out[count].count > 0;
    }
    return count;
}

extern const bb_prim_kind bb_prim_tetrahedron;
const bb_prim_kind bb_prim_tetrahedron = {
    .name = "tetrahedron",
    .plural = "tetrahedra",
    .is_mesh = true,
    .extended = hits,
    BB_PRIM_FUNCTIONS,
};
