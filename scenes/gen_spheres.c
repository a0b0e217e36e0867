/* Mixtures of spheres, modelled after the two states of the particle simulation in Gu, Jendersie,
 * Grosch: Fast and Dynamic Construction of Bounding Volume Hierarchies based on Loose Octrees (VMV
 * 2018), section 4.1 and figure 5. The simulation is not published; these scenes have the
 * properties that the text names.
 *
 * initial: centres uniform in the unit cube, radii uniform over their logarithm from 1 to 16, and a
 * total volume of twice the cube, so that they overlap a lot and sizes are mixed everywhere.
 *
 * settled: overlap is minimal and the distribution no longer uniform. Five heaps of different sizes
 * on a floor are filled with cells from the bottom; some cells are divided into eight, and some of
 * those again; each cell contains one sphere that about fills it, slightly off its middle.
 */
#include "framework/base/random.h"
#include "framework/scene/scene.h"
#include "scenes/repeatable.h"

static const bb_option options_table[] = {
    {"n", "1000000", NULL, "number of spheres"},
    {"state", "initial", "initial|settled", "much overlap, or little and not uniform"},
    {"seed", "1", NULL, "seed"},
    {0},
};

static void put_sphere(float *to, const double centre[3], double radius)
{
    for (int axis = 0; axis < 3; axis++)
        to[axis] = (float)centre[axis];
    to[3] = (float)radius;
}

/* ---- initial ---- */

static double initial_radius(bb_random *random)
{
    return bb_power(16, (uint32_t)(bb_random_u64(random) >> (64 - BB_POWER_BITS)));
}

static void fill_initial(uint64_t seed, uint32_t n, float *to)
{
    static const double volume = 2; /* of the cube */
    bb_random radii = bb_random_make(seed, 3);
    double cubes = 0;
    for (uint32_t i = 0; i < n; i++) {
        double radius = initial_radius(&radii);
        cubes += radius * radius * radius;
    }
    /* The sum of 4/3 pi r^3 must be the volume. */
    double scale = bb_cube_root(volume / 4.1887902047863905 * (1e15 / cubes)) * 1e-5;
    radii = bb_random_make(seed, 3);
    bb_random places = bb_random_make(seed, 4);
    for (uint32_t i = 0; i < n; i++, to += 4) {
        double centre[3];
        for (int axis = 0; axis < 3; axis++)
            centre[axis] = bb_random_unit(&places);
        put_sphere(to, centre, scale * initial_radius(&radii));
    }
}

/* ---- settled ---- */

enum { HEAPS = 5, CUTS = 2 };

/* Position on the floor and radius of the base, in radii of the largest heap; the heaps do not
 * touch. */
static const double heaps[HEAPS][3] = {
    {1.4, 1.0, 1}, {3.4, 1.3, 0.8}, {1.8, 2.9, 0.65}, {3.5, 3.2, 0.5}, {0.1, 2.0, 0.35}};

typedef struct filler {
    bb_random random;
    float *to;      /* NULL: only count */
    uint64_t count; /* spheres so far */
    uint64_t limit;
    double cell; /* in scene units */
} filler;

static void fill_cell(filler *filler, const double lo[3], double size, int cuts)
{
    if (filler->count >= filler->limit)
        return;
    if (cuts > 0 && bb_random_unit(&filler->random) < 0.3) {
        for (int part = 0; part < 8; part++) {
            double corner[3];
            for (int axis = 0; axis < 3; axis++)
                corner[axis] = lo[axis] + ((part >> axis & 1) != 0 ? size / 2 : 0);
            fill_cell(filler, corner, size / 2, cuts - 1);
        }
        return;
    }
    double centre[3];
    for (int axis = 0; axis < 3; axis++)
        centre[axis] = lo[axis] + size * (0.5 + bb_random_range(&filler->random, -0.02, 0.02));
    double radius = 0.5 * size * bb_random_range(&filler->random, 0.88, 1.02);
    if (filler->to != NULL)
        put_sphere(filler->to + 4 * filler->count, centre, radius);
    filler->count++;
}

static void fill_layer(filler *filler, const double heap[3], int64_t base, int64_t layer)
{
    int64_t radius = (int64_t)(heap[2] * (double)base) - 3 * layer / 2;
    int64_t x = (int64_t)(heap[0] * (double)base), z = (int64_t)(heap[1] * (double)base);
    for (int64_t j = -radius; j <= radius; j++)
        for (int64_t i = -radius; i <= radius; i++)
            if (i * i + j * j <= radius * radius) {
                const double lo[3] = {(double)(x + i) * filler->cell, (double)layer * filler->cell,
                                      (double)(z + j) * filler->cell};
                fill_cell(filler, lo, filler->cell, CUTS);
            }
}

/* Fills heaps whose largest has a base of `base` cells; returns the number of spheres, at most
 * `limit`. */
static uint64_t fill_settled(uint64_t seed, uint64_t limit, int64_t base, float *to)
{
    filler filler = {bb_random_make(seed, 5), to, 0, limit, 0.25 / (double)base};
    for (int64_t layer = 0; 3 * layer / 2 <= base; layer++)
        for (int heap = 0; heap < HEAPS; heap++)
            fill_layer(&filler, heaps[heap], base, layer);
    return filler.count;
}

/* Finds the smallest base that has room for n. A heap's cells grow with the cube of the base: about
 * 1.26 b^3 for the five. */
static int64_t find_base(uint64_t seed, uint64_t n)
{
    int64_t base = (int64_t)(bb_cube_root((double)n / 8.14 / 1.26) * 0.9);
    base = base < 1 ? 1 : base;
    while (fill_settled(seed, n, base, NULL) < n)
        base++;
    return base;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t n, seed;
    BB_TRY(bb_spec_u64(spec, options, "n", 1, INT32_MAX, &n));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    BB_TRY(bb_scene_reserve(scene, 0, &(bb_prim_counts){.of = {[BB_SPHERE] = n}}));
    float *spheres = bb_scene_floats(scene, BB_SPHERE);
    if (bb_spec_is(spec, options, "state", "settled"))
        fill_settled(seed, n, find_base(seed, n), spheres);
    else
        fill_initial(seed, (uint32_t)n, spheres);
    return BB_OK;
}

extern const bb_generator bb_generator_spheres;
const bb_generator bb_generator_spheres = {
    .name = "spheres",
    .summary = "mixtures of spheres: overlapping, or settled in heaps",
    .options = options_table,
    .make = make,
};
