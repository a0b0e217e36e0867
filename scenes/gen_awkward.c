/* Triangles that are difficult for builders, one kind of difficulty at a time. */
#include "framework/base/random.h"
#include "framework/scene/scene.h"
#include "scenes/repeatable.h"

#include <math.h>
#include <string.h>

static const bb_option options_table[] = {
    {"kind", "outlier", "outlier|centroids|flat|axis|duplicates|zeros",
     "one far away of all others; one centroid for all; all in a plane; flat on an axis each; 95 % "
     "copies; boxes that end at 0 and at -0"},
    {"n", "10000", NULL, "number of triangles"},
    {"far", "1e8", NULL, "outlier: its distance, in sizes of the others' box"},
    {"seed", "1", NULL, "seed"},
    {0},
};

typedef struct maker {
    bb_random random;
    double size; /* size of a triangle, such that all fill their box about once */
    double far;
    uint32_t n;
} maker;

/* Puts the corners in a small cube somewhere in the unit cube. */
static void put_somewhere(maker *m, float corners[9])
{
    double at[3];
    for (int k = 0; k < 3; k++)
        at[k] = bb_random_unit(&m->random);
    for (int i = 0; i < 9; i++)
        corners[i] = (float)(at[i % 3] + bb_random_range(&m->random, -m->size, m->size));
}

/* Puts a box of any size around the origin, touched by the corners on all sides: its centroid is
 * exactly 0. */
static void put_around_origin(maker *m, float corners[9])
{
    float half[3];
    for (int k = 0; k < 3; k++)
        half[k] = (float)(0.01 + bb_random_unit(&m->random));
    for (int k = 0; k < 3; k++) {
        uint32_t third = bb_random_below(&m->random, 3); /* the corner between both sides */
        for (uint32_t c = 0; c < 3; c++)
            corners[3 * c + k] = c == third ? (float)bb_random_range(&m->random, -half[k], half[k])
                                 : c == (third + 1) % 3 ? -half[k]
                                                        : half[k];
    }
}

/* Puts some corners at 0 and some at -0. Nothing is below 0 on x or above it on y, so that boxes of
 * whole subtrees end at zeros of both signs; z goes both ways. */
static void put_at_zeros(maker *m, float corners[9])
{
    put_somewhere(m, corners);
    uint32_t flat = bb_random_below(&m->random, 4); /* axis; 3: none */
    for (uint32_t axis = 0; axis < 3; axis++) {
        bool below = axis == 1 || (axis == 2 && bb_random_below(&m->random, 2) != 0);
        uint32_t zeros = axis == flat ? 3 : bb_random_below(&m->random, 3); /* number of corners */
        for (uint32_t i = 0; i < 3; i++) {
            float *to = &corners[3 * i + axis];
            float size = i < zeros ? 0 : fabsf(*to);
            bool negative = i < zeros ? bb_random_below(&m->random, 2) != 0 : below;
            *to = negative ? -size : size;
        }
    }
}

static void put(maker *m, const char *kind, uint32_t i, const float *before, float corners[9])
{
    if (strcmp(kind, "centroids") == 0) {
        put_around_origin(m, corners);
        return;
    }
    if (strcmp(kind, "zeros") == 0) {
        put_at_zeros(m, corners);
        return;
    }
    uint32_t distinct = (m->n + 19) / 20;
    if (strcmp(kind, "duplicates") == 0 && i >= distinct) {
        memcpy(corners, before + 9 * (size_t)(i % distinct), 9 * sizeof *corners);
        return;
    }
    put_somewhere(m, corners);
    if (strcmp(kind, "outlier") == 0 && i == m->n - 1)
        for (int k = 0; k < 9; k++)
            corners[k] = (float)(corners[k] + m->far);
    if (strcmp(kind, "flat") == 0)
        corners[2] = corners[5] = corners[8] = 0;
    if (strcmp(kind, "axis") == 0)
        for (uint32_t k = i % 3; k < 9; k += 3)
            corners[k] = corners[i % 3];
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t n, seed;
    maker m;
    const char *kind = bb_spec_value(spec, options, "kind");
    BB_TRY(bb_spec_u64(spec, options, "n", 1, INT32_MAX, &n));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    BB_TRY(bb_spec_double(spec, options, "far", 1, 1e30, &m.far));
    BB_TRY(bb_scene_reserve_mesh(scene, 3 * n, n));
    m.n = (uint32_t)n;
    m.random = bb_random_make(seed, 1);
    m.size = 0.5 / bb_cube_root((double)n);
    for (uint32_t i = 0; i < m.n; i++) {
        put(&m, kind, i, scene->vertices, scene->vertices + 9 * (size_t)i);
        for (uint32_t k = 0; k < 3; k++)
            bb_scene_indices(scene)[3 * (size_t)i + k] = 3 * i + k;
    }
    return BB_OK;
}

extern const bb_generator bb_generator_awkward;
const bb_generator bb_generator_awkward = {
    .name = "awkward",
    .summary = "difficulties for builders: an outlier, equal centroids, flat, duplicates, -0",
    .options = options_table,
    .make = make,
};
