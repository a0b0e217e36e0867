/* Equilateral triangles in random places and orientations, with edges uniform over the logarithm of
 * the sizes: codes of centroids alone do not distinguish them. */
#include "framework/base/random.h"
#include "framework/scene/scene.h"
#include "scenes/repeatable.h"

#include <math.h>

static const bb_option options_table[] = {
    {"n", "100000", NULL, "number of triangles"},
    {"ratio", "1", NULL, "longest edge / shortest edge, 1 to 1e6"},
    {"seed", "1", NULL, "seed"},
    {0},
};

static void put_triangle(bb_random *random, double edge, float *to)
{
    double centre[3], u[3], v[3], along, length = 0;
    for (int axis = 0; axis < 3; axis++)
        centre[axis] = bb_random_unit(random);
    bb_random_direction(random, u);
    do {
        bb_random_direction(random, v);
        along = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        for (int axis = 0; axis < 3; axis++)
            v[axis] -= along * u[axis];
        length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    } while (length < 0.01);
    /* Corners at (2/3 h) v and (-1/3 h) v -+ (1/2 edge) u, the height h being edge * sqrt(3) / 2.
     */
    double height = edge * sqrt(3.0) / 2;
    for (int axis = 0; axis < 3; axis++) {
        double up = v[axis] / length * height, side = u[axis] * edge / 2;
        to[axis] = (float)(centre[axis] + up * 2 / 3);
        to[3 + axis] = (float)(centre[axis] - up / 3 - side);
        to[6 + axis] = (float)(centre[axis] - up / 3 + side);
    }
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t n, seed;
    double ratio;
    BB_TRY(bb_spec_u64(spec, options, "n", 1, INT32_MAX, &n));
    BB_TRY(bb_spec_double(spec, options, "ratio", 1, 1e6, &ratio));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    BB_TRY(bb_scene_reserve_mesh(scene, 3 * n, n));
    bb_random random = bb_random_make(seed, 1);
    /* The middle size is the mean distance of the centres; the largest is at most half the scene.
     */
    double longest = fmin(0.5, sqrt(ratio) / bb_cube_root((double)n));
    for (uint32_t i = 0; i < scene->prims[BB_TRIANGLE].count; i++) {
        uint32_t bits = (uint32_t)(bb_random_u64(&random) >> (64 - BB_POWER_BITS));
        if (i < 2)
            bits = i == 0 ? 0 : (1u << BB_POWER_BITS) - 1; /* both ends occur with any seed */
        put_triangle(&random, longest / ratio * bb_power(ratio, bits),
                     scene->vertices + 9 * (size_t)i);
        for (uint32_t k = 0; k < 3; k++)
            bb_scene_indices(scene)[3 * (size_t)i + k] = 3 * i + k;
    }
    return BB_OK;
}

extern const bb_generator bb_generator_random;
const bb_generator bb_generator_random = {
    .name = "random",
    .summary = "random equilateral triangles in the unit cube, with a ratio of sizes",
    .options = options_table,
    .make = make,
};
