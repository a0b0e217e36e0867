/* Triangles: three indices of vertices. */
#include "framework/scene/exact.h"
#include "framework/scene/face.h"
#include "framework/scene/prim.h"

#include <math.h>

static bb_face face_of(const bb_scene *scene, uint32_t i)
{
    return (bb_face){
        {bb_scene_vertex(scene, i, 0), bb_scene_vertex(scene, i, 1), bb_scene_vertex(scene, i, 2)}};
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

static double product(const bb_scene *scene, uint32_t i)
{
    const bb_face face = face_of(scene, i);
    return bb_face_twice_area(&face);
}

static bool is_flat(const bb_scene *scene, uint32_t i)
{
    const bb_face face = face_of(scene, i);
    return bb_face_is_flat(&face);
}

static double area(const bb_scene *scene, uint32_t i)
{
    return 0.5 * product(scene, i);
}

static void normal(const bb_scene *scene, uint32_t i, const double point[3], double out[3])
{
    (void)point;
    const bb_face face = face_of(scene, i);
    bb_face_normal(&face, out);
}

static void sample(const bb_scene *scene, uint32_t i, bb_random *random, double point[3],
                   double out[3])
{
    const bb_face face = face_of(scene, i);
    bb_face_sample(&face, random, point, out);
}

static bool shrink(const bb_scene *scene, uint32_t i, double lo[3], double hi[3])
{
    const bb_face face = face_of(scene, i);
    return bb_face_shrink(&face, lo, hi);
}

/* ---- for the judge ---- */

static double reach(const bb_scene *scene, uint32_t i, const double o[3])
{
    const bb_face face = face_of(scene, i);
    return bb_corners_reach(face.v, 3, o);
}

static float height(const bb_scene *scene, uint32_t i)
{
    const bb_face face = face_of(scene, i);
    return bb_face_height(&face);
}

static int extended(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                    double t[2])
{
    const bb_face f = face_of(scene, i);
    return bb_exact_plane_t(o, d, f.v[0], f.v[1], f.v[2], &t[0]) ? 1 : 0;
}

static int nearby(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                  double eps, double t[2])
{
    (void)eps;
    return extended(scene, i, o, d, t);
}

static int hits(const bb_scene *scene, uint32_t i, const double o[3], const float d[3], double t[2])
{
    const bb_face f = face_of(scene, i);
    return bb_exact_meets_triangle(o, d, f.v[0], f.v[1], f.v[2]) &&
                   bb_exact_plane_t(o, d, f.v[0], f.v[1], f.v[2], &t[0])
               ? 1
               : 0;
}

static bb_passing pass(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                       double to)
{
    const bb_face face = face_of(scene, i);
    return bb_pass_polygon(frame, face.v, 3, from, to);
}

static uint32_t outlines(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                         double to, bb_outline out[BB_OUTLINES_MAX])
{
    const bb_face face = face_of(scene, i);
    bb_see_polygon(frame, face.v, 3, from, to, &out[0]);
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
