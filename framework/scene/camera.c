/* Pinhole and parallel projection, in doubles, rounded once. */
#include "framework/scene/camera.h"

#include <math.h>

static double length_of(const double v[3])
{
    return hypot(hypot(v[0], v[1]), v[2]);
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

/* Returns false if the vector has no usable length. */
static bool normalise(double v[3])
{
    double length = length_of(v);
    if (!(length > 0.0) || !isfinite(length))
        return false;
    for (int k = 0; k < 3; k++)
        v[k] /= length;
    return true;
}

bb_status bb_camera_make(const bb_view *view, uint32_t width, uint32_t height, bb_camera *camera)
{
    if (width == 0 || height == 0 || (uint64_t)width * height > INT32_MAX)
        return bb_fail(BB_INVALID,
                       "a picture of %ux%u pixels: give a size from 1x1 up to 2^31 - 1 pixels",
                       width, height);
    double limit = view->parallel ? HUGE_VAL : 179.0;
    if (!(view->fov_y > 0.0 && view->fov_y < limit))
        return bb_fail(BB_INVALID, "view '%s': fov_y %g is not in (0, %g)", view->name, view->fov_y,
                       limit);
    camera->parallel = view->parallel;
    double up[3];
    for (int k = 0; k < 3; k++) {
        camera->eye[k] = view->eye[k];
        camera->forward[k] = view->target[k] - view->eye[k];
        up[k] = view->up[k];
    }
    if (!normalise(camera->forward) || !normalise(up))
        return bb_fail(BB_INVALID, "view '%s': eye and target must differ, up must not be 0",
                       view->name);
    cross(camera->forward, up, camera->right);
    if (length_of(camera->right) < 1e-9 || !normalise(camera->right))
        return bb_fail(BB_INVALID, "view '%s' looks along its up vector", view->name);
    cross(camera->forward, camera->right, camera->down);

    const double degree = 3.14159265358979323846 / 180.0;
    double whole = view->parallel ? view->fov_y : 2.0 * tan(0.5 * degree * view->fov_y);
    double pixel = whole / height;
    for (int k = 0; k < 3; k++) {
        camera->right[k] *= pixel;
        camera->down[k] *= pixel;
        camera->corner[k] = (0.5 - 0.5 * width) * camera->right[k] +
                            (0.5 - 0.5 * height) * camera->down[k] +
                            (view->parallel ? 0.0 : camera->forward[k]);
    }
    return BB_OK;
}

void bb_camera_ray(const bb_camera *camera, double x, double y, bb_ray *ray)
{
    double at[3];
    for (int k = 0; k < 3; k++)
        at[k] = camera->corner[k] + x * camera->right[k] + y * camera->down[k];
    double length = camera->parallel ? 1.0 : length_of(at);
    for (int k = 0; k < 3; k++) {
        ray->o[k] = (float)(camera->parallel ? camera->eye[k] + at[k] : camera->eye[k]);
        ray->d[k] = (float)(camera->parallel ? camera->forward[k] : at[k] / length);
    }
    ray->tmin = 0.0f;
    ray->tmax = INFINITY;
}
