/* A huge ground with small objects on it, in rows around the origin: balls, and stones, which are
 * closed meshes. A margin in proportion to the ground would hide everything on it, and edges as
 * long as the ground run beneath the objects. */
#include "framework/base/random.h"
#include "scenes/shapes.h"

#include <math.h>

static const bb_option options_table[] = {
    {"reach", "1e6", NULL, "the ground goes from -reach to reach in x and z"},
    {"cuts", "1", NULL, "the ground is cut into cuts * cuts squares of two triangles each"},
    {"balls", "16", NULL, "number of spheres of radius 0.4"},
    {"stones", "16", NULL, "number of closed meshes of 32 triangles each, of radius 0.1 to 0.4"},
    {"seed", "1", NULL, "seed: what stands where"},
    BB_PLACEMENT_OPTIONS,
    {0},
};

enum { STONE_CUTS = 2, THINGS_MAX = 10000000 };
static const double ball_radius = 0.4;

static void put_ground(double reach, uint32_t cuts, bb_shape_cursor *cursor)
{
    uint32_t across = cuts + 1;
    for (uint32_t j = 0; j <= cuts; j++)
        for (uint32_t i = 0; i <= cuts; i++)
            bb_shape_vertex(cursor, (const double[3]){reach * (2.0 * i / cuts - 1), 0,
                                                      reach * (2.0 * j / cuts - 1)});
    for (uint32_t j = 0; j < cuts; j++)
        for (uint32_t i = 0; i < cuts; i++) {
            uint32_t corner = j * across + i;
            bb_shape_quad(cursor, corner, corner + across, corner + across + 1, corner + 1);
        }
}

/* Puts balls and stones in random order, one per unit square, in rows centred at the origin. */
static void put_things(uint64_t balls, uint64_t stones, uint64_t seed,
                       const bb_placement *placement, bb_shape_cursor *cursor, bb_scene *scene)
{
    bb_random random = bb_random_make(seed, 1);
    uint64_t things = balls + stones, row = (uint64_t)ceil(sqrt((double)things));
    for (uint64_t i = 0; i < things; i++) {
        double middle = 0.5 * (double)(row - 1), placed[3];
        bool is_ball = bb_random_below(&random, (uint32_t)(things - i)) < balls;
        double radius = is_ball ? ball_radius : bb_random_range(&random, 0.1, 0.4);
        double x = (double)(i % row) - middle + bb_random_range(&random, -0.1, 0.1);
        double z = (double)(i / row) - middle + bb_random_range(&random, -0.1, 0.1);
        const double centre[3] = {x, radius, z};
        if (!is_ball) {
            bb_shape_sphere(cursor, centre, radius, STONE_CUTS);
            continue;
        }
        float *to =
            bb_scene_floats(scene, BB_SPHERE) + 4 * (scene->prims[BB_SPHERE].count - balls--);
        bb_placement_point(placement, centre, placed);
        for (int k = 0; k < 3; k++)
            to[k] = (float)placed[k];
        to[3] = (float)(radius * placement->scale);
    }
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const double above[3] = {0, 5, 0}, beside[3] = {-6, 0.5, -1.5}, below[3] = {0, 0, 0};
    static const double to_z[3] = {0, 0, 1}, to_y[3] = {0, 1, 0};
    bb_placement placement;
    double reach;
    uint64_t cuts, balls, stones, seed;
    BB_TRY(bb_placement_read(spec, options, &placement));
    BB_TRY(bb_spec_double(spec, options, "reach", 1, 1e15, &reach));
    BB_TRY(bb_spec_u64(spec, options, "cuts", 1, 10000, &cuts));
    BB_TRY(bb_spec_u64(spec, options, "balls", 0, THINGS_MAX, &balls));
    BB_TRY(bb_spec_u64(spec, options, "stones", 0, THINGS_MAX, &stones));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    /* Otherwise the rounded corners of a turned ground would lift it above the objects on it. */
    BB_TRY(bb_placement_check(&placement, spec, sqrt(2.0) * reach, ball_radius));
    const bb_prim_counts counts = {
        .of = {[BB_TRIANGLE] = 2 * cuts * cuts + stones * bb_shape_sphere_triangles(STONE_CUTS),
               [BB_SPHERE] = balls}};
    BB_TRY(bb_scene_reserve(
        scene, (cuts + 1) * (cuts + 1) + stones * bb_shape_sphere_vertices(STONE_CUTS), &counts));
    bb_shape_cursor cursor = bb_shape_start(scene, &placement);
    put_ground(reach, (uint32_t)cuts, &cursor);
    put_things(balls, stones, seed, &placement, &cursor, scene);
    bb_placement_view(&placement, scene, "above", above, below, to_z, 60);
    bb_placement_view(&placement, scene, "grazing", beside, below, to_y, 40);
    return BB_OK;
}

extern const bb_generator bb_generator_ground;
const bb_generator bb_generator_ground = {
    .name = "ground",
    .summary = "huge ground with small balls and stones on it, seen from close above and grazing",
    .options = options_table,
    .make = make,
};
