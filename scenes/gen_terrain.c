/* A height field of evenly sized triangles: five octaves of value noise on a regular grid. Flat,
 * open, and easy for Morton codes. */
#include "framework/base/random.h"
#include "framework/scene/scene.h"

#include <math.h>

static const bb_option options_table[] = {
    {"n", "100000", NULL, "number of triangles, rounded to a square grid"},
    {"seed", "1", NULL, "seed"},
    {0},
};

static const double side = 100; /* in scene units; heights are about a tenth of it */
enum { OCTAVES = 5, COARSEST = 4 };

static double lattice(uint64_t seed, uint32_t octave, int64_t x, int64_t z)
{
    uint64_t cell = (uint64_t)octave << 48 ^ (uint64_t)x << 24 ^ (uint64_t)z;
    return (double)(bb_random_mix(seed ^ bb_random_mix(cell + 1)) >> 11) * 0x1p-53;
}

/* Noise at (x, z) in 0..1, bilinear with smoothed fractions. */
static double noise(uint64_t seed, uint32_t octave, double x, double z)
{
    double x0 = floor(x), z0 = floor(z);
    double u = x - x0, v = z - z0;
    u = u * u * (3 - 2 * u);
    v = v * v * (3 - 2 * v);
    int64_t i = (int64_t)x0, j = (int64_t)z0;
    double low = lattice(seed, octave, i, j) * (1 - u) + lattice(seed, octave, i + 1, j) * u;
    double high =
        lattice(seed, octave, i, j + 1) * (1 - u) + lattice(seed, octave, i + 1, j + 1) * u;
    return low * (1 - v) + high * v;
}

static double height(uint64_t seed, double x, double z)
{
    double sum = 0, amplitude = 14, frequency = COARSEST;
    for (uint32_t octave = 0; octave < OCTAVES; octave++) {
        sum += amplitude * noise(seed, octave, x * frequency, z * frequency);
        amplitude *= 0.45;
        frequency *= 2;
    }
    return sum;
}

static void put_quad(bb_scene *scene, uint32_t cells, uint32_t i, uint32_t j)
{
    uint32_t corner = j * (cells + 1) + i;
    uint32_t *to = bb_scene_indices(scene) + 6 * ((size_t)j * cells + i);
    to[0] = to[3] = corner;
    to[1] = corner + cells + 1;
    to[2] = to[4] = corner + cells + 2;
    to[5] = corner + 1;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const bb_view views[] = {
        {"overall", false, {-28, 62, 128}, {50, 6, 48}, {0, 1, 0}, 45},
        {"valley", false, {8, 26, 92}, {60, 8, 40}, {0, 1, 0}, 55},
        {"above", true, {50, 120, 50}, {50, 0, 50}, {0, 0, -1}, 100},
    };
    uint64_t n, seed;
    BB_TRY(bb_spec_u64(spec, options, "n", 2, INT32_MAX, &n));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    uint32_t cells = (uint32_t)floor(sqrt((double)n / 2) + 0.5);
    BB_TRY(bb_scene_reserve_mesh(scene, (uint64_t)(cells + 1) * (cells + 1),
                                 2 * (uint64_t)cells * cells));
    float *to = scene->vertices;
    for (uint32_t j = 0; j <= cells; j++)
        for (uint32_t i = 0; i <= cells; i++, to += 3) {
            double x = (double)i / cells, z = (double)j / cells;
            to[0] = (float)(x * side);
            to[1] = (float)height(seed, x, z);
            to[2] = (float)(z * side);
        }
    for (uint32_t j = 0; j < cells; j++)
        for (uint32_t i = 0; i < cells; i++)
            put_quad(scene, cells, i, j);
    scene->view_count = sizeof views / sizeof views[0];
    for (uint32_t i = 0; i < scene->view_count; i++)
        scene->views[i] = views[i];
    return BB_OK;
}

extern const bb_generator bb_generator_terrain;
const bb_generator bb_generator_terrain = {
    .name = "terrain",
    .summary = "height field of evenly sized triangles",
    .options = options_table,
    .make = make,
};
