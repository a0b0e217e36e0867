/* Hairs that grow out of a ball in wandering paths: ribbons of long thin triangles, each of which
 * fills its box badly. */
#include "framework/base/random.h"
#include "framework/scene/scene.h"

#include <math.h>
#include <string.h>

static const bb_option options_table[] = {
    {"n", "100000", NULL, "number of triangles"},
    {"seed", "1", NULL, "seed"},
    {0},
};

enum { SEGMENTS = 16, HAIR_TRIANGLES = 2 * SEGMENTS, HAIR_VERTICES = 2 * (SEGMENTS + 1) };

static const double core = 0.3, length = 0.06, width = 0.003; /* radius of the ball; of a segment;
                                                               * of a ribbon */

static void normalise(double v[3])
{
    double size = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int axis = 0; axis < 3; axis++)
        v[axis] /= size;
}

/* Puts two vertices per step, half a width to either side of the path. */
static void put_hair(bb_random *random, float *to)
{
    double at[3], ahead[3], side[3], turn[3];
    bb_random_direction(random, ahead);
    bb_random_direction(random, side);
    for (int axis = 0; axis < 3; axis++)
        at[axis] = core * ahead[axis];
    for (int step = 0; step <= SEGMENTS; step++, to += 6) {
        for (int axis = 0; axis < 3; axis++) {
            to[axis] = (float)(at[axis] - 0.5 * width * side[axis]);
            to[3 + axis] = (float)(at[axis] + 0.5 * width * side[axis]);
        }
        bb_random_direction(random, turn);
        for (int axis = 0; axis < 3; axis++) {
            ahead[axis] += 0.45 * turn[axis];
            side[axis] += 0.3 * turn[(axis + 1) % 3];
        }
        normalise(ahead);
        normalise(side);
        for (int axis = 0; axis < 3; axis++)
            at[axis] += length * ahead[axis];
    }
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t n, seed;
    BB_TRY(bb_spec_u64(spec, options, "n", 1, INT32_MAX, &n));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    uint64_t hairs = (n + HAIR_TRIANGLES - 1) / HAIR_TRIANGLES;
    BB_TRY(bb_scene_reserve_mesh(scene, hairs * HAIR_VERTICES, n));
    bb_random random = bb_random_make(seed, 2);
    for (uint64_t hair = 0; hair < hairs; hair++)
        put_hair(&random, scene->vertices + hair * HAIR_VERTICES * 3);
    for (uint64_t i = 0; i < n; i++) { /* the last hair is shortened */
        uint32_t base = (uint32_t)(i / HAIR_TRIANGLES * HAIR_VERTICES + i % HAIR_TRIANGLES);
        const uint32_t corners[2][3] = {{base, base + 1, base + 2}, {base + 1, base, base + 2}};
        memcpy(bb_scene_indices(scene) + 3 * i, corners[i % 2], sizeof corners[0]);
    }
    return BB_OK;
}

extern const bb_generator bb_generator_hairball;
const bb_generator bb_generator_hairball = {
    .name = "hairball",
    .summary = "long thin triangles in wandering hairs",
    .options = options_table,
    .make = make,
};
