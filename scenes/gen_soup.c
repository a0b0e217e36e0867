/* A soup of triangles with a parameter for each difficulty that builders and tests have, so that
 * one difficulty can be increased while everything else stays. Triangles are isosceles: a long side
 * u and a height v perpendicular to it. The scene is around the origin, where floats are finest. */
#include "framework/base/random.h"
#include "framework/scene/scene.h"
#include "scenes/repeatable.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const bb_option options_table[] = {
    {"n", "10000", NULL, "number of triangles"},
    {"edge", "1", NULL, "longest side, in mean distances of the triangles, 0 to 1e6"},
    {"aspect", "1", NULL, "longest side over height, 1 to 1e12"},
    {"along", "any", "any|diagonal|axis", "direction of the longest sides"},
    {"flat", "1", NULL, "extent in z relative to those in x and y, 0 to 1"},
    {"layer", "1", NULL,
     "likewise, but of the triangles' middles alone: they keep their shapes, 0 to 1"},
    {"cells", "0", NULL, "centres lie on a grid of so many places per axis; 0: anywhere"},
    {"copies", "1", NULL, "how often each triangle occurs"},
    {"centred", "0", NULL, "share of triangles whose boxes have one and the same centroid, 0 to 1"},
    {"sorted", "0", NULL, "share of triangles that come in the order of their x, 0 to 1"},
    {"move", "0", NULL, "the whole scene is moved by this along each axis, in its own sizes"},
    {"scale", "1", NULL, "everything is multiplied by this, 1e-44 to 1e30"},
    {"nan", "0", NULL, "triangles with a corner that is no number: the scene is refused"},
    {"seed", "1", NULL, "seed"},
    {0},
};

typedef struct soup {
    bb_random random;
    uint64_t n, cells, copies, nan;
    double edge, aspect, flat, layer, centred, sorted, move, scale;
    const char *along;
} soup;

static bb_status read(const bb_spec *spec, const bb_option *options, soup *s)
{
    uint64_t seed;
    s->along = bb_spec_value(spec, options, "along");
    BB_TRY(bb_spec_u64(spec, options, "n", 1, INT32_MAX, &s->n));
    BB_TRY(bb_spec_double(spec, options, "edge", 0, 1e6, &s->edge));
    BB_TRY(bb_spec_double(spec, options, "aspect", 1, 1e12, &s->aspect));
    BB_TRY(bb_spec_double(spec, options, "flat", 0, 1, &s->flat));
    BB_TRY(bb_spec_double(spec, options, "layer", 0, 1, &s->layer));
    BB_TRY(bb_spec_u64(spec, options, "cells", 0, 1u << 30, &s->cells));
    BB_TRY(bb_spec_u64(spec, options, "copies", 1, INT32_MAX, &s->copies));
    BB_TRY(bb_spec_double(spec, options, "centred", 0, 1, &s->centred));
    BB_TRY(bb_spec_double(spec, options, "sorted", 0, 1, &s->sorted));
    BB_TRY(bb_spec_double(spec, options, "move", 0, 1e30, &s->move));
    BB_TRY(bb_spec_double(spec, options, "scale", 1e-44, 1e30, &s->scale));
    BB_TRY(bb_spec_u64(spec, options, "nan", 0, s->n, &s->nan));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    s->random = bb_random_make(seed, 5);
    return BB_OK;
}

static void choose_side(soup *s, double u[3])
{
    bb_random_direction(&s->random, u);
    if (strcmp(s->along, "any") == 0)
        return;
    uint32_t axis = bb_random_below(&s->random, 3);
    for (uint32_t k = 0; k < 3; k++) {
        double sign = u[k] < 0 ? -1 : 1;
        u[k] = s->along[0] == 'd' ? sign / sqrt(3.0) : k == axis ? sign : 0;
    }
}

static void choose_perpendicular(soup *s, const double u[3], double v[3])
{
    double length;
    do {
        bb_random_direction(&s->random, v);
        double along = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        length = 0;
        for (int k = 0; k < 3; k++) {
            v[k] -= along * u[k];
            length += v[k] * v[k];
        }
        length = sqrt(length);
    } while (length < 0.01);
    for (int k = 0; k < 3; k++)
        v[k] /= length;
}

/* Returns the middle of a cell of the grid, or a point of the unit cube around the origin. */
static double choose_place(soup *s)
{
    if (s->cells == 0)
        return bb_random_unit(&s->random) - 0.5;
    uint32_t cell = bb_random_below(&s->random, (uint32_t)s->cells);
    return (cell + 0.5) / (double)s->cells - 0.5;
}

/* A box around the origin that its triangle touches on all sides has the exact centroid 0. Its
 * sides are chosen one by one, so that edges of one triangle are not behind those of another. */
static void centre(soup *s, double corners[9])
{
    const double size = s->edge / bb_cube_root((double)s->n);
    for (int k = 0; k < 3; k++) {
        double least = fmin(corners[k], fmin(corners[3 + k], corners[6 + k]));
        double most = fmax(corners[k], fmax(corners[3 + k], corners[6 + k]));
        double half = size * bb_random_range(&s->random, 0.5, 1);
        for (int c = 0; c < 9; c += 3) /* at -half, at half, and between */
            corners[c + k] =
                most > least ? half * (2 * (corners[c + k] - least) / (most - least) - 1) : 0;
    }
}

static void put_triangle(soup *s, double corners[9])
{
    double at[3], u[3], v[3], edge = s->edge / bb_cube_root((double)s->n);
    double height = edge / s->aspect * (s->aspect < 1.2 ? sqrt(0.75) : 1);
    for (int k = 0; k < 3; k++)
        at[k] = choose_place(s) * (k == 2 ? s->layer : 1);
    choose_side(s, u);
    choose_perpendicular(s, u, v);
    for (int k = 0; k < 3; k++) {
        corners[k] = at[k] - u[k] * edge / 2 - v[k] * height / 3;
        corners[3 + k] = at[k] + u[k] * edge / 2 - v[k] * height / 3;
        corners[6 + k] = at[k] + v[k] * height * 2 / 3;
    }
    if (bb_random_unit(&s->random) < s->centred)
        centre(s, corners);
}

static void put_all(soup *s, float *to)
{
    for (uint64_t i = 0; i < s->n; i++, to += 9) {
        double corners[9];
        if (i % s->copies != 0) {
            memcpy(to, to - 9, 9 * sizeof *to);
            continue;
        }
        put_triangle(s, corners);
        for (int k = 2; k < 9; k += 3)
            corners[k] *= s->flat;
        for (int k = 0; k < 9; k++)
            to[k] = (float)((corners[k] + s->move) * s->scale);
    }
}

static int compare_x(const void *a, const void *b)
{
    const float *p = a, *q = b;
    for (int k = 0; k < 9; k++)
        if (p[k] != q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    soup s;
    BB_TRY(read(spec, options, &s));
    BB_TRY(bb_scene_reserve_mesh(scene, 3 * s.n, s.n));
    put_all(&s, scene->vertices);
    qsort(scene->vertices, (size_t)(s.sorted * (double)s.n), 9 * sizeof *scene->vertices,
          compare_x);
    for (uint64_t i = 0; i < s.nan; i++)
        scene->vertices[9 * (i * (s.n / s.nan)) + i % 9] = NAN;
    for (uint64_t i = 0; i < 3 * s.n; i++)
        bb_scene_indices(scene)[i] = (uint32_t)i;
    return BB_OK;
}

extern const bb_generator bb_generator_soup;
const bb_generator bb_generator_soup = {
    .name = "soup",
    .summary = "random triangles with a parameter for each difficulty of builders and tests",
    .options = options_table,
    .make = make,
};
