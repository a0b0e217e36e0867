/* Rotations are random unit quaternions (Shoemake: Uniform Random Rotations, Graphics Gems III,
 * 1992), sampled by rejection: + - * / and square roots are the same on every machine. */
#include "scenes/placement.h"

#include "framework/base/random.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void set_turn(uint64_t number, double turn[3][3])
{
    bb_random random = bb_random_make(number, 0x7475726e);
    double q[4], square;
    do {
        square = 0;
        for (int k = 0; k < 4; k++) {
            q[k] = bb_random_range(&random, -1, 1);
            square += q[k] * q[k];
        }
    } while (square > 1 || square < 0x1p-20);
    double length = sqrt(square);
    double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    const double rows[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
    };
    memcpy(turn, rows, sizeof rows);
}

bb_status bb_placement_read(const bb_spec *spec, const bb_option *options, bb_placement *out)
{
    uint64_t turn;
    BB_TRY(bb_spec_double(spec, options, "scale", 1e-15, 1e15, &out->scale));
    BB_TRY(bb_spec_u64(spec, options, "turn", 0, UINT64_MAX, &turn));
    out->turned = turn > 0;
    if (out->turned)
        set_turn(turn, out->turn);
    return BB_OK;
}

bb_status bb_placement_check(const bb_placement *placement, const bb_spec *spec, double farthest,
                             double detail)
{
    float far = (float)farthest;
    double step = (double)nextafterf(far, INFINITY) - (double)far;
    if (placement->turned && !(detail >= 2 * step))
        return bb_fail(BB_INVALID,
                       "%s: details of %g lie %g from the origin, where floats are %g apart: take "
                       "larger details, a smaller scene, or turn=0",
                       spec->text, detail, farthest, step);
    return BB_OK;
}

static void turn_vector(const bb_placement *placement, const double v[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        const double *row = placement->turn[k];
        out[k] = placement->turned ? row[0] * v[0] + row[1] * v[1] + row[2] * v[2] : v[k];
    }
}

void bb_placement_point(const bb_placement *placement, const double p[3], double out[3])
{
    turn_vector(placement, p, out);
    for (int k = 0; k < 3; k++)
        out[k] *= placement->scale;
}

void bb_placement_view(const bb_placement *placement, bb_scene *scene, const char *name,
                       const double eye[3], const double target[3], const double up[3], double fov)
{
    bb_view *view = &scene->views[scene->view_count++];
    *view = (bb_view){.fov_y = fov};
    snprintf(view->name, sizeof view->name, "%s", name);
    bb_placement_point(placement, eye, view->eye);
    bb_placement_point(placement, target, view->target);
    turn_vector(placement, up, view->up);
}

void bb_placement_inside(const bb_placement *placement, bb_scene *scene, const double p[3])
{
    scene->closed_from_inside = true;
    bb_placement_point(placement, p, scene->inside_point);
}
