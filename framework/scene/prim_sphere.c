/* Spheres: centre and radius. */
#include "framework/scene/exact.h"
#include "framework/scene/prim.h"

#include <math.h>

static const float *sphere_of(const bb_scene *scene, uint32_t i)
{
    return bb_scene_floats(scene, BB_SPHERE) + 4 * (size_t)i;
}

/* Returns the largest float not above a + b. The double sum plus its error is exact (Knuth's
 * two-sum), so the result bounds the true sum, however far apart the two are. */
static float sum_down(float a, float b)
{
    double x = a, y = b;
    double sum = x + y;
    double part = sum - x;
    double error = (x - (sum - part)) + (y - part);
    float down = (float)sum;
    if ((double)down > sum || ((double)down == sum && error < 0))
        down = nextafterf(down, -INFINITY);
    return down;
}

static bb_status bounds(const bb_scene *scene, uint32_t i, bb_box *box)
{
    const float *s = sphere_of(scene, i);
    bool good = isfinite(s[3]) && s[3] >= 0;
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = sum_down(s[axis], -s[3]);
        box->hi[axis] = -sum_down(-s[axis], -s[3]);
        good = good && isfinite(s[axis]) && isfinite(box->lo[axis]) && isfinite(box->hi[axis]);
    }
    if (!good)
        return bb_fail(BB_INVALID,
                       "%s: sphere %u (centre %g %g %g, radius %g) must be finite, its radius not "
                       "negative",
                       scene->name, i, (double)s[0], (double)s[1], (double)s[2], (double)s[3]);
    return BB_OK;
}

static double product(const bb_scene *scene, uint32_t i)
{
    double radius = sphere_of(scene, i)[3];
    return radius * radius;
}

static bool is_flat(const bb_scene *scene, uint32_t i)
{
    return sphere_of(scene, i)[3] == 0;
}

static double area(const bb_scene *scene, uint32_t i)
{
    double radius = sphere_of(scene, i)[3];
    return 4.0 * acos(-1.0) * radius * radius;
}

static void normal(const bb_scene *scene, uint32_t i, const double point[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = point[k] - (double)sphere_of(scene, i)[k];
}

static void sample(const bb_scene *scene, uint32_t i, bb_random *random, double point[3],
                   double out[3])
{
    const float *s = sphere_of(scene, i);
    bb_random_direction(random, out);
    for (int k = 0; k < 3; k++)
        point[k] = (double)s[k] + (double)s[3] * out[k];
}

/* Decides by the distances from the centre to the nearest and the farthest point of the box; the
 * box stays as it is. */
static bool shrink(const bb_scene *scene, uint32_t i, double lo[3], double hi[3])
{
    const float *s = sphere_of(scene, i);
    double nearest = 0.0, farthest = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        double below = lo[axis] - s[axis], above = hi[axis] - s[axis];
        double near = below > 0.0 ? below : above < 0.0 ? above : 0.0;
        double far = fmax(fabs(below), fabs(above));
        nearest += near * near;
        farthest += far * far;
    }
    double radius = s[3];
    return nearest <= radius * radius && radius * radius <= farthest;
}

static double reach(const bb_scene *scene, uint32_t i, const double o[3])
{
    const float *s = sphere_of(scene, i);
    double largest = 0.0;
    for (int k = 0; k < 3; k++)
        largest = fmax(largest, fabs((double)s[k] - o[k]) + (double)s[3]);
    return largest;
}

static float height(const bb_scene *scene, uint32_t i)
{
    return 2.0f * sphere_of(scene, i)[3];
}

static int extended(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                    double t[2])
{
    return bb_exact_sphere_t(o, d, sphere_of(scene, i), t) ? 2 : 0;
}

static int hits(const bb_scene *scene, uint32_t i, const double o[3], const float d[3], double t[2])
{
    return bb_exact_meets_sphere(o, d, sphere_of(scene, i)) ? extended(scene, i, o, d, t) : 0;
}

/* Returns 0: near the extent from pass(), the point of the line nearest to the centre. */
static int nearby(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                  double eps, double t[2])
{
    (void)scene, (void)i, (void)o, (void)d, (void)eps, (void)t;
    return 0;
}

static bb_passing pass(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                       double to)
{
    return bb_pass_ball(frame, sphere_of(scene, i), from, to);
}

static uint32_t outlines(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                         double to, bb_outline out[BB_OUTLINES_MAX])
{
    (void)scene, (void)i, (void)frame, (void)from, (void)to, (void)out;
    return 0;
}

static void mirror(bb_scene *scene, uint32_t i, int axis, float lo, float hi)
{
    float *at = &bb_scene_floats(scene, BB_SPHERE)[4 * (size_t)i + (size_t)axis];
    *at = bb_mirrored(*at, lo, hi);
}

extern const bb_prim_kind bb_prim_sphere;
const bb_prim_kind bb_prim_sphere = {
    .name = "sphere",
    .plural = "spheres",
    .extended = extended,
    .mirror = mirror,
    BB_PRIM_FUNCTIONS,
};
