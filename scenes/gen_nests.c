/* Nests of triangles whose boxes contain each other like Russian dolls, around one centre: no plane
 * separates them, every split leaves overlap, and a ray to the innermost meets all. */
#include "framework/base/random.h"
#include "framework/scene/scene.h"
#include "scenes/repeatable.h"

static const bb_option options_table[] = {
    {"n", "10000", NULL, "number of triangles"},
    {"levels", "10", NULL, "triangles of a nest, 1 to n"},
    {"spread", "1", NULL,
     "how much the sides of a box differ, in steps of size, 0 to 1; 0: cubes, whose diagonals, and "
     "edges of triangles, lie behind each other"},
    {"seed", "1", NULL, "seed"},
    {0},
};

/* Puts a triangle that touches its box around `at`, with half sizes from `inner` to `outer`, on all
 * sides. These differ, so that edges of one triangle are not behind those of another. */
static void put_triangle(bb_random *random, const double at[3], double inner, double outer,
                         float *to)
{
    for (uint32_t k = 0; k < 3; k++) {
        double half = bb_random_range(random, inner, outer);
        uint32_t between = bb_random_below(random, 3); /* the corner that touches neither side */
        for (uint32_t c = 0; c < 3; c++) {
            double side = c == between             ? bb_random_range(random, -half, half)
                          : c == (between + 1) % 3 ? -half
                                                   : half;
            to[3 * c + k] = (float)(at[k] + side);
        }
    }
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t n, levels, seed;
    double spread;
    BB_TRY(bb_spec_u64(spec, options, "n", 1, INT32_MAX, &n));
    BB_TRY(bb_spec_u64(spec, options, "levels", 1, n, &levels));
    BB_TRY(bb_spec_double(spec, options, "spread", 0, 1, &spread));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    BB_TRY(bb_scene_reserve_mesh(scene, 3 * n, n));
    bb_random random = bb_random_make(seed, 6);
    double at[3] = {0, 0, 0}, outer = 0.5 / bb_cube_root((double)((n + levels - 1) / levels));
    for (uint64_t i = 0; i < n; i++) {
        uint64_t level = i % levels;
        for (int k = 0; k < 3 && level == 0; k++)
            at[k] = bb_random_range(&random, -0.5, 0.5);
        double largest = outer * (1 - (double)level / (double)levels);
        put_triangle(&random, at, largest - spread * outer / (double)levels, largest,
                     scene->vertices + 9 * i);
        for (uint64_t k = 3 * i; k < 3 * i + 3; k++)
            bb_scene_indices(scene)[k] = (uint32_t)k;
    }
    return BB_OK;
}

extern const bb_generator bb_generator_nests;
const bb_generator bb_generator_nests = {
    .name = "nests",
    .summary = "boxes within boxes around common centres, which no plane separates",
    .options = options_table,
    .make = make,
};
